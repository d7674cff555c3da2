//! The mirror images of a brush.

use glam::Vec3;

/// Signs of the mirror images of a brush, itself left out.
pub fn mirrors(symmetry: [bool; 3]) -> impl Iterator<Item = Vec3> {
    (1..8u32).filter(move |m| (0..3).all(|axis| m >> axis & 1 == 0 || symmetry[axis])).map(|m| {
        let sign = |axis: u32| if m >> axis & 1 == 1 { -1.0 } else { 1.0 };
        Vec3::new(sign(0), sign(1), sign(2))
    })
}

//! A round tool pushing through clay: what its swept path covers is moved out to its side.

use glam::Vec3;

use crate::{Kernel, PageIn, PageOut};

/// A ball on its way.
#[derive(Debug, Clone, Copy)]
pub struct Push {
    from: Vec3,
    along: Vec3,
    inv_length2: f32,
    radius: f32,
    strength: f32,
}

impl Push {
    /// A ball of `radius` swept from `from` to `to`; `strength` 0 to 1 is the share of the way out.
    pub fn new(from: Vec3, to: Vec3, radius: f32, strength: f32) -> Self {
        let along = to - from;
        let length2 = along.length_squared();
        Push {
            from,
            along,
            inv_length2: if length2 > 0.0 { 1.0 / length2 } else { 0.0 },
            radius,
            strength,
        }
    }
}

impl Kernel for Push {
    #[inline(always)]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        for i in 0..page.own() {
            let p = page.positions.get(i);
            let t = ((p - self.from).dot(self.along) * self.inv_length2).clamp(0.0, 1.0);
            let off = p - (self.from + self.along * t);
            let d = off.length();
            if d < self.radius {
                out.visit();
                // On the axis itself the surface's own normal says where "out" is not: inward.
                let dir = if d > 0.0 { off / d } else { -page.normals.get(i) };
                out.set(i, p + dir * ((self.radius - d) * self.strength * (1.0 - page.mask(i))));
            }
        }
    }
}

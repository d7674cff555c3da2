//! The numbers that a frame is drawn with, as the shader has them.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use super::provisional::ProvisionalDabs;
use crate::look::SCALE;
use sculptd_clay::Page;

/// One for the world, and one for each object in its own frame.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Frame {
    pub(super) view_projection: [[f32; 4]; 4],
    pub(super) right: [f32; 4],
    pub(super) up: [f32; 4],
    pub(super) back: [f32; 4],
    pub(super) brush: [f32; 4],
    pub(super) base: [f32; 4],
    pub(super) finish: [f32; 4],
    pub(super) map: [f32; 4],
    pub(super) scale: [[f32; 4]; SCALE],
    pub(super) low: [f32; 4],
    pub(super) high: [f32; 4],
    pub(super) light: [f32; 4],
    pub(super) backdrop: [f32; 4],
    pub(super) main_light: [f32; 4],
    pub(super) shadow: [[f32; 4]; 4],
    pub(super) led: ProvisionalDabs,
}

/// Returns true if a page's box may be visible: not wholly beyond one plane of the view.
pub(super) fn in_view(matrix: &Mat4, page: &Page) -> bool {
    let (lo, hi) = page.bounds();
    let mut beyond = [0u8; 5];
    for corner in 0..8u32 {
        let pick = |axis: u32, lo: f32, hi: f32| if corner >> axis & 1 == 0 { lo } else { hi };
        let p = Vec3::new(pick(0, lo.x, hi.x), pick(1, lo.y, hi.y), pick(2, lo.z, hi.z));
        let c = *matrix * p.extend(1.0);
        for (n, out) in
            beyond.iter_mut().zip([c.x < -c.w, c.x > c.w, c.y < -c.w, c.y > c.w, c.w <= 0.0])
        {
            *n += u8::from(out);
        }
    }
    beyond.iter().all(|&n| n < 8)
}

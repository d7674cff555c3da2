//! Carrying clay along: what is near the tool moves with it, less toward the rim.

use glam::Vec3;

use crate::{Kernel, PageIn, PageOut};

/// A ball of clay that is carried along.
#[derive(Debug, Clone, Copy)]
pub struct Drag {
    centre: Vec3,
    by: Vec3,
    inv_radius: f32,
}

impl Drag {
    /// `by` in mesh units; longer than half the radius it is cut to that, so that the surface does
    /// not fold over itself in one step (callers step long moves).
    pub fn new(centre: Vec3, by: Vec3, radius: f32) -> Self {
        Drag { centre, by: by.clamp_length_max(radius * 0.5), inv_radius: 1.0 / radius }
    }
}

impl Kernel for Drag {
    #[inline(always)]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        for i in 0..page.own() {
            let p = page.positions.get(i);
            let x = (p - self.centre).length() * self.inv_radius;
            if x < 1.0 {
                out.visit();
                // Smooth to the second order at the rim and flat at the middle, so that what is
                // held moves as one piece.
                let w = 1.0 - x * x * x * (x * (x * 6.0 - 15.0) + 10.0);
                out.set(i, p + self.by * (w * (1.0 - page.mask(i))));
            }
        }
    }
}

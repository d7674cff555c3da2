//! Takes back what the stroke did about a point: for dabs that are not final until the pen lifts.

use glam::Vec3;

use crate::{Kernel, PageIn, PageOut};

/// Sets every vertex whose place at the start of the stroke lay within the ball to what it was
/// then.
#[derive(Debug, Clone, Copy)]
pub struct Restore {
    /// The middle of the ball.
    pub centre: Vec3,
    /// Its radius, mesh units.
    pub radius: f32,
}

impl Kernel for Restore {
    #[inline(always)]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        for v in 0..page.own() {
            let before = page.before(v);
            if (before - self.centre).length_squared() <= self.radius * self.radius {
                out.visit();
                out.set(v, before);
                out.set_mask(v, page.mask_before(v));
                let colour = page.colour_before(v);
                if colour != page.colour(v) {
                    out.set_colour(v, colour);
                }
                let set = page.face_set_before(v);
                if set != page.face_set(v) {
                    out.set_face_set(v, set);
                }
            }
        }
    }
}

//! The mask of the whole work: each change is one step of undo, and costs as much as the work is
//! large, in portions that whoever runs it decides.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::mask_blur::{sharper, slope};
use crate::brush::automask::hollow;
use crate::{Kernel, PageIn, PageOut, Reach};

/// An operation on the whole mask.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MaskAction {
    /// Clears the mask.
    Clear,
    /// Masks everything.
    Fill,
    /// Inverts the mask.
    Invert,
    /// To the mean of the neighbours.
    Blur,
    /// Edges of the mask become steeper.
    Sharpen,
    /// Each vertex takes the greatest mask of its neighbours.
    Grow,
    /// The least.
    Shrink,
    /// Masks hollows of at least this value: mean curvature times a tenth of the clay's bounding
    /// radius.
    Cavity(f32),
}

impl MaskAction {
    /// Everything.
    pub fn reach() -> Reach {
        Reach::Sphere { centre: Vec3::ZERO, radius: f32::INFINITY }
    }
}

/// An action on a work of this bounding radius.
#[derive(Debug, Clone, Copy)]
pub struct MaskAll {
    /// The operation.
    pub action: MaskAction,
    /// The bounding radius, mesh units.
    pub extent: f32,
}

impl Kernel for MaskAll {
    // It is carried out in portions.
    const SEES_START: bool = true;

    #[inline(always)]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        for v in 0..page.own() {
            let m = page.mask(v);
            let ring = || page.ring(v).map(|k| page.mask(k as usize));
            out.visit();
            out.set_mask(
                v,
                match self.action {
                    MaskAction::Clear => 0.0,
                    MaskAction::Fill => 1.0,
                    MaskAction::Invert => 1.0 - m,
                    MaskAction::Blur => m + slope(page, v),
                    MaskAction::Sharpen if m > 0.0 && m < 1.0 => m + sharper(page, v),
                    MaskAction::Sharpen => m,
                    MaskAction::Grow => ring().fold(m, f32::max),
                    MaskAction::Shrink => ring().fold(m, f32::min),
                    // Over a tenth of the measure it goes from free to protected.
                    MaskAction::Cavity(least) => {
                        m.max((hollow(page, v) * self.extent * 0.1 - least) * 10.0)
                    }
                },
            );
        }
    }
}

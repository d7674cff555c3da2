//! Levelling: what lies over or under the mean plane beneath the brush goes a share of the way to
//! it. [`super::fill`], [`super::flatten`] and [`super::scrape`] are this brush.
//!
//! The plane is that of the surface as the stroke found it (unless the stroke accumulates): a plane
//! that followed what the stroke has levelled so far would depend on how closely its dabs lie.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};

/// One dab of a levelling brush. `SIDE` selects the clay to level: 1 above the plane, -1 below it,
/// 0 both. Inverted, 1 and -1 change places, and 0 moves away from the plane.
#[derive(Debug, Clone, Copy)]
pub struct LevelBrush<const SIDE: i8> {
    plane: Plane,
}

impl<const SIDE: i8> Brush for LevelBrush<SIDE> {
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "offset",
        value: 0.0,
        min: -1.0,
        max: 1.0,
        about: "how far the plane is moved along its normal, in radii",
    }];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let plane = if dab.settings.accumulate {
            on.plane(dab, dab.extra(0))
        } else {
            on.plane_before(dab, dab.extra(0))
        };
        LevelBrush { plane }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let h = self.plane.height(spot.p);
        if SIDE != 0 && h * dab.sign * f32::from(SIDE) <= 0.0 {
            return VertexChange::default();
        }
        let way = if SIDE == 0 { dab.sign } else { 1.0 };
        VertexChange::by(self.plane.normal * (-h * way * part(dab.pace, spot.weight)))
    }
}

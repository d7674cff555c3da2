//! Flatten: both hills and hollows to the mean plane; the other way round it deepens them.

use super::dab::{Brush, Dab, VertexChange, VertexContext};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};

/// One dab of flatten, made ready.
#[derive(Debug, Clone, Copy)]
pub struct FlattenBrush {
    plane: Plane,
}

impl Brush for FlattenBrush {
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "offset",
        value: 0.0,
        min: -1.0,
        max: 1.0,
        about: "how far the plane is moved along its normal, in radii",
    }];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        FlattenBrush { plane: on.plane(dab, dab.extra(0)) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let h = self.plane.height(spot.p);
        VertexChange::by(self.plane.normal * (-h * dab.sign * dab.share * spot.weight))
    }
}

//! Fill: hollows up to the mean plane, hills stay; the other way round hills down to it.

use super::dab::{Brush, Dab, VertexChange, VertexContext};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};

/// One dab of fill, made ready.
#[derive(Debug, Clone, Copy)]
pub struct FillBrush {
    plane: Plane,
}

impl Brush for FillBrush {
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "offset",
        value: 0.0,
        min: -1.0,
        max: 1.0,
        about: "how far the plane is moved along its normal, in radii",
    }];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        FillBrush { plane: on.plane(dab, dab.extra(0)) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let h = self.plane.height(spot.p);
        if h * -dab.sign <= 0.0 {
            return VertexChange::default();
        }
        VertexChange::by(self.plane.normal * (-h * dab.share * spot.weight))
    }
}

//! Clay: fills up to a plane a little over the surface, so that it builds in flat coats; the other
//! way round it wears down.

use super::dab::{Brush, VertexChange, Dab, VertexContext};
use super::preset::OwnNumber;
use crate::brush::surface_query::{SurfaceQuery, Plane};

#[derive(Debug, Clone, Copy)]
pub struct ClayBrush {
    plane: Plane,
}

impl Brush for ClayBrush {
    const OWN_NUMBERS: &'static [OwnNumber] = &[
        OwnNumber {
            name: "lift",
            value: 0.12,
            min: 0.0,
            max: 1.0,
            about: "how far over the surface the plane stands, in radii, at full strength",
        },
    ];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        ClayBrush { plane: on.plane(dab, dab.extra(0) * dab.sign * dab.strength) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        coat(&self.plane, dab.sign, spot)
    }
}

/// Moves what lies under the plane (over it, if `sign` is negative) up to it, by its weight.
pub(super) fn coat(plane: &Plane, sign: f32, spot: &VertexContext<'_>) -> VertexChange {
    let h = plane.height(spot.p);
    if h * sign >= 0.0 { VertexChange::default() } else { VertexChange::by(plane.normal * (-h * spot.weight)) }
}

//! Clay: fills up to a plane a little over the surface, so that it builds in flat coats; the other
//! way round it wears down.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::{Ground, Plane};

#[derive(Debug, Clone, Copy)]
pub struct ClayBrush {
    plane: Plane,
}

impl Brush for ClayBrush {
    fn ready(dab: &Dab<'_>, on: &mut Ground<'_>) -> Self {
        ClayBrush { plane: on.plane(dab, dab.extra(0) * dab.sign * dab.strength) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        coat(&self.plane, dab.sign, spot)
    }
}

/// Moves what lies under the plane (over it, if `sign` is negative) up to it, by its weight.
pub(super) fn coat(plane: &Plane, sign: f32, spot: &Spot<'_>) -> Change {
    let h = plane.height(spot.p);
    if h * sign >= 0.0 { Change::default() } else { Change::by(plane.normal * (-h * spot.weight)) }
}

//! Trim: cuts off what stands over a plane set a little below the surface, as a knife does:
//! whatever is deep within the brush comes to lie on the plane at once. The other way round it
//! fills to a plane set over the surface.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::{Ground, Plane};

#[derive(Debug, Clone, Copy)]
pub struct TrimBrush {
    plane: Plane,
}

impl Brush for TrimBrush {
    fn ready(dab: &Dab<'_>, on: &mut Ground<'_>) -> Self {
        TrimBrush { plane: on.plane(dab, -dab.sign * dab.extra(0) * dab.strength) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        let h = self.plane.height(spot.p);
        if h * dab.sign <= 0.0 {
            return Change::default();
        }
        // A knife has no soft edge: a third of the falloff is all the fading there is.
        Change::by(self.plane.normal * (-h * (spot.weight * 3.0).min(1.0)))
    }
}

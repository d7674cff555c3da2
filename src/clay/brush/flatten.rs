//! Flatten: both hills and hollows to the mean plane; the other way round it deepens them.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::{Ground, Plane};

#[derive(Debug, Clone, Copy)]
pub struct FlattenBrush {
    plane: Plane,
}

impl Brush for FlattenBrush {
    fn ready(dab: &Dab<'_>, on: &mut Ground<'_>) -> Self {
        FlattenBrush { plane: on.plane(dab, dab.extra(0)) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        let h = self.plane.height(spot.p);
        Change::by(self.plane.normal * (-h * dab.sign * dab.strength * spot.weight))
    }
}

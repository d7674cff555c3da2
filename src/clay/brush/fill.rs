//! Fill: hollows up to the mean plane, hills stay; the other way round hills down to it.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::{Ground, Plane};

#[derive(Debug, Clone, Copy)]
pub struct FillBrush {
    plane: Plane,
}

impl Brush for FillBrush {
    fn ready(dab: &Dab<'_>, on: &mut Ground<'_>) -> Self {
        FillBrush { plane: on.plane(dab, dab.extra(0)) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        let h = self.plane.height(spot.p);
        if h * -dab.sign <= 0.0 {
            return Change::default();
        }
        Change::by(self.plane.normal * (-h * dab.strength * spot.weight))
    }
}

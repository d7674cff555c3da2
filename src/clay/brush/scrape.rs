//! Scrape: hills down to the mean plane, hollows stay; the other way round hollows up to it.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::{Ground, Plane};

#[derive(Debug, Clone, Copy)]
pub struct ScrapeBrush {
    plane: Plane,
}

impl Brush for ScrapeBrush {
    fn ready(dab: &Dab<'_>, on: &mut Ground<'_>) -> Self {
        ScrapeBrush { plane: on.plane(dab, dab.extra(0)) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        let h = self.plane.height(spot.p);
        if h * dab.sign <= 0.0 {
            return Change::default();
        }
        Change::by(self.plane.normal * (-h * dab.strength * spot.weight))
    }
}

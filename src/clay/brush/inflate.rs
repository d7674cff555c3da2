//! Inflate: every vertex along its own normal, so that the form swells, or shrinks.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::Ground;

#[derive(Debug, Clone, Copy)]
pub struct InflateBrush;

impl Brush for InflateBrush {
    fn ready(_: &Dab<'_>, _: &mut Ground<'_>) -> Self {
        InflateBrush
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        Change::by(spot.normal() * (dab.height() * spot.weight))
    }
}

//! Paint: lays the brush's colour on.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::Ground;

#[derive(Debug, Clone, Copy)]
pub struct PaintBrush;

impl Brush for PaintBrush {
    fn ready(_: &Dab<'_>, _: &mut Ground<'_>) -> Self {
        PaintBrush
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        Change { dye: dab.strength * spot.weight, ..Change::default() }
    }
}

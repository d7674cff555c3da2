//! Mask: protects what it paints from other brushes; the other way round it frees it.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::Ground;

#[derive(Debug, Clone, Copy)]
pub struct MaskBrush;

impl Brush for MaskBrush {
    const MASKED: bool = false;

    fn ready(_: &Dab<'_>, _: &mut Ground<'_>) -> Self {
        MaskBrush
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        Change::mask(dab.sign * dab.strength * spot.weight)
    }
}

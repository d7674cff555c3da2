//! Snake hook: draws clay out after the pen, and goes with it.

use super::dab::{Brush, Change, Dab, Grip, Spot};
use crate::brush::surface_query::Ground;

#[derive(Debug, Clone, Copy)]
pub struct SnakeHookBrush;

impl Brush for SnakeHookBrush {
    const GRIP: Grip = Grip::Tow;

    fn ready(_: &Dab<'_>, _: &mut Ground<'_>) -> Self {
        SnakeHookBrush
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        Change::by(dab.motion * (dab.strength * dab.sign * spot.weight))
    }
}

//! Slide-relax: evens the triangles along the surface and leaves the form: the tangential part of
//! the way to the middle of the neighbours.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::Ground;

#[derive(Debug, Clone, Copy)]
pub struct RelaxBrush;

impl Brush for RelaxBrush {
    fn ready(_: &Dab<'_>, _: &mut Ground<'_>) -> Self {
        RelaxBrush
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        let (n, d) = (spot.normal(), spot.middle() - spot.p);
        Change::by((d - n * d.dot(n)) * (dab.strength * spot.weight))
    }
}

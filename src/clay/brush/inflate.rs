//! Inflate: every vertex along its own normal, so that the form swells, or shrinks.

use super::dab::{Brush, VertexChange, Dab, VertexContext};
use crate::brush::surface_query::SurfaceQuery;

#[derive(Debug, Clone, Copy)]
pub struct InflateBrush;

impl Brush for InflateBrush {
    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        InflateBrush
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::by(spot.normal() * (dab.height() * spot.weight))
    }
}

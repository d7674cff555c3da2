//! Inflate: moves every vertex along its normal, so that the form swells, or shrinks.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of inflate.
#[derive(Debug, Clone, Copy)]
pub struct InflateBrush;

impl Brush for InflateBrush {
    const FOUND: bool = true;

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        InflateBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::by(spot.normal_at(dab) * (dab.height() * spot.weight))
    }
}

//! Mask: protects what it paints from other brushes; the other way round it frees it.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of mask, made ready.
#[derive(Debug, Clone, Copy)]
pub struct MaskBrush;

impl Brush for MaskBrush {
    const MASKED: bool = false;

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        MaskBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::mask(dab.sign * dab.strength * dab.span * spot.weight)
    }
}

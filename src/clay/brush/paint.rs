//! Paint: lays the brush's colour on.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use crate::brush::surface_query::SurfaceQuery;

/// One dab of paint, made ready.
#[derive(Debug, Clone, Copy)]
pub struct PaintBrush;

impl Brush for PaintBrush {
    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        PaintBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange { dye: part(dab.pace, spot.weight), ..VertexChange::default() }
    }
}

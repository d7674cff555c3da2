//! Simplify: draws small triangles together to the wanted size, and leaves large ones; the form
//! stays.
//!
//! It cuts triangles as every brush with dynamic topology does
//! ([`super::options::TopologySettings`]); its preset turns that on.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use super::relax::RelaxBrush;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of simplify, made ready.
#[derive(Debug, Clone, Copy)]
pub struct SimplifyBrush(RelaxBrush);

impl Brush for SimplifyBrush {
    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        SimplifyBrush(RelaxBrush::ready(dab, on))
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        self.0.change(dab, spot)
    }
}

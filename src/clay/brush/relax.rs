//! Slide-relax: evens the triangles along the surface and leaves the form: the tangential part of
//! the way to the middle of the neighbours.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of relax, made ready.
#[derive(Debug, Clone, Copy)]
pub struct RelaxBrush;

impl Brush for RelaxBrush {
    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        RelaxBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let (n, d) = (spot.normal(), spot.middle() - spot.p);
        VertexChange::by((d - n * d.dot(n)) * (dab.evening(dab.strength) * spot.weight))
    }
}

//! Draw: raises the surface along its mean normal under the brush, by the falloff.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of draw.
#[derive(Debug, Clone, Copy)]
pub struct DrawBrush {
    offset: Vec3,
}

impl Brush for DrawBrush {
    const FOUND: bool = true;

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        DrawBrush { offset: on.plane(dab, 0.0).normal * dab.height() }
    }

    #[inline]
    fn change(&self, _: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::by(self.offset * spot.weight)
    }
}

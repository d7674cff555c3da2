//! Nudge: pushes the surface along with the stroke, in its tangent plane.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of nudge, made ready.
#[derive(Debug, Clone, Copy)]
pub struct NudgeBrush {
    by: Vec3,
}

impl Brush for NudgeBrush {
    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let n = on.plane(dab, 0.0).normal;
        let flat = dab.motion - n * dab.motion.dot(n);
        // A stroke that leapt to another part of the form does not tear it along.
        NudgeBrush { by: flat.clamp_length_max(dab.radius) * (dab.strength * dab.sign) }
    }

    #[inline]
    fn change(&self, _: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::by(self.by * spot.weight)
    }
}

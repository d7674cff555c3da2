//! Pinch: draws the surface together to the middle of the brush along itself; the other way round
//! it spreads it.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use crate::brush::surface_query::SurfaceQuery;

/// One dab of pinch, made ready.
#[derive(Debug, Clone, Copy)]
pub struct PinchBrush {
    normal: Vec3,
}

impl Brush for PinchBrush {
    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        PinchBrush { normal: on.plane(dab, 0.0).normal }
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let d = dab.centre - spot.p;
        let flat = d - self.normal * d.dot(self.normal);
        VertexChange::by(flat * (dab.sign * part(dab.pace, spot.weight)))
    }
}

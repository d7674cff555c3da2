//! Thumb: smears what was under the brush along the surface.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, Grip};
use crate::Reach;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of thumb, made ready.
#[derive(Debug, Clone, Copy)]
pub struct ThumbBrush {
    by: Vec3,
}

impl Brush for ThumbBrush {
    const GRIP: Grip = Grip::Anchor;

    fn ready(dab: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        ThumbBrush {
            by: (dab.motion - dab.normal * dab.motion.dot(dab.normal)) * (dab.strength * dab.sign),
        }
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        Reach::Capsule { from: dab.centre, to: dab.centre + dab.last, radius: dab.radius * 1.01 }
    }

    #[inline]
    fn change(&self, _: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::held(self.by * spot.weight)
    }
}

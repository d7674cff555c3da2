//! Twist: turns what was under the brush about the surface normal; to the right a whole radius is
//! one radian.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, Grip};
use crate::Reach;
use crate::brush::surface_query::SurfaceQuery;
use sculptd_geometry::portable::turn_about;

/// One dab of twist, made ready.
#[derive(Debug, Clone, Copy)]
pub struct TwistBrush {
    angle: f32,
}

impl Brush for TwistBrush {
    const GRIP: Grip = Grip::Anchor;

    fn ready(dab: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        let drawn = dab.motion.dot(dab.right) / dab.radius;
        TwistBrush { angle: drawn * dab.strength * dab.sign * dab.hand }
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        // A turn leaves everything as far from the middle as it was.
        dab.ball(1.01)
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let arm = spot.page.before(spot.v) - dab.centre;
        let turned = turn_about(dab.normal, self.angle * spot.weight) * arm;
        VertexChange::held(turned - arm)
    }
}

//! Grab: what was under the brush when the pen came down follows the pen.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, Grip};
use crate::Reach;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of grab, made ready.
#[derive(Debug, Clone, Copy)]
pub struct GrabBrush;

impl Brush for GrabBrush {
    const GRIP: Grip = Grip::Anchor;

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        GrabBrush
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        // The held clay is now between its first position and the last one that it was drawn to.
        Reach::Capsule { from: dab.centre, to: dab.centre + dab.last, radius: dab.radius }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::held(dab.motion * (dab.strength * dab.sign * spot.weight))
    }
}

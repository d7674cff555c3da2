//! Snake hook: draws clay out after the pen, and goes with it.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, Grip};
use crate::brush::surface_query::SurfaceQuery;

/// One dab of snake hook, made ready.
#[derive(Debug, Clone, Copy)]
pub struct SnakeHookBrush;

impl Brush for SnakeHookBrush {
    const GRIP: Grip = Grip::Tow;

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        SnakeHookBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::by(dab.motion * (dab.strength * dab.sign * spot.weight))
    }
}

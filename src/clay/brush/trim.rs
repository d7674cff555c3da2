//! Trim: cuts off the clay above a plane set a little below the surface, as a knife does: the clay
//! under the middle of the brush ends on the plane. Inverted, it fills to a plane above the
//! surface. The surface is that at the start of the stroke (unless the stroke accumulates), so a
//! stroke does not dig itself in.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};

/// The share of what stands over the plane that goes over a fifth of the radius in the middle of
/// the brush. A faster knife would keep the lowest of the planes that its dabs happened to have.
const RATE: f32 = 0.75;

/// One dab of trim, made ready.
#[derive(Debug, Clone, Copy)]
pub struct TrimBrush {
    plane: Plane,
    pace: f32,
}

impl Brush for TrimBrush {
    const FOUND: bool = true;
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "depth",
        value: 0.1,
        min: 0.0,
        max: 1.0,
        about: "how far below the surface it cuts, in radii, at full strength",
    }];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        TrimBrush {
            plane: on.plane(dab, -dab.sign * dab.extra(0) * dab.strength),
            pace: dab.pace_of(RATE),
        }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let h = self.plane.height(spot.p);
        if h * dab.sign <= 0.0 {
            return VertexChange::default();
        }
        VertexChange::by(self.plane.normal * (-h * part(self.pace, spot.weight)))
    }
}

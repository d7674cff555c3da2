//! Trim: cuts off what stands over a plane set a little below the surface, as a knife does:
//! whatever is deep within the brush comes to lie on the plane at once. The other way round it
//! fills to a plane set over the surface. The surface is that which the stroke found (unless the
//! stroke accumulates), so a stroke does not dig itself in.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, FASTEST, part};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};

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
            pace: dab.pace_of(FASTEST),
        }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let h = self.plane.height(spot.p);
        if h * dab.sign <= 0.0 {
            return VertexChange::default();
        }
        // A knife has no soft edge: a third of the falloff is all the fading there is.
        VertexChange::by(self.plane.normal * (-h * part(self.pace, (spot.weight * 3.0).min(1.0))))
    }
}

//! Crease: a groove (or a ridge) drawn together from both sides, a continuous valley along the
//! stroke.
//!
//! How deep it cuts is measured on the surface as the stroke found it; what it draws together goes
//! towards the line of the stroke by a share of its way there, so it never passes the line. The
//! first dab has no line and only cuts.
//!
//! A falloff that comes to a point would leave a pit under each dab: the floor is rounded, so that
//! the sum of the dabs along the stroke is even.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::footprint::{Footprint, FootprintShape};
use super::preset::OwnNumber;
use crate::brush::surface_query::SurfaceQuery;

/// Rounding width of the groove's floor, in radii.
const FLOOR: f32 = 0.08;

/// One dab of crease.
#[derive(Debug, Clone, Copy)]
pub struct CreaseBrush {
    normal: Vec3,
    /// The direction of the stroke, along which nothing is drawn together.
    along: Vec3,
    /// The pace of the pinch towards the stroke's line.
    pinch: f32,
    /// Squared, mesh units: added to the squared distance from the middle.
    round: f32,
}

impl CreaseBrush {
    /// Returns the vector in the tangent plane from a vertex to the stroke's line.
    fn inward(&self, dab: &Dab<'_>, p: Vec3) -> Vec3 {
        let d = dab.touch - p;
        let flat = d - self.normal * d.dot(self.normal);
        flat - self.along * flat.dot(self.along)
    }
}

impl Brush for CreaseBrush {
    const FOUND: bool = true;
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "pinch",
        value: 0.6,
        min: 0.0,
        max: 1.0,
        about: "how much the sides are drawn together",
    }];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let rate = if dab.heading == Vec3::ZERO { 0.0 } else { dab.extra(0) * dab.strength };
        let round = FLOOR * dab.radius;
        let round = round * round;
        CreaseBrush {
            round,
            normal: on.plane(dab, 0.0).normal,
            along: dab.along(),
            pinch: dab.pace_of(rate),
        }
    }

    fn footprint(&self, dab: &Dab<'_>) -> Option<Footprint> {
        Some(Footprint::of(dab, FootprintShape::Ball { round: self.round }))
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let w = spot.weight;
        // Sharper than it is pinched: the groove's floor is a line.
        let cut = self.normal * (dab.height() * w * w);
        VertexChange::by(cut + self.inward(dab, spot.p) * part(self.pinch, w))
    }
}

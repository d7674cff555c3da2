//! Crease: a groove (or a ridge) drawn together from both sides.

use glam::Vec3;

use super::dab::{Brush, VertexChange, Dab, VertexContext};
use super::preset::OwnNumber;
use crate::brush::surface_query::SurfaceQuery;

#[derive(Debug, Clone, Copy)]
pub struct CreaseBrush {
    normal: Vec3,
    /// The direction of the stroke, along which nothing is drawn together; zero for a single dab.
    along: Vec3,
}

impl CreaseBrush {
    /// What leads a vertex to the stroke's line, in the tangent plane.
    fn inward(&self, dab: &Dab<'_>, p: Vec3) -> Vec3 {
        let d = dab.centre - p;
        let flat = d - self.normal * d.dot(self.normal);
        flat - self.along * flat.dot(self.along)
    }
}

impl Brush for CreaseBrush {
    const OWN_NUMBERS: &'static [OwnNumber] = &[
        OwnNumber {
            name: "pinch",
            value: 0.6,
            min: 0.0,
            max: 1.0,
            about: "how much the sides are drawn together",
        },
    ];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let along = if dab.motion == Vec3::ZERO { Vec3::ZERO } else { dab.along() };
        CreaseBrush { normal: on.plane(dab, 0.0).normal, along }
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let w = spot.weight;
        // Sharper than it is pinched: the groove's floor is a line.
        let cut = self.normal * (dab.height() * w * w);
        VertexChange::by(cut + self.inward(dab, spot.p) * (dab.extra(0) * dab.strength * w))
    }
}

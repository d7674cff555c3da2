//! Blob: swells away from a point below the surface, so that a round drop rises; along a stroke
//! from the line that such points make, so that a round bead rises and nothing is drawn to and fro
//! along it.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use super::preset::OwnNumber;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of blob.
#[derive(Debug, Clone, Copy)]
pub struct BlobBrush {
    heart: Vec3,
    /// The direction of the stroke, in which nothing moves; zero where it begins.
    along: Vec3,
}

impl Brush for BlobBrush {
    const FOUND: bool = true;
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "depth",
        value: 0.6,
        min: 0.05,
        max: 2.0,
        about: "how far below the surface that point lies, in radii",
    }];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let plane = on.plane(dab, 0.0);
        let along = if dab.heading == Vec3::ZERO { Vec3::ZERO } else { dab.along() };
        BlobBrush { heart: plane.point - plane.normal * (dab.radius * dab.extra(0)), along }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let away = spot.at - self.heart;
        let out = (away - self.along * away.dot(self.along)).normalize_or_zero();
        VertexChange::by(out * (dab.height() * spot.weight))
    }
}

//! Blob: swells away from a point below the surface, so that a round drop rises.

use glam::Vec3;

use super::dab::{Brush, Dab, VertexChange, VertexContext};
use super::preset::OwnNumber;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of blob.
#[derive(Debug, Clone, Copy)]
pub struct BlobBrush {
    heart: Vec3,
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
        BlobBrush { heart: plane.point - plane.normal * (dab.radius * dab.extra(0)) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let out = (spot.at - self.heart).normalize_or_zero();
        VertexChange::by(out * (dab.height() * spot.weight))
    }
}

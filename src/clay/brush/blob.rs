//! Blob: swells away from a point below the surface, so that a round drop rises.

use glam::Vec3;

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::Ground;

#[derive(Debug, Clone, Copy)]
pub struct BlobBrush {
    heart: Vec3,
}

impl Brush for BlobBrush {
    fn ready(dab: &Dab<'_>, on: &mut Ground<'_>) -> Self {
        let plane = on.plane(dab, 0.0);
        BlobBrush { heart: plane.point - plane.normal * (dab.radius * dab.extra(0)) }
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        let out = (spot.p - self.heart).normalize_or_zero();
        Change::by(out * (dab.height() * spot.weight))
    }
}

//! Multiplane scrape: takes hills down to two planes that meet along the stroke as a roof does, so
//! that a ridge with flat sides is left; the other way round it fills a valley up to them.

use glam::Vec3;

use super::dab::{Brush, Dab, VertexChange, VertexContext};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};
use sculptd_geometry::portable::turn_about;

/// One dab of multiplane scrape.
#[derive(Debug, Clone, Copy)]
pub struct MultiplaneScrapeBrush {
    /// To the left and to the right of the stroke.
    planes: [Plane; 2],
    across: Vec3,
    share: f32,
}

impl Brush for MultiplaneScrapeBrush {
    const FOUND: bool = true;
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "angle",
        value: 60.0,
        min: 0.0,
        max: 160.0,
        about: "between the planes' normals, in degrees",
    }];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let plane = on.plane(dab, 0.0);
        let along = (dab.along() - plane.normal * dab.along().dot(plane.normal))
            .try_normalize()
            .unwrap_or_else(|| plane.normal.any_orthonormal_vector());
        let half = dab.extra(0).to_radians() * 0.5 * dab.sign;
        let tilted = |angle: f32| Plane {
            normal: turn_about(along, angle) * plane.normal,
            ..plane
        };
        MultiplaneScrapeBrush {
            planes: [tilted(-half), tilted(half)],
            across: plane.normal.cross(along),
            // A stroke that has no direction yet has no ridge.
            share: if dab.heading == Vec3::ZERO { 0.0 } else { dab.share },
        }
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let left = (spot.p - self.planes[0].point).dot(self.across) > 0.0;
        let plane = &self.planes[usize::from(!left)];
        let h = plane.height(spot.p);
        if h * dab.sign <= 0.0 {
            return VertexChange::default();
        }
        VertexChange::by(plane.normal * (-h * self.share * spot.weight))
    }
}

//! Multiplane scrape: takes hills down to two planes that meet along the stroke as a roof does, so
//! that a ridge with flat sides is left; the other way round it fills a valley up to them.
//!
//! The ridge is rounded a little: a sharp one would follow every tremble of the hand, for each dab
//! leaves a roof of its own and the lowest of them stays.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};
use sculptd_geometry::portable::PortableMath;

/// How wide the ridge is rounded, in radii.
const RIDGE: f32 = 0.2;

/// One dab of multiplane scrape.
#[derive(Debug, Clone, Copy)]
pub struct MultiplaneScrapeBrush {
    /// The mean plane, through the ridge.
    plane: Plane,
    across: Vec3,
    /// Of both sides; below 0 for a valley.
    slope: f32,
    /// Mesh units, above 0: see [`RIDGE`].
    ridge: f32,
    pace: f32,
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
        MultiplaneScrapeBrush {
            across: plane.normal.cross(along),
            plane,
            slope: (dab.extra(0).to_radians() * 0.5).portable_tan() * dab.sign,
            ridge: RIDGE * dab.radius,
            // A stroke that has no direction yet has no ridge.
            pace: if dab.heading == Vec3::ZERO { 0.0 } else { dab.pace },
        }
    }

    #[inline(always)]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let d = spot.p - self.plane.point;
        let v = d.dot(self.across);
        // The roof is a hyperbola between its two sides, `slope * (far - ridge)` below the plane.
        let far2 = v * v + self.ridge * self.ridge;
        let far = far2.sqrt();
        let upright = d.dot(self.plane.normal) + self.slope * (far - self.ridge);
        // Its gradient is `normal + across * lean` with `lean = slope * v / far`; both sides of the
        // fraction `upright / (1 + lean^2)` are multiplied by `far^2`.
        let lean = self.slope * v;
        let steep = far2 + lean * lean;
        let trimmed = upright * upright * far2 > self.plane.trim * self.plane.trim * steep;
        if upright * dab.sign <= 0.0 || trimmed {
            return VertexChange::default();
        }
        let way = self.plane.normal * far2 + self.across * (lean * far);
        VertexChange::by(way * (-upright / steep * part(self.pace, spot.weight)))
    }
}

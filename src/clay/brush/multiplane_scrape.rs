//! Multiplane scrape: scrapes hills down to two planes that meet along the stroke like a roof,
//! which leaves a ridge with flat sides. Inverted, it fills a valley up to them.
//!
//! Each dab has its roof, and the lowest of them stays. Three measures make one ridge of the roofs
//! of a stroke. A roof bends as the stroke does: its ridge follows the same circle. It reaches
//! along the stroke only by a share of its width. Its ridge is rounded: a sharp one would follow
//! every tremble of the hand.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::footprint::{Footprint, FootprintShape};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};
use sculptd_geometry::portable::PortableMath;

/// Rounding width of the ridge, in radii.
const RIDGE: f32 = 0.33;
/// The reach of a dab along the stroke, as a share of its reach across.
const LENGTH: f32 = 0.5;

/// One dab of multiplane scrape.
#[derive(Debug, Clone, Copy)]
pub struct MultiplaneScrapeBrush {
    /// The mean plane, through the ridge.
    plane: Plane,
    /// A point of the ridge.
    centre: Vec3,
    /// Unit, in the plane.
    along: Vec3,
    across: Vec3,
    /// One over the radius of the circle that the ridge follows, above 0 where that bends to the
    /// side of `across`.
    bend: f32,
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
        let along = dab.course_in(plane.normal);
        let across = plane.normal.cross(along);
        MultiplaneScrapeBrush {
            plane,
            centre: dab.centre,
            along,
            across,
            bend: dab.bend.dot(across),
            slope: (dab.extra(0).to_radians() * 0.5).portable_tan() * dab.sign,
            ridge: RIDGE * dab.radius,
            // A stroke that has no direction yet has no ridge. Elsewhere each place is passed for a
            // shorter while than a dab is wide.
            pace: if dab.heading == Vec3::ZERO { 0.0 } else { dab.pace / LENGTH },
        }
    }

    fn footprint(&self, dab: &Dab<'_>) -> Option<Footprint> {
        let shape = FootprintShape::Square {
            along: self.along / LENGTH,
            across: self.across,
            normal: self.plane.normal,
            round: 1.0,
        };
        Some(Footprint::of(dab, shape))
    }

    #[inline(always)]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let d = spot.p - self.centre;
        let (x, y) = (d.dot(self.along), d.dot(self.across));
        // The distance from the circle of the ridge, towards its middle: one over `bend`, less the
        // distance from the middle, free of cancellation where the ridge is straight.
        let (turned, off) = (self.bend * x, 1.0 - self.bend * y);
        let aside =
            (2.0 * y - self.bend * (x * x + y * y)) / (1.0 + (turned * turned + off * off).sqrt());
        // The roof is a hyperbola between its two sides, `slope * (far - ridge)` below the plane.
        let far2 = aside * aside + self.ridge * self.ridge;
        let far = far2.sqrt();
        let high = (spot.p - self.plane.point).dot(self.plane.normal);
        let upright = high + self.slope * (far - self.ridge);
        // The slope at a place is `lean / far`: from the roof it is `upright * far / sqrt(steep)`.
        let lean = self.slope * aside;
        let steep = far2 + lean * lean;
        let trimmed = upright * upright * far2 > self.plane.trim * self.plane.trim * steep;
        if upright * dab.sign <= 0.0 || trimmed {
            return VertexChange::default();
        }
        // Upright upon the plane, so that nothing is drawn along the stroke to and fro; where the
        // roof is steeper than 45 degrees, the slower.
        let slow = (2.0 * far2 / steep).min(1.0);
        let by = -upright * part(self.pace, slow * spot.weight);
        VertexChange::by(self.plane.normal * by)
    }
}

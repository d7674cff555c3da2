//! Clay strips: clay laid on in bands with flat tops and square ends, turned along the stroke.
//!
//! The footprint is a square in the tangent plane, its falloff the product of one along the stroke
//! and one across it, so that what a stroke adds up to across itself is that of a single dab. As
//! [`super::clay`] it fills to the plane of the surface as the stroke found it.

use glam::Vec3;

use super::clay::coat;
use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, soft};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};
use crate::{PageIn, Reach};

/// One dab of clay strips.
#[derive(Debug, Clone, Copy)]
pub struct ClayStripsBrush {
    plane: Plane,
    along: Vec3,
    across: Vec3,
    /// How fast this dab goes to the plane.
    pace: f32,
    /// 1 a disc, 0 a square.
    round: f32,
}

impl Brush for ClayStripsBrush {
    const FOUND: bool = true;
    const OWN_NUMBERS: &'static [OwnNumber] = &[
        OwnNumber {
            name: "lift",
            value: 0.3,
            min: 0.0,
            max: 1.0,
            about: "how far over the surface the plane stands, in radii, at full strength",
        },
        OwnNumber {
            name: "roundness",
            value: 0.0,
            min: 0.0,
            max: 1.0,
            about: "0 a square, 1 a disc",
        },
        OwnNumber {
            name: "fill",
            value: 0.5,
            min: 0.01,
            max: 1.0,
            about: "the share of the way to the plane over a fifth of the radius travelled",
        },
    ];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let plane = on.plane(dab, dab.extra(0) * dab.sign * dab.strength);
        let along = dab.along();
        // A stroke has no direction yet where it begins: a disc has none either.
        let round = if dab.heading == Vec3::ZERO { 1.0 } else { dab.extra(1) };
        ClayStripsBrush {
            plane,
            along,
            across: along.cross(dab.normal),
            pace: dab.pace_of(dab.extra(2)),
            round,
        }
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        // The square's corners.
        dab.ball(std::f32::consts::SQRT_2)
    }

    fn share(&self, dab: &Dab<'_>, _: &PageIn<'_>, _: usize, at: Vec3) -> f32 {
        let d = (at - dab.centre) / dab.radius;
        let (x, y, z) = (d.dot(self.along), d.dot(self.across), d.dot(dab.normal));
        if z * z >= 1.0 {
            return 0.0;
        }
        let s = dab.settings;
        let fade = |r: f32| s.falloff.at(soft(r, s.hardness), &s.curve);
        let square = fade(x.abs()) * fade(y.abs());
        if self.round == 0.0 {
            return square;
        }
        let disc = fade((x * x + y * y).sqrt());
        square + (disc - square) * self.round
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        coat(&self.plane, dab.sign, self.pace, spot)
    }
}

//! Clay strips: clay laid on in bands with flat tops and square ends, turned along the stroke.
//!
//! The footprint is a square in the tangent plane, its falloff the product of one along the stroke
//! and one across it, so that what a stroke adds up to across itself is that of a single dab. As
//! [`super::clay`] it fills to the plane of the surface as the stroke found it.

use glam::Vec3;

use super::brush_trait::{BlockContext, Brush, VertexChange, VertexContext};
use super::clay::{coat, coat_block};
use super::dab::Dab;
use super::footprint::{Footprint, FootprintShape};
use super::preset::OwnNumber;
use super::triples::Triples;
use crate::Reach;
use crate::brush::surface_query::{Plane, SurfaceQuery};

/// One dab of clay strips.
#[derive(Debug, Clone, Copy)]
pub struct ClayStripsBrush {
    plane: Plane,
    along: Vec3,
    across: Vec3,
    /// The pace of this dab towards the plane; see [`Dab::pace_of`].
    pace: f32,
    /// 1 a disc, 0 a square.
    round: f32,
}

impl Brush for ClayStripsBrush {
    const FOUND: bool = true;
    const BLOCKS: bool = true;
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
            value: 0.42,
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

    fn footprint(&self, dab: &Dab<'_>) -> Option<Footprint> {
        let ClayStripsBrush { along, across, round, .. } = *self;
        let shape = FootprintShape::Square { along, across, normal: dab.normal, round };
        Some(Footprint::of(dab, shape))
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        coat(&self.plane, dab.sign, self.pace, spot)
    }

    #[inline(always)]
    fn change_block(&self, dab: &Dab<'_>, block: &BlockContext<'_>, by: &mut Triples) {
        coat_block(&self.plane, dab.sign, self.pace, block, by);
    }
}

//! Clay: fills up to a plane a little over the surface, so that it builds in flat coats; the other
//! way round it wears down.
//!
//! The plane is that of the surface as the stroke found it (unless the stroke accumulates), so a
//! stroke does not climb upon itself: it comes to one coat, however closely its dabs lie.

use super::brush_trait::{BlockContext, Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::preset::OwnNumber;
use super::triples::Triples;
use super::weights::BLOCK;
use crate::brush::surface_query::{Plane, SurfaceQuery};

/// One dab of clay.
#[derive(Debug, Clone, Copy)]
pub struct ClayBrush {
    plane: Plane,
    /// The pace of this dab towards the plane; see [`Dab::pace_of`].
    pace: f32,
}

impl Brush for ClayBrush {
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
            name: "fill",
            value: 0.4,
            min: 0.01,
            max: 1.0,
            about: "the share of the way to the plane over a fifth of the radius travelled",
        },
    ];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let plane = on.plane(dab, dab.extra(0) * dab.sign * dab.strength);
        ClayBrush { plane, pace: dab.pace_of(dab.extra(1)) }
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

/// Moves a vertex under the plane (over it, if `sign` is negative) towards the plane at this pace,
/// scaled by its weight.
pub(super) fn coat(plane: &Plane, sign: f32, pace: f32, spot: &VertexContext<'_>) -> VertexChange {
    let h = plane.height(spot.p);
    if h * sign >= 0.0 {
        VertexChange::default()
    } else {
        VertexChange::by(plane.normal * (-h * part(pace, spot.weight)))
    }
}

/// [`coat`] of a block of vertices.
#[inline(always)]
pub(super) fn coat_block(
    plane: &Plane,
    sign: f32,
    pace: f32,
    block: &BlockContext<'_>,
    by: &mut Triples,
) {
    let height = block.now().each(|p| plane.height(p));
    let mut way = [0.0; BLOCK];
    for ((way, h), weight) in way.iter_mut().zip(height).zip(block.weights) {
        let part = -h * part(pace, *weight);
        *way = if h * sign >= 0.0 { 0.0 } else { part };
    }
    for (i, way) in way.into_iter().enumerate() {
        by.set(i, plane.normal * way);
    }
}

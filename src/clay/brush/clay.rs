//! Clay: fills up to a plane a little over the surface, so that it builds in flat coats; the other
//! way round it wears down.
//!
//! The plane is that of the surface as the stroke found it (unless the stroke accumulates), so a
//! stroke does not climb upon itself: it comes to one coat, however closely its dabs lie.

use super::brush_trait::{BlockContext, Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::preset::OwnNumber;
use super::weigh::Triples;
use crate::brush::surface_query::{Plane, SurfaceQuery};

/// One dab of clay.
#[derive(Debug, Clone, Copy)]
pub struct ClayBrush {
    plane: Plane,
    /// How fast this dab goes to the plane.
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

/// Moves what lies under the plane (over it, if `sign` is negative) towards it at this pace, by its
/// weight.
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
    for (i, (row, weight)) in block.rows.iter().zip(block.weights).enumerate() {
        let h = plane.height(row.truncate());
        let way = -h * part(pace, *weight);
        by.set(i, plane.normal * if h * sign >= 0.0 { 0.0 } else { way });
    }
}

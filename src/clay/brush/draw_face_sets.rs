//! Draw face sets: adds the vertices under the stroke to one face set. A stroke begins a new set or
//! draws the set given by [`SET`]. Inverted, it extends the set that it began on, which may be
//! none. [`Dab::draws`] finds the set once a stroke.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use super::preset::OwnNumber;
use crate::brush::surface_query::SurfaceQuery;
use crate::page_sets::MOST_SETS;

/// The place of the brush's only number among [`super::BrushSettings::extra`].
pub const SET: usize = 0;

/// The weight from which on a vertex belongs to the dab.
const LEAST: f32 = 0.5;

/// One dab of draw face sets.
#[derive(Debug, Clone, Copy)]
pub struct DrawFaceSetsBrush;

impl Brush for DrawFaceSetsBrush {
    const CUTS: bool = false;
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "set",
        value: 0.0,
        min: 0.0,
        max: MOST_SETS as f32,
        about: "the number of the face set that is drawn; 0: each stroke begins a new one",
    }];

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        DrawFaceSetsBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let set = dab.draws.filter(|_| spot.weight >= LEAST);
        VertexChange { set, ..VertexChange::default() }
    }
}

//! Erase layer: takes away what the active layer does, so that the surface goes back to what is
//! below the layer. What layers above it do stays. On the base, and on an object without layers,
//! it changes nothing.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of erase layer.
#[derive(Debug, Clone, Copy)]
pub struct EraseLayerBrush;

impl Brush for EraseLayerBrush {
    const CUTS: bool = false;

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        EraseLayerBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        match spot.page.below_active_layer(spot.v) {
            Some(below) => {
                VertexChange::by((below - spot.p) * (dab.evening(dab.strength) * spot.weight))
            }
            None => VertexChange::default(),
        }
    }
}

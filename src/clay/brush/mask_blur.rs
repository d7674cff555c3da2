//! Mask blur: softens the mask's edges to the mean of the neighbours; the other way round it
//! sharpens them.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use crate::PageIn;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of mask blur, made ready.
#[derive(Debug, Clone, Copy)]
pub struct MaskBlurBrush;

/// Returns the mean mask of a vertex's neighbours minus the vertex's mask; 0 without neighbours.
pub(super) fn slope(page: &PageIn<'_>, v: usize) -> f32 {
    let ring = page.ring(v);
    let n = ring.len();
    let sum: f32 = ring.map(|k| page.mask(k as usize)).sum();
    if n > 0 { sum / n as f32 - page.mask(v) } else { 0.0 }
}

/// Returns the sharpening change: away from the mean of the neighbours and from one half.
pub(super) fn sharper(page: &PageIn<'_>, v: usize) -> f32 {
    (page.mask(v) - 0.5) * 0.5 - slope(page, v)
}

impl Brush for MaskBlurBrush {
    const MASKED: bool = false;

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        MaskBlurBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let m = spot.page.mask(spot.v);
        let by = if dab.sign > 0.0 {
            slope(spot.page, spot.v)
        } else if m > 0.0 && m < 1.0 {
            sharper(spot.page, spot.v)
        } else {
            0.0
        };
        VertexChange::mask(by * part(dab.pace, spot.weight))
    }
}

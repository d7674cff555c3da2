//! Sharpen: makes fine relief stand out: every vertex goes away from the mean of its neighbours,
//! along its normal, by what the surface had when the stroke began (unsharp masking, one ring
//! wide). The other way round the relief is taken down.
//!
//! The relief is that of the surface as the stroke found it and does not feed upon itself; nothing
//! goes further in one stroke than half of the shortest edge about it.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of sharpen.
#[derive(Debug, Clone, Copy)]
pub struct SharpenBrush;

impl Brush for SharpenBrush {
    const CUTS: bool = false;
    const FOUND: bool = true;

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        SharpenBrush
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let (page, v) = (spot.page, spot.v);
        if !page.is_closed(v) {
            return VertexChange::default();
        }
        let (before, normal) = (page.before(v), page.normal_before(v));
        let (mut relief, mut count, mut shortest) = (0.0, 0.0f32, f32::INFINITY);
        for k in page.ring(v) {
            let d = before - page.before(k as usize);
            relief += d.dot(normal);
            count += 1.0;
            shortest = shortest.min(d.length_squared());
        }
        if !(count > 0.0) {
            return VertexChange::default();
        }
        let most = 0.5 * shortest.sqrt();
        let so_far = (spot.p - before).dot(normal);
        let by = relief / count * (dab.sign * dab.strength * dab.span * spot.weight);
        VertexChange::by(normal * ((so_far + by).clamp(-most, most) - so_far))
    }
}

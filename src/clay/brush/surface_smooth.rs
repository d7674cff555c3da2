//! Surface smooth: evens the surface and keeps its volume: Taubin 1995, "A signal processing
//! approach to fair surface design". Each dab evens by `lambda` and then goes back by `mu`, where
//! `1 / lambda + 1 / mu` is the pass band: what is wider than that keeps its form.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use super::smooth::around;
use crate::brush::surface_query::SurfaceQuery;

/// The pass band, as a share of the highest frequency (Taubin's `k_PB`).
const PASS_BAND: f32 = 0.1;
/// The greatest share of the way to the mean of the ring in one pass, so that the way back stays
/// stable.
const MOST: f32 = 0.6;

/// One dab of surface smooth.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceSmoothBrush {
    factor: f32,
}

impl Brush for SurfaceSmoothBrush {
    const PASSES: usize = 2;

    fn ready(dab: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        let lambda = dab.evening(dab.strength * MOST).min(MOST);
        let back = -lambda / (1.0 - PASS_BAND * lambda);
        SurfaceSmoothBrush { factor: if dab.pass == 0 { lambda } else { back } }
    }

    #[inline]
    fn change(&self, _: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let (sum, weights) = around(spot.page, spot.v, spot.p);
        if weights > 0.0 && !spot.page.is_border(spot.v) {
            VertexChange::by(sum * (self.factor * spot.weight / weights))
        } else {
            VertexChange::default()
        }
    }
}

//! Pinch: draws the surface together to the middle of the brush along itself; the other way round
//! it spreads it.

use glam::Vec3;

use super::brush_trait::{BlockContext, Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::footprint::Footprint;
use super::stamp::StampBy;
use super::triples::Triples;
use super::weigh::faded;
use super::weights::BLOCK;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of pinch, made ready.
#[derive(Debug, Clone, Copy)]
pub struct PinchBrush {
    normal: Vec3,
    /// Nothing but the mask and the far side takes from the footprint.
    plain: bool,
}

impl Brush for PinchBrush {
    const BLOCKS: bool = true;

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let s = dab.settings;
        let plain = !s.auto.is_on() && s.stamp.by == StampBy::Off;
        PinchBrush { normal: on.plane(dab, 0.0).normal, plain }
    }

    #[inline(always)]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let d = dab.centre - spot.p;
        let flat = d - self.normal * d.dot(self.normal);
        // The weight is that of the middle of the way, so that few large dabs and many small ones
        // come to the same.
        let mut weight = spot.weight;
        if self.plain {
            let x = 0.5 * dab.pace * weight;
            let half = d - flat * (dab.sign * (x - 0.5 * x * x));
            let free = 1.0 - spot.page.mask(spot.v);
            weight = dab.fade(half.length_squared()) * free * dab.facing(spot.normal());
        }
        VertexChange::by(flat * (dab.sign * part(dab.pace, weight)))
    }

    #[inline(always)]
    fn change_block(&self, dab: &Dab<'_>, block: &BlockContext<'_>, by: &mut Triples) {
        let now = block.now();
        for i in 0..BLOCK {
            let d = dab.centre - now.get(i);
            by.set(i, d - self.normal * d.dot(self.normal));
        }
        let mut weight = *block.weights;
        if self.plain {
            let mut away = [0.0; BLOCK];
            for (i, away) in away.iter_mut().enumerate() {
                let x = 0.5 * dab.pace * weight[i];
                let d = dab.centre - now.get(i);
                let half = d - by.get(i) * (dab.sign * (x - 0.5 * x * x));
                *away = half.length_squared().sqrt() / dab.radius;
            }
            let (fade, masks) = (faded(&Footprint::ball(dab), away), block.masks());
            let facing = block.normals().each(|n| dab.facing(n));
            for (i, weight) in weight.iter_mut().enumerate() {
                *weight = fade[i] * (1.0 - masks[i]) * facing[i];
            }
        }
        for (i, weight) in weight.into_iter().enumerate() {
            by.set(i, by.get(i) * (dab.sign * part(dab.pace, weight)));
        }
    }
}

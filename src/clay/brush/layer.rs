//! Layer: one coat of even height a stroke, however often the stroke passes: the greatest of all
//! its dabs, not their sum, each measured from where the stroke found the surface. A dab covers the
//! way from the one before it, so that the rim is that of the stroke and not of single discs,
//! whatever the spacing.

use super::brush_trait::{BlockContext, Brush, VertexChange, VertexContext};
use super::dab::Dab;
use super::footprint::{Footprint, FootprintShape};
use super::triples::Triples;
use crate::Reach;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of layer.
#[derive(Debug, Clone, Copy)]
pub struct LayerBrush;

impl Brush for LayerBrush {
    const CUTS: bool = false;
    const FOUND: bool = true;
    const BLOCKS: bool = true;

    fn ready(_: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        LayerBrush
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        dab.ball(1.0 + dab.way().length() / dab.radius)
    }

    fn footprint(&self, dab: &Dab<'_>) -> Option<Footprint> {
        Some(Footprint::of(dab, FootprintShape::Capsule { back: -dab.way() }))
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let normal = spot.page.normal_before(spot.v);
        // The height that the stroke has raised it so far, in the direction of the brush.
        let so_far = (spot.p - spot.page.before(spot.v)).dot(normal) * dab.sign;
        let goal = dab.whole_height().abs() * spot.weight;
        if goal > so_far {
            VertexChange::by(normal * ((goal - so_far) * dab.sign))
        } else {
            VertexChange::default()
        }
    }

    #[inline(always)]
    fn change_block(&self, dab: &Dab<'_>, block: &BlockContext<'_>, by: &mut Triples) {
        let height = dab.whole_height().abs();
        let (now, before, normals) = (block.now(), block.before(), block.normals_before());
        for (i, weight) in block.weights.iter().enumerate() {
            let normal = normals.get(i);
            let so_far = (now.get(i) - before.get(i)).dot(normal) * dab.sign;
            let more = height * weight - so_far;
            by.set(i, normal * (more.max(0.0) * dab.sign));
        }
    }
}

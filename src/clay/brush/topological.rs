//! Move-topological: as grab, but what is held is what is near along the surface: lips part,
//! fingers stay apart.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, Grip};
use super::footprint::Footprint;
use crate::brush::surface_query::SurfaceQuery;
use crate::{PageIn, Reach};

/// One dab of topological, made ready.
#[derive(Debug, Clone, Copy)]
pub struct TopologicalBrush;

impl Brush for TopologicalBrush {
    const GRIP: Grip = Grip::Anchor;

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        on.measure_before(dab);
        TopologicalBrush
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        Reach::Capsule { from: dab.centre, to: dab.centre + dab.last, radius: dab.radius }
    }

    fn footprint(&self, _: &Dab<'_>) -> Option<Footprint> {
        None
    }

    /// `change` measures the distance by the walk.
    #[inline]
    fn share(&self, dab: &Dab<'_>, page: &PageIn<'_>, v: usize, _: Vec3) -> f32 {
        if (page.before(v) - dab.centre).length_squared() < dab.radius * dab.radius {
            1.0
        } else {
            0.0
        }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let walk = spot.scratch.walk(dab.image);
        let Some(d) = walk.and_then(|w| w.distance(spot.number, spot.v)) else {
            return VertexChange::default();
        };
        let w = dab.fade(d * d) * spot.weight;
        VertexChange::held(dab.motion * (dab.strength * dab.sign * w))
    }
}

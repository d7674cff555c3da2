//! Boundary: what hangs on the border of an open surface follows the pen: the border itself by how
//! far it is along the border from the pen, and the surface behind it by how far it is from the
//! border, both measured along edges on the surface as the stroke found it.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, Grip};
use super::footprint::Footprint;
use crate::brush::surface_query::SurfaceQuery;
use crate::{PageIn, Reach};

/// The greatest distance of a held vertex from the pen, in radii: the nearest border point within
/// one, along the border within another, and behind the border within a third.
const FAR: f32 = 3.0;

/// One dab of boundary, made ready.
#[derive(Debug, Clone, Copy)]
pub struct BoundaryBrush {
    by: Vec3,
}

impl Brush for BoundaryBrush {
    const GRIP: Grip = Grip::Anchor;

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        on.measure_from_border(dab);
        BoundaryBrush { by: dab.motion * (dab.strength * dab.sign) }
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        let radius = dab.radius * FAR;
        Reach::Capsule { from: dab.centre, to: dab.centre + dab.last, radius }
    }

    fn footprint(&self, _: &Dab<'_>) -> Option<Footprint> {
        None
    }

    /// `change` measures the distance by the walk.
    #[inline]
    fn share(&self, dab: &Dab<'_>, page: &PageIn<'_>, v: usize, _: Vec3) -> f32 {
        let far = dab.radius * FAR;
        if (page.before(v) - dab.centre).length_squared() < far * far { 1.0 } else { 0.0 }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let walk = spot.scratch.walk(dab.image);
        let behind = walk.and_then(|w| w.distance(spot.number, spot.v));
        let along = walk.and_then(|w| w.place(spot.number, spot.v));
        let (Some(behind), Some([along, _])) = (behind, along) else {
            return VertexChange::default();
        };
        let w = dab.fade(behind * behind) * dab.fade(along * along) * spot.weight;
        VertexChange::held(self.by * w)
    }
}

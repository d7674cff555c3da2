//! Plane: brings what lies within a slab about a plane to that plane, hills and hollows alike, and
//! leaves what stands further off. The plane is that of the surface as the stroke found it, so that
//! it stays where it is while the stroke passes to and fro; the other way round it deepens.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, part};
use super::preset::OwnNumber;
use crate::brush::surface_query::{Plane, SurfaceQuery};

/// One dab of plane.
#[derive(Debug, Clone, Copy)]
pub struct PlaneBrush {
    plane: Plane,
    pace: f32,
    /// Mesh units, above and below the plane.
    above: f32,
    below: f32,
}

/// The fade at the ends of the slab, as a share of its height.
const EDGE: f32 = 0.25;

impl Brush for PlaneBrush {
    const FOUND: bool = true;
    const OWN_NUMBERS: &'static [OwnNumber] = &[
        OwnNumber {
            name: "height",
            value: 1.0,
            min: 0.0,
            max: 1.0,
            about: "how far over the plane the slab reaches, in radii",
        },
        OwnNumber {
            name: "depth",
            value: 1.0,
            min: 0.0,
            max: 1.0,
            about: "how far below the plane the slab reaches, in radii",
        },
        OwnNumber {
            name: "offset",
            value: 0.0,
            min: -1.0,
            max: 1.0,
            about: "how far the plane is moved along its normal, in radii",
        },
    ];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        PlaneBrush {
            plane: on.plane(dab, dab.extra(2)),
            pace: dab.pace,
            above: dab.extra(0) * dab.radius,
            below: dab.extra(1) * dab.radius,
        }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let h = self.plane.height(spot.p);
        let most = if h > 0.0 { self.above } else { self.below };
        if !(h.abs() < most) {
            return VertexChange::default();
        }
        let within = ((most - h.abs()) / (EDGE * most)).min(1.0);
        let by = -h * dab.sign * part(self.pace, within * spot.weight);
        VertexChange::by(self.plane.normal * by)
    }
}

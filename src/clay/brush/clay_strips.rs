//! Clay strips: clay laid on in bands with a square end, turned along the stroke.

use glam::Vec3;

use super::clay::coat;
use super::dab::{Brush, VertexChange, Dab, VertexContext};
use super::preset::OwnNumber;
use crate::brush::surface_query::{SurfaceQuery, Plane};
use crate::{PageIn, Reach};

#[derive(Debug, Clone, Copy)]
pub struct ClayStripsBrush {
    plane: Plane,
    along: Vec3,
    across: Vec3,
    /// 1 a disc, 0 a square.
    round: f32,
}

impl Brush for ClayStripsBrush {
    const OWN_NUMBERS: &'static [OwnNumber] = &[
        OwnNumber {
            name: "lift",
            value: 0.15,
            min: 0.0,
            max: 1.0,
            about: "how far over the surface the plane stands, in radii, at full strength",
        },
        OwnNumber {
            name: "roundness",
            value: 0.1,
            min: 0.0,
            max: 1.0,
            about: "0 a square, 1 a disc",
        },
    ];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let plane = on.plane(dab, dab.extra(0) * dab.sign * dab.strength);
        let along = dab.along();
        ClayStripsBrush { plane, along, across: along.cross(dab.normal), round: dab.extra(1) }
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        // The square's corners.
        dab.ball(std::f32::consts::SQRT_2)
    }

    fn share(&self, dab: &Dab<'_>, _: &PageIn<'_>, _: usize, p: Vec3) -> f32 {
        let d = (p - dab.centre) / dab.radius;
        let (x, y, z) = (d.dot(self.along), d.dot(self.across), d.dot(dab.normal));
        if z * z >= 1.0 {
            return 0.0;
        }
        let square = x.abs().max(y.abs());
        let disc = (x * x + y * y).sqrt();
        let r = square + (disc - square) * self.round;
        dab.settings.falloff.at(r, &dab.settings.curve)
    }

    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        coat(&self.plane, dab.sign, spot)
    }
}

//! Elastic grab: the clay as an elastic body that is held at a point and moved: regularised
//! Kelvinlets (de Goes and James 2017, "Regularized Kelvinlets: sculpting brushes based on
//! fundamental solutions of elasticity").
//!
//! The displacement at `r` from the pen by a force `f` (their equation 6), with `e` the brush's
//! size and `r_e = sqrt(r^2 + e^2)`:
//!
//! `u(r) = [ (a - b) / r_e I + b / r_e^3 r r^T + (a / 2) e^2 / r_e^3 I ] f`,  `a = 1 / (4 pi mu)`,
//! `b = a / (4 - 4 nu)`.
//!
//! The force is what moves the held point as the pen moved. `u` falls as `1 / r`; three of them at
//! sizes `e`, `1.1 e`, `1.21 e`, weighed so that the far terms vanish (their section 5,
//! "tri-scale"), fall as `1 / r^5`. Each solves the equations of elasticity, so with `nu = 1/2`
//! their divergence is zero and small moves keep the volume.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::{Dab, Grip};
use super::footprint::Footprint;
use super::preset::OwnNumber;
use crate::brush::surface_query::SurfaceQuery;
use crate::{PageIn, Reach};

/// The brush's size as a share of its radius: the circle drawn on the surface is where about a
/// tenth of the motion is left.
const SIZE: f32 = 0.75;
/// Beyond this many radii the remaining motion is under a thousandth, and is dropped.
const FAR: f32 = 4.0;

/// One dab of elastic, made ready.
#[derive(Debug, Clone, Copy)]
pub struct ElasticBrush {
    sizes: [f32; 3],
    weights: [f32; 3],
    /// `b / a`.
    b: f32,
    /// The sum of the three at the middle.
    middle: f32,
    by: Vec3,
}

impl ElasticBrush {
    /// A point moved by `by`; `size` in mesh units; `nu`, Poisson's ratio, 0 to 0.5.
    pub fn new(by: Vec3, size: f32, nu: f32) -> Self {
        let sizes = [size, size * 1.1, size * 1.21];
        let [s1, s2, s3] = sizes.map(|e| e * e);
        // Their equation for three scales: w1 + w2 + w3 = 0 and the next far term zero as well.
        let weights = [1.0, -(s3 - s1) / (s3 - s2), (s2 - s1) / (s3 - s2)];
        let b = 1.0 / (4.0 - 4.0 * nu);
        let at = |e: f32| (1.0 - b) / e + 0.5 / e;
        let middle = sizes.iter().zip(weights).map(|(&e, w)| w * at(e)).sum();
        ElasticBrush { sizes, weights, b, middle, by }
    }

    /// The displacement at `r` from the held point.
    #[inline]
    pub fn at(&self, r: Vec3) -> Vec3 {
        let (mut even, mut along) = (0.0, 0.0);
        for (&e, &w) in self.sizes.iter().zip(&self.weights) {
            let re2 = r.length_squared() + e * e;
            let inverse = 1.0 / re2.sqrt();
            let cube = inverse / re2;
            even += w * ((1.0 - self.b) * inverse + 0.5 * e * e * cube);
            along += w * self.b * cube;
        }
        (self.by * even + r * (along * r.dot(self.by))) / self.middle
    }
}

impl Brush for ElasticBrush {
    const GRIP: Grip = Grip::Anchor;
    const OWN_NUMBERS: &'static [OwnNumber] = &[OwnNumber {
        name: "poisson",
        value: 0.5,
        min: 0.0,
        max: 0.5,
        about: "how far the clay keeps its volume: 0.5 wholly",
    }];

    fn ready(dab: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        ElasticBrush::new(dab.motion * (dab.strength * dab.sign), dab.radius * SIZE, dab.extra(0))
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        Reach::Capsule { from: dab.centre, to: dab.centre + dab.last, radius: dab.radius * FAR }
    }

    fn footprint(&self, _: &Dab<'_>) -> Option<Footprint> {
        None
    }

    #[inline]
    fn share(&self, dab: &Dab<'_>, page: &PageIn<'_>, v: usize, _: Vec3) -> f32 {
        let far = (page.before(v) - dab.centre).length() / (dab.radius * FAR);
        // The last tenth fades out, so that the cut leaves no step.
        ((1.0 - far) * 10.0).clamp(0.0, 1.0)
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let before = spot.page.before(spot.v);
        VertexChange::held(self.at(before - dab.centre) * spot.weight)
    }
}

//! The Gaussian brush of Cipollini 2020: a bell along the surface normal at the stroke point.
//!
//! `height * exp(-x^2 / (2 sigma^2))`, with sigma = 0.7 and `x` the distance to the stroke point
//! scaled so that the radius is at x = 3.5, the profile's reach (there the bell is 3.7e-6 of its
//! height). Strength changes the height and never the footprint.

use glam::Vec3;

use super::brush_trait::{Brush, RunKernel, VertexChange, VertexContext};
use super::dab::Dab;
use super::footprint::Footprint;
use super::weights::{Weights, exp};
use crate::brush::surface_query::SurfaceQuery;
use crate::{Kernel, PageIn, PageOut};

/// The standard deviation of the bell, in the unit in which the radius is [`REACH`].
pub const SIGMA: f32 = 0.7;
/// The distance at which the profile ends.
pub const REACH: f32 = 3.5;

/// One dab of gaussian, made ready.
#[derive(Debug, Clone, Copy)]
pub struct GaussianBrush {
    centre: Vec3,
    normal: Vec3,
    offset: Vec3,
    radius2: f32,
    /// Multiplies the squared distance in the exponent.
    fall: f32,
}

impl GaussianBrush {
    /// `normal` of unit length; `height` in mesh units, negative to carve.
    pub fn new(centre: Vec3, radius: f32, normal: Vec3, height: f32) -> Self {
        let scale = REACH / radius;
        GaussianBrush {
            centre,
            normal,
            offset: normal * height,
            radius2: radius * radius,
            fall: -(scale * scale) / (2.0 * SIGMA * SIGMA),
        }
    }
}

impl Kernel for GaussianBrush {
    #[inline(always)]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        let w = &mut Weights::zero();
        let (within, _) =
            w.sphere(page, self.centre, self.normal, self.radius2, |d2| exp(d2 * self.fall));
        out.visit_many(within);
        out.push_all(self.offset, w.of(page));
    }
}

impl Brush for GaussianBrush {
    fn ready(dab: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        GaussianBrush::new(dab.centre, dab.radius, dab.normal, dab.height())
    }

    fn footprint(&self, _: &Dab<'_>) -> Option<Footprint> {
        None
    }

    #[inline(always)]
    fn share(&self, _: &Dab<'_>, _: &PageIn<'_>, _: usize, p: Vec3) -> f32 {
        let d2 = (p - self.centre).length_squared();
        if d2 < self.radius2 { exp(d2 * self.fall) } else { 0.0 }
    }

    #[inline]
    fn change(&self, _: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        VertexChange::by(self.offset * spot.weight)
    }

    fn alone<R: RunKernel>(dab: &Dab<'_>, on: &mut R) -> bool {
        on.run_kernel(
            &Self::reach(dab),
            &GaussianBrush::new(dab.centre, dab.radius, dab.normal, dab.height()),
        );
        true
    }
}

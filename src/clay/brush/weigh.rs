//! The weights of a page's vertices under a [`Footprint`], for every brush: loops over plain
//! arrays, the same bits as [`Footprint::at`] gives one at a time.

use glam::Vec3;

use super::dab::soft;
use super::falloff::Falloff;
use super::footprint::{CapsuleAxis, Footprint, FootprintShape};
use super::triples::{Triples, fourth_lanes};
use super::weights::{BLOCK, MOST, Weights, facing};
use crate::PageIn;
use sculptd_geometry::simd::wide::{Wide, WideWork, dispatch};

/// The rules that exclude vertices from a dab's footprint, and the positions that it measures.
#[derive(Debug, Clone, Copy)]
pub struct WeightRules {
    /// True to use positions and normals at the start of the stroke.
    pub before: bool,
    /// True to leave masked vertices alone.
    pub masked: bool,
    /// Vertices that face away from this normal are left alone; see [`super::Dab::facing`].
    pub facing: Option<Vec3>,
}

/// The weight of each own vertex of `page` for a dab that covers `foot`: its share there, less what
/// is masked and what faces away. Returns how many have a share.
pub fn weigh(
    weights: &mut Weights,
    page: &PageIn<'_>,
    foot: &Footprint,
    rules: &WeightRules,
) -> usize {
    dispatch(false, Weigh { weights, page, foot, rules })
}

/// [`weigh`], compiled for this processor.
struct Weigh<'a> {
    weights: &'a mut Weights,
    page: &'a PageIn<'a>,
    foot: &'a Footprint,
    rules: &'a WeightRules,
}

impl WideWork for Weigh<'_> {
    type Output = usize;
    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> usize {
        let Weigh { weights, page, foot, rules } = self;
        let own = page.own().min(MOST);
        let bound = foot.bound();
        let mut within = 0u32;
        for (b, weights) in weights.all_mut()[..own].chunks_mut(BLOCK).enumerate() {
            let first = b * BLOCK;
            let rows = &page.rows()[first..first + weights.len()];
            let mut d = Triples::NOWHERE;
            let measured = match rules.before {
                true => &page.rows_before()[first..first + rows.len()],
                false => rows,
            };
            d.fill(measured, foot.centre);
            let d2 = d.each(|d| d.x * d.x + d.y * d.y + d.z * d.z);
            if d2.iter().map(|d2| u32::from(*d2 < bound)).sum::<u32>() == 0 {
                weights.fill(0.0);
                continue;
            }
            let mut share = shares(foot, &d);
            within += share[..rows.len()].iter().map(|s| u32::from(*s > 0.0)).sum::<u32>();
            if rules.masked {
                for (share, mask) in share.iter_mut().zip(fourth_lanes(rows)) {
                    *share *= 1.0 - mask;
                }
            }
            if let Some(normal) = rules.facing {
                let normals = match rules.before {
                    true => page.normal_rows_before(),
                    false => page.normal_rows(),
                };
                let n = Triples::of(&normals[first..first + rows.len()]);
                let c = n.each(|n| n.x * normal.x + n.y * normal.y + n.z * normal.z);
                for (share, c) in share.iter_mut().zip(c) {
                    *share *= facing(c);
                }
            }
            weights.copy_from_slice(&share[..rows.len()]);
        }
        within as usize
    }
}

/// [`Footprint::at`] of a block of vertices, `d` from the centre, in steps without a choice in
/// their loops.
#[inline(always)]
fn shares(foot: &Footprint, d: &Triples) -> [f32; BLOCK] {
    match foot.shape {
        FootprintShape::Ball { round } => {
            faded(foot, d.each(|d| (d.length_squared() + round).sqrt() / foot.radius))
        }
        FootprintShape::Capsule { back } => {
            let axis = CapsuleAxis::new(back);
            faded(foot, d.each(|d| axis.away(d).length_squared().sqrt() / foot.radius))
        }
        FootprintShape::Square { along, across, normal, round } => {
            let x = d.each(|d| (d / foot.radius).dot(along));
            let y = d.each(|d| (d / foot.radius).dot(across));
            let z = d.each(|d| (d / foot.radius).dot(normal));
            let mut share = faded(foot, x.map(f32::abs));
            let other = faded(foot, y.map(f32::abs));
            for (share, other) in share.iter_mut().zip(&other) {
                *share *= other;
            }
            if round != 0.0 {
                let mut far = [0.0; BLOCK];
                for i in 0..BLOCK {
                    far[i] = (x[i] * x[i] + y[i] * y[i]).sqrt();
                }
                for (share, disc) in share.iter_mut().zip(&faded(foot, far)) {
                    *share += (disc - *share) * round;
                }
            }
            for (share, z) in share.iter_mut().zip(&z) {
                *share = if z * z < 1.0 { *share } else { 0.0 };
            }
            share
        }
    }
}

/// The profile at distances in radii.
#[inline(always)]
pub(super) fn faded(foot: &Footprint, mut x: [f32; BLOCK]) -> [f32; BLOCK] {
    if foot.hardness > 0.0 {
        x.iter_mut().for_each(|x| *x = soft(*x, foot.hardness));
    }
    // One loop a profile.
    macro_rules! profiles {
        ($($profile:ident)*) => {
            match foot.falloff {
                $(Falloff::$profile => x.iter_mut().for_each(|x| {
                    let y = Falloff::$profile.within(*x, &foot.curve);
                    *x = if *x < 1.0 { y } else { 0.0 };
                }),)*
                Falloff::Custom => {
                    x.iter_mut().for_each(|x| *x = Falloff::Custom.at(*x, &foot.curve));
                }
            }
        };
    }
    profiles!(Gaussian Smooth Sphere Root Sharp Linear Constant);
    x
}

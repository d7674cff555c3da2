//! The weights of a page's vertices under a [`Footprint`], for every brush: loops over plain
//! arrays, the same bits as [`Footprint::at`] gives one at a time.

use glam::{Vec3, Vec4};

use super::dab::soft;
use super::falloff::Falloff;
use super::footprint::{CapsuleAxis, Footprint, FootprintShape};
use super::weights::{BLOCK, MOST, Weights, facing};
use crate::PageIn;
use sculptd_geometry::simd::wide::{Wide, WideWork, dispatch};

/// What a dab leaves out of its footprint, and where it measures vertices.
#[derive(Debug, Clone, Copy)]
pub struct WeightRules {
    /// Places and normals are those when the stroke began.
    pub before: bool,
    /// What is masked is left alone.
    pub masked: bool,
    /// What faces away from this normal is left alone, as [`super::Dab::facing`] has it.
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
            if rules.before {
                let rows = &page.rows_before()[first..first + rows.len()];
                d.fill(rows, |p| p - foot.centre);
            } else {
                d.fill(rows, |p| p - foot.centre);
            }
            let Triples([x, y, z]) = &d;
            let d2 = |i: usize| x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
            if (0..BLOCK).map(|i| u32::from(d2(i) < bound)).sum::<u32>() == 0 {
                weights.fill(0.0);
                continue;
            }
            let share = shares(foot, &d);
            let counted = &share[..rows.len()];
            within += counted.iter().map(|s| u32::from(*s > 0.0)).sum::<u32>();
            for ((weight, share), row) in weights.iter_mut().zip(counted).zip(rows) {
                *weight = if rules.masked { share * (1.0 - row.w) } else { *share };
            }
            let Some(normal) = rules.facing else { continue };
            let mut n = Triples::NOWHERE;
            if rules.before {
                n.fill(&page.normal_rows_before()[first..first + rows.len()], |n| n);
            } else {
                n.fill(&page.normal_rows()[first..first + rows.len()], |n| n);
            }
            let Triples([x, y, z]) = &n;
            for (i, weight) in weights.iter_mut().enumerate() {
                *weight *= facing(x[i] * normal.x + y[i] * normal.y + z[i] * normal.z);
            }
        }
        within as usize
    }
}

/// The x, the y and the z of a block of vertices, each in a row.
#[derive(Debug)]
pub struct Triples([[f32; BLOCK]; 3]);

impl Triples {
    /// Outside of every footprint.
    const NOWHERE: Triples = Triples([[f32::INFINITY; BLOCK]; 3]);
    /// Zeros.
    pub const ZERO: Triples = Triples([[0.0; BLOCK]; 3]);

    /// Takes what `of` makes of the first three lanes of each row; 64 rows at most.
    #[inline(always)]
    pub fn fill(&mut self, rows: &[Vec4], of: impl Fn(Vec3) -> Vec3) {
        let [x, y, z] = &mut self.0;
        for (((row, x), y), z) in rows.iter().zip(x).zip(y).zip(z) {
            let v = of(row.truncate());
            (*x, *y, *z) = (v.x, v.y, v.z);
        }
    }

    /// One of them.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3 {
        let [x, y, z] = &self.0;
        Vec3::new(x[i], y[i], z[i])
    }

    /// Sets one of them.
    #[inline(always)]
    pub fn set(&mut self, i: usize, v: Vec3) {
        (self.0[0][i], self.0[1][i], self.0[2][i]) = (v.x, v.y, v.z);
    }

    /// Calls `of` with each, for a row of what it answers.
    #[inline(always)]
    fn each(&self, of: impl Fn(Vec3) -> f32) -> [f32; BLOCK] {
        let [x, y, z] = &self.0;
        let mut out = [0.0; BLOCK];
        for i in 0..BLOCK {
            out[i] = of(Vec3::new(x[i], y[i], z[i]));
        }
        out
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

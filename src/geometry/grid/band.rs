//! Signed distances near a surface only, refined block by block.
//!
//! The sampled function is any combination of signed distances with a slope of at most one: a value
//! far from zero at the middle of a block settles the whole block. So the cost follows the surface,
//! not the volume. Exact within one spacing of zero; further away only the sign is right, and the
//! size is at least one spacing.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use glam::DVec3;
use rayon::prelude::*;

use super::DistanceGrid;
use crate::distance::DistanceSolid;
use crate::job::{Cancelled, Job};

/// Samples along a block's side.
const BLOCK: usize = 8;

/// A parent's signed distance to one solid at its middle.
#[derive(Clone, Copy)]
struct KnownDistance {
    at: DVec3,
    signed: f64,
}

struct BandSampler<'a, const N: usize, F> {
    solids: [&'a DistanceSolid; N],
    combine: &'a F,
    origin: DVec3,
    spacing: f64,
    size: [usize; 3],
    /// Every solid is closed, so that the sign changes at the surface only.
    closed: bool,
}

impl<const N: usize, F: Fn([f64; N]) -> f64 + Sync> BandSampler<'_, N, F> {
    fn place(&self, i: f64, j: f64, k: f64) -> DVec3 {
        self.origin + DVec3::new(i, j, k) * self.spacing
    }

    /// Each solid's signed distance at `p`, from what is known nearby.
    fn signed(&self, p: DVec3, near: &[[KnownDistance; N]]) -> [KnownDistance; N] {
        std::array::from_fn(|s| {
            let solid = self.solids[s];
            let mut within = f64::INFINITY;
            for n in near {
                within = within.min(n[s].signed.abs() + p.distance(n[s].at));
            }
            // A bound that rounding made too small would lose the nearest triangle.
            let found = solid.tree.nearest(p, within * (1.0 + 1e-9) + self.spacing * 1e-6);
            let d = found.map_or(f64::INFINITY, |n| n.distance());
            let settled = near.iter().find(|n| {
                self.closed && d + n[s].signed.abs() > p.distance(n[s].at) * (1.0 + 1e-9)
            });
            let inside = match settled {
                Some(n) => n[s].signed < 0.0,
                None => solid.inside(p, found.as_ref()),
            };
            KnownDistance { at: p, signed: if inside { -d } else { d } }
        })
    }

    /// Fills the block of `side` samples from `(i, j, k)`; `slab` begins at the plane `k0`.
    fn block(
        &self,
        slab: &mut [f32],
        k0: usize,
        from: [usize; 3],
        side: usize,
        near: &[[KnownDistance; N]],
    ) {
        let [nx, ny, _] = self.size;
        let to: [usize; 3] = std::array::from_fn(|a| (from[a] + side).min(self.size[a]));
        if (0..3).any(|a| from[a] >= to[a]) {
            return;
        }
        let middle: [f64; 3] = std::array::from_fn(|a| (from[a] + to[a] - 1) as f64 * 0.5);
        let p = self.place(middle[0], middle[1], middle[2]);
        let known = self.signed(p, near);
        let value = (self.combine)(known.map(|k| k.signed));
        if side == 1 {
            slab[((from[2] - k0) * ny + from[1]) * nx + from[0]] = value as f32;
            return;
        }
        let h = self.spacing;
        let span: [f64; 3] = std::array::from_fn(|a| (to[a] - 1 - from[a]) as f64 * 0.5);
        let radius = DVec3::from_array(span).length() * h;
        let far = value.abs() > radius + h && (self.closed || self.one_side(from, to, value < 0.0));
        if far {
            let size = (value.abs() - radius).min(f32::MAX as f64).copysign(value) as f32;
            for k in from[2]..to[2] {
                for j in from[1]..to[1] {
                    let row = ((k - k0) * ny + j) * nx;
                    slab[row + from[0]..row + to[0]].fill(size);
                }
            }
            return;
        }
        let half = side / 2;
        let mut around = [known; 9];
        if half == 1 {
            // Samples of a group of eight settle one another's sign.
            let mut count = 1;
            for c in 0..8 {
                let at: [usize; 3] = std::array::from_fn(|a| from[a] + (c >> a & 1));
                if (0..3).any(|a| at[a] >= to[a]) {
                    continue;
                }
                let p = self.place(at[0] as f64, at[1] as f64, at[2] as f64);
                let found = self.signed(p, &around[..count]);
                around[count] = found;
                count += 1;
                let value = (self.combine)(found.map(|k| k.signed));
                slab[((at[2] - k0) * ny + at[1]) * nx + at[0]] = value as f32;
            }
            return;
        }
        for c in 0..8 {
            let at: [usize; 3] = std::array::from_fn(|a| from[a] + half * (c >> a & 1));
            self.block(slab, k0, at, half, &around[..1]);
        }
    }

    /// Near a hole the side changes with no surface near: the corners are asked too.
    fn one_side(&self, from: [usize; 3], to: [usize; 3], inside: bool) -> bool {
        (0..8).all(|c| {
            let at: [usize; 3] =
                std::array::from_fn(|a| if c >> a & 1 == 0 { from[a] } else { to[a] - 1 });
            let p = self.place(at[0] as f64, at[1] as f64, at[2] as f64);
            let signed = self.solids.map(|s| if s.inside(p, None) { -f64::MAX } else { f64::MAX });
            // Only the sides count here, so any combination that keeps the order of its arguments
            // will do.
            ((self.combine)(signed) < 0.0) == inside
        })
    }
}

impl DistanceGrid {
    /// Samples `combine` of the solids' signed distances near where it is zero. `combine` must
    /// change by no more than its arguments do: minima, maxima, negation and adding a constant are
    /// such. The outermost samples are always outside.
    pub fn band<const N: usize>(
        solids: [&DistanceSolid; N],
        combine: impl Fn([f64; N]) -> f64 + Sync,
        layout: DistanceGrid,
        job: &Job,
    ) -> Result<DistanceGrid, Cancelled> {
        let mut grid = layout;
        let [nx, ny, nz] = grid.size;
        grid.values = vec![0.0; nx * ny * nz];
        let sampler = BandSampler {
            solids,
            combine: &combine,
            origin: grid.origin,
            spacing: grid.spacing,
            size: grid.size,
            closed: solids.iter().all(|s| s.topology.closed),
        };
        let slabs = nz.div_ceil(BLOCK);
        let done = AtomicUsize::new(0);
        grid.values.par_chunks_mut(nx * ny * BLOCK).enumerate().try_for_each(|(s, slab)| {
            let k0 = s * BLOCK;
            for j in (0..ny).step_by(BLOCK) {
                job.check()?;
                let mut last: Vec<[KnownDistance; N]> = Vec::new();
                for i in (0..nx).step_by(BLOCK) {
                    let p = sampler.place(i as f64 + 3.5, j as f64 + 3.5, k0 as f64 + 3.5);
                    let known = sampler.signed(p, &last);
                    last.clear();
                    last.push(known);
                    sampler.block(slab, k0, [i, j, k0], BLOCK, &last);
                }
            }
            let n = done.fetch_add(1, Relaxed) + 1;
            job.progress(0.8 * n as f32 / slabs as f32);
            Ok(())
        })?;
        // A closed surface needs an outside all around it.
        let outside = (grid.spacing * 0.5) as f32;
        for k in 0..nz {
            for j in 0..ny {
                let row = (k * ny + j) * nx;
                let edge = k == 0 || k == nz - 1 || j == 0 || j == ny - 1;
                for i in 0..nx {
                    if edge || i == 0 || i == nx - 1 {
                        let v = &mut grid.values[row + i];
                        *v = v.max(outside);
                    }
                }
            }
        }
        Ok(grid)
    }
}

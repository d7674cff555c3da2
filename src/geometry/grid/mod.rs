//! The signed distance sampled on a regular grid.

mod band;
mod npy;

use glam::DVec3;
use rayon::prelude::*;

use super::distance::DistanceSolid;
use crate::job::{Cancelled, Job};
pub use npy::NpyError;

/// Samples at `origin + spacing * (i, j, k)`.
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceGrid {
    /// The place of sample (0, 0, 0), in the mesh's unit.
    pub origin: DVec3,
    /// The mesh's unit.
    pub spacing: f64,
    /// Samples along x, y, z; at least 2 each.
    pub size: [usize; 3],
    /// Negative inside; x runs fastest: `values[(k * size[1] + j) * size[0] + i]`.
    pub values: Vec<f32>,
}

/// Most samples of one grid: 8 GiB.
pub const MAX_SAMPLES: usize = 1 << 31;

impl DistanceGrid {
    /// Returns the layout of a grid with `side` samples along the longest side: the box of the
    /// mesh, `margin` samples wider on every side. `side` is at least 2 + 2 * `margin`.
    pub fn layout((lo, hi): (DVec3, DVec3), side: usize, margin: usize) -> DistanceGrid {
        let side = side.max(2 + 2 * margin);
        let extent = (hi - lo).max(DVec3::ZERO);
        let longest = extent.max_element();
        let longest = if longest > 0.0 && longest.is_finite() { longest } else { 1.0 };
        let spacing = longest / (side - 1 - 2 * margin) as f64;
        let size = extent.to_array().map(|e| {
            let n = if e.is_finite() { (e / spacing - 1e-9).ceil().max(1.0) as usize } else { 1 };
            (n + 1 + 2 * margin).min(side.max(2))
        });
        let span = DVec3::from_array(size.map(|n| (n - 1) as f64)) * spacing;
        let centre = if lo.is_finite() && hi.is_finite() { (lo + hi) * 0.5 } else { DVec3::ZERO };
        DistanceGrid { origin: centre - span * 0.5, spacing, size, values: Vec::new() }
    }

    /// As [`DistanceGrid::layout`], with a number of samples for each axis, each at least 2 + 2 *
    /// `margin`: the smallest spacing, the same along all axes, with which the grid holds the box
    /// and its margin.
    pub fn layout_of((lo, hi): (DVec3, DVec3), size: [usize; 3], margin: usize) -> DistanceGrid {
        let size = size.map(|n| n.max(2 + 2 * margin));
        let extent = (hi - lo).max(DVec3::ZERO);
        let spacing =
            (0..3).map(|k| extent[k] / (size[k] - 1 - 2 * margin) as f64).fold(0.0, f64::max);
        let spacing = if spacing > 0.0 && spacing.is_finite() { spacing } else { 1.0 };
        let span = DVec3::from_array(size.map(|n| (n - 1) as f64)) * spacing;
        let centre = if lo.is_finite() && hi.is_finite() { (lo + hi) * 0.5 } else { DVec3::ZERO };
        DistanceGrid { origin: centre - span * 0.5, spacing, size, values: Vec::new() }
    }

    /// Every sample exact, on all threads. The sign is asked for only where the distances do not
    /// settle it: two samples further from the surface, together, than from each other are on the
    /// same side of a closed one.
    pub fn sample(
        solid: &DistanceSolid,
        layout: DistanceGrid,
        job: &Job,
    ) -> Result<DistanceGrid, Cancelled> {
        let mut grid = layout;
        let [nx, ny, nz] = grid.size;
        grid.values = vec![0.0; nx * ny * nz];
        let (origin, h) = (grid.origin, grid.spacing);
        let carry = solid.topology.closed;
        let done = std::sync::atomic::AtomicUsize::new(0);
        grid.values.par_chunks_mut(nx * ny).enumerate().try_for_each(|(k, slab)| {
            let mut above = vec![f64::INFINITY; nx];
            for j in 0..ny {
                job.check()?;
                let mut before = f64::INFINITY;
                for i in 0..nx {
                    let p = origin + DVec3::new(i as f64, j as f64, k as f64) * h;
                    let seed = before.abs().min(above[i].abs());
                    let within = seed + h * (1.0 + 1e-6) + seed * 1e-12;
                    let Some(n) = solid.tree.nearest(p, within) else {
                        slab[j * nx + i] = f32::INFINITY;
                        continue;
                    };
                    let d = n.distance();
                    let settled = |other: f64| {
                        carry && other.is_finite() && d + other.abs() > h * (1.0 + 1e-9)
                    };
                    let inside = if settled(before) {
                        before < 0.0
                    } else if settled(above[i]) {
                        above[i] < 0.0
                    } else {
                        solid.inside(p, Some(&n))
                    };
                    let d = if inside { -d } else { d };
                    (before, above[i]) = (d, d);
                    slab[j * nx + i] = d as f32;
                }
            }
            let n = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            job.progress(n as f32 / nz as f32);
            Ok(())
        })?;
        Ok(grid)
    }

    /// The far corner.
    pub fn end(&self) -> DVec3 {
        self.origin + DVec3::from_array(self.size.map(|n| (n - 1) as f64)) * self.spacing
    }

    /// The sample at `(i, j, k)`. Panics out of range.
    pub fn value(&self, i: usize, j: usize, k: usize) -> f32 {
        self.values[(k * self.size[1] + j) * self.size[0] + i]
    }

    /// The cell around `p` and where in it `p` is; outside the grid, of the nearest place in it.
    #[inline]
    fn cell(&self, p: DVec3) -> (usize, [f32; 3]) {
        let at = (p - self.origin) / self.spacing;
        let (mut index, mut part) = ([0usize; 3], [0.0f32; 3]);
        for axis in 0..3 {
            let last = self.size[axis] as f64 - 1.0;
            let x = at[axis].clamp(0.0, last);
            let i = (x as usize).min(self.size[axis] - 2);
            index[axis] = i;
            part[axis] = (x - i as f64) as f32;
        }
        ((index[2] * self.size[1] + index[1]) * self.size[0] + index[0], part)
    }

    #[inline]
    fn corners(&self, at: usize) -> [f32; 8] {
        let (y, z) = (self.size[0], self.size[0] * self.size[1]);
        let v = &self.values;
        [
            v[at],
            v[at + 1],
            v[at + y],
            v[at + y + 1],
            v[at + z],
            v[at + z + 1],
            v[at + z + y],
            v[at + z + y + 1],
        ]
    }

    /// Interpolated along x, then y, then z. Outside the grid, the value of the nearest place in
    /// it.
    #[inline]
    pub fn interpolate(&self, p: DVec3) -> f32 {
        let (at, [x, y, z]) = self.cell(p);
        let c = self.corners(at);
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        mix(
            mix(mix(c[0], c[1], x), mix(c[2], c[3], x), y),
            mix(mix(c[4], c[5], x), mix(c[6], c[7], x), y),
            z,
        )
    }

    /// The interpolant's gradient: about of unit length, away from the solid.
    pub fn gradient(&self, p: DVec3) -> DVec3 {
        let (at, [x, y, z]) = self.cell(p);
        let c = self.corners(at);
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let face = |a: [usize; 4], s: f32, t: f32| {
            mix(mix(c[a[0]], c[a[1]], s), mix(c[a[2]], c[a[3]], s), t) as f64
        };
        let d = DVec3::new(
            face([1, 3, 5, 7], y, z) - face([0, 2, 4, 6], y, z),
            face([2, 3, 6, 7], x, z) - face([0, 1, 4, 5], x, z),
            face([4, 5, 6, 7], x, y) - face([0, 1, 2, 3], x, y),
        );
        d / self.spacing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_of_so_many_samples_each_way_holds_the_box() {
        let (lo, hi) = (DVec3::new(-1.0, 2.0, 0.0), DVec3::new(3.0, 4.0, 10.0));
        let grid = DistanceGrid::layout_of((lo, hi), [20, 11, 31], 2);
        assert_eq!(grid.size, [20, 11, 31]);
        // Along z: 26 spacings hold 10; x and y have room.
        assert!((grid.spacing - 10.0 / 26.0).abs() < 1e-12, "{}", grid.spacing);
        let room = DVec3::splat(2.0 * grid.spacing - 1e-9);
        assert!((grid.origin + room).cmple(lo).all() && (grid.end() - room).cmpge(hi).all());
    }
}

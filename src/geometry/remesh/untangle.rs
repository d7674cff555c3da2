//! Moves the vertices of a dual surface where it crosses itself, until it no longer does.
//!
//! A vertex that is projected onto the old surface, or placed where sharp edges meet, can leave its
//! cell, and a wall thinner than a voxel brings two sheets into one: triangles cross. Such a vertex
//! moves back in steps to the middle of its patch's crossings, which is in its cell (Ju and Udeshi,
//! "Intersection-free contouring on an octree grid", 2006). Then it moves to the corresponding
//! place on the surface that halves every edge of the grid, where sheets are farthest apart. Only
//! vertices of triangles that cross move; once all of those have reached the end, their neighbours
//! follow. Triangles that lie back on their neighbours, without crossing them, are treated the same
//! until their vertices are in the middles.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::job::{Cancelled, Job};
use crate::self_intersection::{pairs, pairs_with};

/// Steps from the wanted place to the middle of the crossings, and as many from there to the end.
const STEPS: u8 = 2;
/// The maximum number of rounds. A crossing takes four if only its vertices need to move.
const ROUNDS: usize = 24;

/// The places to which a surface's vertices go back.
pub(super) struct CalmPlaces {
    /// The middles of the patches' crossings.
    pub(super) middles: Vec<Vec3>,
    /// The same, with every edge of the grid crossed half way.
    pub(super) halves: Vec<Vec3>,
}

impl CalmPlaces {
    fn at(&self, wanted: Vec3, v: usize, step: u8) -> Vec3 {
        let share = |step: u8| f32::from(step) / f32::from(STEPS);
        match step.checked_sub(STEPS) {
            None => wanted.lerp(self.middles[v], share(step)),
            Some(more) => self.middles[v].lerp(self.halves[v], share(more)),
        }
    }
}

/// Untangles the surface; how many pairs of triangles cross after it. `is_folded` tells triangles
/// that lie back on others by their corners. `calm` is asked for only where there are some of
/// either.
pub(super) fn untangle(
    positions: &mut [Vec3],
    triangles: &[[u32; 3]],
    is_folded: impl Fn([DVec3; 3]) -> bool + Sync,
    calm: impl FnOnce() -> Result<CalmPlaces, Cancelled>,
    job: &Job,
) -> Result<usize, Cancelled> {
    let mut exact: Vec<DVec3> = positions.par_iter().map(|p| p.as_dvec3()).collect();
    let mut found = pairs(&exact, triangles, job)?;
    let folded =
        |exact: &[DVec3], t: u32| is_folded(triangles[t as usize].map(|v| exact[v as usize]));
    let all = 0..triangles.len() as u32;
    let mut folds: Vec<u32> = all.into_par_iter().filter(|&t| folded(&exact, t)).collect();
    if found.is_empty() && folds.is_empty() {
        return Ok(0);
    }
    let calm = calm()?;
    let wanted = positions.to_vec();
    let mut steps = vec![0u8; positions.len()];
    for _ in 0..ROUNDS {
        // How far each vertex may go: what is only folded, no further than to the middles.
        let mut until = vec![0u8; positions.len()];
        let mut mark = |t: u32, step: u8| {
            for v in triangles[t as usize] {
                until[v as usize] = until[v as usize].max(step);
            }
        };
        folds.iter().for_each(|&t| mark(t, STEPS));
        found.iter().for_each(|&(a, b)| {
            mark(a, 2 * STEPS);
            mark(b, 2 * STEPS);
        });
        let mut moved: Vec<usize> = (0..positions.len()).filter(|&v| steps[v] < until[v]).collect();
        if moved.is_empty() {
            let crossed = |v: &u32| until[*v as usize] == 2 * STEPS;
            let beside = triangles.iter().filter(|t| t.iter().any(crossed));
            moved = beside.flatten().map(|&v| v as usize).collect();
            moved.sort_unstable();
            moved.dedup();
            moved.retain(|&v| steps[v] < 2 * STEPS);
        }
        if moved.is_empty() {
            break;
        }
        let mut turned = vec![false; positions.len()];
        for v in moved {
            steps[v] += 1;
            positions[v] = calm.at(wanted[v], v, steps[v]);
            exact[v] = positions[v].as_dvec3();
            turned[v] = true;
        }
        let changed = |t: u32| triangles[t as usize].iter().any(|&v| turned[v as usize]);
        let list: Vec<u32> =
            (0..triangles.len() as u32).into_par_iter().filter(|&t| changed(t)).collect();
        found.retain(|&(a, b)| !changed(a) && !changed(b));
        found.extend(pairs_with(&exact, triangles, &list, job)?);
        folds.retain(|&t| !changed(t));
        folds.par_extend(list.par_iter().copied().filter(|&t| folded(&exact, t)));
        if found.is_empty() && folds.is_empty() {
            break;
        }
    }
    Ok(found.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::DistanceGrid;
    use crate::remesh::{dual, middle};

    /// Every pattern of inside corners beside every other, and vertices thrown out of their cells.
    #[test]
    fn noise_is_untangled() {
        let job = Job::default();
        for seed in 0..6u64 {
            let mut state = seed * 1_000_003 + 17;
            let mut unit = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 40) as f32 / (1u64 << 24) as f32
            };
            let n = 20;
            let mut values = vec![1.0; n * n * n];
            for (at, v) in values.iter_mut().enumerate() {
                let inner =
                    [at % n, at / n % n, at / (n * n)].iter().all(|i| (1..n - 1).contains(i));
                if inner {
                    *v = unit() - 0.1 - 0.1 * seed as f32;
                }
            }
            let origin = DVec3::ZERO;
            let mut grid = DistanceGrid { origin, spacing: 1.0, size: [n; 3], values };
            let (middles, triangles) = dual::extract(&grid, middle, &job).unwrap();
            grid.values.iter_mut().for_each(|v| *v = if *v < 0.0 { -1.0 } else { 1.0 });
            let halves = dual::extract(&grid, middle, &job).unwrap().0;
            let crossings = |places: &[Vec3]| {
                let places: Vec<DVec3> = places.iter().map(|p| p.as_dvec3()).collect();
                pairs(&places, &triangles, &job).unwrap().len()
            };
            let mut places = middles.clone();
            for p in &mut places {
                *p += (Vec3::new(unit(), unit(), unit()) - 0.5) * 0.7;
            }
            let before = [&places, &middles, &halves].map(|p| crossings(p));
            let calm = || Ok(CalmPlaces { middles: middles.clone(), halves: halves.clone() });
            let left = untangle(&mut places, &triangles, |_| false, calm, &job).unwrap();
            println!(
                "seed {seed}: {} triangles, crossings {before:?}, {left} left",
                triangles.len()
            );
            assert!(before[0] > 100);
            assert_eq!(left, crossings(&places));
            assert_eq!(left, 0);
        }
    }
}

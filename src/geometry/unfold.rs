//! Moves vertices back to their former places if their new places fold faces.
//!
//! In the dual surface before any vertex moves, each vertex is among its cell's crossings and no
//! face folds. So going back always helps, and only vertices that cause folds go back.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::job::{Cancelled, Job};
use crate::self_intersection;

/// A face may turn by at most the angle of this cosine.
const TURN: f64 = 0.3;

/// Rounds of taking back after which what still crosses was crossing before.
const ROUNDS: usize = 6;

/// Steps of smoothing for vertices that could not go where they were to.
const SMOOTHING: usize = 4;

/// `moved`, but for vertices whose faces turn over or cross others: those go to the middle of their
/// neighbours, or, where that folds too, stay at `from`.
pub(super) fn settle_all(
    from: &[Vec3],
    moved: Vec<Vec3>,
    faces: &[[u32; 3]],
    job: &Job,
) -> Result<Vec<Vec3>, Cancelled> {
    let wanted = moved.clone();
    let safe = unfold(from, moved, faces, job)?;
    let back: Vec<bool> = safe.iter().zip(&wanted).map(|(a, b)| a != b).collect();
    if !back.contains(&true) {
        return Ok(safe);
    }
    let mut smooth = safe.clone();
    for _ in 0..SMOOTHING {
        let middles = middles(&smooth, faces);
        smooth
            .iter_mut()
            .zip(middles)
            .zip(&back)
            .filter(|(_, back)| **back)
            .for_each(|((p, m), _)| *p = m);
    }
    unfold(&safe, smooth, faces, job)
}

/// The middle of each vertex's neighbours; a vertex without faces stays.
fn middles(points: &[Vec3], faces: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); points.len()];
    // On a closed surface every edge comes once each way: a neighbour counts once.
    for f in faces {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let sum = &mut sums[f[a] as usize];
            *sum = (sum.0 + points[f[b] as usize].as_dvec3(), sum.1 + 1.0);
        }
    }
    let each = |(&p, (sum, count)): (&Vec3, (DVec3, f64))| {
        if count > 0.0 { (sum / count).as_vec3() } else { p }
    };
    points.iter().zip(sums).map(each).collect()
}

/// Each vertex half way to the middle of its neighbours, at most `room` away (Gibson, "Constrained
/// elastic surface nets", 1998): two vertices on either side of a cell's border come apart.
pub(super) fn even(points: &[Vec3], faces: &[[u32; 3]], room: f64) -> Vec<Vec3> {
    let each = |(p, m): (&Vec3, Vec3)| *p + ((m - *p) * 0.5).clamp_length_max(room as f32);
    points.iter().zip(middles(points, faces)).map(each).collect()
}

fn unfold(
    from: &[Vec3],
    mut moved: Vec<Vec3>,
    faces: &[[u32; 3]],
    job: &Job,
) -> Result<Vec<Vec3>, Cancelled> {
    let normal = |at: &[Vec3], f: &[u32; 3]| {
        let [a, b, c] = f.map(|v| at[v as usize].as_dvec3());
        (b - a).cross(c - a)
    };
    for _ in 0..ROUNDS {
        loop {
            job.check()?;
            let turned: Vec<u32> = faces
                .par_iter()
                .enumerate()
                .filter(|(_, f)| f.iter().any(|&v| moved[v as usize] != from[v as usize]))
                .filter(|(_, f)| {
                    let (old, new) = (normal(from, f), normal(&moved, f));
                    old.dot(new) < TURN * old.length() * new.length() || new == DVec3::ZERO
                })
                .map(|(i, _)| i as u32)
                .collect();
            if turned.is_empty() {
                break;
            }
            take_back(from, &mut moved, faces, &turned);
        }
        let at: Vec<DVec3> = moved.iter().map(|p| p.as_dvec3()).collect();
        let mut crossed: Vec<u32> = self_intersection::pairs(&at, faces, job)?
            .into_iter()
            .flat_map(|(a, b)| [a, b])
            .collect();
        crossed
            .retain(|&f| faces[f as usize].iter().any(|&v| moved[v as usize] != from[v as usize]));
        if crossed.is_empty() {
            break;
        }
        take_back(from, &mut moved, faces, &crossed);
    }
    Ok(moved)
}

fn take_back(from: &[Vec3], moved: &mut [Vec3], faces: &[[u32; 3]], which: &[u32]) {
    for &v in which.iter().flat_map(|&f| &faces[f as usize]) {
        moved[v as usize] = from[v as usize];
    }
}

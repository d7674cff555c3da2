//! The orientation field: at each vertex a cross of four directions in the tangent plane, as alike
//! to its neighbours' as they can be (4-RoSy; Jakob et al. 2015, section 4.1, extrinsic form, which
//! follows the shape as well as the neighbours).
//!
//! A cross is stored as one of its directions, of unit length and tangent.

use glam::DVec3;

use super::hierarchy::FieldLevel;
use crate::job::{Cancelled, Job};

/// Gauss-Seidel rounds a level.
const ROUNDS: usize = 6;

/// Of the directions of two crosses, the pair that differs least: (of the first, of the second).
pub(super) fn closest_pair(q: DVec3, n: DVec3, r: DVec3, m: DVec3) -> (DVec3, DVec3) {
    let (a, b) = ([q, n.cross(q)], [r, m.cross(r)]);
    let mut best = (-1.0, a[0], b[0]);
    for x in a {
        for y in b {
            let d = x.dot(y);
            if d.abs() > best.0 {
                best = (d.abs(), x, if d < 0.0 { -y } else { y });
            }
        }
    }
    (best.1, best.2)
}

/// `q` in the tangent plane of the unit normal `n`, of unit length.
fn tangent(q: DVec3, n: DVec3) -> DVec3 {
    (q - n * q.dot(n)).try_normalize().unwrap_or_else(|| n.any_orthonormal_vector())
}

/// The field on the finest level.
pub(super) fn orientations(levels: &[FieldLevel], job: &Job) -> Result<Vec<DVec3>, Cancelled> {
    let mut field: Vec<DVec3> = Vec::new();
    for (l, level) in levels.iter().enumerate().rev() {
        field = if field.is_empty() {
            level.normals.iter().map(|n| n.any_orthonormal_vector()).collect()
        } else {
            let parent = &level.parent;
            let from = |v: usize| tangent(field[parent[v] as usize], level.normals[v]);
            (0..level.positions.len()).map(from).collect()
        };
        for v in 0..field.len() {
            if level.along[v] != DVec3::ZERO {
                field[v] = tangent(level.along[v], level.normals[v]);
            }
        }
        for _ in 0..if l == 0 { ROUNDS } else { ROUNDS * 2 } {
            job.check()?;
            smooth(level, &mut field);
        }
    }
    Ok(field)
}

fn smooth(level: &FieldLevel, field: &mut [DVec3]) {
    level.update(field, |v, field| {
        if level.along[v] != DVec3::ZERO {
            return field[v];
        }
        let n = level.normals[v];
        let (mut sum, mut weights) = (field[v], 0.0);
        for &(w, weight) in level.links(v) {
            let (a, b) = closest_pair(sum, n, field[w as usize], level.normals[w as usize]);
            let mean = a * weights + b * weight;
            sum = (mean - n * n.dot(mean)).try_normalize().unwrap_or(sum);
            weights += weight;
        }
        sum
    });
}

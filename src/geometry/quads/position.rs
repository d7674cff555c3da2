//! The position field: at each vertex a lattice of unit squares in the tangent plane, along the
//! orientation, shifted so that it agrees with its neighbours' (4-PoSy; Jakob et al. 2015, section
//! 4.2, extrinsic form). The side of a square is `step`.
//!
//! A lattice is stored as one of its points, the one nearest to the vertex.

use glam::DVec3;

use super::hierarchy::{FieldHold, FieldLevel};
use crate::job::{Cancelled, Job};

/// Gauss-Seidel rounds a level.
const ROUNDS: usize = 6;

/// The lattice of one vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct LatticeFrame {
    /// The vertex.
    pub at: DVec3,
    pub normal: DVec3,
    pub along: DVec3,
    /// A point of the lattice.
    pub origin: DVec3,
}

impl LatticeFrame {
    fn across(&self) -> DVec3 {
        self.normal.cross(self.along)
    }

    fn place(&self, index: [f64; 2], step: f64) -> DVec3 {
        self.origin + (self.along * index[0] + self.across() * index[1]) * step
    }

    fn coordinates(&self, p: DVec3, step: f64) -> [f64; 2] {
        let d = (p - self.origin) / step;
        [d.dot(self.along), d.dot(self.across())]
    }

    /// The lattice point nearest to the vertex.
    fn rounded(&self, step: f64) -> DVec3 {
        self.place(self.coordinates(self.at, step).map(|x| floor(x + 0.5)), step)
    }
}

/// The greatest whole number that is not above `x`, whose size is that of a mesh in quads.
fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    whole - f64::from(u8::from(whole > x))
}

/// A point near both tangent planes and both vertices.
fn middle(a: &LatticeFrame, b: &LatticeFrame) -> DVec3 {
    let (p, n, q, m) = (a.at, a.normal, b.at, b.normal);
    let (np, nq, mp, mq, nm) = (n.dot(p), n.dot(q), m.dot(p), m.dot(q), n.dot(m));
    let scale = 1.0 / (1.0 - nm * nm + 1e-4);
    let x = 2.0 * (nq - np - nm * (mp - mq)) * scale;
    let y = 2.0 * (mp - mq - nm * (nq - np)) * scale;
    (p + q) * 0.5 - (n * x + m * y) * 0.25
}

/// Of the lattice points of `a` around the middle and the points of `b` nearest to them, the pair
/// that is nearest, by index.
pub(super) fn closest_points(
    a: &LatticeFrame,
    b: &LatticeFrame,
    step: f64,
) -> ([f64; 2], [f64; 2]) {
    let base = a.coordinates(middle(a, b), step).map(floor);
    let mut best = (f64::INFINITY, base, [0.0; 2]);
    for k in 0..4 {
        let i = [base[0] + f64::from(k & 1), base[1] + f64::from(k >> 1)];
        let p = a.place(i, step);
        let j = b.coordinates(p, step).map(|x| floor(x + 0.5));
        let d = p.distance_squared(b.place(j, step));
        if d < best.0 {
            best = (d, i, j);
        }
    }
    (best.1, best.2)
}

/// The frames on the finest level.
pub(super) fn positions(
    levels: &[FieldLevel],
    orientations: &[DVec3],
    step: f64,
    job: &Job,
) -> Result<Vec<LatticeFrame>, Cancelled> {
    // The orientations of the coarser levels are those of the finest, averaged upwards by taking
    // the first member's.
    let mut by_level = vec![orientations.to_vec()];
    for l in 1..levels.len() {
        let mut next = vec![DVec3::ZERO; levels[l].positions.len()];
        for (v, &p) in levels[l - 1].parent.iter().enumerate() {
            let own = by_level[l - 1][v];
            let n = levels[l].normals[p as usize];
            let sum = next[p as usize];
            next[p as usize] = if sum == DVec3::ZERO {
                own
            } else {
                let (a, b) =
                    super::orientation::closest_pair(sum, n, own, levels[l - 1].normals[v]);
                a + b
            };
        }
        for (q, n) in next.iter_mut().zip(&levels[l].normals) {
            *q =
                (*q - *n * q.dot(*n)).try_normalize().unwrap_or_else(|| n.any_orthonormal_vector());
        }
        by_level.push(next);
    }
    let mut origins: Vec<DVec3> = Vec::new();
    let mut frames = Vec::new();
    for (l, level) in levels.iter().enumerate().rev() {
        let field = &by_level[l];
        origins = if origins.is_empty() {
            level.positions.clone()
        } else {
            let from = |v: usize| {
                let o: DVec3 = origins[level.parent[v] as usize];
                o - level.normals[v] * level.normals[v].dot(o - level.positions[v])
            };
            (0..level.positions.len()).map(from).collect()
        };
        frames = (0..level.positions.len())
            .map(|v| LatticeFrame {
                at: level.positions[v],
                normal: level.normals[v],
                along: field[v],
                origin: origins[v],
            })
            .collect();
        for _ in 0..if l == 0 { ROUNDS } else { ROUNDS * 2 } {
            job.check()?;
            smooth(level, &mut frames, step);
        }
        origins = frames.iter().map(|f| f.origin).collect();
    }
    Ok(frames)
}

fn smooth(level: &FieldLevel, frames: &mut [LatticeFrame], step: f64) {
    level.update(frames, |v, frames| {
        let mut own = frames[v];
        if level.hold[v] == FieldHold::Point {
            own.origin = own.at;
            return own;
        }
        let mut weights = 0.0;
        for &(w, weight) in level.links(v) {
            let other = &frames[w as usize];
            let (i, j) = closest_points(&own, other, step);
            let (p, q) = (own.place(i, step), other.place(j, step));
            let mean = (p * weights + q * weight) / (weights + weight);
            weights += weight;
            own.origin = mean - own.normal * own.normal.dot(mean - own.at);
        }
        if level.hold[v] == FieldHold::Line {
            // The lattice line passes through the vertex.
            let d = own.at - own.origin;
            own.origin += d - own.along * own.along.dot(d);
        }
        own.origin = own.rounded(step);
        own
    });
}

//! Triangles around a vertex that are known not to cross without testing each pair.
//!
//! Consider the triangles around a vertex that all face the same way along an axis, whose edges at
//! the vertex have two triangles each, and which go around it once. Seen along the axis, they cover
//! their surroundings once: no two of them have more in common than their vertex or their edge.
//! That holds at nearly every vertex of a smooth surface (Volino and Magnenat-Thalmann, "Efficient
//! self-collision detection on smoothly discretized surface animations using geometrical shape
//! regularity", 1994, test the same on larger patches). All signs are certain: a sign within
//! rounding counts as unknown.

use glam::DVec3;
use rayon::prelude::*;

use crate::job::{Cancelled, Job};

/// The triangles at each vertex, and at which vertices none of them can cross another.
#[derive(Debug)]
pub(super) struct Stars {
    /// Along which of the six axis directions each triangle certainly faces, one bit each.
    facing: Vec<u8>,
    /// The corners at vertex `v` are `corners[starts[v]..starts[v + 1]]`: three times the triangle,
    /// and which of its corners.
    starts: Vec<u32>,
    corners: Vec<u32>,
    clear: Vec<bool>,
}

/// Vertices of one task.
const TASK: usize = 4096;

impl Stars {
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]], job: &Job) -> Result<Stars, Cancelled> {
        let flat = triangles.as_flattened();
        let mut starts = vec![0u32; positions.len() + 1];
        flat.iter().for_each(|&v| starts[v as usize + 1] += 1);
        for v in 0..positions.len() {
            starts[v + 1] += starts[v];
        }
        job.check()?;
        let mut next = starts.clone();
        let mut corners = vec![0u32; flat.len()];
        for (c, &v) in flat.iter().enumerate() {
            let at = &mut next[v as usize];
            corners[*at as usize] = c as u32;
            *at += 1;
        }
        job.check()?;
        let facing: Vec<u8> =
            triangles.par_iter().map(|t| facing(t.map(|v| positions[v as usize]))).collect();
        job.check()?;
        let mut stars = Stars { facing, starts, corners, clear: Vec::new() };
        let mut clear = vec![false; positions.len()];
        clear.par_chunks_mut(TASK).enumerate().for_each(|(task, out)| {
            let mut ends = (Vec::new(), Vec::new());
            for (i, out) in out.iter_mut().enumerate() {
                *out = stars.is_clear((task * TASK + i) as u32, positions, flat, &mut ends);
            }
        });
        stars.clear = clear;
        Ok(stars)
    }

    /// Returns true if triangles that share this vertex are known not to cross.
    #[inline(always)]
    pub fn clear(&self, v: u32) -> bool {
        self.clear[v as usize]
    }

    fn around(&self, v: u32) -> &[u32] {
        &self.corners[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }

    fn is_clear(
        &self,
        v: u32,
        positions: &[DVec3],
        flat: &[u32],
        (ins, outs): &mut (Vec<u32>, Vec<u32>),
    ) -> bool {
        let around = self.around(v);
        let common = around.iter().fold(0x3f, |m, &c| m & self.facing[c as usize / 3]);
        if around.len() < 3 || common == 0 {
            return false;
        }
        let bit = common.trailing_zeros() as usize;
        let (axis, back) = (bit / 2, bit % 2 == 1);
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let o = positions[v as usize];
        // From the positive first axis on, half a turn.
        let upper = |w: u32| {
            let p = positions[w as usize];
            p[j] > o[j] || (p[j] == o[j] && p[i] > o[i])
        };
        ins.clear();
        outs.clear();
        let mut turns = 0;
        for &c in around {
            let first = c - c % 3;
            let at = |k: u32| flat[(first + (c + k) % 3) as usize];
            let (a, b) = if back { (at(2), at(1)) } else { (at(1), at(2)) };
            // A triangle spans less than half a turn, and the positive axis is passed upwards only.
            turns += usize::from(!upper(a) && upper(b));
            outs.push(a);
            ins.push(b);
        }
        if turns != 1 {
            return false;
        }
        ins.sort_unstable();
        outs.sort_unstable();
        ins == outs && ins.windows(2).all(|w| w[0] != w[1])
    }

    /// Calls `f(state of the task, lower vertex, upper vertex, triangles)` for each edge of two or
    /// more triangles if two of them may be coplanar on the same side of it. Skips triangles with a
    /// vertex twice.
    pub fn doubtful_edges<T: Send + Default>(
        &self,
        triangles: &[[u32; 3]],
        job: &Job,
        f: impl Fn(&mut T, u32, u32, &[u32]) + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        self.clear
            .par_chunks(TASK)
            .enumerate()
            .map(|(task, clear)| {
                job.check()?;
                let mut state = T::default();
                // (upper vertex, triangle, whether the edge runs to it)
                let mut uses: Vec<(u32, u32, bool)> = Vec::new();
                let mut group = Vec::new();
                for i in (0..clear.len()).filter(|&i| !clear[i]) {
                    let v = (task * TASK + i) as u32;
                    uses.clear();
                    for &c in self.around(v) {
                        let t = triangles[c as usize / 3];
                        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
                            continue;
                        }
                        let k = c as usize % 3;
                        let ends = [(t[(k + 1) % 3], true), (t[(k + 2) % 3], false)];
                        let later = ends.into_iter().filter(|e| e.0 > v && !self.clear(e.0));
                        uses.extend(later.map(|(w, to)| (w, c / 3, to)));
                    }
                    uses.sort_unstable();
                    for edge in uses.chunk_by(|x, y| x.0 == y.0).filter(|e| e.len() > 1) {
                        // Two triangles that face the same way are on both sides of their edge.
                        if let &[(_, s, x), (_, t, y)] = edge
                            && x != y
                            && self.facing[s as usize] & self.facing[t as usize] != 0
                        {
                            continue;
                        }
                        group.clear();
                        group.extend(edge.iter().map(|e| e.1));
                        f(&mut state, v, edge[0].0, &group);
                    }
                }
                Ok(state)
            })
            .collect()
    }
}

/// One bit for each axis direction along which the triangle certainly faces: twice its area seen
/// along the axis, held against the bound of Shewchuk's `orient2d` (1997).
fn facing([a, b, c]: [DVec3; 3]) -> u8 {
    const BOUND: f64 = 3.331e-16;
    /// Below this, products may have lost digits to underflow.
    const LEAST: f64 = 1e-280;
    let (u, w) = (b - a, c - a);
    let mut bits = 0;
    for axis in 0..3 {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let (left, right) = (u[i] * w[j], u[j] * w[i]);
        let (area, size) = (left - right, left.abs() + right.abs());
        if area.abs() > BOUND * size && size > LEAST {
            bits |= if area > 0.0 { 1 } else { 2 } << (2 * axis);
        }
    }
    bits
}

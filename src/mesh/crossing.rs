//! Which triangles of a mesh cross others: boxes in a tree, then exact tests.
//!
//! Two triangles cross if an edge of one passes through the inside of the other, or if they lie in one plane and overlap. The
//! vertices that both share (by index) and touches from outside do not count. Signs are those of exact arithmetic (Shewchuk's
//! `orient3d`) on the coordinates as they are.

use glam::{DVec3, Vec3};
use obvhs::aabb::Aabb;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::analysis::cancel::{Cancelled, Job};

/// How often a mesh crosses itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of triangles.
    pub pairs: usize,
    /// Triangles with a part in a pair.
    pub triangles: usize,
}

/// All crossing pairs, the lower triangle first, sorted.
pub fn pairs(positions: &[DVec3], triangles: &[[u32; 3]], job: &Job) -> Result<Vec<(u32, u32)>, Cancelled> {
    if triangles.len() < 2 {
        return Ok(Vec::new());
    }
    let boxes: Vec<Aabb> = triangles
        .par_iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
            // Outwards, so that rounding to single precision loses no contact.
            let down = Vec3::from(lo.to_array().map(|v| (v as f32).next_down()));
            let up = Vec3::from(hi.to_array().map(|v| (v as f32).next_up()));
            Aabb::new(down.into(), up.into())
        })
        .collect();
    job.check()?;
    let tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Low,
        &boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        0,
    );
    job.check()?;
    job.progress(0.6);
    // In the tree's order neighbours in the list are neighbours in space: the walk stays in the cache.
    let found: Result<Vec<Vec<(u32, u32)>>, Cancelled> = tree
        .primitive_indices
        .par_chunks(1024)
        .map(|block| {
            job.check()?;
            let mut out = Vec::new();
            let mut stack: Vec<u32> = Vec::with_capacity(128);
            for &t in block {
                let own = &boxes[t as usize];
                stack.push(0);
                while let Some(n) = stack.pop() {
                    let node = &tree.nodes[n as usize];
                    if !node.aabb().intersect_aabb(own) {
                        continue;
                    }
                    if !node.is_leaf() {
                        stack.extend([node.first_index, node.first_index + 1]);
                        continue;
                    }
                    let first = node.first_index as usize;
                    for &u in &tree.primitive_indices[first..first + node.prim_count as usize] {
                        if u > t
                            && boxes[u as usize].intersect_aabb(own)
                            && cross(positions, triangles[t as usize], triangles[u as usize])
                        {
                            out.push((t, u));
                        }
                    }
                }
            }
            Ok(out)
        })
        .collect();
    let mut found: Vec<(u32, u32)> = found?.into_iter().flatten().collect();
    found.sort_unstable();
    Ok(found)
}

/// Counts the pairs of [`pairs`].
pub fn count(positions: &[DVec3], triangles: &[[u32; 3]], job: &Job) -> Result<Crossings, Cancelled> {
    let found = pairs(positions, triangles, job)?;
    let mut crossed: Vec<u32> = found.iter().flat_map(|&(a, b)| [a, b]).collect();
    crossed.sort_unstable();
    crossed.dedup();
    Ok(Crossings { pairs: found.len(), triangles: crossed.len() })
}

fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let at = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(at(a), at(b), at(c), at(d))
}

/// Whether two triangles cross beyond what they share.
fn cross(positions: &[DVec3], s: [u32; 3], t: [u32; 3]) -> bool {
    let p = |v: u32| positions[v as usize];
    let shared = s.iter().filter(|v| t.contains(v)).count();
    let (ps, pt) = (s.map(p), t.map(p));
    let of_t = pt.map(|d| side(ps[0], ps[1], ps[2], d));
    if of_t.iter().all(|&v| v == 0.0) {
        return overlap(ps, pt);
    }
    if shared >= 2 {
        return false;
    }
    if of_t.iter().all(|&v| v > 0.0) || of_t.iter().all(|&v| v < 0.0) {
        return false;
    }
    let of_s = ps.map(|d| side(pt[0], pt[1], pt[2], d));
    if of_s.iter().all(|&v| v > 0.0) || of_s.iter().all(|&v| v < 0.0) {
        return false;
    }
    (0..3).any(|i| {
        let j = (i + 1) % 3;
        pierces(pt[i], pt[j], of_t[i], of_t[j], ps) || pierces(ps[i], ps[j], of_s[i], of_s[j], pt)
    })
}

/// Whether the edge, whose ends lie on sides `d` and `e` of the triangle's plane, passes through the triangle's inside.
fn pierces(p: DVec3, q: DVec3, d: f64, e: f64, t: [DVec3; 3]) -> bool {
    if !(d > 0.0 && e < 0.0 || d < 0.0 && e > 0.0) {
        return false;
    }
    let turn = [side(p, q, t[0], t[1]), side(p, q, t[1], t[2]), side(p, q, t[2], t[0])];
    turn.iter().all(|&v| v > 0.0) || turn.iter().all(|&v| v < 0.0)
}

/// Whether two triangles in one plane have an area in common: no edge's line has one on either side.
fn overlap(ps: [DVec3; 3], pt: [DVec3; 3]) -> bool {
    let n = ((ps[1] - ps[0]).cross(ps[2] - ps[0])).abs();
    let m = ((pt[1] - pt[0]).cross(pt[2] - pt[0])).abs();
    let n = n.max(m);
    let flat = |p: DVec3| {
        if n.x >= n.y && n.x >= n.z {
            Coord { x: p.y, y: p.z }
        } else if n.y >= n.z {
            Coord { x: p.z, y: p.x }
        } else {
            Coord { x: p.x, y: p.y }
        }
    };
    let (a, b) = (ps.map(flat), pt.map(flat));
    let apart = |a: &[Coord<f64>; 3], b: &[Coord<f64>; 3]| {
        let turn = orient2d(a[0], a[1], a[2]);
        turn == 0.0
            || (0..3).any(|i| {
                let j = (i + 1) % 3;
                b.iter().all(|&q| orient2d(a[i], a[j], q) * turn.signum() <= 0.0)
            })
    };
    !apart(&a, &b) && !apart(&b, &a)
}

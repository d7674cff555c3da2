//! Which triangles of a mesh cross others: boxes in a tree, then exact tests.
//!
//! Two triangles cross if their insides have a line in common, or if they are coplanar and overlap.
//! A surface also crosses another exactly along edges: an edge that runs through a triangle's
//! inside with faces on both sides of it, and two edges on one line whose faces alternate. Parts
//! shared by index and touches from outside do not count. Signs are exact (Shewchuk's `orient3d`)
//! for the given coordinates, so these cases include all surfaces that go through each other. Such
//! surfaces have a line in common, and each piece of it is inside of, or an edge of, a face of
//! either.

mod box_groups;
mod predicate;
mod shared;
mod stars;
mod touch;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::job::{Cancelled, Job};
use crate::tight_frame::tight_frame;
use box_groups::{BoxGroups, RoundedBox};
use predicate::{Meet, triangles_meet};
use shared::along_shared_edge;
use stars::Stars;
use touch::{Touch, through, touch};

/// The number of a mesh's self-crossings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of triangles.
    pub pairs: usize,
    /// Triangles that are part of a pair.
    pub triangles: usize,
}

/// Pairs that cross whatever is beside them, and what to ask their neighbours.
type Found = (Vec<(u32, u32)>, Vec<Touch>);

/// All crossing pairs, the lower triangle first, sorted.
pub fn pairs(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    job: &Job,
) -> Result<Vec<(u32, u32)>, Cancelled> {
    if triangles.len() < 2 {
        return Ok(Vec::new());
    }
    let boxes = TriangleBoxes::new(positions, triangles);
    let list = (0..triangles.len() as u32).into_par_iter();
    let (tree, stars) = rayon::join(
        || BoxGroups::build(list, |t| boxes.of(t), job),
        || Stars::new(positions, triangles, job),
    );
    let (tree, stars) = (tree?, stars?);
    job.progress(0.6);
    let found: Vec<Found> = tree.pairs(job, |found, t, u| {
        let (own, other) = (triangles[t as usize], triangles[u as usize]);
        if !own.iter().any(|v| other.contains(v) && stars.clear(*v)) {
            compare(positions, triangles, t.min(u), t.max(u), found);
        }
    })?;
    let (mut crossed, touches) = joined(found);
    through(positions, triangles, touches, |_| true, &mut crossed);
    let at_edges = stars.doubtful_edges(triangles, job, |out: &mut Vec<_>, a, b, around| {
        along_shared_edge(positions, triangles, (a, b), around, out);
    })?;
    crossed.extend(at_edges.into_iter().flatten());
    crossed.sort_unstable();
    crossed.dedup();
    Ok(crossed)
}

/// Pairs of triangles whose boxes are no farther from each other than twice `slack`, the lower
/// triangle first, sorted.
pub(crate) fn near_pairs(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    slack: f64,
    job: &Job,
) -> Result<Vec<(u32, u32)>, Cancelled> {
    if triangles.len() < 2 {
        return Ok(Vec::new());
    }
    let boxes = TriangleBoxes::new(positions, triangles);
    let list = (0..triangles.len() as u32).into_par_iter();
    let tree = BoxGroups::build(list, |t| boxes.grown(t, slack), job)?;
    let found: Vec<Vec<(u32, u32)>> =
        tree.pairs(job, |found: &mut Vec<_>, t, u| found.push((t.min(u), t.max(u))))?;
    let mut all = found.concat();
    all.par_sort_unstable();
    Ok(all)
}

/// Those of [`pairs`] in which one triangle of `changed` is, ascending and each once. The rest of
/// the mesh is not compared, and costs a look at each box only.
pub fn pairs_with(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    changed: &[u32],
    job: &Job,
) -> Result<Vec<(u32, u32)>, Cancelled> {
    let mut counts = vec![false; triangles.len()];
    changed.iter().for_each(|&t| counts[t as usize] = true);
    let counts = |t: u32| counts[t as usize];
    let counted = |p: &(u32, u32)| counts(p.0) || counts(p.1);
    if changed.len() * 3 > triangles.len() {
        let mut found = pairs(positions, triangles, job)?;
        found.retain(counted);
        return Ok(found);
    }
    if changed.is_empty() {
        return Ok(Vec::new());
    }
    // The status of an edge on a surface depends on all triangles at the edge: all are compared.
    let sides = |t: u32| {
        let t = triangles[t as usize];
        [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(a, b)| (a.min(b), a.max(b)))
    };
    let mut edges: Vec<(u32, u32)> = changed.iter().flat_map(|&t| sides(t)).collect();
    edges.par_sort_unstable();
    edges.dedup();
    let mut at_edge = vec![false; positions.len()];
    edges.iter().for_each(|e| (at_edge[e.0 as usize], at_edge[e.1 as usize]) = (true, true));
    let is_compared = |t: &u32| {
        let near = triangles[*t as usize].iter().filter(|&&v| at_edge[v as usize]).count();
        counts(*t) || near >= 2 && sides(*t).iter().any(|e| edges.binary_search(e).is_ok())
    };
    let all = (0..triangles.len() as u32).into_par_iter();
    let compared: Vec<u32> = all.filter(is_compared).collect();
    job.check()?;
    let boxes = TriangleBoxes::new(positions, triangles);
    let tree = BoxGroups::build(compared.par_iter().copied(), |t| boxes.of(t), job)?;
    job.progress(0.6);
    const TASK: usize = 1 << 13;
    let found: Result<Vec<Found>, Cancelled> = (0..triangles.len().div_ceil(TASK))
        .into_par_iter()
        .map(|task| {
            job.check()?;
            let (mut found, mut stack) = (Found::default(), Vec::new());
            for t in task * TASK..triangles.len().min((task + 1) * TASK) {
                let t = t as u32;
                tree.near(&boxes.of(t), &mut stack, |u| {
                    // Two that are in the tree meet twice.
                    if u < t || u > t && compared.binary_search(&t).is_err() {
                        compare(positions, triangles, t.min(u), t.max(u), &mut found);
                    }
                });
            }
            Ok(found)
        })
        .collect();
    let (mut crossed, touches) = joined(found?);
    through(positions, triangles, touches, counts, &mut crossed);
    let mut uses: Vec<((u32, u32), u32)> = Vec::new();
    for &t in &compared {
        let [a, b, c] = triangles[t as usize];
        if a != b && b != c && c != a {
            let own = sides(t).into_iter().filter(|e| edges.binary_search(e).is_ok());
            uses.extend(own.map(|e| (e, t)));
        }
    }
    uses.sort_unstable();
    for edge in uses.chunk_by(|x, y| x.0 == y.0).filter(|e| e.len() > 1) {
        let around: Vec<u32> = edge.iter().map(|e| e.1).collect();
        along_shared_edge(positions, triangles, edge[0].0, &around, &mut crossed);
    }
    crossed.retain(counted);
    crossed.sort_unstable();
    crossed.dedup();
    Ok(crossed)
}

/// Compares two triangles whose boxes meet. Triangles at one edge are left to
/// [`along_shared_edge`], which compares them in their order around it.
fn compare(positions: &[DVec3], triangles: &[[u32; 3]], t: u32, u: u32, found: &mut Found) {
    let (own, other) = (triangles[t as usize], triangles[u as usize]);
    if own.iter().filter(|v| other.contains(v)).count() == 2 {
        return;
    }
    match triangles_meet(positions, own, other) {
        Meet::No => {}
        Meet::Cross => found.0.push((t, u)),
        meet => found.1.extend(touch(positions, triangles, t, u, meet)),
    }
}

fn joined(found: Vec<Found>) -> Found {
    let (mut crossed, mut touches) = Found::default();
    for (c, t) in found {
        crossed.extend(c);
        touches.extend(t);
    }
    (crossed, touches)
}

/// The boxes of triangles, in a frame in which they are small.
struct TriangleBoxes<'a> {
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    /// The frame, and by how much boxes in it are larger, for places in it are off by rounding.
    turned: Option<(DMat3, f64)>,
}

impl<'a> TriangleBoxes<'a> {
    fn new(positions: &'a [DVec3], triangles: &'a [[u32; 3]]) -> TriangleBoxes<'a> {
        let turned = tight_frame(positions, triangles).map(|turn| {
            let reach = positions.iter().fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
            (turn, reach * 1e-14)
        });
        TriangleBoxes { positions, triangles, turned }
    }

    fn of(&self, t: u32) -> RoundedBox {
        self.grown(t, 0.0)
    }

    /// The box, larger by a length on every side.
    fn grown(&self, t: u32, by: f64) -> RoundedBox {
        let [a, b, c] = self.triangles[t as usize].map(|v| self.positions[v as usize]);
        match self.turned {
            Some((turn, room)) => {
                let ([a, b, c], room) = ([turn * a, turn * b, turn * c], room + by);
                RoundedBox::around(a.min(b).min(c) - room, a.max(b).max(c) + room)
            }
            None => RoundedBox::around(a.min(b).min(c) - by, a.max(b).max(c) + by),
        }
    }
}

/// Counts the pairs of [`pairs`].
pub fn count(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    job: &Job,
) -> Result<Crossings, Cancelled> {
    let found = pairs(positions, triangles, job)?;
    let mut crossed: Vec<u32> = found.iter().flat_map(|&(a, b)| [a, b]).collect();
    crossed.sort_unstable();
    crossed.dedup();
    Ok(Crossings { pairs: found.len(), triangles: crossed.len() })
}

/// Returns true if the insides of two triangles have a line or an area in common, beyond the
/// corners that they share.
pub fn crosses(positions: &[DVec3], s: [u32; 3], t: [u32; 3]) -> bool {
    triangles_meet(positions, s, t) != Meet::No
}

#[cfg(test)]
mod tests;

//! What a mould asks of a part: draft, undercuts and the direction in which it parts.
//!
//! A face is released by the half of the mould on its side, if the way from it along the pull
//! direction is free; a face along the pull direction, by either half. The area that neither half
//! releases is an undercut. Draft is exact; undercuts are measured by a ray from each cell of each
//! face ([`crate::columns`]).

use glam::DVec3;
use rayon::prelude::*;
use sculptd_geometry::flat_region::large_faces;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::projection::spread_directions;

use crate::ceilings::Ceilings;
use crate::columns::{CellSum, over_cells, surface_points};
use crate::part::PreparedPart;
use crate::regions::{FaceRegion, connected};

/// Angles that differ by less, degrees, are one.
const ANGLE_SLACK: f64 = 0.01;
/// Directions of a hemisphere that are tried.
const DIRECTIONS: usize = 500;
/// Points of the surface that each of them is tried with, and the last of them are.
const POINTS: usize = 2048;
const FINE_POINTS: usize = 1 << 14;
/// Directions that are refined.
const REFINED: usize = 8;
/// The share of the points that all directions are tried with, one in so many.
const FIRST: usize = 16;
/// Points of which all are counted before directions are left out.
const BLOCK: usize = 64;
/// The least share of the surface of a flat face whose normal is tried.
const FLAT_SHARE: f64 = 0.01;
/// Faces of one task.
const CHUNK: usize = 256;

/// A region with less draft than a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct DraftRegion {
    /// The region.
    pub region: FaceRegion,
    /// The least draft, degrees.
    pub draft: f64,
}

/// A region that neither half of a mould releases.
#[derive(Debug, Clone, PartialEq)]
pub struct UndercutRegion {
    /// The faces that are hidden at least in part.
    pub region: FaceRegion,
    /// The hidden area.
    pub hidden: CellSum,
}

/// The angle between a face and the pull direction, degrees, 0 to 90.
pub fn draft_angle(normal: DVec3, pull: DVec3) -> f64 {
    90.0 - normal.dot(pull).abs().min(1.0).portable_acos().to_degrees()
}

/// The regions with less draft than `limit` degrees, the largest first.
pub fn draft_regions(part: &PreparedPart, pull: DVec3, limit: f64) -> Vec<DraftRegion> {
    let most = (limit - ANGLE_SLACK).max(0.0).to_radians().portable_sin();
    let faces: Vec<u32> = (0..part.triangles() as u32)
        .filter(|&t| {
            part.areas[t as usize] > 0.0 && part.normals[t as usize].dot(pull).abs() < most
        })
        .collect();
    connected(part, &faces)
        .into_iter()
        .map(|region| {
            let own = region.triangles.iter();
            let draft = own.map(|&t| draft_angle(part.normals[t as usize], pull));
            DraftRegion { draft: draft.fold(f64::INFINITY, f64::min), region }
        })
        .collect()
}

/// Returns true if a point of a face is hidden from both halves. `blocked` says whether the way
/// from a place along a direction is.
fn hidden(
    part: &PreparedPart,
    pull: DVec3,
    (p, t): (DVec3, u32),
    blocked: impl Fn(DVec3, DVec3) -> bool,
) -> bool {
    let normal = part.normals[t as usize];
    let step = 16.0 * part.rounding();
    let (from, rise) = (p + normal * step, normal.dot(pull));
    let vertical = rise.abs() < ANGLE_SLACK.to_radians();
    (rise < 0.0 && !vertical || blocked(from, pull))
        && (rise > 0.0 && !vertical || blocked(from, -pull))
}

/// The regions that neither half releases along `pull`, the largest first. Cells have `cell` square
/// millimetres.
pub fn undercuts(
    part: &PreparedPart,
    pull: DVec3,
    cell: f64,
    job: &Job,
) -> Result<Vec<UndercutRegion>, Cancelled> {
    let all: Vec<u32> = (0..part.triangles() as u32).collect();
    let (above, below) = rayon::join(|| Ceilings::new(part, pull), || Ceilings::new(part, -pull));
    let blocked = |from: DVec3, way: DVec3| {
        let ceilings = if way == pull { &above } else { &below };
        !ceilings.open_above(from) && part.blocked(from, way, 0.0)
    };
    let one = |&t: &u32| {
        let Some(corners) = part.corners(t) else { return CellSum::default() };
        over_cells(corners, part.areas[t as usize], cell, |p| {
            f64::from(u8::from(hidden(part, pull, (p, t), blocked)))
        })
    };
    let chunks = all.par_chunks(CHUNK).map(|chunk| {
        job.check()?;
        Ok(chunk.iter().map(one).collect::<Vec<_>>())
    });
    let sums = chunks.collect::<Result<Vec<_>, Cancelled>>()?.concat();
    let faces: Vec<u32> = all.into_iter().filter(|&t| sums[t as usize].total > 0.0).collect();
    let mut out: Vec<UndercutRegion> = connected(part, &faces)
        .into_iter()
        .map(|region| {
            let mut hidden = CellSum::default();
            region.triangles.iter().for_each(|&t| hidden.add(&sums[t as usize]));
            UndercutRegion { region, hidden }
        })
        .collect();
    out.sort_by(|a, b| b.hidden.total.total_cmp(&a.hidden.total));
    Ok(out)
}

/// A direction in which a mould may part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartingDirection {
    /// Of unit length.
    pub direction: DVec3,
    /// The area that neither half releases.
    pub undercut: CellSum,
    /// The area with less draft than the limit.
    pub low_draft: f64,
}

/// A direction and how many points of a sample it hides.
#[derive(Debug, Clone, Copy)]
struct TriedDirection {
    hidden: usize,
    direction: DVec3,
}

/// Points of the surface with which directions are compared. Points that earlier directions hid
/// come first, so that a bad direction is left out before all its points are counted.
struct HidingPoints<'a> {
    part: &'a PreparedPart,
    points: Vec<(DVec3, u32)>,
    /// The number of directions that hid each point.
    times: Vec<u32>,
}

impl<'a> HidingPoints<'a> {
    fn new(part: &'a PreparedPart, count: usize) -> HidingPoints<'a> {
        let points = surface_points(part, count);
        HidingPoints { part, times: vec![0; points.len()], points }
    }

    /// Adds to `best` the directions of `tried`, in their order, with the number of points that
    /// each hides. Those that hide more than the `keep`-th least of all are left out, some of them
    /// as soon as they do.
    fn rate(
        &mut self,
        tried: &[DVec3],
        best: &mut Vec<TriedDirection>,
        keep: usize,
        job: &Job,
    ) -> Result<(), Cancelled> {
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        order.sort_by_key(|&i| std::cmp::Reverse(self.times[i]));
        let mut counts: Vec<usize> = vec![0; tried.len()];
        let mut live: Vec<usize> = (0..tried.len()).collect();
        let least = |mut all: Vec<usize>| {
            all.sort_unstable();
            all.get(keep - 1).copied().unwrap_or(usize::MAX)
        };
        let known = best.iter().map(|b| b.hidden);
        let (first, rest) = order.split_at((order.len() / FIRST).min(order.len()));
        self.count(first, tried, &live, &mut counts, job)?;
        // The best by these points are counted in full: a bound for the others.
        live.sort_by_key(|&d| counts[d]);
        let others = live.split_off(keep.min(live.len()));
        self.count(rest, tried, &live, &mut counts, job)?;
        let most = least(known.chain(live.iter().map(|&d| counts[d])).collect());
        let mut rest = rest.to_vec();
        rest.sort_by_key(|&i| std::cmp::Reverse(self.times[i]));
        let mut open = others;
        for block in rest.chunks(BLOCK) {
            open.retain(|&d| counts[d] <= most);
            self.count(block, tried, &open, &mut counts, job)?;
        }
        live.extend(open);
        live.retain(|&d| counts[d] <= most);
        live.sort_unstable();
        let rated = |d| TriedDirection { hidden: counts[d], direction: tried[d] };
        best.extend(live.into_iter().map(rated));
        Ok(())
    }

    /// Adds to `counts` how many of `points` each direction of `live` hides.
    fn count(
        &mut self,
        points: &[usize],
        tried: &[DVec3],
        live: &[usize],
        counts: &mut [usize],
        job: &Job,
    ) -> Result<(), Cancelled> {
        let blocked = |from, way| self.part.blocked(from, way, 0.0);
        // All directions of a point, one after the other: what is near it stays in the caches.
        let hides = |&i: &usize| {
            job.check()?;
            let hidden = |d: &usize| hidden(self.part, tried[*d], self.points[i], blocked);
            Ok(live.iter().copied().filter(hidden).collect())
        };
        let found: Vec<Vec<usize>> = points.par_iter().map(hides).collect::<Result<_, _>>()?;
        for (&i, hidden) in points.iter().zip(&found) {
            self.times[i] += hidden.len() as u32;
            hidden.iter().for_each(|&d| counts[d] += 1);
        }
        Ok(())
    }
}

/// The direction with the least undercut, then the least area without draft: among `also`, the
/// axes, the normals of large flat faces and 500 directions of a hemisphere, the best of which are
/// refined. The undercut is measured at points spread over the surface. The first of `also` wins a
/// tie.
pub fn best_parting(
    part: &PreparedPart,
    also: &[DVec3],
    draft: f64,
    job: &Job,
) -> Result<Option<PartingDirection>, Cancelled> {
    let mut points = HidingPoints::new(part, POINTS);
    let mut fixed: Vec<DVec3> = also.to_vec();
    fixed.extend([DVec3::Z, DVec3::X, DVec3::Y]);
    let flat = large_faces(&part.centred.mesh, FLAT_SHARE);
    fixed.extend(flat.iter().map(|f| f.normal).take(REFINED * 2));
    let mut rated = Vec::new();
    let mut tried = spread_directions(DIRECTIONS);
    let mut step = 6f64.to_radians();
    for _ in 0..=3 {
        points.rate(&tried, &mut rated, REFINED, job)?;
        rated.sort_by_key(|r| r.hidden);
        rated.truncate(REFINED);
        tried = rated.iter().flat_map(|r| ring(r.direction, step)).collect();
        step *= 0.4;
    }
    let mut last: Vec<DVec3> = Vec::new();
    for d in fixed.into_iter().chain(rated.iter().map(|r| r.direction)) {
        if last.iter().all(|o| o.dot(d).abs() < 1.0 - 1e-9) {
            last.push(d);
        }
    }
    let mut measured = Vec::new();
    HidingPoints::new(part, FINE_POINTS).rate(&last, &mut measured, 1, job)?;
    let Some(count) = measured.iter().map(|m| m.hidden).min() else { return Ok(None) };
    let each = part.areas.iter().sum::<f64>() / FINE_POINTS as f64;
    let share = count as f64 / FINE_POINTS as f64;
    let variance = count as f64 * (1.0 - share) * each * each;
    let undercut = CellSum { total: count as f64 * each, variance };
    let least = draft.to_radians().portable_sin();
    let low_draft = |d: DVec3| -> f64 {
        let low = |t: usize| part.normals[t].dot(d).abs() < least - 1e-4;
        (0..part.triangles()).filter(|&t| low(t)).map(|t| part.areas[t]).sum()
    };
    let parting = |m: &TriedDirection| PartingDirection {
        direction: m.direction,
        undercut,
        low_draft: low_draft(m.direction),
    };
    let equal: Vec<PartingDirection> =
        measured.par_iter().filter(|m| m.hidden == count).map(parting).collect();
    Ok(equal.into_iter().min_by(|a, b| a.low_draft.total_cmp(&b.low_draft)))
}

/// Six directions around `d` at an angle of `step` radians.
pub fn ring(d: DVec3, step: f64) -> impl Iterator<Item = DVec3> {
    let (u, v) = d.any_orthonormal_pair();
    (0..6).map(move |i| {
        let turn = std::f64::consts::TAU * f64::from(i) / 6.0;
        let side = u * turn.portable_cos() + v * turn.portable_sin();
        (d * step.portable_cos() + side * step.portable_sin()).normalize()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ceilings::tests::parts;

    #[test]
    fn the_best_directions_are_those_of_an_exhaustive_search() {
        let job = Job::default();
        for part in parts() {
            let count = |d: DVec3, points: &[(DVec3, u32)]| {
                let blocked = |from, way| part.blocked(from, way, 0.0);
                points.iter().filter(|&&p| hidden(&part, d, p, blocked)).count()
            };
            for keep in [1, 5] {
                let mut points = HidingPoints::new(&part, 1000);
                let mut best: Vec<TriedDirection> = Vec::new();
                let mut all: Vec<TriedDirection> = Vec::new();
                // A second set is compared with the first, as refined directions are.
                for tried in spread_directions(120).chunks(60) {
                    points.rate(tried, &mut best, keep, &job).expect("not cancelled");
                    let counted = |&direction: &DVec3| TriedDirection {
                        hidden: count(direction, &points.points),
                        direction,
                    };
                    all.extend(tried.iter().map(counted));
                    for list in [&mut best, &mut all] {
                        list.sort_by_key(|t| t.hidden);
                    }
                    let kept = |list: &[TriedDirection]| -> Vec<(usize, DVec3)> {
                        list.iter().take(keep).map(|t| (t.hidden, t.direction)).collect()
                    };
                    assert_eq!(kept(&best), kept(&all));
                }
                assert!(best.len() < all.len(), "none was left out");
            }
        }
    }
}

//! Face sets that follow from the shape: loose parts, parts that face one way, parts between
//! creases, parts of equal wall. Computed from a snapshot on the thread of whoever asks, put in
//! place by [`SetsEdit::Assign`].

use std::sync::Arc;

use glam::Vec3;

use super::{HIDDEN, MOST_SETS, SetsEdit, SetsError};
use crate::snapshot::Snapshot;
use sculptd_geometry::TriMesh;
use sculptd_geometry::disjoint_sets::DisjointSets;
use sculptd_geometry::job::Job;
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::thickness::partition::PartitionSettings;
use sculptd_geometry::thickness::{
    MeasuredPlaces, ThicknessError, ThicknessMethod, ThicknessSettings, measure,
};

/// The rule that separates one set from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Partition {
    /// Makes a set of each connected part.
    Loose,
    /// Grows a set from its first triangle over all triangles within this angle of its normal, in
    /// degrees, 0 to 180.
    Normals(f32),
    /// Separates sets at edges where the surface bends by more than this angle, in degrees, 0 to
    /// 180.
    Crease(f32),
    /// Separates parts whose walls differ, in at most this many levels of thickness, 1 to 16;
    /// `None`: as few as the walls need. The thickness is the mean of a cone of rays.
    Walls(Option<usize>),
}

/// No triangle, no part.
const NONE: u32 = u32::MAX;

/// The edit that gives what is not hidden new sets, numbered by the first vertex of each in the
/// order of the mesh. A vertex is in the set of the largest part of its surroundings. Sets of what
/// is hidden stay, and their numbers are not given again.
///
/// # Errors
/// [`SetsError::Full`] where there are more parts than numbers, [`SetsError::Cancelled`], and
/// [`SetsError::Levels`] for a number of levels out of its range.
pub fn partition(clay: &Snapshot, by: Partition, job: &Job) -> Result<SetsEdit, SetsError> {
    let tri = clay.to_tri();
    let ranks = clay.ranks();
    let mut hidden = vec![false; tri.positions.len()];
    let mut first = 0;
    for page in clay.pages() {
        let Some(sets) = page.sets() else { continue };
        for (&id, row) in page.topology().ids.iter().zip(sets.rows()) {
            if row & HIDDEN != 0 {
                hidden[ranks.of(id)] = true;
                first = first.max(row & !HIDDEN);
            }
        }
    }
    let shown: Vec<[u32; 3]> =
        tri.triangles.iter().copied().filter(|t| !t.iter().all(|&v| hidden[v as usize])).collect();
    // For each triangle its part.
    let normals: Vec<Vec3> = shown
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| tri.positions[v as usize]);
            (b - a).cross(c - a)
        })
        .collect();
    let cosine = |degrees: f32| degrees.clamp(0.0, 180.0).to_radians().portable_cos();
    let turned = |a: u32, b: u32, least: f32| {
        let [a, b] = [a, b].map(|t| normals[t as usize].normalize_or_zero());
        // A triangle without a normal parts nothing.
        a != Vec3::ZERO && b != Vec3::ZERO && a.dot(b) < least
    };
    let parts: Vec<u32> = match by {
        Partition::Loose => {
            let mut joined = DisjointSets::new(tri.positions.len());
            for &[a, b, c] in &shown {
                joined.join(a, b);
                joined.join(b, c);
            }
            shown.iter().map(|t| joined.root(t[0])).collect()
        }
        Partition::Crease(degrees) => {
            let least = cosine(degrees);
            let mut joined = DisjointSets::new(shown.len());
            each_pair(&shown, |a, b| {
                if !turned(a, b, least) {
                    joined.join(a, b);
                }
            });
            (0..shown.len() as u32).map(|t| joined.root(t)).collect()
        }
        Partition::Walls(levels) => {
            let is_shown = |t: &&[u32; 3]| !t.iter().all(|&v| hidden[v as usize]);
            let of = parts_of_equal_wall(&tri, levels, job)?;
            let all = tri.triangles.iter().zip(of);
            all.filter(|(t, _)| is_shown(t)).map(|(_, part)| part).collect()
        }
        Partition::Normals(degrees) => grown(&shown, |seed, t| !turned(seed, t, cosine(degrees))),
    };
    // A vertex goes to the part with the largest area about it; of equal ones to the first.
    let mut about: Vec<(u32, u32, f32)> = Vec::with_capacity(3 * shown.len());
    for ((t, part), n) in shown.iter().zip(&parts).zip(&normals) {
        about.extend(t.iter().map(|&v| (v, *part, n.length())));
    }
    about.sort_by_key(|a| (a.0, a.1));
    let mut of = vec![NONE; tri.positions.len()];
    for vertex in about.chunk_by(|a, b| a.0 == b.0) {
        let mut best = f32::NEG_INFINITY;
        for part in vertex.chunk_by(|a, b| a.1 == b.1) {
            let area: f32 = part.iter().map(|p| p.2).sum();
            if area > best {
                (best, of[part[0].0 as usize]) = (area, part[0].1);
            }
        }
    }
    // Parts in the order of their first vertices.
    let mut number = vec![0u16; tri.positions.len().max(shown.len())];
    let mut sets = vec![0u16; tri.positions.len()];
    for (v, part) in of.iter().enumerate().filter(|(v, p)| **p != NONE && !hidden[*v]) {
        let number = &mut number[*part as usize];
        if *number == 0 {
            if first == MOST_SETS {
                return Err(SetsError::Full);
            }
            first += 1;
            *number = first;
        }
        sets[v] = *number;
    }
    let pages = clay.pages().enumerate().filter(|(_, page)| page.own() > 0).map(|(p, page)| {
        (p as u32, page.topology().ids.iter().map(|&id| sets[ranks.of(id)]).collect())
    });
    Ok(SetsEdit::Assign { revision: clay.revision(), pages: Arc::new(pages.collect()) })
}

/// For each triangle its part of equal wall; one more part for those without a value.
fn parts_of_equal_wall(
    tri: &TriMesh,
    levels: Option<usize>,
    job: &Job,
) -> Result<Vec<u32>, SetsError> {
    let settings = ThicknessSettings {
        method: ThicknessMethod::Cone,
        at: MeasuredPlaces::VerticesAndFaces,
        ..ThicknessSettings::default()
    };
    let refused = |e| match e {
        ThicknessError::Cancelled(_) => SetsError::Cancelled,
        ThicknessError::Setting { .. } => SetsError::Levels,
    };
    let measured = measure(tri, &settings, job).map_err(refused)?;
    let how = PartitionSettings { levels, ..PartitionSettings::default() };
    let found = measured.partition(how, job).map_err(refused)?;
    let rest = found.parts.len() as u32;
    Ok(found.of.into_iter().map(|part| part.min(rest)).collect())
}

/// Directed edges of triangles as (lesser end, greater end, triangle), ascending.
fn edges(triangles: &[[u32; 3]]) -> Vec<(u32, u32, u32)> {
    let mut all = Vec::with_capacity(3 * triangles.len());
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        all.extend([(a, b), (b, c), (c, a)].map(|(x, y)| (x.min(y), x.max(y), t as u32)));
    }
    all.sort_unstable();
    all
}

/// Calls `visit` with triangles that share an edge, each with the next at that edge.
fn each_pair(triangles: &[[u32; 3]], mut visit: impl FnMut(u32, u32)) {
    let edges = edges(triangles);
    let pairs = edges.windows(2).filter(|two| (two[0].0, two[0].1) == (two[1].0, two[1].1));
    pairs.for_each(|two| visit(two[0].2, two[1].2));
}

/// Parts that grow from their first triangle over neighbours that `joins` takes; each is named by
/// that triangle.
fn grown(triangles: &[[u32; 3]], joins: impl Fn(u32, u32) -> bool) -> Vec<u32> {
    let mut neighbours: Vec<(u32, u32)> = Vec::with_capacity(3 * triangles.len());
    each_pair(triangles, |a, b| neighbours.extend([(a, b), (b, a)]));
    neighbours.sort_unstable();
    let mut part = vec![NONE; triangles.len()];
    let mut open = Vec::new();
    for seed in 0..triangles.len() as u32 {
        if part[seed as usize] != NONE {
            continue;
        }
        part[seed as usize] = seed;
        open.push(seed);
        while let Some(t) = open.pop() {
            let from = neighbours.partition_point(|n| n.0 < t);
            for &(_, other) in neighbours[from..].iter().take_while(|n| n.0 == t) {
                if part[other as usize] == NONE && joins(seed, other) {
                    part[other as usize] = seed;
                    open.push(other);
                }
            }
        }
    }
    part
}

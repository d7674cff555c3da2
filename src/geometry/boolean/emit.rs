//! A result as a mesh: chosen pieces, turned where the operation asks, and vertices doubled where
//! the solid touches itself, so that what comes out is an oriented 2-manifold.

use glam::DVec3;
use rayon::prelude::*;

use super::common::FEW;
use super::points::Map;
use crate::PolyMesh;
use crate::disjoint_sets::DisjointSets;
use crate::fans;
use crate::job::{Cancelled, Job};
use crate::portable::PortableMath;
use crate::triangulate::area_vector;

/// The operand and the face from which a face of the result comes, whole or in part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaceOrigin {
    /// 0 for A, 1 for B.
    pub operand: u8,
    /// The operand's face.
    pub face: u32,
}

/// Facts of a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BooleanFacts {
    /// In cubic units; 0 of an empty result.
    pub volume: f64,
    /// In square units.
    pub area: f64,
    /// Connected shells.
    pub components: usize,
    /// Every edge has as many faces on one side as on the other.
    pub closed: bool,
    /// Every edge has two faces, every vertex one fan.
    pub manifold: bool,
}

/// Turns the chosen faces, whose corners index `at`, into a separate mesh, and returns its facts.
pub fn finish(mesh: &mut PolyMesh, at: &[DVec3], job: &Job) -> Result<BooleanFacts, Cancelled> {
    let closed = match fans::degrees(mesh, at.len(), job)? {
        Some(degrees) => {
            job.check()?;
            compact(mesh, at, &degrees);
            true
        }
        None => separate(mesh, at, job)?,
    };
    job.check()?;
    let mut facts = facts(mesh, job)?;
    (facts.closed, facts.manifold) = (closed, closed);
    Ok(facts)
}

/// Removes faces that coincide with their fronts outwards: two faces with the same corners in
/// opposite order have nothing between them. Such sheets arise where surfaces meet within the
/// tolerance along the border of a face. Considers only faces whose corners are all marked. Returns
/// the number of faces removed.
pub fn drop_folded_faces(
    mesh: &mut PolyMesh,
    origins: &mut Vec<FaceOrigin>,
    marked: &[bool],
) -> usize {
    let mut rings: Vec<(Vec<u32>, bool, u32)> = Vec::new();
    for (f, corners) in mesh.faces().enumerate() {
        if corners.len() < 3 || !corners.iter().all(|&v| marked[v as usize]) {
            continue;
        }
        let mut ring = corners.to_vec();
        let first = (0..ring.len()).min_by_key(|&i| ring[i]).unwrap_or(0);
        ring.rotate_left(first);
        let turned = ring[1] > ring[ring.len() - 1];
        if turned {
            ring[1..].reverse();
        }
        rings.push((ring, turned, f as u32));
    }
    rings.sort_unstable();
    let mut gone = vec![false; mesh.face_count()];
    let mut count = 0;
    for same in rings.chunk_by(|a, b| a.0 == b.0) {
        let back = same.partition_point(|r| !r.1);
        let pairs = back.min(same.len() - back);
        let folded = same[..pairs].iter().chain(&same[back..back + pairs]);
        folded.for_each(|r| gone[r.2 as usize] = true);
        count += 2 * pairs;
    }
    if count > 0 {
        let old = std::mem::replace(mesh, PolyMesh::new());
        let mut kept = Vec::with_capacity(origins.len() - count);
        for (f, corners) in old.faces().enumerate().filter(|(f, _)| !gone[*f]) {
            mesh.push_face(corners);
            kept.push(origins[f]);
        }
        *origins = kept;
    }
    count
}

/// Takes out shells whose volume is less than that of a sheet of their area and this thickness:
/// what faces in contact leave between them. Returns how many went.
pub fn drop_thin_shells(
    mesh: &mut PolyMesh,
    origins: &mut Vec<FaceOrigin>,
    thickness: f64,
) -> usize {
    let mut shells = DisjointSets::new(mesh.positions.len());
    for f in mesh.faces() {
        f.windows(2).for_each(|w| shells.join(w[0], w[1]));
    }
    let (triangles, _) = mesh.triangles();
    let mut sums = vec![(0.0f64, 0.0f64); mesh.positions.len()];
    for t in &triangles {
        let root = shells.root(t[0]);
        let origin = mesh.positions[root as usize];
        let [a, b, c] = t.map(|v| mesh.positions[v as usize] - origin);
        let n = (b - a).cross(c - a);
        let sum = &mut sums[root as usize];
        *sum = (sum.0 + a.dot(n) / 6.0, sum.1 + n.length() / 2.0);
    }
    let thin = |&(volume, area): &(f64, f64)| area > 0.0 && volume.abs() <= 0.5 * area * thickness;
    let gone = sums.iter().filter(|s| thin(s)).count();
    if gone == 0 {
        return 0;
    }
    let old = std::mem::replace(mesh, PolyMesh::new());
    let mut degrees = vec![0u32; old.positions.len()];
    let mut kept = Vec::with_capacity(origins.len());
    for (f, corners) in old.faces().enumerate() {
        if !thin(&sums[shells.root(corners[0]) as usize]) {
            corners.iter().for_each(|&v| degrees[v as usize] += 1);
            mesh.push_face(corners);
            kept.push(origins[f]);
        }
    }
    *origins = kept;
    compact(mesh, &old.positions, &degrees);
    gone
}

/// Volume, area and shells of a closed manifold.
pub fn facts(mesh: &PolyMesh, job: &Job) -> Result<BooleanFacts, Cancelled> {
    let count = || {
        let mut shells = DisjointSets::new(mesh.positions.len());
        for (i, f) in mesh.faces().enumerate() {
            // The counts of a cancelled job are discarded.
            if i % 65_536 == 0 && job.cancelled() {
                return 0;
            }
            f.windows(2).for_each(|w| shells.join(w[0], w[1]));
        }
        (0..mesh.positions.len() as u32).filter(|&v| shells.root(v) == v).count()
    };
    let (components, (volume, area)) = rayon::join(count, || measure(mesh));
    job.check()?;
    Ok(BooleanFacts { volume, area, components, closed: true, manifold: true })
}

/// Drops the points without a corner.
fn compact(mesh: &mut PolyMesh, at: &[DVec3], degrees: &[u32]) {
    let mut next = 0;
    let names: Vec<u32> = degrees
        .iter()
        .map(|&d| {
            let own = next;
            next += u32::from(d > 0);
            own
        })
        .collect();
    mesh.positions = at.iter().zip(degrees).filter(|(_, d)| **d > 0).map(|(p, _)| *p).collect();
    mesh.corners.par_iter_mut().for_each(|c| *c = names[*c as usize]);
}

/// Drops unused points, doubles vertices where the surface touches itself, and where that leaves
/// one edge between two pairs of faces, gives one pair a corner in the middle. Corners of `mesh`
/// index `at`. Returns whether each edge found its partner: then the mesh is closed, oriented and
/// manifold.
pub fn separate(mesh: &mut PolyMesh, at: &[DVec3], job: &Job) -> Result<bool, Cancelled> {
    Ok(separate_patch(mesh, at, |_| false, job)?.open.is_empty())
}

/// What [`separate_patch`] found and did.
pub struct Separation {
    /// Edges without a partner in the direction of their faces, over the points before; an edge
    /// that can have none, as (`NOWHERE`, `NOWHERE`).
    pub open: Vec<(u32, u32)>,
    /// The point that each vertex was; `NOWHERE` for a corner in the middle of an edge.
    pub from: Vec<u32>,
}

/// No point.
pub const NOWHERE: u32 = u32::MAX;

/// As [`separate`], for a patch of a larger surface. Points that are `fixed` have faces outside of
/// the patch: they stay one vertex, and edges between two of them need no partner.
pub fn separate_patch(
    mesh: &mut PolyMesh,
    at: &[DVec3],
    fixed: impl Fn(u32) -> bool,
    job: &Job,
) -> Result<Separation, Cancelled> {
    let n = mesh.corners.len();
    let mut face_of = vec![0u32; n];
    let mut next = vec![0u32; n];
    for f in 0..mesh.face_count() {
        let (s, e) = (mesh.face_starts[f], mesh.face_starts[f + 1]);
        for c in s..e {
            face_of[c as usize] = f as u32;
            next[c as usize] = if c + 1 == e { s } else { c + 1 };
        }
    }
    let mut half: Vec<(u64, u32)> = (0..n as u32)
        .into_par_iter()
        .with_min_len(FEW)
        .map(|c| {
            let (a, b) = (mesh.corners[c as usize], mesh.corners[next[c as usize] as usize]);
            ((a.min(b) as u64) << 32 | a.max(b) as u64, c)
        })
        .collect();
    // In parts, to be ended between them; then the runs are one.
    for part in half.chunks_mut(1 << 18) {
        part.par_sort_unstable();
        job.check()?;
    }
    half.sort();
    job.check()?;
    let mut open: Vec<(u32, u32)> = Vec::new();
    let mut several: Vec<(u32, u32)> = Vec::new();
    let mut sets = DisjointSets::new(n);
    let mut i = 0;
    while i < n {
        let mut j = i + 1;
        while j < n && half[j].0 == half[i].0 {
            j += 1;
        }
        let group = &half[i..j];
        let forward = |c: u32| mesh.corners[c as usize] as u64 == group[0].0 >> 32;
        let mut pair = |g: u32, h: u32| {
            sets.join(g, next[h as usize]);
            sets.join(next[g as usize], h);
        };
        if group.len() == 2 && forward(group[0].1) != forward(group[1].1) {
            pair(group[0].1, group[1].1);
        } else if group.iter().filter(|h| forward(h.1)).count() * 2 != group.len() {
            let c = group[0].1;
            let ends = (mesh.corners[c as usize], mesh.corners[next[c as usize] as usize]);
            let border = group.len() == 1 && fixed(ends.0) && fixed(ends.1);
            open.push(if border { ends } else { (NOWHERE, NOWHERE) });
        } else {
            for (g, h) in around(mesh, at, group, &face_of) {
                pair(g, h);
                several.push((g, h));
            }
        }
        i = j;
    }
    job.check()?;
    let mut stay: Map<u32, u32> = Map::default();
    for c in (0..n as u32).filter(|&c| fixed(mesh.corners[c as usize])) {
        sets.join(c, *stay.entry(mesh.corners[c as usize]).or_insert(c));
    }
    // One vertex a fan, numbered by first use.
    let mut id = vec![u32::MAX; n];
    let mut corners = vec![0u32; n];
    let mut from: Vec<u32> = Vec::new();
    mesh.positions.clear();
    for c in 0..n as u32 {
        let r = sets.root(c) as usize;
        if id[r] == u32::MAX {
            id[r] = mesh.positions.len() as u32;
            mesh.positions.push(at[mesh.corners[c as usize] as usize]);
            from.push(mesh.corners[c as usize]);
        }
        corners[c as usize] = id[r];
    }
    mesh.corners = corners;
    // Pairs at one edge that found the same ends by other ways.
    several.sort_unstable_by_key(|&(g, _)| {
        let (a, b) = (mesh.corners[g as usize], mesh.corners[next[g as usize] as usize]);
        (a.min(b), a.max(b), g)
    });
    let mut middles: Vec<(u32, u32)> = Vec::new();
    let ends = |g: u32| {
        let (a, b) = (mesh.corners[g as usize], mesh.corners[next[g as usize] as usize]);
        (a.min(b), a.max(b))
    };
    for w in several.windows(2) {
        if ends(w[0].0) == ends(w[1].0) {
            let (a, b) = ends(w[1].0);
            let v = mesh.positions.len() as u32;
            let middle = (mesh.positions[a as usize] + mesh.positions[b as usize]) * 0.5;
            mesh.positions.push(middle);
            from.push(NOWHERE);
            middles.extend([(w[1].0, v), (w[1].1, v)]);
        }
    }
    if !middles.is_empty() {
        middles.sort_unstable();
        let old = std::mem::replace(mesh, PolyMesh::new());
        mesh.positions.clone_from(&old.positions);
        let (mut face, mut m) = (Vec::new(), 0);
        for f in 0..old.face_count() {
            face.clear();
            for c in old.face_starts[f]..old.face_starts[f + 1] {
                face.push(old.corners[c as usize]);
                if middles.get(m).is_some_and(|x| x.0 == c) {
                    face.push(middles[m].1);
                    m += 1;
                }
            }
            mesh.push_face(&face);
        }
    }
    Ok(Separation { open, from })
}

/// Partners around an edge with more than two faces: those with the solid between them, as
/// Requicha's regularised boundary has it, so that what only touches comes apart.
fn around(mesh: &PolyMesh, at: &[DVec3], group: &[(u64, u32)], face_of: &[u32]) -> Vec<(u32, u32)> {
    let (a, b) = ((group[0].0 >> 32) as usize, (group[0].0 & 0xffff_ffff) as usize);
    let d = (at[b] - at[a]).normalize_or(DVec3::Z);
    let (x, y) = d.any_orthonormal_pair();
    let mut all: Vec<(f64, bool, u32)> = group
        .iter()
        .map(|&(_, c)| {
            let forward = mesh.corners[c as usize] as usize == a;
            let n = area_vector(at, mesh.face(face_of[c as usize] as usize)).normalize_or_zero();
            let w = n.cross(if forward { d } else { -d });
            let (s, t) = (w.dot(x), w.dot(y));
            // Directions that differ by rounding only are one direction; the solid starts after it.
            let angle = (t.portable_atan2(s) * 1e9).round();
            (
                if angle <= -(std::f64::consts::PI * 1e9).round() { -angle } else { angle },
                forward,
                c,
            )
        })
        .collect();
    all.sort_by(|p, q| p.0.total_cmp(&q.0).then(q.1.cmp(&p.1)).then(p.2.cmp(&q.2)));
    // Like brackets: a face after which the solid starts, the next free one before which it ends.
    let (mut open, mut out, mut done) = (Vec::new(), Vec::new(), vec![false; all.len()]);
    for turn in 0..2 * all.len() {
        let i = turn % all.len();
        if done[i] {
            continue;
        }
        if !all[i].1 {
            if turn < all.len() {
                open.push(i);
            }
        } else if let Some(o) = open.pop() {
            out.push((all[i].2, all[o].2));
            done[i] = true;
            done[o] = true;
        }
    }
    out
}

/// Volume and area, about the box's centre; faces in the triangles that [`PolyMesh::triangles`]
/// gives.
pub fn measure(mesh: &PolyMesh) -> (f64, f64) {
    let (lo, hi) = mesh
        .positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    if mesh.positions.is_empty() {
        return (0.0, 0.0);
    }
    let centre = (lo + hi) * 0.5;
    let part = |t: &[u32]| {
        t.chunks_exact(3).fold((0.0, 0.0), |(v, s), t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize] - centre);
            let n = (b - a).cross(c - a);
            (v + a.dot(n), s + n.length())
        })
    };
    // Sums of fixed blocks, in order: the same bits with any number of workers.
    let blocks = |c: &[u32]| c.par_chunks(3 * 4096).map(part).collect();
    let plain = mesh.corners.len() == 3 * mesh.face_count() && mesh.faces().all(|f| f.len() == 3);
    let sums: Vec<(f64, f64)> =
        if plain { blocks(&mesh.corners) } else { blocks(mesh.triangles().0.as_flattened()) };
    let (v, s) = sums.iter().fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    (v / 6.0, s / 2.0)
}

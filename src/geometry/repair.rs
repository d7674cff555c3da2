//! Repair: one vertex for one place, no faces without extent, all faces outwards, no holes. Each
//! function works in place and returns how much it changed; none moves a vertex.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec3;

use super::PolyMesh;
use super::boolean::box_tree::Span;
use super::boolean::classify::crossings;
use super::disjoint_sets::DisjointSets;
use super::edges::EdgeTable;
use super::face_attributes::NO_UV;
use super::job::Job;
use super::{self_intersection, triangulate};

/// Turns every face over.
pub fn flip(mesh: &mut PolyMesh) {
    for f in 0..mesh.face_count() {
        mesh.turn_face(f);
    }
}

/// Keeps the faces that `make` gives, with their groups; the corners it pushes are the face's new
/// ones.
fn rebuild(mesh: &mut PolyMesh, mut make: impl FnMut(&[u32], &mut Vec<u32>)) -> usize {
    let (mut starts, mut corners) = (vec![0u32], Vec::with_capacity(mesh.corners.len()));
    let mut groups = mesh.groups.as_ref().map(|_| Vec::new());
    let (before, mut face) = (mesh.face_count(), Vec::new());
    for f in 0..before {
        face.clear();
        make(mesh.face(f), &mut face);
        if face.is_empty() {
            continue;
        }
        corners.extend_from_slice(&face);
        starts.push(corners.len() as u32);
        if let (Some(new), Some(old)) = (&mut groups, &mesh.groups) {
            new.push(old[f]);
        }
    }
    mesh.face_starts = starts;
    if corners.len() != mesh.corners.len() {
        mesh.drop_uvs();
    }
    mesh.corners = corners;
    mesh.groups = groups;
    before - mesh.face_count()
}

/// The face without repeated neighbours; nothing if fewer than three corners are left.
fn without_repeats(face: &[u32], out: &mut Vec<u32>) {
    for &c in face {
        if out.last() != Some(&c) {
            out.push(c);
        }
    }
    while out.len() > 1 && out.first() == out.last() {
        out.pop();
    }
    if out.len() < 3 {
        out.clear();
    }
}

/// Makes one vertex of all that are within `distance` of each other (also by way of others); the
/// first of them stays. Vertices that no face uses any more are removed, and faces that lost their
/// extent too. Returns how many vertices went into others.
pub fn weld(mesh: &mut PolyMesh, distance: f64) -> usize {
    let n = mesh.positions.len();
    let p = |i: u32| mesh.positions[i as usize];
    let mut sets = DisjointSets::new(n);
    if distance > 0.0 {
        // Cells of the distance's size: neighbours within it are in the same or an adjacent cell.
        let cell = |q: DVec3| (q / distance).floor();
        let key = |c: DVec3| c.to_array().map(|v| (v + 0.0).to_bits());
        let mut cells: Vec<([u64; 3], u32)> = (0..n as u32).map(|i| (key(cell(p(i))), i)).collect();
        cells.sort_unstable();
        for i in 0..n as u32 {
            let home = cell(p(i));
            for d in 0..27 {
                let step = DVec3::new(
                    (d % 3) as f64 - 1.0,
                    (d / 3 % 3) as f64 - 1.0,
                    (d / 9) as f64 - 1.0,
                );
                let k = key(home + step);
                let first = cells.partition_point(|c| c.0 < k);
                for &(_, j) in cells[first..].iter().take_while(|c| c.0 == k) {
                    if j > i && p(i).distance_squared(p(j)) <= distance * distance {
                        sets.join(i, j);
                    }
                }
            }
        }
    } else {
        let key = |i: u32| (p(i) + 0.0).to_array().map(f64::to_bits);
        let mut order: Vec<u32> = (0..n as u32).collect();
        order.sort_unstable_by_key(|&i| (key(i), i));
        for w in order.windows(2) {
            if key(w[0]) == key(w[1]) {
                sets.join(w[0], w[1]);
            }
        }
    }
    let merged = n - sets.count();
    if merged > 0 {
        let home: Vec<u32> = (0..n as u32).map(|i| sets.root(i)).collect();
        rebuild(mesh, |face, out| {
            let moved: Vec<u32> = face.iter().map(|&c| home[c as usize]).collect();
            without_repeats(&moved, out);
        });
        drop_unused(mesh);
    }
    merged
}

/// Removes vertices that no face uses; the others keep their order. Returns the number removed.
pub fn drop_unused(mesh: &mut PolyMesh) -> usize {
    let mut new = vec![u32::MAX; mesh.positions.len()];
    for &c in &mesh.corners {
        new[c as usize] = 0;
    }
    for (count, n) in new.iter_mut().filter(|n| **n == 0).enumerate() {
        *n = count as u32;
    }
    let mut used = new.iter().map(|&n| n != u32::MAX);
    let mut keep = || used.next().unwrap_or(false);
    let before = mesh.positions.len();
    mesh.positions.retain(|_| keep());
    if let Some(colours) = &mut mesh.colours {
        let mut used = new.iter().map(|&n| n != u32::MAX);
        colours.retain(|_| used.next().unwrap_or(false));
    }
    for c in &mut mesh.corners {
        *c = new[*c as usize];
    }
    before - mesh.positions.len()
}

/// Removes corners that repeat their neighbour, then faces of fewer than three corners, and pairs
/// of faces that are each other turned over (a sheet folded onto itself). Faces without area but
/// with three different corners stay: taking one out would open the surface. Returns how many faces
/// went.
pub fn remove_degenerate(mesh: &mut PolyMesh) -> usize {
    let gone = rebuild(mesh, without_repeats);
    // A face and its reverse have the same sorted corners.
    let mut keys: Vec<(Vec<u32>, u32)> = mesh
        .faces()
        .enumerate()
        .map(|(f, c)| {
            let mut k = c.to_vec();
            k.sort_unstable();
            (k, f as u32)
        })
        .collect();
    keys.sort_unstable();
    let mut drop = vec![false; mesh.face_count()];
    for pair in keys.windows(2) {
        let (f, g) = (pair[0].1, pair[1].1);
        if pair[0].0 == pair[1].0
            && !drop[f as usize]
            && reversed(mesh.face(f as usize), mesh.face(g as usize))
        {
            drop[f as usize] = true;
            drop[g as usize] = true;
        }
    }
    let mut f = 0;
    gone + rebuild(mesh, |face, out| {
        if !drop[f] {
            out.extend_from_slice(face);
        }
        f += 1;
    })
}

fn reversed(a: &[u32], b: &[u32]) -> bool {
    let n = a.len();
    let Some(start) = b.iter().position(|&v| v == a[0]) else { return false };
    n == b.len() && (0..n).all(|i| a[i] == b[(start + n - i) % n])
}

/// What [`orient_shells`] did and what it could not know.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct OrientedShells {
    /// Faces that were turned.
    pub turned: usize,
    /// Pairs of closed shells that cross each other.
    pub crossing: usize,
    /// Closed shells that lie within another and face the same way as it does: their inside is
    /// counted twice.
    pub nested: usize,
    /// Shells whose direction the mesh itself does not tell: neighbouring faces disagreed, or an
    /// outermost shell faced inwards.
    pub guessed: usize,
}

/// As [`orient_shells`]; returns the number of faces turned.
pub fn orient(mesh: &mut PolyMesh) -> usize {
    orient_shells(mesh).turned
}

/// Makes neighbours agree across every edge of two faces (the first face of a shell leads), then
/// decides for each closed shell which way it faces. If the mesh is consistent already (no
/// neighbours disagree, every outermost shell faces outwards), its directions are kept: a shell
/// that faces inwards is a cavity. Otherwise shells in no other face outwards, and shells that
/// others enclose an odd number of times face inwards; a shell that crosses another is not within
/// it. A one-sided surface keeps a seam, which [`super::check::report`] still reports.
pub fn orient_shells(mesh: &mut PolyMesh) -> OrientedShells {
    let edges = EdgeTable::of(mesh);
    let faces = mesh.face_count();
    // Neighbours across edges of exactly two faces, and whether they run along it in the same
    // direction (so disagree).
    let mut links: Vec<(u32, u32, bool)> = Vec::new();
    let mut open = Vec::new();
    for half_edges in edges.each() {
        let face = |i: usize| edges.face_of[half_edges[i].corner as usize];
        if let [a, b] = half_edges {
            let same = mesh.corners[a.corner as usize] == mesh.corners[b.corner as usize];
            links.push((face(0), face(1), same));
            links.push((face(1), face(0), same));
        } else {
            open.extend((0..half_edges.len()).map(face));
        }
    }
    links.sort_unstable();
    let mut shell = vec![u32::MAX; faces];
    let mut turned = vec![false; faces];
    let mut shells = 0u32;
    for start in 0..faces {
        if shell[start] != u32::MAX {
            continue;
        }
        shell[start] = shells;
        let mut todo = vec![start as u32];
        while let Some(f) = todo.pop() {
            let first = links.partition_point(|l| l.0 < f);
            for &(_, g, same) in links[first..].iter().take_while(|l| l.0 == f) {
                if shell[g as usize] == u32::MAX {
                    shell[g as usize] = shells;
                    turned[g as usize] = turned[f as usize] ^ same;
                    todo.push(g);
                }
            }
        }
        shells += 1;
    }
    let mut out = turn_out(mesh, &shell, shells as usize, &open, &mut turned);
    for (f, _) in turned.iter().enumerate().filter(|(_, t)| **t) {
        mesh.turn_face(f);
        out.turned += 1;
    }
    out
}

/// Decides for each closed shell whether it must be turned as a whole.
fn turn_out(
    mesh: &PolyMesh,
    shell: &[u32],
    shells: usize,
    open: &[u32],
    turned: &mut [bool],
) -> OrientedShells {
    let mut closed = vec![true; shells];
    for &f in open {
        closed[shell[f as usize] as usize] = false;
    }
    let mut known = vec![true; shells];
    turned.iter().zip(shell).filter(|(t, _)| **t).for_each(|(_, &s)| known[s as usize] = false);
    let (mut triangles, of) = mesh.triangles();
    let mut volume = vec![0.0; shells];
    let mut bounds = vec![Span::EMPTY; shells];
    let mut sample = vec![DVec3::ZERO; shells];
    let mut lists: Vec<Vec<[DVec3; 3]>> = vec![Vec::new(); shells];
    let origin = mesh.positions.first().copied().unwrap_or_default();
    for (t, &f) in triangles.iter_mut().zip(&of) {
        if turned[f as usize] {
            t.swap(1, 2);
        }
        let s = shell[f as usize] as usize;
        let corners = t.map(|v| mesh.positions[v as usize]);
        let [a, b, c] = corners;
        volume[s] += (a - origin).dot((b - origin).cross(c - origin));
        bounds[s] = bounds[s].join(Span::of(corners));
        sample[s] = a;
        lists[s].push(corners);
    }
    let beside: Vec<(usize, usize)> = (0..shells)
        .flat_map(|a| (0..shells).map(move |b| (a, b)))
        .filter(|&(a, b)| a != b && closed[a] && closed[b] && bounds[a].meets(&bounds[b]))
        .collect();
    let crossing = crossing_shells(mesh, &triangles, |t| shell[of[t] as usize], &beside);
    let around = |s: usize| -> Vec<usize> {
        let others = beside.iter().filter(|p| p.0 == s).map(|p| p.1);
        let around = others.filter(|&o| {
            let (q, reach) = (sample[s], (bounds[o].hi - bounds[o].lo).length() * 2.0);
            q.cmpgt(bounds[o].lo).all()
                && q.cmplt(bounds[o].hi).all()
                && !crossing.contains(&(s.min(o), s.max(o)))
                && crossings(q, reach, |p, visit| {
                    let inverse = 1.0 / (p - q);
                    for t in &lists[o] {
                        let lo = (t[0].min(t[1]).min(t[2]) - q) * inverse;
                        let hi = (t[0].max(t[1]).max(t[2]) - q) * inverse;
                        let (near, far) = (lo.min(hi).max_element(), lo.max(hi).min_element());
                        if near.max(0.0) <= far.min(1.0) + 1e-9 && !visit(*t) {
                            return;
                        }
                    }
                }) != 0
        });
        around.collect()
    };
    let holders: Vec<Vec<usize>> =
        (0..shells).map(|s| if closed[s] { around(s) } else { Vec::new() }).collect();
    let mut out = OrientedShells { crossing: crossing.len(), ..Default::default() };
    let outermost = |s: usize| closed[s] && holders[s].is_empty();
    let wrong =
        (0..shells).filter(|&s| closed[s] && (!known[s] || (outermost(s) && volume[s] < 0.0)));
    out.guessed = wrong.count();
    if out.guessed == 0 {
        let same = |&s: &usize| {
            let count = |o: &usize| if volume[*o] < 0.0 { -1 } else { 1 };
            volume[s] > 0.0 && holders[s].iter().map(count).sum::<i32>() > 0
        };
        out.nested = (0..shells).filter(same).count();
        return out;
    }
    let turn: Vec<bool> = (0..shells)
        .map(|s| closed[s] && (volume[s] < 0.0) != (holders[s].len() % 2 == 1))
        .collect();
    for (t, &s) in turned.iter_mut().zip(shell) {
        *t ^= turn[s as usize];
    }
    out
}

/// Pairs of shells, the lower first, of which triangles cross; only shells that are in `beside`.
fn crossing_shells(
    mesh: &PolyMesh,
    triangles: &[[u32; 3]],
    of: impl Fn(usize) -> u32,
    beside: &[(usize, usize)],
) -> BTreeSet<(usize, usize)> {
    let asked: BTreeSet<usize> = beside.iter().map(|p| p.0).collect();
    let list: Vec<usize> =
        (0..triangles.len()).filter(|&t| asked.contains(&(of(t) as usize))).collect();
    let some: Vec<[u32; 3]> = list.iter().map(|&t| triangles[t]).collect();
    let found = self_intersection::pairs(&mesh.positions, &some, &Job::default());
    let shell = |t: u32| of(list[t as usize]) as usize;
    let pairs = found.unwrap_or_default().into_iter().map(|(s, t)| (shell(s), shell(t)));
    pairs.filter(|(s, t)| s != t).map(|(s, t)| (s.min(t), s.max(t))).collect()
}

/// What [`fill_holes`] did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Filled {
    /// Loops of open edges that were closed.
    pub holes: usize,
    /// Triangles that were added.
    pub faces: usize,
    /// Open edges that belong to no simple loop, or to one longer than asked for.
    pub left: usize,
}

/// Longest loop that is closed with the least area; longer ones are cut by ears.
const LEAST_AREA: usize = 160;

/// Closes every loop of open edges of at most `longest` edges with triangles: of least total area
/// (Barequet and Sharir 1995) for loops up to 160 edges, by ears in the loop's mean plane beyond.
pub fn fill_holes(mesh: &mut PolyMesh, longest: usize) -> Filled {
    let edges = EdgeTable::of(mesh);
    // Of each open edge: from, to, as the hole's face will run along it.
    let mut open: Vec<(u32, u32)> = edges
        .each()
        .filter(|s| s.len() == 1)
        .map(|s| {
            let c = s[0].corner;
            (mesh.corners[edges.next(mesh, c) as usize], mesh.corners[c as usize])
        })
        .collect();
    open.sort_unstable();
    let mut used = vec![false; open.len()];
    let mut filled = Filled::default();
    let mut group = mesh.groups.as_ref().map(|g| g.iter().max().map_or(0, |m| m + 1));
    for start in 0..open.len() {
        if used[start] {
            continue;
        }
        let mut chain = vec![start];
        let mut ring = vec![open[start].0];
        let mut at = open[start].1;
        let simple = loop {
            if at == ring[0] {
                break true;
            }
            let first = open.partition_point(|e| e.0 < at);
            let ways = open[first..].iter().take_while(|e| e.0 == at).count();
            // At a vertex where borders meet, the loop is not one loop.
            if ways != 1 || used[first] || ring.len() > open.len() {
                break false;
            }
            ring.push(at);
            chain.push(first);
            at = open[first].1;
        };
        for &e in &chain {
            used[e] = true;
        }
        if !simple || ring.len() < 3 || ring.len() > longest {
            filled.left += chain.len();
            continue;
        }
        let mut triangles = Vec::new();
        if ring.len() <= LEAST_AREA {
            least_area(&mesh.positions, &ring, &mut triangles);
        } else {
            triangulate::face(&mesh.positions, &ring, &mut triangles);
        }
        filled.holes += 1;
        filled.faces += triangles.len();
        for t in &triangles {
            mesh.push_face(t);
        }
        if let (Some(groups), Some(id)) = (&mut mesh.groups, &mut group) {
            groups.resize(groups.len() + triangles.len(), *id);
            *id += 1;
        }
    }
    if filled.faces > 0
        && let Some(own) = mesh.attributes.as_mut().filter(|a| !a.uv_corners.is_empty())
    {
        Arc::make_mut(own).uv_corners.resize(mesh.corners.len(), NO_UV);
    }
    filled
}

fn least_area(positions: &[DVec3], ring: &[u32], out: &mut Vec<[u32; 3]>) {
    let n = ring.len();
    let p = |i: usize| positions[ring[i] as usize];
    let mut best = vec![0.0f64; n * n];
    let mut cut = vec![0usize; n * n];
    for gap in 2..n {
        for i in 0..n - gap {
            let j = i + gap;
            let (cost, k) = (i + 1..j)
                .map(|k| {
                    let area = (p(k) - p(i)).cross(p(j) - p(i)).length();
                    (best[i * n + k] + best[k * n + j] + area, k)
                })
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
                .unwrap_or((0.0, i + 1));
            best[i * n + j] = cost;
            cut[i * n + j] = k;
        }
    }
    let mut todo = vec![(0, n - 1)];
    while let Some((i, j)) = todo.pop() {
        if j - i < 2 {
            continue;
        }
        let k = cut[i * n + j];
        out.push([ring[i], ring[k], ring[j]]);
        todo.extend([(i, k), (k, j)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::report;
    use crate::shapes::{cuboid, icosphere, torus};

    fn volume(mesh: &PolyMesh) -> Option<f64> {
        report(mesh, false, &Job::default()).unwrap().volume
    }

    #[test]
    fn a_soup_becomes_the_solid_again() {
        let solid = torus(3.0, 1.0, 24, 12);
        let mut soup = PolyMesh::new();
        for face in solid.faces() {
            let first = soup.positions.len() as u32;
            soup.positions.extend(face.iter().map(|&c| solid.positions[c as usize]));
            soup.push_face(&(0..face.len() as u32).map(|i| first + i).collect::<Vec<_>>());
        }
        for (f, turn) in (0..soup.face_count()).map(|f| (f, f % 3 == 1)) {
            if turn {
                let (a, b) = (soup.face_starts[f] as usize, soup.face_starts[f + 1] as usize);
                soup.corners[a..b].reverse();
            }
        }
        for distance in [0.0, 1e-6] {
            let mut mesh = soup.clone();
            assert_eq!(weld(&mut mesh, distance), soup.positions.len() - solid.positions.len());
            assert!(orient(&mut mesh) > 0);
            let r = report(&mesh, true, &Job::default()).unwrap();
            assert_eq!((r.closed, r.manifold, r.genus, r.components), (true, true, Some(1), 1));
            assert!((r.volume.unwrap() - volume(&solid).unwrap()).abs() < 1e-9);
        }
    }

    #[test]
    fn a_cavity_faces_in_and_a_pebble_in_it_out() {
        let mut mesh = PolyMesh::new();
        for (n, s) in [3.0, 2.0, 1.0].into_iter().enumerate() {
            let mut b = cuboid(DVec3::splat(-s), DVec3::splat(s));
            if n == 0 {
                flip(&mut b);
            }
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(&b.positions);
            b.faces()
                .for_each(|f| mesh.push_face(&f.iter().map(|c| c + first).collect::<Vec<_>>()));
        }
        orient(&mut mesh);
        assert!((volume(&mesh).unwrap() - (216.0 - 64.0 + 8.0)).abs() < 1e-9);
    }

    fn boxes(list: &[(f64, f64, bool)]) -> PolyMesh {
        let mut mesh = PolyMesh::new();
        for &(lo, hi, turned) in list {
            let mut b = cuboid(DVec3::splat(lo), DVec3::splat(hi));
            if turned {
                flip(&mut b);
            }
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(&b.positions);
            b.faces()
                .for_each(|f| mesh.push_face(&f.iter().map(|c| c + first).collect::<Vec<_>>()));
        }
        mesh
    }

    #[test]
    fn shells_that_cross_are_not_within_each_other() {
        let mut crossed = boxes(&[(0.0, 2.0, false), (1.0, 3.0, true)]);
        let done = orient_shells(&mut crossed);
        assert_eq!((done.crossing, done.turned, done.guessed), (1, 6, 1));
        assert_eq!(volume(&crossed), Some(16.0));
        // Directions that are consistent stay: a cavity, and a solid within a solid.
        let mut cavity = boxes(&[(0.0, 3.0, false), (1.0, 2.0, true)]);
        assert_eq!(orient_shells(&mut cavity), OrientedShells::default());
        let mut twice = boxes(&[(0.0, 3.0, false), (1.0, 2.0, false)]);
        let done = orient_shells(&mut twice);
        assert_eq!(done, OrientedShells { nested: 1, ..Default::default() });
    }

    #[test]
    fn holes_are_closed_and_folded_sheets_removed() {
        let whole = icosphere(1.0, 6).to_poly();
        let mut mesh = whole.clone();
        let keep: Vec<Vec<u32>> = whole
            .faces()
            .enumerate()
            .filter(|(f, _)| f % 90 != 7)
            .map(|(_, f)| f.to_vec())
            .collect();
        let lost = whole.face_count() - keep.len();
        (mesh.face_starts, mesh.corners) = (vec![0], vec![]);
        keep.iter().for_each(|f| mesh.push_face(f));
        let filled = fill_holes(&mut mesh, 100);
        assert_eq!(filled, Filled { holes: lost, faces: lost, left: 0 });
        assert!((volume(&mesh).unwrap() - volume(&whole).unwrap()).abs() < 1e-12);
        mesh.push_face(&[0, 1, 2]);
        mesh.push_face(&[1, 0, 2]);
        mesh.push_face(&[3, 3, 4]);
        assert_eq!(remove_degenerate(&mut mesh), 3);
        let mut open = cuboid(DVec3::ZERO, DVec3::ONE);
        open.corners.truncate(20);
        open.face_starts.truncate(6);
        assert_eq!(fill_holes(&mut open, 4).holes, 1);
        assert_eq!(volume(&open), Some(1.0));
    }
}

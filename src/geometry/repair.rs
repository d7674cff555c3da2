//! Mending: one vertex for one place, no faces without extent, all faces outwards, no holes.
//! Each works in place and says how much it changed; none moves a vertex.

use glam::DVec3;

use super::PolyMesh;
use super::disjoint_sets::DisjointSets;
use super::edges::EdgeTable;
use super::triangulate;

/// Turns every face over.
pub fn flip(mesh: &mut PolyMesh) {
    for f in 0..mesh.face_count() {
        let (a, b) = (mesh.face_starts[f] as usize, mesh.face_starts[f + 1] as usize);
        mesh.corners[a..b].reverse();
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
        // Cells of the distance's size: what is near lies in the same or a neighbouring cell.
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

/// Removes vertices that no face uses; the others keep their order. Returns how many went.
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

/// Makes neighbours agree across every edge of two faces (the first face of a patch leads), then
/// turns closed patches so that the outermost face out and what lies inside an odd number of others
/// (cavities) faces in. Returns how many faces were turned. A one-sided surface keeps a seam;
/// [`super::check::report`] then still says so.
pub fn orient(mesh: &mut PolyMesh) -> usize {
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
    let mut patch = vec![u32::MAX; faces];
    let mut turned = vec![false; faces];
    let mut patches = 0u32;
    for start in 0..faces {
        if patch[start] != u32::MAX {
            continue;
        }
        patch[start] = patches;
        let mut todo = vec![start as u32];
        while let Some(f) = todo.pop() {
            let first = links.partition_point(|l| l.0 < f);
            for &(_, g, same) in links[first..].iter().take_while(|l| l.0 == f) {
                if patch[g as usize] == u32::MAX {
                    patch[g as usize] = patches;
                    turned[g as usize] = turned[f as usize] ^ same;
                    todo.push(g);
                }
            }
        }
        patches += 1;
    }
    turn_out(mesh, &patch, patches as usize, &open, &mut turned);
    let mut count = 0;
    for (f, _) in turned.iter().enumerate().filter(|(_, t)| **t) {
        let (a, b) = (mesh.face_starts[f] as usize, mesh.face_starts[f + 1] as usize);
        mesh.corners[a..b].reverse();
        count += 1;
    }
    count
}

/// Decides for each closed patch whether it must be turned as a whole.
fn turn_out(mesh: &PolyMesh, patch: &[u32], patches: usize, open: &[u32], turned: &mut [bool]) {
    let mut closed = vec![true; patches];
    for &f in open {
        closed[patch[f as usize] as usize] = false;
    }
    let (triangles, of) = mesh.triangles();
    let mut volume = vec![0.0; patches];
    let mut bounds = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); patches];
    let mut sample = vec![DVec3::ZERO; patches];
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); patches];
    let origin = mesh.positions.first().copied().unwrap_or_default();
    for (t, corners) in triangles.iter().enumerate() {
        let f = of[t] as usize;
        let p = patch[f] as usize;
        let [a, b, c] = corners.map(|v| mesh.positions[v as usize]);
        let sign = if turned[f] { -1.0 } else { 1.0 };
        volume[p] += sign * (a - origin).dot((b - origin).cross(c - origin));
        let (lo, hi) = bounds[p];
        bounds[p] = (lo.min(a).min(b).min(c), hi.max(a).max(b).max(c));
        sample[p] = a;
        lists[p].push(t as u32);
    }
    // Aslant, so that it meets no edge of a part built along the axes.
    let direction = DVec3::new(0.577_215_7, 0.702_340_1, 0.416_593_3);
    let turn: Vec<bool> = (0..patches)
        .map(|p| {
            if !closed[p] {
                return false;
            }
            let q = sample[p];
            let around = (0..patches)
                .filter(|&o| {
                    o != p && closed[o] && q.cmpgt(bounds[o].0).all() && q.cmplt(bounds[o].1).all()
                })
                .filter(|&o| {
                    let hits = lists[o].iter().filter(|&&t| {
                        hits(
                            q,
                            direction,
                            triangles[t as usize].map(|v| mesh.positions[v as usize]),
                        )
                    });
                    hits.count() % 2 == 1
                })
                .count();
            (volume[p] < 0.0) != (around % 2 == 1)
        })
        .collect();
    for (t, &p) in turned.iter_mut().zip(patch) {
        *t ^= turn[p as usize];
    }
}

/// Whether the ray meets the triangle (Moller and Trumbore 1997).
fn hits(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (e1, e2) = (b - a, c - a);
    let p = direction.cross(e2);
    let det = e1.dot(p);
    let s = (origin - a) / det;
    let u = s.dot(p);
    let q = s.cross(e1);
    let v = direction.dot(q);
    det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && e2.dot(q) > 0.0
}

/// What [`fill_holes`] did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Filled {
    pub holes: usize,
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
            // Where borders meet, the loop is not one loop.
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
    use crate::job::Job;
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

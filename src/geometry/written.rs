//! The mesh that a file will hold: in the format's faces and precision, and without crossings.
//!
//! Rounding moves each vertex separately, so a mesh without crossings may cross itself once it is
//! written. Here it is rounded first, checked with exact predicates ([`crate::self_intersection`]),
//! and repaired by local operations: an edge is flipped, an edge of at most a few steps of the
//! precision is collapsed, or a vertex is moved by a few steps. An operation is kept only if it
//! reduces the number of crossings (the greedy scheme of Attene, "A lightweight approach to
//! repairing digitized polygon meshes", 2010).

use std::borrow::Cow;
use std::cell::Cell;
use std::sync::Arc;

use glam::DVec3;

use crate::PolyMesh;
use crate::boolean::box_tree::{Span, SpanTree};
use crate::face_attributes::{FaceAttributes, NO_UV};
use crate::job::{Cancelled, Job};
use crate::self_intersection;

/// A mesh as a file will hold it.
#[derive(Debug, Clone)]
pub struct WrittenMesh<'a> {
    /// Rounded to the format, in triangles where the format holds no others.
    pub mesh: Cow<'a, PolyMesh>,
    /// Pairs of triangles that crossed before the repair.
    pub found: usize,
    /// Pairs that still cross.
    pub crossings: usize,
}

/// Faces that come from another mesh, which is closed, manifold and without crossings: its faces
/// that are unchanged in the file do not cross, and are not compared again.
#[derive(Debug, Clone, Copy)]
pub struct KnownFaces<'a> {
    /// The other mesh.
    pub mesh: &'a PolyMesh,
    /// For each face of the written mesh, the face there that it is, or is a part of.
    pub faces: &'a [Option<u32>],
}

impl KnownFaces<'_> {
    /// The triangles of `out` that are not triangles of the known mesh; `of`: the face of each.
    fn changed(&self, out: &PolyMesh, of: &[u32]) -> Vec<u32> {
        // Each face is used once: a second copy would coincide with the first.
        let mut used = vec![false; self.mesh.face_count()];
        let mut as_known = |f: u32| {
            let Some(Some(known)) = self.faces.get(f as usize) else { return false };
            let (own, old) = (out.face(f as usize), self.mesh.face(*known as usize));
            let same = |(&v, &w): (&u32, &u32)| {
                out.positions[v as usize] == self.mesh.positions[w as usize]
            };
            own.len() == 3
                && old.len() == 3
                && own.iter().zip(old).all(same)
                && !std::mem::replace(&mut used[*known as usize], true)
        };
        (0..of.len() as u32).filter(|&t| !as_known(of[t as usize])).collect()
    }
}

/// With more crossing pairs a mesh is no rounded solid, and is left as it is.
const MOST_PAIRS: usize = 3000;
const ROUNDS: usize = 6;
/// Triangles compared until a repair is given up: so many, and so many more a triangle of the mesh.
/// Surfaces that lie upon each other in many places would cost a thousand times that, and no repair
/// parts them.
const COMPARED: (usize, usize) = (2_000_000, 100);

/// `mesh` as a file with the ending `kind` will hold it (STL, GLB and glTF have single precision;
/// they and 3MF have triangles only). Vertices move by no more than 64 steps of the format's
/// precision or four times `tolerance`, and only where triangles cross. A polygon that a repair
/// changes comes in triangles; the others stay. `known`: what need not be compared, one entry a
/// face of `mesh`.
///
/// # Errors
/// [`Cancelled`] when the job is.
pub fn for_file<'a>(
    mesh: &'a PolyMesh,
    kind: &str,
    tolerance: f64,
    mut known: Option<KnownFaces<'_>>,
    job: &Job,
) -> Result<WrittenMesh<'a>, Cancelled> {
    let single = matches!(kind, "stl" | "glb" | "gltf");
    let mut out = Cow::Borrowed(mesh);
    if matches!(kind, "stl" | "glb" | "gltf" | "3mf") && mesh.corners.len() != 3 * mesh.face_count()
    {
        out = Cow::Owned(triangulated(mesh));
        known = None;
    }
    if single && mesh.positions.iter().any(|p| p.as_vec3().as_dvec3() != *p) {
        let rounded = mesh.positions.iter().map(|p| p.as_vec3().as_dvec3()).collect();
        out.to_mut().positions = rounded;
    }
    let (triangles, faces) = out.triangles();
    let pairs = match known {
        Some(known) => {
            let changed = known.changed(&out, &faces);
            self_intersection::pairs_with(&out.positions, &triangles, &changed, job)?
        }
        None => self_intersection::pairs(&out.positions, &triangles, job)?,
    };
    let found = pairs.len();
    if pairs.is_empty() || found > MOST_PAIRS {
        return Ok(WrittenMesh { mesh: out, found, crossings: found });
    }
    let reach = out.positions.iter().fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
    let step = reach * 2f64.powi(if single { -23 } else { -52 });
    let mut local = LocalMesh::new(out.positions.clone(), triangles, single, step, tolerance, job)?;
    local.faces = faces;
    let mut left = pairs;
    let most = COMPARED.0 + COMPARED.1 * local.triangles.len();
    for _ in 0..ROUNDS {
        let before = left.len();
        for &(s, t) in &left {
            job.check()?;
            if local.compared.get() > most {
                break;
            }
            local.repair(s, t);
        }
        left = self_intersection::pairs(&local.positions, &local.alive(), job)?;
        if left.is_empty() || left.len() >= before {
            break;
        }
        // The list's numbers are those of the triangles that are left.
        let names = local.numbers();
        left.iter_mut().for_each(|p| *p = (names[p.0 as usize], names[p.1 as usize]));
    }
    if left.len() < found {
        local.store(out.to_mut());
    }
    Ok(WrittenMesh { mesh: out, found, crossings: left.len().min(found) })
}

/// A mesh with all its faces in triangles, colours and groups with them.
pub fn triangulated(mesh: &PolyMesh) -> PolyMesh {
    let (triangles, of) = mesh.triangles();
    let mut out = PolyMesh {
        positions: mesh.positions.clone(),
        face_starts: (0..=of.len() as u32).map(|t| t * 3).collect(),
        corners: triangles.into_iter().flatten().collect(),
        colours: mesh.colours.clone(),
        groups: mesh.groups.as_ref().map(|g| of.iter().map(|&f| g[f as usize]).collect()),
        attributes: mesh.attributes.clone(),
    };
    // By vertex of a face, which is one corner of it, unless the face meets a vertex twice.
    if let Some((uvs, old)) = mesh.uvs() {
        let uv = |(t, &v): (usize, &u32)| {
            let f = of[t / 3] as usize;
            let own = mesh.face(f).iter().position(|&c| c == v);
            own.map_or(NO_UV, |k| old[mesh.face_starts[f] as usize + k])
        };
        let uv_corners = out.corners.iter().enumerate().map(uv).collect();
        let rest = mesh.attributes.as_deref().cloned().unwrap_or_default();
        let uvs = uvs.to_vec();
        out.attributes = Some(Arc::new(FaceAttributes { uvs, uv_corners, ..rest }));
    }
    out
}

/// Triangles that change one by one.
struct LocalMesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Face of each triangle.
    faces: Vec<u32>,
    gone: Vec<bool>,
    /// Triangles that a repair changed.
    touched: Vec<bool>,
    around: Vec<Vec<u32>>,
    tree: SpanTree,
    /// Triangles that are no longer where the tree has them.
    changed: Vec<u32>,
    /// True for each triangle in `changed`.
    is_changed: Vec<bool>,
    single: bool,
    step: f64,
    limit: f64,
    /// Triangles compared so far.
    compared: Cell<usize>,
}

/// A change, and what undoes it.
struct Undo {
    triangles: Vec<(u32, [u32; 3], bool)>,
    position: Option<(u32, DVec3)>,
}

impl LocalMesh {
    fn new(
        positions: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
        single: bool,
        step: f64,
        tolerance: f64,
        job: &Job,
    ) -> Result<LocalMesh, Cancelled> {
        let mut around = vec![Vec::new(); positions.len()];
        for (t, c) in triangles.iter().enumerate() {
            c.iter().for_each(|&v| around[v as usize].push(t as u32));
        }
        let spans: Vec<Span> =
            triangles.iter().map(|t| Span::of(t.map(|v| positions[v as usize]))).collect();
        let tree = SpanTree::build(&spans, job)?;
        let none = vec![false; triangles.len()];
        let (gone, touched, is_changed) = (none.clone(), none.clone(), none);
        let limit = (64.0 * step).max(4.0 * tolerance);
        Ok(LocalMesh {
            positions,
            triangles,
            faces: Vec::new(),
            gone,
            touched,
            around,
            tree,
            changed: Vec::new(),
            is_changed,
            single,
            step,
            limit,
            compared: Cell::new(0),
        })
    }

    fn alive(&self) -> Vec<[u32; 3]> {
        self.numbers().iter().map(|&t| self.triangles[t as usize]).collect()
    }

    fn numbers(&self) -> Vec<u32> {
        (0..self.triangles.len() as u32).filter(|&t| !self.gone[t as usize]).collect()
    }

    /// Pairs that cross with one of `list` in them, counted no further than to `most`.
    fn crossings(&self, list: &[u32], most: usize) -> usize {
        let mut count = 0;
        let mut near: Vec<u32> = Vec::new();
        for &t in list.iter().filter(|t| !self.gone[**t as usize]) {
            let own = self.triangles[t as usize];
            let span = Span::of(own.map(|v| self.positions[v as usize])).grown(self.limit);
            let crosses = |u: u32| {
                let other = self.triangles[u as usize];
                u != t
                    && !self.gone[u as usize]
                    && !(list.contains(&u) && u < t)
                    && Span::of(other.map(|v| self.positions[v as usize])).meets(&span)
                    && self_intersection::crosses(&self.positions, own, other)
            };
            near.clear();
            self.tree.each_meets(&span, |u| near.push(u));
            self.compared.update(|n| n + near.len() + self.changed.len());
            // Those that changed are where they are, not where the tree has them: each once.
            let still = near.iter().filter(|&&u| !self.is_changed[u as usize]);
            for &u in still.chain(&self.changed) {
                count += usize::from(crosses(u));
                if count >= most {
                    return count;
                }
            }
        }
        count
    }

    /// Marks triangles as changed.
    fn mark(&mut self, list: &[u32]) {
        for &t in list {
            if !std::mem::replace(&mut self.is_changed[t as usize], true) {
                self.changed.push(t);
            }
        }
    }

    /// Returns true if two triangles cross by more than any operation moves them. Then they overlap
    /// by more than the limit along each separating axis: both normals, and the cross product of
    /// each two edges (Gottschalk, 1996).
    fn cross_deeply(&self, s: u32, t: u32) -> bool {
        let [p, q] = [s, t].map(|t| self.triangles[t as usize].map(|v| self.positions[v as usize]));
        let edges = |c: [DVec3; 3]| [c[1] - c[0], c[2] - c[1], c[0] - c[2]];
        let (e, f) = (edges(p), edges(q));
        let across = e.into_iter().flat_map(|e| f.map(|f| e.cross(f)));
        let mut axes = [e[0].cross(e[1]), f[0].cross(f[1])].into_iter().chain(across);
        axes.all(|axis| {
            let Some(axis) = axis.try_normalize() else { return true };
            let span = |c: [DVec3; 3]| {
                let h = c.map(|x| (x - p[0]).dot(axis));
                (h[0].min(h[1]).min(h[2]), h[0].max(h[1]).max(h[2]))
            };
            let ((a, b), (c, d)) = (span(p), span(q));
            (b - c).min(d - a) > self.limit
        })
    }

    /// Tries what may part two triangles that cross.
    fn repair(&mut self, s: u32, t: u32) {
        let pair = [s, t];
        if pair.iter().any(|&t| self.gone[t as usize])
            || !self_intersection::crosses(
                &self.positions,
                self.triangles[s as usize],
                self.triangles[t as usize],
            )
            || self.cross_deeply(s, t)
        {
            return;
        }
        for t in pair {
            let c = self.triangles[t as usize];
            for k in 0..3 {
                let (a, b) = (c[k], c[(k + 1) % 3]);
                let length = self.positions[a as usize].distance(self.positions[b as usize]);
                if length <= self.limit && (self.collapse(a, b) || self.collapse(b, a)) {
                    return;
                }
            }
        }
        for t in pair {
            let c = self.triangles[t as usize];
            for k in 0..3 {
                if self.flip(c[k], c[(k + 1) % 3]) {
                    return;
                }
            }
        }
        // Along the other triangle's normal, to its plane and a little beyond, or to its other
        // side.
        // Nothing changes from here to the first shift that helps, and there it ends.
        let known = pair.map(|t| self.crossing_around(t));
        for (n, (own, other)) in [(s, t), (t, s)].into_iter().enumerate() {
            let [a, b, c] = self.triangles[other as usize].map(|v| self.positions[v as usize]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for (k, v) in self.triangles[own as usize].into_iter().enumerate() {
                let height = (self.positions[v as usize] - a).dot(normal);
                for share in [1.0, 1.25, 2.0] {
                    let by = height * share + height.signum() * self.step;
                    if by.abs() <= self.limit && self.shift(v, -normal * by, known[n][k]) {
                        return;
                    }
                }
            }
        }
        let mut size = self.step;
        while size <= self.limit {
            for (n, t) in pair.into_iter().enumerate() {
                for (k, v) in self.triangles[t as usize].into_iter().enumerate() {
                    for d in
                        [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z]
                    {
                        if self.shift(v, d * size, known[n][k]) {
                            return;
                        }
                    }
                }
            }
            size *= 4.0;
        }
    }

    /// Keeps the change that `make` does where fewer pairs cross among `list` and what is new.
    fn attempt(&mut self, list: &[u32], make: impl FnOnce(&mut LocalMesh) -> Option<Undo>) -> bool {
        let before = self.crossings(list, usize::MAX);
        self.attempt_below(before, list, make)
    }

    /// The same where `before` pairs are known to cross among `list`.
    fn attempt_below(
        &mut self,
        before: usize,
        list: &[u32],
        make: impl FnOnce(&mut LocalMesh) -> Option<Undo>,
    ) -> bool {
        if before == 0 {
            return false;
        }
        let Some(undo) = make(self) else { return false };
        let marks = self.changed.len();
        self.mark(list);
        if self.crossings(list, before) < before {
            list.iter().for_each(|&t| self.touched[t as usize] = true);
            return true;
        }
        for t in self.changed.drain(marks..) {
            self.is_changed[t as usize] = false;
        }
        if let Some((v, p)) = undo.position {
            self.positions[v as usize] = p;
        }
        for (t, corners, gone) in undo.triangles {
            for v in self.triangles[t as usize] {
                self.around[v as usize].retain(|&x| x != t);
            }
            (self.triangles[t as usize], self.gone[t as usize]) = (corners, gone);
            for v in corners {
                self.around[v as usize].push(t);
            }
        }
        false
    }

    /// `before`: what [`LocalMesh::crossing_around`] says of `v`.
    fn shift(&mut self, v: u32, by: DVec3, before: usize) -> bool {
        if before == 0 {
            return false;
        }
        let list = self.around[v as usize].clone();
        let old = self.positions[v as usize];
        let new = if self.single { (old + by).as_vec3().as_dvec3() } else { old + by };
        new != old
            && self.attempt_below(before, &list, |m| {
                m.positions[v as usize] = new;
                Some(Undo { triangles: Vec::new(), position: Some((v, old)) })
            })
    }

    /// Pairs that cross with a triangle around each of a triangle's corners.
    fn crossing_around(&self, t: u32) -> [usize; 3] {
        let around = |v: u32| self.crossings(&self.around[v as usize], usize::MAX);
        self.triangles[t as usize].map(around)
    }

    /// The triangle with the edge from `a` to `b`, and its third corner.
    fn beside(&self, a: u32, b: u32) -> Option<(u32, u32)> {
        let mut found = self.around[a as usize].iter().filter_map(|&t| {
            let c = self.triangles[t as usize];
            (0..3).find(|&k| c[k] == a && c[(k + 1) % 3] == b).map(|k| (t, c[(k + 2) % 3]))
        });
        let one = found.next();
        if found.next().is_some() { None } else { one }
    }

    fn set(&mut self, t: u32, corners: [u32; 3], gone: bool) -> (u32, [u32; 3], bool) {
        let old = (t, self.triangles[t as usize], self.gone[t as usize]);
        for v in old.1 {
            self.around[v as usize].retain(|&x| x != t);
        }
        self.triangles[t as usize] = corners;
        self.gone[t as usize] = gone;
        if !gone {
            for v in corners {
                self.around[v as usize].push(t);
            }
        }
        old
    }

    fn flip(&mut self, a: u32, b: u32) -> bool {
        let (Some((s, c)), Some((t, d))) = (self.beside(a, b), self.beside(b, a)) else {
            return false;
        };
        let p = |v: u32| self.positions[v as usize];
        let normal = |x: u32, y: u32, z: u32| (p(y) - p(x)).cross(p(z) - p(x));
        let sum = normal(a, b, c) + normal(b, a, d);
        let flat = |v: u32| (p(v) - p(a)).dot(sum.normalize_or_zero()).abs() <= self.limit;
        let (first, second) = (normal(c, a, d), normal(d, b, c));
        if c == d
            || ![b, c, d].into_iter().all(flat)
            || first.dot(sum) <= 0.0
            || second.dot(sum) <= 0.0
            || self.around[c as usize].iter().any(|&x| self.triangles[x as usize].contains(&d))
        {
            return false;
        }
        self.attempt(&[s, t], |m| {
            let triangles = vec![m.set(s, [c, a, d], false), m.set(t, [d, b, c], false)];
            Some(Undo { triangles, position: None })
        })
    }

    /// Makes `a` one with `b`.
    fn collapse(&mut self, a: u32, b: u32) -> bool {
        let (Some((s, c)), Some((t, d))) = (self.beside(a, b), self.beside(b, a)) else {
            return false;
        };
        let ring = |v: u32| -> Vec<u32> {
            let mut out: Vec<u32> = self.around[v as usize]
                .iter()
                .flat_map(|&t| self.triangles[t as usize])
                .filter(|&w| w != v)
                .collect();
            out.sort_unstable();
            out.dedup();
            out
        };
        let (near, other) = (ring(a), ring(b));
        let common = near.iter().filter(|v| other.binary_search(v).is_ok()).count();
        if c == d || common != 2 || near.len() < 4 || other.len() < 4 {
            return false;
        }
        let list = self.around[a as usize].clone();
        self.attempt(&list, |m| {
            let mut triangles = Vec::new();
            for &x in &list {
                let corners = m.triangles[x as usize];
                let new = corners.map(|v| if v == a { b } else { v });
                let flat = x == s || x == t;
                triangles.push(m.set(x, if flat { corners } else { new }, flat));
            }
            Some(Undo { triangles, position: None })
        })
    }

    /// Stores the result in the original mesh: unchanged faces as they were, and the triangles of
    /// the others.
    fn store(self, mesh: &mut PolyMesh) {
        let old = std::mem::replace(mesh, PolyMesh::new());
        let mut names = Vec::new();
        let mut start = 0;
        for group in self.faces.chunk_by(|a, b| a == b) {
            let range = start..start + group.len();
            start = range.end;
            if range.clone().any(|t| self.touched[t]) {
                for t in range.filter(|&t| !self.gone[t]) {
                    mesh.push_face(&self.triangles[t]);
                    names.push(group[0]);
                }
            } else {
                mesh.push_face(old.face(group[0] as usize));
                names.push(group[0]);
            }
        }
        mesh.groups = old.groups.map(|g| names.iter().map(|&f| g[f as usize]).collect());
        mesh.colours = old.colours;
        mesh.attributes = old.attributes;
        mesh.drop_uvs();
        mesh.positions = self.positions;
        crate::repair::drop_unused(mesh);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::icosphere;

    #[test]
    fn a_ball_with_a_dented_vertex_crosses_nothing_once_written() {
        let mut mesh = icosphere(1.0, 4).to_poly();
        let job = Job::default();
        assert_eq!(for_file(&mesh, "stl", 0.0, None, &job).expect("written").found, 0);
        // A vertex pulled over its neighbour by a few steps of single precision.
        let edge = [mesh.corners[0], mesh.corners[1]];
        let to = mesh.positions[edge[1] as usize];
        let from = mesh.positions[edge[0] as usize];
        mesh.positions[edge[0] as usize] = to + (to - from).normalize() * 4e-6;
        let made = for_file(&mesh, "stl", 0.0, None, &job).expect("written");
        assert!(made.found > 0 && made.crossings == 0, "{} {}", made.found, made.crossings);
        let facts = crate::check::report(&made.mesh, true, &job).expect("a report");
        assert_eq!((facts.closed, facts.manifold), (true, true));
        assert_eq!(facts.self_intersections, Some(0));
    }

    #[test]
    fn polygons_that_no_repair_changes_stay() {
        let mut mesh = crate::shapes::torus(2.0, 0.5, 16, 8);
        let quads = mesh.face_count();
        let edge = [mesh.corners[0], mesh.corners[1]];
        let (from, to) = (mesh.positions[edge[0] as usize], mesh.positions[edge[1] as usize]);
        mesh.positions[edge[0] as usize] = to + (to - from).normalize() * 4e-6;
        let made = for_file(&mesh, "stl", 0.0, None, &Job::default()).expect("written");
        assert!(made.found > 0 && made.crossings == 0, "{} {}", made.found, made.crossings);
        let made = for_file(&mesh, "ply", 1e-6, None, &Job::default()).expect("written");
        assert!(made.found > 0 && made.crossings == 0, "{} {}", made.found, made.crossings);
        let kept = made.mesh.faces().filter(|f| f.len() == 4).count();
        assert!(kept + 16 > quads && kept < quads, "{kept} of {quads}");
        let facts = crate::check::report(&made.mesh, true, &Job::default()).expect("a report");
        assert_eq!((facts.closed, facts.manifold), (true, true));
    }

    #[test]
    fn faces_of_a_clean_mesh_are_not_compared_again_and_nothing_is_missed() {
        let job = Job::default();
        let clean = icosphere(1.0, 12).to_poly();
        let known: Vec<Option<u32>> = (0..clean.face_count() as u32).map(Some).collect();
        let faces = KnownFaces { mesh: &clean, faces: &known };
        // Beyond the repair's reach: what is found is what is left.
        let crossings = |mesh: &PolyMesh, known| {
            for_file(mesh, "ply", 0.0, known, &job).expect("written").crossings
        };
        assert_eq!(crossings(&clean, Some(faces)), 0);
        let mut dented = clean.clone();
        dented.positions[7] *= -1.5;
        let all = crossings(&dented, None);
        assert!(all > 3, "{all}");
        assert_eq!(crossings(&dented, Some(faces)), all);
        // A duplicate face coincides with the first, although both are unchanged.
        let mut twice = clean.clone();
        let again: Vec<u32> = twice.face(5).to_vec();
        twice.push_face(&again);
        let both: Vec<Option<u32>> = known.iter().copied().chain([Some(5)]).collect();
        let both = KnownFaces { mesh: &clean, faces: &both };
        assert_eq!(crossings(&twice, Some(both)), crossings(&twice, None));
        assert!(crossings(&twice, Some(both)) > 0);
    }
}

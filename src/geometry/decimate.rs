//! Fewer triangles, by quadric error metrics (QEM): edges are collapsed in the order of the error
//! that it makes (Garland and Heckbert, "Surface simplification using quadric error metrics",
//! 1997).
//!
//! A collapse is rejected if it would break the surface (link condition: the edge's ends share
//! exactly the vertices opposite the edge), turn a triangle by more than about 75 degrees or make a
//! needle of it, or move the surface by more than the bound. Planes perpendicular to the borders
//! preserve them, and likewise the borders between regions. A closed manifold stays one.
//!
//! A collapse considers its triangles only, so the result may cross itself where the surface is
//! thin or two parts are near each other. At the end, crossings that the mesh did not have are
//! searched for. If there are any, everything is repeated with a bound on the number of vertices
//! that one near them may represent, a quarter each time, until there are none. A bound of one
//! leaves the surface there unchanged.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DMat3, DVec3};

use super::PolyMesh;
use super::edges::EdgeTable;
use super::self_intersection;
use crate::job::{Cancelled, Job};

/// The stopping criteria.
#[derive(Debug, Clone, Copy)]
pub struct DecimationTarget {
    /// Stop at this many triangles.
    pub triangles: usize,
    /// And before the mean square distance to the planes that a vertex stands for exceeds this one
    /// squared, in the mesh's unit; infinity for no bound.
    pub error: f64,
    /// Places are rounded to single precision, in which clay keeps them, before crossings are
    /// looked for.
    pub single: bool,
}

/// Rounds of the search for a result without new crossings.
const ROUNDS: usize = 8;

/// A mesh of fewer triangles, and what is to be said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Decimated {
    /// The mesh; its groups are those of the triangles that are left.
    pub mesh: PolyMesh,
    /// Pairs of triangles that cross each other where none did before.
    pub new_crossings: usize,
    /// The number of more careful repetitions because of crossings.
    pub repeated: usize,
}

/// A symmetric quadratic form: the weighted sum of squared distances to planes.
#[derive(Debug, Clone, Copy, Default)]
struct Quadric {
    /// xx xy xz yy yz zz of the matrix.
    a: [f64; 6],
    b: DVec3,
    c: f64,
    weight: f64,
}

impl Quadric {
    fn plane(normal: DVec3, through: DVec3, weight: f64) -> Quadric {
        let d = -normal.dot(through);
        let n = normal;
        Quadric {
            a: [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z]
                .map(|v| v * weight),
            b: n * (d * weight),
            c: d * d * weight,
            weight,
        }
    }

    fn add(&mut self, o: &Quadric) {
        for (x, y) in self.a.iter_mut().zip(o.a) {
            *x += y;
        }
        self.b += o.b;
        self.c += o.c;
        self.weight += o.weight;
    }

    fn matrix(&self) -> DMat3 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
    }

    fn at(&self, p: DVec3) -> f64 {
        (p.dot(self.matrix() * p) + 2.0 * self.b.dot(p) + self.c).max(0.0)
    }

    /// The place of least error, if it is well determined.
    fn least(&self) -> Option<DVec3> {
        let m = self.matrix();
        let size = (self.a[0] + self.a[3] + self.a[5]) / 3.0;
        let det = m.determinant();
        (det.abs() > 1e-6 * size * size * size).then(|| m.inverse() * -self.b)
    }
}

struct CollapseSurface {
    /// Around the middle of the box, so that the forms lose no digits to the place of the mesh.
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    alive: Vec<bool>,
    around: Vec<Vec<u32>>,
    forms: Vec<Quadric>,
    /// Counts the changes of a vertex: entries of the heap made before are stale.
    stamp: Vec<u32>,
    fixed: Vec<bool>,
    border: Vec<bool>,
    /// The region of each triangle.
    regions: Vec<u32>,
    /// The number of input vertices that each vertex represents, and its maximum.
    members: Vec<u32>,
    most_members: Vec<u32>,
    /// The vertex that each was joined with.
    joined: Vec<u32>,
}

/// Errors as bits: those of non-negative numbers sort as the numbers do.
type CollapseCandidate = Reverse<(u64, u32, u32, u32, u32)>;

/// Collapses edges of the mesh's triangles (polygons are cut first) until `target` is reached or
/// nothing more may go. As [`decimate`], without regions.
pub fn quadric(
    mesh: &PolyMesh,
    target: DecimationTarget,
    job: &Job,
) -> Result<PolyMesh, Cancelled> {
    Ok(decimate(mesh, None, target, job)?.mesh)
}

/// Collapses edges of the mesh's triangles (polygons are cut first) until `target` is reached or
/// nothing more may go, without crossings that were not there before. Borders between regions are
/// kept as borders of the mesh are: those between the mesh's groups, and those between what
/// `marked` says of its vertices; a triangle is marked if two of its corners are.
pub fn decimate(
    mesh: &PolyMesh,
    marked: Option<&[bool]>,
    target: DecimationTarget,
    job: &Job,
) -> Result<Decimated, Cancelled> {
    let (mut triangles, faces) = mesh.triangles();
    let proper = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    let groups = mesh.groups.as_ref();
    let regions: Vec<u32> = triangles
        .iter()
        .zip(&faces)
        .filter(|(t, _)| proper(t))
        .map(|(t, &face)| {
            let group = groups.and_then(|g| g.get(face as usize)).copied().unwrap_or(0);
            let is = |v: &&u32| marked.is_some_and(|m| m.get(**v as usize) == Some(&true));
            group << 1 | u32::from(t.iter().filter(is).count() >= 2)
        })
        .collect();
    triangles.retain(proper);
    let mut most_members = vec![u32::MAX; mesh.positions.len()];
    let mut old_crossings: Option<Vec<bool>> = None;
    let mut repeated = 0;
    loop {
        let s = collapsed(mesh, (&triangles, &regions), &most_members, target, job)?;
        let left: Vec<[u32; 3]> =
            s.triangles.iter().zip(&s.alive).filter(|(_, a)| **a).map(|(t, _)| *t).collect();
        let mut found = self_intersection::pairs(&s.positions, &left, job)?;
        let all: Vec<u32> = (0..s.joined.len() as u32).map(|v| s.stands_for(v)).collect();
        if !found.is_empty() {
            // Old crossings may remain.
            let old = match &old_crossings {
                Some(old) => old,
                None => old_crossings.insert(crossing_vertices(mesh, &triangles, job)?),
            };
            let mut of_old = vec![false; all.len()];
            (0..all.len()).filter(|&v| old[v]).for_each(|v| of_old[all[v] as usize] = true);
            let is_old = |t: u32| left[t as usize].iter().any(|&v| of_old[v as usize]);
            found.retain(|&(t, u)| !(is_old(t) && is_old(u)));
        }
        if found.is_empty() || repeated == ROUNDS {
            let mesh = s.finished(mesh);
            return Ok(Decimated { mesh, new_crossings: found.len(), repeated });
        }
        repeated += 1;
        let mut near = vec![false; all.len()];
        let corners = found.iter().flat_map(|&(t, u)| [left[t as usize], left[u as usize]]);
        corners.flatten().for_each(|v| near[v as usize] = true);
        for (v, &to) in all.iter().enumerate().filter(|(_, to)| near[**to as usize]) {
            most_members[v] = most_members[v].min(s.members[to as usize] / 4).max(1);
        }
    }
}

/// The vertices of triangles that cross others.
fn crossing_vertices(
    mesh: &PolyMesh,
    triangles: &[[u32; 3]],
    job: &Job,
) -> Result<Vec<bool>, Cancelled> {
    let mut out = vec![false; mesh.positions.len()];
    for (t, u) in self_intersection::pairs(&mesh.positions, triangles, job)? {
        for v in [triangles[t as usize], triangles[u as usize]].into_iter().flatten() {
            out[v as usize] = true;
        }
    }
    Ok(out)
}

/// Everything collapsed that may be.
fn collapsed(
    mesh: &PolyMesh,
    (triangles, regions): (&[[u32; 3]], &[u32]),
    most_members: &[u32],
    target: DecimationTarget,
    job: &Job,
) -> Result<CollapseSurface, Cancelled> {
    let middle = mesh
        .positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let middle =
        if mesh.positions.is_empty() { DVec3::ZERO } else { middle.0 / 2.0 + middle.1 / 2.0 };
    let mut s = CollapseSurface::of(mesh, triangles.to_vec(), regions.to_vec(), middle);
    s.most_members.copy_from_slice(most_members);
    let mut heap: BinaryHeap<CollapseCandidate> = BinaryHeap::new();
    let mut pairs: Vec<(u32, u32)> = s
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    for (i, (a, b)) in pairs.into_iter().enumerate() {
        if i.is_multiple_of(1 << 14) {
            job.check()?;
        }
        s.offer(a, b, target.error, &mut heap);
    }
    let start = s.triangles.len();
    let mut left = start;
    let mut steps = 0u32;
    while left > target.triangles {
        let Some(Reverse((_, a, b, stamp_a, stamp_b))) = heap.pop() else { break };
        steps = steps.wrapping_add(1);
        if steps.is_multiple_of(1 << 12) {
            job.check()?;
            job.progress((start - left) as f32 / (start - target.triangles).max(1) as f32);
        }
        if s.stamp[a as usize] != stamp_a || s.stamp[b as usize] != stamp_b {
            continue;
        }
        let (_, to) = s.best(a, b);
        if !s.allowed(a, b, to) {
            continue;
        }
        left -= s.collapse(a, b, to);
        let mut near: Vec<u32> = s.around[a as usize]
            .iter()
            .flat_map(|&t| s.triangles[t as usize])
            .filter(|&v| v != a)
            .collect();
        near.sort_unstable();
        near.dedup();
        for v in near {
            s.offer(a, v, target.error, &mut heap);
        }
    }
    // Crossings are looked for in the numbers that go out.
    s.positions.iter_mut().for_each(|p| *p += middle);
    if target.single {
        s.positions.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
    }
    Ok(s)
}

impl CollapseSurface {
    fn of(
        mesh: &PolyMesh,
        triangles: Vec<[u32; 3]>,
        regions: Vec<u32>,
        middle: DVec3,
    ) -> CollapseSurface {
        let n = mesh.positions.len();
        let mut s = CollapseSurface {
            positions: mesh.positions.iter().map(|&p| p - middle).collect(),
            alive: vec![true; triangles.len()],
            around: vec![Vec::new(); n],
            forms: vec![Quadric::default(); n],
            stamp: vec![0; n],
            fixed: vec![false; n],
            border: vec![false; n],
            regions,
            members: vec![1; n],
            most_members: vec![u32::MAX; n],
            joined: (0..n as u32).collect(),
            triangles,
        };
        let mut flat = PolyMesh::new();
        for (t, &corners) in s.triangles.iter().enumerate() {
            flat.push_face(&corners);
            let [a, b, c] = corners.map(|v| s.positions[v as usize]);
            let normal = (b - a).cross(c - a);
            let form = Quadric::plane(normal.normalize_or_zero(), a, normal.length() / 6.0);
            for v in corners {
                s.around[v as usize].push(t as u32);
                s.forms[v as usize].add(&form);
            }
        }
        for half_edges in EdgeTable::of(&flat).each() {
            let (u, v) = half_edges[0].ends;
            let upright = |corner: u32| {
                let [a, b, c] = s.triangles[corner as usize / 3].map(|v| s.positions[v as usize]);
                let (from, to) = (s.positions[u as usize], s.positions[v as usize]);
                let normal = (to - from).cross((b - a).cross(c - a)).normalize_or_zero();
                Quadric::plane(normal, from, (to - from).length_squared())
            };
            let region = |corner: u32| s.regions[corner as usize / 3];
            match half_edges {
                [one] => {
                    let form = upright(one.corner);
                    for v in [u, v] {
                        s.border[v as usize] = true;
                        s.forms[v as usize].add(&form);
                    }
                }
                [one, two] => {
                    if region(one.corner) != region(two.corner) {
                        for form in [upright(one.corner), upright(two.corner)] {
                            s.forms[u as usize].add(&form);
                            s.forms[v as usize].add(&form);
                        }
                    }
                }
                _ => {
                    s.fixed[u as usize] = true;
                    s.fixed[v as usize] = true;
                }
            }
        }
        // A collapse might join sheets that only touch, so such vertices stay.
        for v in 0..n {
            // Vertices where three regions meet, or where a border between two regions ends, stay.
            if !s.one_fan(v as u32) || !matches!(s.region_borders(v as u32), 0 | 2) {
                s.fixed[v] = true;
            }
        }
        s
    }

    /// The mesh of what is left.
    fn finished(&self, old: &PolyMesh) -> PolyMesh {
        let mut out = PolyMesh::new();
        out.positions.clone_from(&self.positions);
        out.colours.clone_from(&old.colours);
        let alive = || (0..self.triangles.len()).filter(|&t| self.alive[t]);
        alive().for_each(|t| out.push_face(&self.triangles[t]));
        out.groups = old.groups.as_ref().map(|_| alive().map(|t| self.regions[t] >> 1).collect());
        crate::repair::drop_unused(&mut out);
        out
    }

    /// The vertex that `v` was joined with in the end.
    fn stands_for(&self, mut v: u32) -> u32 {
        while self.joined[v as usize] != v {
            v = self.joined[v as usize];
        }
        v
    }

    /// Returns the number of edges between two regions that end at `v`.
    fn region_borders(&self, v: u32) -> usize {
        let around = &self.around[v as usize];
        let own = |t: u32| self.regions[t as usize];
        if around.iter().all(|&t| own(t) == own(around[0])) {
            return 0;
        }
        let each = around.iter().enumerate().flat_map(|(i, &t)| {
            around[i + 1..].iter().filter(move |&&u| {
                let other = self.triangles[u as usize];
                let mut corners = self.triangles[t as usize].iter();
                own(t) != own(u) && corners.any(|w| *w != v && other.contains(w))
            })
        });
        each.count()
    }

    /// Returns true if triangles of several regions meet at `v`.
    fn between_regions(&self, v: u32) -> bool {
        let around = &self.around[v as usize];
        around.iter().any(|&t| self.regions[t as usize] != self.regions[around[0] as usize])
    }

    /// Returns true if the triangles around `v` are connected by edges at `v`.
    fn one_fan(&self, v: u32) -> bool {
        let around = &self.around[v as usize];
        let Some(&first) = around.first() else { return true };
        let mut seen = vec![first];
        let mut at = 0;
        while at < seen.len() {
            let t = self.triangles[seen[at] as usize];
            at += 1;
            for &u in around {
                let shares =
                    self.triangles[u as usize].iter().filter(|w| **w != v && t.contains(w)).count();
                if shares > 0 && !seen.contains(&u) {
                    seen.push(u);
                }
            }
        }
        seen.len() == around.len()
    }

    fn best(&self, a: u32, b: u32) -> (f64, DVec3) {
        let mut form = self.forms[a as usize];
        form.add(&self.forms[b as usize]);
        let (pa, pb) = (self.positions[a as usize], self.positions[b as usize]);
        let length = pa.distance(pb);
        let least =
            form.least().filter(|p| p.is_finite() && p.distance((pa + pb) / 2.0) <= 2.0 * length);
        let [first, .., last] = [pa, (pa + pb) / 2.0, pb];
        let mut best = (form.at(first), first);
        for p in [Some((pa + pb) / 2.0), Some(last), least].into_iter().flatten() {
            let e = form.at(p);
            if e < best.0 {
                best = (e, p);
            }
        }
        // On a flat piece every place has the same error: short edges go first.
        (best.0 + 1e-9 * form.weight * length * length, best.1)
    }

    fn offer(&self, a: u32, b: u32, bound: f64, heap: &mut BinaryHeap<CollapseCandidate>) {
        let (a, b) = (a.min(b), a.max(b));
        if self.fixed[a as usize] || self.fixed[b as usize] {
            return;
        }
        let members = self.members[a as usize].saturating_add(self.members[b as usize]);
        if members > self.most_members[a as usize].min(self.most_members[b as usize]) {
            return;
        }
        let (cost, to) = self.best(a, b);
        let mut form = self.forms[a as usize];
        form.add(&self.forms[b as usize]);
        if !cost.is_finite() || form.at(to) > bound * bound * form.weight {
            return;
        }
        heap.push(Reverse((cost.to_bits(), a, b, self.stamp[a as usize], self.stamp[b as usize])));
    }

    /// Returns true if the edge can be collapsed to `to` without breaking or folding the surface.
    fn allowed(&self, a: u32, b: u32, to: DVec3) -> bool {
        let ring = |v: u32| {
            let mut r: Vec<u32> = self.around[v as usize]
                .iter()
                .flat_map(|&t| self.triangles[t as usize])
                .filter(|&w| w != v)
                .collect();
            r.sort_unstable();
            r.dedup();
            r
        };
        let shared: Vec<u32> = self.around[a as usize]
            .iter()
            .copied()
            .filter(|t| self.triangles[*t as usize].contains(&b))
            .collect();
        let inner = self.border[a as usize] && self.border[b as usize] && shared.len() == 2;
        // Nor may two borders between regions be joined across one of them.
        let regions: Vec<u32> = shared.iter().map(|&t| self.regions[t as usize]).collect();
        let across = regions.iter().all(|r| *r == regions[0])
            && self.between_regions(a)
            && self.between_regions(b);
        let rb = ring(b);
        let ra = ring(a);
        let common = ra.iter().filter(|v| rb.binary_search(v).is_ok()).count();
        // A tetrahedron has nothing to give; neither has a lone triangle.
        let all = ra
            .iter()
            .filter(|&&v| v != b)
            .chain(rb.iter().filter(|&&v| v != a))
            .collect::<std::collections::BTreeSet<_>>();
        if shared.is_empty()
            || inner
            || across
            || common != shared.len()
            || all.len() < shared.len() + 1
        {
            return false;
        }
        [a, b].iter().all(|&v| {
            self.around[v as usize].iter().filter(|t| !shared.contains(t)).all(|&t| {
                let corners = self.triangles[t as usize];
                let old = corners.map(|w| self.positions[w as usize]);
                let new = corners.map(|w| if w == v { to } else { self.positions[w as usize] });
                let normal = |p: [DVec3; 3]| (p[1] - p[0]).cross(p[2] - p[0]);
                let (was, is) = (normal(old), normal(new));
                let longest =
                    (0..3).map(|i| new[i].distance_squared(new[(i + 1) % 3])).fold(0.0, f64::max);
                // Upright enough, and no needle unless it was one.
                was.dot(is) >= 0.25 * was.length() * is.length()
                    && (is.length() > 0.02 * longest || is.length() >= was.length() * 0.9)
                    && is.length() > 0.0
            })
        })
    }

    /// Moves both ends to `to`, merging the higher into the lower; returns the number of triangles
    /// removed.
    fn collapse(&mut self, a: u32, b: u32, to: DVec3) -> usize {
        let mut gone = 0;
        let moved = std::mem::take(&mut self.around[b as usize]);
        for &t in &moved {
            if self.triangles[t as usize].contains(&a) {
                self.alive[t as usize] = false;
                gone += 1;
                for v in self.triangles[t as usize] {
                    if v != b {
                        self.around[v as usize].retain(|&u| u != t);
                    }
                }
            } else {
                for v in &mut self.triangles[t as usize] {
                    if *v == b {
                        *v = a;
                    }
                }
                self.around[a as usize].push(t);
            }
        }
        self.positions[a as usize] = to;
        let form = self.forms[b as usize];
        self.forms[a as usize].add(&form);
        self.border[a as usize] |= self.border[b as usize];
        self.members[a as usize] += self.members[b as usize];
        self.most_members[a as usize] =
            self.most_members[a as usize].min(self.most_members[b as usize]);
        self.joined[b as usize] = a;
        self.stamp[a as usize] += 1;
        self.stamp[b as usize] += 1;
        gone
    }
}

#[cfg(test)]
mod tests;

//! Fewer triangles, by quadric error metrics (QEM): edges are collapsed in the order of the error
//! that it makes (Garland and Heckbert, "Surface simplification using quadric error metrics",
//! 1997).
//!
//! A collapse is refused if it would break the surface (link condition: the edge's ends share
//! exactly the vertices opposite the edge), turn a triangle by more than about 75 degrees or make a
//! needle of it, or move the surface by more than the bound. Borders hold by planes set upright on
//! them. What was closed and manifold stays so.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DMat3, DVec3};

use super::PolyMesh;
use super::edges::EdgeTable;
use crate::job::{Cancelled, Job};

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct DecimationTarget {
    /// Stop at this many triangles.
    pub triangles: usize,
    /// And before the mean square distance to the planes that a vertex stands for exceeds this one
    /// squared, in the mesh's unit; infinity for no bound.
    pub error: f64,
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
}

/// Errors as bits: those of non-negative numbers sort as the numbers do.
type CollapseCandidate = Reverse<(u64, u32, u32, u32, u32)>;

/// Collapses edges of the mesh's triangles (polygons are cut first) until `target` is reached or
/// nothing more may go.
pub fn quadric(
    mesh: &PolyMesh,
    target: DecimationTarget,
    job: &Job,
) -> Result<PolyMesh, Cancelled> {
    let (triangles, _) = mesh.triangles();
    let middle = mesh
        .positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let middle =
        if mesh.positions.is_empty() { DVec3::ZERO } else { middle.0 / 2.0 + middle.1 / 2.0 };
    let mut s = CollapseSurface::of(mesh, triangles, middle);
    let mut heap: BinaryHeap<CollapseCandidate> = BinaryHeap::new();
    let mut pairs: Vec<(u32, u32)> = s
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    for (a, b) in pairs {
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
    let mut out = PolyMesh::new();
    out.positions = s.positions.iter().map(|&p| p + middle).collect();
    out.colours.clone_from(&mesh.colours);
    for (t, _) in s.triangles.iter().zip(&s.alive).filter(|(_, a)| **a) {
        out.push_face(t);
    }
    crate::repair::drop_unused(&mut out);
    Ok(out)
}

impl CollapseSurface {
    fn of(mesh: &PolyMesh, mut triangles: Vec<[u32; 3]>, middle: DVec3) -> CollapseSurface {
        triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        let n = mesh.positions.len();
        let mut s = CollapseSurface {
            positions: mesh.positions.iter().map(|&p| p - middle).collect(),
            alive: vec![true; triangles.len()],
            around: vec![Vec::new(); n],
            forms: vec![Quadric::default(); n],
            stamp: vec![0; n],
            fixed: vec![false; n],
            border: vec![false; n],
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
            match half_edges {
                [one] => {
                    let [a, b, c] =
                        s.triangles[one.corner as usize / 3].map(|v| s.positions[v as usize]);
                    let (from, to) = (s.positions[u as usize], s.positions[v as usize]);
                    let upright = (to - from).cross((b - a).cross(c - a)).normalize_or_zero();
                    let form = Quadric::plane(upright, from, (to - from).length_squared());
                    for v in [u, v] {
                        s.border[v as usize] = true;
                        s.forms[v as usize].add(&form);
                    }
                }
                [_, _] => {}
                _ => {
                    s.fixed[u as usize] = true;
                    s.fixed[v as usize] = true;
                }
            }
        }
        // Where sheets only touch, a collapse might join them: such vertices stay.
        for v in 0..n {
            if !s.one_fan(v as u32) {
                s.fixed[v] = true;
            }
        }
        s
    }

    /// Whether the triangles around `v` hang together by edges at `v`.
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
        let (cost, to) = self.best(a, b);
        let mut form = self.forms[a as usize];
        form.add(&self.forms[b as usize]);
        if !cost.is_finite() || form.at(to) > bound * bound * form.weight {
            return;
        }
        heap.push(Reverse((cost.to_bits(), a, b, self.stamp[a as usize], self.stamp[b as usize])));
    }

    /// Whether the edge may go to `to` without breaking or folding the surface.
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
        let rb = ring(b);
        let ra = ring(a);
        let common = ra.iter().filter(|v| rb.binary_search(v).is_ok()).count();
        // A tetrahedron has nothing to give; neither has a lone triangle.
        let all = ra
            .iter()
            .filter(|&&v| v != b)
            .chain(rb.iter().filter(|&&v| v != a))
            .collect::<std::collections::BTreeSet<_>>();
        if shared.is_empty() || inner || common != shared.len() || all.len() < shared.len() + 1 {
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

    /// Moves both ends to `to`, the higher into the lower; returns how many triangles went.
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
        self.stamp[a as usize] += 1;
        self.stamp[b as usize] += 1;
        gone
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::report;
    use crate::shapes::{cuboid, grid, icosphere, torus};
    use crate::subdivide::loop_;

    fn down(mesh: &PolyMesh, triangles: usize, error: f64) -> PolyMesh {
        quadric(mesh, DecimationTarget { triangles, error }, &Job::default()).unwrap()
    }

    #[test]
    fn a_ball_stays_a_ball_and_a_ring_a_ring() {
        let job = Job::default();
        let ball = icosphere(1.0, 30).to_poly();
        let few = report(&down(&ball, 600, f64::INFINITY), true, &job).unwrap();
        assert!(
            few.closed && few.manifold && few.genus == Some(0) && few.triangles <= 600,
            "{few:?}"
        );
        assert_eq!(few.self_intersections, Some(0));
        let sphere = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((few.volume.unwrap() - sphere).abs() < 0.02 * sphere, "{few:?}");
        let ring = report(&down(&torus(3., 1., 80, 40), 300, f64::INFINITY), true, &job).unwrap();
        assert!(
            ring.closed && ring.manifold && ring.genus == Some(1) && ring.triangles <= 300,
            "{ring:?}"
        );
    }

    #[test]
    fn flat_faces_cost_nothing_and_the_bound_holds_the_edges() {
        let cube = cuboid(DVec3::ZERO, DVec3::ONE);
        let mut fine = cube;
        // Cut only, not smoothed: each level halves every edge.
        for _ in 0..4 {
            let sharp = loop_(&fine, 1, &Job::default()).unwrap();
            let mut middle = sharp.clone();
            let (tri, _) = fine.triangulate();
            for (v, p) in fine.positions.iter().enumerate() {
                middle.positions[v] = *p;
            }
            let flat = PolyMesh {
                corners: tri.triangles.iter().flatten().copied().collect(),
                face_starts: (0..=tri.triangles.len() as u32).map(|t| t * 3).collect(),
                positions: fine.positions.clone(),
                ..PolyMesh::new()
            };
            for (e, s) in EdgeTable::of(&flat).each().enumerate() {
                let (u, v) = s[0].ends;
                middle.positions[fine.positions.len() + e] =
                    (fine.positions[u as usize] + fine.positions[v as usize]) / 2.0;
            }
            fine = middle;
        }
        assert_eq!(fine.face_count(), 12 * 256);
        let r = report(&down(&fine, 0, 1e-6), true, &Job::default()).unwrap();
        assert!(r.closed && r.manifold && r.triangles <= 40, "{r:?}");
        assert!((r.volume.unwrap() - 1.0).abs() < 1e-6 && (r.area - 6.0).abs() < 1e-5, "{r:?}");
        let sheet = report(&down(&grid(2., 3., 20, 20), 0, 1e-6), true, &Job::default()).unwrap();
        assert!((sheet.area - 6.0).abs() < 1e-6 && sheet.triangles <= 20, "{sheet:?}");
    }
}

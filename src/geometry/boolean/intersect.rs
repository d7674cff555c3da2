//! Where two surfaces intersect: points of one on vertices, edges and faces of the other, each
//! computed once and shared by all triangles around it; then the segments that cut each triangle.

use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord3D, orient3d};

use super::points::{Map, PointSet};
use crate::job::{Cancelled, Job};

/// The marks that the other surface leaves on one triangle.
#[derive(Debug, Default, Clone)]
pub struct TriangleMarks {
    /// Points within it.
    pub inner: Vec<u32>,
    /// Cuts through it, between points of its border or within it.
    pub segments: Vec<(u32, u32)>,
    /// True if it coincides, within the tolerance, with a face of the other side.
    pub flat: bool,
}

/// An edge of a triangle, and the points on it.
#[derive(Debug)]
pub struct CutEdge {
    /// The lesser point first.
    pub ends: [u32; 2],
    /// From `ends[0]` to `ends[1]`, once sorted.
    pub inner: Vec<u32>,
}

/// Everything that the two surfaces have in common.
#[derive(Debug, Default)]
pub struct Intersections {
    /// Numbers of the edges, by their ends.
    pub edge_ids: Map<(u32, u32), u32>,
    /// Every edge of a triangle that may be crossed.
    pub edges: Vec<CutEdge>,
    /// Triangle to its marks, a side each.
    pub marks: [Map<u32, TriangleMarks>; 2],
    /// Pieces of the curve in which the surfaces meet, lesser end first: between two points that
    /// both have, and nothing between.
    pub curve: Map<(u32, u32), ()>,
    /// Points on both surfaces; one a point.
    pub shared: Vec<bool>,
}

/// A point as `robust` takes it.
pub fn c3(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// Pairs that one thread looks at before another may take some.
const PAIRS: usize = 512;

/// One triangle of each surface: whose marks they have, their numbers, corners and edges.
struct TrianglePair {
    sides: [usize; 2],
    ids: [u32; 2],
    corners: [[u32; 3]; 2],
    edges: [[u32; 3]; 2],
}

/// The points of triangles with many, sorted, by side and triangle.
#[derive(Default)]
struct SortedPoints(Map<(u32, u32), Vec<u32>>);

/// More points of a triangle are sorted.
const MANY_POINTS: usize = 24;

struct Finder<'a> {
    points: &'a mut PointSet,
    eps: f64,
    /// Whose marks the triangles of a pair have: their own operand's, or both the first's.
    sides: [usize; 2],
    m: Intersections,
    crossings: Map<(u32, u32), Option<u32>>,
    piercings: Map<(u32, u32, u32), Option<u32>>,
}

/// Intersects the triangles of the pairs (ascending).
pub fn intersect(
    triangles: [&[[u32; 3]]; 2],
    mut pairs: Vec<(u32, u32)>,
    points: &mut PointSet,
    eps: f64,
    job: &Job,
) -> Result<Intersections, Cancelled> {
    let [a, b] = triangles;
    let at = &points.at;
    // The plane of a triangle in several pairs is computed once.
    let several = pairs.len() > 2 * b.len();
    let planes: Vec<(DVec3, DVec3)> =
        if several { b.iter().map(|&t| plane(at, t)).collect() } else { Vec::new() };
    let near = |group: &[(u32, u32)], out: &mut Vec<(u32, u32)>| {
        let s = a[group[0].0 as usize];
        let own = plane(at, s);
        out.extend(group.iter().filter(|&&(_, j)| {
            let t = b[j as usize];
            near_plane(at, own, t, eps)
                && {
                    let other = planes.get(j as usize).copied();
                    near_plane(at, other.unwrap_or_else(|| plane(at, t)), s, eps)
                }
                && !beside(at, s, t, eps)
                && !beside(at, t, s, eps)
        }));
    };
    pairs = by_first(&pairs, near);
    job.check()?;
    met(triangles, &pairs, [0, 1], points, eps, job)
}

/// Intersects the triangles of one surface with each other; the lower triangle of a pair comes
/// first. All marks are those of the first side. Cuts may go through each other.
pub fn intersect_itself(
    triangles: &[[u32; 3]],
    mut pairs: Vec<(u32, u32)>,
    points: &mut PointSet,
    eps: f64,
    job: &Job,
) -> Result<Intersections, Cancelled> {
    let at = &points.at;
    let near = |&(i, j): &(u32, u32)| {
        let (s, t) = (triangles[i as usize], triangles[j as usize]);
        let apart = |s, t| beyond_shared(at, s, t, eps) || beside(at, s, t, eps);
        near_plane(at, plane(at, s), t, eps)
            && near_plane(at, plane(at, t), s, eps)
            && !apart(s, t)
            && !apart(t, s)
    };
    pairs = pairs.into_par_iter().with_min_len(PAIRS).filter(near).collect();
    job.check()?;
    met([triangles, triangles], &pairs, [0, 0], points, eps, job)
}

fn met(
    [a, b]: [&[[u32; 3]]; 2],
    pairs: &[(u32, u32)],
    sides: [usize; 2],
    points: &mut PointSet,
    eps: f64,
    job: &Job,
) -> Result<Intersections, Cancelled> {
    let mut f = Finder {
        points,
        eps,
        sides,
        m: Intersections::default(),
        crossings: Map::default(),
        piercings: Map::default(),
    };
    // Edges of the triangles of each pair. Pairs with one first triangle follow each other.
    let mut edges: Vec<[[u32; 3]; 2]> = Vec::with_capacity(pairs.len());
    for (n, &(i, j)) in pairs.iter().enumerate() {
        if n % 1024 == 0 {
            job.check()?;
        }
        let (s, t) = (a[i as usize], b[j as usize]);
        let own = match edges.last() {
            Some(last) if pairs[n - 1].0 == i => last[0],
            _ => f.edges(s),
        };
        edges.push([own, f.edges(t)]);
        f.events([i, j], [s, t], edges[n]);
    }
    let mut m = f.m;
    for e in &mut m.edges {
        let [p, q] = e.ends;
        let (o, d) = (points.at[p as usize], points.at[q as usize] - points.at[p as usize]);
        let along = |i: u32| (points.at[i as usize] - o).dot(d);
        e.inner.sort_unstable_by(|&x, &y| along(x).total_cmp(&along(y)).then(x.cmp(&y)));
        e.inner.dedup();
        e.inner.retain(|&i| i != p && i != q);
    }
    m.shared.resize(points.at.len(), false);
    let mut sorted = SortedPoints::default();
    for (n, &(i, j)) in pairs.iter().enumerate() {
        if n % 1024 == 0 {
            job.check()?;
        }
        let pair = TrianglePair {
            sides,
            ids: [i, j],
            corners: [a[i as usize], b[j as usize]],
            edges: edges[n],
        };
        m.segments(&points.at, &pair, eps, &mut sorted);
    }
    Ok(m)
}

/// Calls `keep` with all pairs of one first triangle at a time; returns the pairs that it appends.
fn by_first(
    pairs: &[(u32, u32)],
    keep: impl Fn(&[(u32, u32)], &mut Vec<(u32, u32)>) + Sync,
) -> Vec<(u32, u32)> {
    let of = |part: &[(u32, u32)]| -> Vec<(u32, u32)> {
        let mut out = Vec::new();
        part.chunk_by(|p, q| p.0 == q.0).for_each(|group| keep(group, &mut out));
        out
    };
    if pairs.len() <= 8 * PAIRS {
        return of(pairs);
    }
    pairs.par_chunks(PAIRS).map(of).collect::<Vec<_>>().concat()
}

/// A place in the plane of a triangle, and its normal.
fn plane(at: &[DVec3], t: [u32; 3]) -> (DVec3, DVec3) {
    let [a, b, c] = t.map(|i| at[i as usize]);
    (a, (b - a).cross(c - a).normalize_or_zero())
}

/// Whether `t` reaches a plane.
fn near_plane(at: &[DVec3], (a, n): (DVec3, DVec3), t: [u32; 3], eps: f64) -> bool {
    let d = t.map(|i| (at[i as usize] - a).dot(n));
    d.iter().any(|&x| x <= 2.0 * eps) && d.iter().any(|&x| x >= -2.0 * eps)
}

/// Returns true if triangles that share corners have nothing else in common. The other corners of
/// `t` are then beyond the plane of `s`, all on one side, or in it and beyond the common edge.
fn beyond_shared(at: &[DVec3], s: [u32; 3], t: [u32; 3], eps: f64) -> bool {
    if !t.iter().any(|v| s.contains(v)) {
        return false;
    }
    let [a, b, c] = s.map(|i| at[i as usize]);
    let n = (b - a).cross(c - a).normalize_or_zero();
    let mut heights = t.iter().filter(|v| !s.contains(v)).map(|&v| (at[v as usize] - a).dot(n));
    let first = heights.next().unwrap_or(0.0);
    if heights.chain([first]).all(|h| h * first > 0.0 && h.abs() > 2.0 * eps) {
        return true;
    }
    (0..3).any(|k| {
        let (i, j, other) = (s[k], s[(k + 1) % 3], s[(k + 2) % 3]);
        let third = t.iter().find(|v| !s.contains(v));
        let (Some(&third), true) = (third, t.contains(&i) && t.contains(&j)) else { return false };
        let (o, d) = (at[i as usize], at[j as usize] - at[i as usize]);
        let side = d.cross(n).normalize_or_zero();
        let far = |v: u32| (at[v as usize] - o).dot(side);
        far(third) * far(other) < 0.0 && far(third).abs() > 2.0 * eps
    })
}

/// Returns true if `t` is beyond an edge of `s`, seen along the normal of `s`, by more than any
/// length compared with the tolerance. Among coplanar triangles, as in fans around the holes of a
/// flat face, thousands have boxes that meet and nothing else.
fn beside(at: &[DVec3], s: [u32; 3], t: [u32; 3], eps: f64) -> bool {
    let [a, b, c] = s.map(|i| at[i as usize]);
    let n = (b - a).cross(c - a);
    let other = t.map(|i| at[i as usize]);
    // From each edge outwards.
    [(a, b), (b, c), (c, a)].iter().any(|&(o, p)| {
        let out = (p - o).cross(n);
        let far = 8.0 * eps * out.length();
        far > 0.0 && other.iter().all(|&q| (q - o).dot(out) > far)
    })
}

/// `p`, with the coordinates that all of `of` have in common exactly: what is computed on a face or
/// an edge along the axes stays on it.
pub(super) fn kept(mut p: DVec3, of: &[DVec3]) -> DVec3 {
    for axis in 0..3 {
        if of.iter().all(|q| q[axis] == of[0][axis]) {
            p[axis] = of[0][axis];
        }
    }
    p
}

impl Finder<'_> {
    fn edge(&mut self, a: u32, b: u32) -> u32 {
        let key = (a.min(b), a.max(b));
        let next = self.m.edges.len() as u32;
        let id = *self.m.edge_ids.entry(key).or_insert(next);
        if id == next {
            self.m.edges.push(CutEdge { ends: [key.0, key.1], inner: Vec::new() });
        }
        id
    }

    fn p(&self, i: u32) -> DVec3 {
        self.points.at[i as usize]
    }

    fn on_edge(&mut self, p: u32, e: u32) -> bool {
        let [a, b] = self.m.edges[e as usize].ends;
        if p == a || p == b {
            return false;
        }
        let (o, d, x) = (self.p(a), self.p(b) - self.p(a), self.p(p));
        let t = (x - o).dot(d) / d.length_squared();
        t > 0.0 && t < 1.0 && self.points.contact.compared((o + d * t).distance(x), self.eps)
    }

    fn edges(&mut self, t: [u32; 3]) -> [u32; 3] {
        [self.edge(t[0], t[1]), self.edge(t[1], t[2]), self.edge(t[2], t[0])]
    }

    fn events(&mut self, ids: [u32; 2], tris: [[u32; 3]; 2], edges: [[u32; 3]; 2]) {
        let mut touch = [[[false; 3]; 3]; 2];
        let mut lies = [[false; 3]; 2];
        for s in 0..2 {
            self.m.marks[self.sides[s]].entry(ids[s]).or_default();
            let o = 1 - s;
            for v in 0..3 {
                let p = tris[s][v];
                if tris[o].contains(&p) {
                    continue;
                }
                let mut any = false;
                for k in 0..3 {
                    if self.on_edge(p, edges[o][k]) {
                        self.m.edges[edges[o][k] as usize].inner.push(p);
                        touch[s][v][k] = true;
                        any = true;
                    }
                }
                lies[s][v] = any || self.in_face(p, tris[o]);
                if lies[s][v] && !any {
                    self.m.marks[self.sides[o]].entry(ids[o]).or_default().inner.push(p);
                }
            }
        }
        let mut crossed = [[false; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let (a, b) = (edges[0][i], edges[1][j]);
                if a == b
                    || touch[0][i][j]
                    || touch[0][(i + 1) % 3][j]
                    || touch[1][j][i]
                    || touch[1][(j + 1) % 3][i]
                {
                    crossed[i][j] = true;
                    continue;
                }
                if let Some(p) = self.crossing_point(a, b) {
                    crossed[i][j] = true;
                    self.m.edges[a as usize].inner.push(p);
                    self.m.edges[b as usize].inner.push(p);
                }
            }
        }
        for s in 0..2 {
            let o = 1 - s;
            for i in 0..3 {
                let met = (0..3).any(|j| if s == 0 { crossed[i][j] } else { crossed[j][i] });
                if !met && !lies[s][i] && !lies[s][(i + 1) % 3] {
                    self.pierce(s, edges[s][i], ids[o], tris[o]);
                }
            }
        }
    }

    /// The point where two edges cross, within the tolerance.
    fn crossing_point(&mut self, a: u32, b: u32) -> Option<u32> {
        let (ea, eb) = (self.m.edges[a as usize].ends, self.m.edges[b as usize].ends);
        if ea.contains(&eb[0]) || ea.contains(&eb[1]) {
            return None;
        }
        if let Some(&known) = self.crossings.get(&(a, b)) {
            return known;
        }
        let (o, u) = (self.p(ea[0]), self.p(ea[1]) - self.p(ea[0]));
        let (q, v) = (self.p(eb[0]), self.p(eb[1]) - self.p(eb[0]));
        let n = u.cross(v);
        let (nn, w) = (n.length_squared(), q - o);
        if nn <= 1e-24 * u.length_squared() * v.length_squared() {
            return None;
        }
        let gap = w.dot(n);
        let distance = gap.abs() / nn.sqrt();
        if distance > 4.0 * self.eps {
            return None;
        }
        let s = w.cross(v).dot(n) / nn;
        let t = w.cross(u).dot(n) / nn;
        if !(s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0) {
            return None;
        }
        if !self.points.contact.compared(distance, self.eps) {
            return None;
        }
        let middle = (o + u * s + q + v * t) * 0.5;
        let [on_a, on_b] = [ea, eb].map(|e| e.map(|i| self.p(i)));
        let p = self.points.point(kept(kept(middle, &on_b), &on_a));
        self.crossings.insert((a, b), Some(p));
        Some(p)
    }

    /// Finds the point where an edge of side `s` goes through the inside of triangle `t`.
    fn pierce(&mut self, s: usize, e: u32, id: u32, t: [u32; 3]) {
        let ends = self.m.edges[e as usize].ends;
        if t.contains(&ends[0]) || t.contains(&ends[1]) {
            return;
        }
        let key = (self.sides[s] as u32, e, id);
        let found = match self.piercings.get(&key) {
            Some(&k) => k,
            None => {
                let [a, b, c] = t.map(|i| self.p(i));
                let (p, q) = (self.p(ends[0]), self.p(ends[1]));
                let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                if !(p.min(q).cmple(high) & low.cmple(p.max(q))).all() {
                    return;
                }
                let height = |x: DVec3| orient3d(c3(a), c3(b), c3(c), c3(x));
                let turn = |i: DVec3, j: DVec3| orient3d(c3(p), c3(q), c3(i), c3(j));
                let (x, y) = (height(p), height(q));
                // Ends on the triangle are found elsewhere; all other cases are decided exactly.
                let through = (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
                let inside = through && {
                    let w = [turn(a, b), turn(b, c), turn(c, a)];
                    w.iter().all(|&x| x > 0.0) || w.iter().all(|&x| x < 0.0)
                };
                let k = inside.then(|| {
                    let place = p + (q - p) * (x / (x - y));
                    self.points.point(kept(place, &[a, b, c]))
                });
                self.piercings.insert(key, k);
                k
            }
        };
        if let Some(p) = found {
            self.m.edges[e as usize].inner.push(p);
            self.m.marks[self.sides[1 - s]].entry(id).or_default().inner.push(p);
        }
    }

    fn in_face(&mut self, p: u32, t: [u32; 3]) -> bool {
        let [a, b, c] = t.map(|i| self.p(i));
        let (n, x) = ((b - a).cross(c - a), self.p(p));
        let distance = (x - a).dot(n).abs() / n.length().max(f64::MIN_POSITIVE);
        distance <= 4.0 * self.eps
            && [(a, b), (b, c), (c, a)].iter().all(|&(i, j)| (j - i).cross(x - i).dot(n) > 0.0)
            && self.points.contact.compared(distance, self.eps)
    }
}

impl Intersections {
    /// The number of an edge, whichever way it runs.
    pub fn edge_of(&self, a: u32, b: u32) -> Option<u32> {
        self.edge_ids.get(&(a.min(b), a.max(b))).copied()
    }

    /// The points that the other surface leaves within a triangle.
    fn inner(&self, pair: &TrianglePair, s: usize) -> &[u32] {
        self.marks[pair.sides[s]].get(&pair.ids[s]).map_or(&[], |m| &m.inner)
    }

    /// The points of a triangle: its corners, on its edges, and inside; some more than once.
    fn closure(&self, pair: &TrianglePair, s: usize) -> impl Iterator<Item = u32> {
        let on = pair.edges[s].into_iter().flat_map(|e| &self.edges[e as usize].inner);
        pair.corners[s].into_iter().chain(on.chain(self.inner(pair, s)).copied())
    }

    /// The points that two triangles share, in order. A face that many others cut has many points:
    /// they are sorted once, and those of the other triangle are looked for among them.
    fn common(&self, pair: &TrianglePair, sorted: &mut SortedPoints) -> Vec<u32> {
        let count = |s: usize| {
            let on = pair.edges[s].iter().map(|&e| self.edges[e as usize].inner.len());
            3 + on.sum::<usize>() + self.inner(pair, s).len()
        };
        let counts = [count(0), count(1)];
        let fewer = usize::from(counts[1] < counts[0]);
        let more = 1 - fewer;
        let mut out: Vec<u32> = if counts[more] > MANY_POINTS {
            let key = (pair.sides[more] as u32, pair.ids[more]);
            let all = sorted.0.entry(key).or_insert_with(|| {
                let mut all: Vec<u32> = self.closure(pair, more).collect();
                all.sort_unstable();
                all
            });
            self.closure(pair, fewer).filter(|i| all.binary_search(i).is_ok()).collect()
        } else {
            let has = |i: &u32| self.closure(pair, more).any(|j| j == *i);
            self.closure(pair, fewer).filter(has).collect()
        };
        out.sort_unstable();
        out.dedup();
        out
    }

    /// Returns true if both points are on the same edge of the triangle.
    fn on_one_edge(&self, edges: [u32; 3], p: u32, q: u32) -> bool {
        edges.into_iter().any(|e| {
            let e = &self.edges[e as usize];
            let on = |x: u32| e.ends.contains(&x) || e.inner.contains(&x);
            on(p) && on(q)
        })
    }

    fn segments(&mut self, at: &[DVec3], pair: &TrianglePair, eps: f64, sorted: &mut SortedPoints) {
        let TrianglePair { sides, ids, .. } = *pair;
        let mut x = self.common(pair, sorted);
        for &i in &x {
            self.shared[i as usize] = true;
        }
        if x.len() < 2 {
            return;
        }
        // The farthest two, and whether the others are on their line.
        let mut far = (0.0, x[0], x[1]);
        for (n, &i) in x.iter().enumerate() {
            for &j in &x[n + 1..] {
                let d = at[i as usize].distance_squared(at[j as usize]);
                if d > far.0 {
                    far = (d, i, j);
                }
            }
        }
        let o = at[far.1 as usize];
        let d = (at[far.2 as usize] - o) / far.0.sqrt();
        let straight = x.iter().all(|&i| {
            let w = at[i as usize] - o;
            (w - d * w.dot(d)).length() <= 4.0 * eps
        });
        let mut found: [Vec<(u32, u32)>; 2] = Default::default();
        let chain = |list: &mut Vec<u32>, d: DVec3, out: &mut Vec<(u32, u32)>| {
            list.sort_by(|&i, &j| {
                at[i as usize].dot(d).total_cmp(&at[j as usize].dot(d)).then(i.cmp(&j))
            });
            out.extend(list.windows(2).map(|w| (w[0], w[1])));
        };
        if straight {
            chain(&mut x, d, &mut found[0]);
            found[1] = found[0].clone();
        } else {
            for s in 0..2 {
                self.marks[sides[s]].entry(ids[s]).or_default().flat = true;
                for e in pair.edges[1 - s] {
                    let e = &self.edges[e as usize];
                    let mut on: Vec<u32> = x
                        .iter()
                        .copied()
                        .filter(|i| e.ends.contains(i) || e.inner.contains(i))
                        .collect();
                    let d = at[e.ends[1] as usize] - at[e.ends[0] as usize];
                    chain(&mut on, d, &mut found[s]);
                }
            }
        }
        for s in 0..2 {
            for (p, q) in std::mem::take(&mut found[s]) {
                self.curve.insert((p.min(q), p.max(q)), ());
                if !self.on_one_edge(pair.edges[s], p, q) {
                    let own = self.marks[sides[s]].entry(ids[s]).or_default();
                    own.segments.push((p.min(q), p.max(q)));
                }
            }
        }
    }
}

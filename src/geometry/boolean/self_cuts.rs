//! The cuts of a surface at itself, each divided where it goes through another cut.
//!
//! Where three triangles go through each other, their three cuts have one point in common. It is
//! computed once, in the triangle that finds it first, and is then a point of all three cuts, so
//! that every triangle around it has the same corners there (Zhou, Grinspun, Zorin and Jacobson,
//! "Mesh arrangements for solid geometry", 2016, resolve the same in exact numbers).

use glam::DVec3;
use robust::{Coord, orient2d};

use super::intersect::{Intersections, kept};
use super::planar::flatten;
use super::points::{Map, PointSet};
use crate::job::{Cancelled, Job};

/// The number of rounds that snap points to nearby lines: each may bring other points near.
const ROUNDS: usize = 4;

/// A piece of the line in which two triangles meet.
#[derive(Debug)]
struct CutLine {
    /// The lesser point first.
    ends: [u32; 2],
    /// From the first end to the second, once sorted.
    inner: Vec<u32>,
    /// Triangles that it runs through.
    of: Vec<u32>,
}

/// All cuts of a surface at itself.
#[derive(Debug)]
pub struct SelfCuts {
    lines: Vec<CutLine>,
    /// The cuts through each triangle that has some.
    of: Map<u32, Vec<u32>>,
}

impl SelfCuts {
    /// The cuts that were found, divided at each other. Points are added to `points`, and to the
    /// edges along which cuts run.
    pub fn divided(
        triangles: &[[u32; 3]],
        m: &mut Intersections,
        points: &mut PointSet,
        eps: f64,
        job: &Job,
    ) -> Result<SelfCuts, Cancelled> {
        let mut cut: Vec<u32> =
            m.marks[0].iter().filter(|k| !k.1.segments.is_empty()).map(|k| *k.0).collect();
        cut.sort_unstable();
        let mut all = SelfCuts { lines: Vec::new(), of: Map::default() };
        let mut known: Map<(u32, u32), u32> = Map::default();
        for &t in &cut {
            let mut own = Vec::new();
            for &(a, b) in &m.marks[0][&t].segments {
                let next = all.lines.len() as u32;
                let id = *known.entry((a, b)).or_insert(next);
                if id == next {
                    all.lines.push(CutLine { ends: [a, b], inner: Vec::new(), of: Vec::new() });
                }
                let line = &mut all.lines[id as usize];
                if line.of.last() != Some(&t) {
                    line.of.push(t);
                    own.push(id);
                }
            }
            all.of.insert(t, own);
        }
        let mut triple: Map<[u32; 3], u32> = Map::default();
        for (n, &t) in cut.iter().enumerate() {
            if n % 256 == 0 {
                job.check()?;
            }
            all.divide(t, triangles[t as usize], points, &mut triple, eps);
        }
        for _ in 0..ROUNDS {
            let mut more = false;
            for &t in &cut {
                more |= all.settle(t, triangles[t as usize], m, points, eps);
            }
            job.check()?;
            if !more {
                break;
            }
        }
        all.sort(&points.at);
        all.share_with_edges(m, points);
        Ok(all)
    }

    /// The cuts through a triangle, in pieces between the points on them.
    pub fn through(&self, t: u32) -> Vec<(u32, u32)> {
        let mut out = Vec::new();
        for &id in self.of.get(&t).into_iter().flatten() {
            let line = &self.lines[id as usize];
            let mut from = line.ends[0];
            for &v in line.inner.iter().chain(&line.ends[1..]) {
                out.push((from, v));
                from = v;
            }
        }
        out
    }

    /// Finds where the cuts through `t` meet, by a sweep over their boxes.
    fn divide(
        &mut self,
        t: u32,
        corners: [u32; 3],
        points: &mut PointSet,
        triple: &mut Map<[u32; 3], u32>,
        eps: f64,
    ) {
        let own = self.of[&t].clone();
        if own.len() < 2 {
            return;
        }
        let [a, b, c] = corners.map(|v| points.at[v as usize]);
        let flat = flatten((b - a).cross(c - a));
        let span = |id: u32| {
            let [p, q] = self.lines[id as usize].ends.map(|v| flat(points.at[v as usize]));
            let (lo, hi) = (p.x.min(q.x) - eps, p.x.max(q.x) + eps);
            (lo, hi, p.y.min(q.y) - eps, p.y.max(q.y) + eps, id)
        };
        let mut spans: Vec<_> = own.iter().map(|&id| span(id)).collect();
        spans.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.4.cmp(&y.4)));
        for (i, s) in spans.iter().enumerate() {
            for u in spans[i + 1..].iter().take_while(|u| u.0 <= s.1) {
                if u.2 <= s.3 && s.2 <= u.3 {
                    self.intersect_cuts(
                        t,
                        [s.4.min(u.4), s.4.max(u.4)],
                        &flat,
                        points,
                        triple,
                        eps,
                    );
                }
            }
        }
    }

    fn intersect_cuts(
        &mut self,
        t: u32,
        two: [u32; 2],
        flat: &impl Fn(DVec3) -> Coord<f64>,
        points: &mut PointSet,
        triple: &mut Map<[u32; 3], u32>,
        eps: f64,
    ) {
        let ends = two.map(|id| self.lines[id as usize].ends);
        let at = |v: u32| points.at[v as usize];
        let mut touched = ends[0].iter().any(|v| ends[1].contains(v));
        for s in 0..2 {
            let [p, q] = ends[s];
            let (o, d) = (at(p), at(q) - at(p));
            for v in ends[1 - s].into_iter().filter(|v| *v != p && *v != q) {
                let along = (at(v) - o).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
                if along > 0.0 && along < 1.0 && (o + d * along).distance(at(v)) <= eps {
                    self.lines[two[s] as usize].inner.push(v);
                    touched = true;
                }
            }
        }
        if touched {
            return;
        }
        let [a, b] = ends[0].map(|v| flat(at(v)));
        let [c, d] = ends[1].map(|v| flat(at(v)));
        let turns = [orient2d(c, d, a), orient2d(c, d, b), orient2d(a, b, c), orient2d(a, b, d)];
        let parted = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
        if !parted(turns[0], turns[1]) || !parted(turns[2], turns[3]) {
            return;
        }
        let [first, second] = ends.map(|e| e.map(at));
        let place = first[0] + (first[1] - first[0]) * (turns[0] / (turns[0] - turns[1]));
        let place = kept(kept(place, &second), &first);
        // The triangles that the cuts are made by, where each is one.
        let others = two.map(|id| self.lines[id as usize].of.iter().copied().find(|o| *o != t));
        let point = match others {
            [Some(x), Some(y)] if x != y => {
                let mut key = [t, x, y];
                key.sort_unstable();
                let third = self.between(x, y, place, points);
                let point = *triple.entry(key).or_insert_with(|| points.point(place));
                if let Some(third) = third {
                    self.lines[third as usize].inner.push(point);
                }
                point
            }
            _ => points.point(place),
        };
        for id in two {
            self.lines[id as usize].inner.push(point);
        }
    }

    /// Puts each point on a line of `t`, and on its border, on every other line and edge of it that
    /// is within the tolerance: lines of faces in one plane lie upon each other. Whether any was.
    fn settle(
        &mut self,
        t: u32,
        corners: [u32; 3],
        m: &mut Intersections,
        points: &PointSet,
        eps: f64,
    ) -> bool {
        let at = |v: u32| points.at[v as usize];
        let own = self.of[&t].clone();
        let edges = [0, 1, 2].map(|k| m.edge_of(corners[k], corners[(k + 1) % 3]));
        // Lines, then edges: whether it is an edge, its number, its ends.
        let mut ways: Vec<(bool, u32, [u32; 2])> =
            own.iter().map(|&id| (false, id, self.lines[id as usize].ends)).collect();
        ways.extend(edges.iter().flatten().map(|&e| (true, e, m.edges[e as usize].ends)));
        let on = |s: &SelfCuts, m: &Intersections, &(edge, id, ends): &(bool, u32, [u32; 2])| {
            let inner =
                if edge { &m.edges[id as usize].inner } else { &s.lines[id as usize].inner };
            ends.iter().chain(inner).copied().collect::<Vec<u32>>()
        };
        let mut spots: Vec<u32> = ways.iter().flat_map(|w| on(self, m, w)).collect();
        spots.sort_unstable();
        spots.dedup();
        spots.sort_by(|&a, &b| at(a).x.total_cmp(&at(b).x));
        let mut any = false;
        for way in &ways {
            let (p, q) = (at(way.2[0]), at(way.2[1]));
            let (lo, hi) = (p.min(q) - eps, p.max(q) + eps);
            let first = spots.partition_point(|&v| at(v).x < lo.x);
            let known = on(self, m, way);
            for &v in spots[first..].iter().take_while(|v| at(**v).x <= hi.x) {
                let x = at(v);
                if !(x.cmpge(lo).all() && x.cmple(hi).all()) || known.contains(&v) {
                    continue;
                }
                let d = q - p;
                let along = (x - p).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
                if along > 0.0 && along < 1.0 && (p + d * along).distance(x) <= eps {
                    any = true;
                    match way.0 {
                        true => m.edges[way.1 as usize].inner.push(v),
                        false => self.lines[way.1 as usize].inner.push(v),
                    }
                }
            }
        }
        any
    }

    /// The cut of two triangles at each other that is nearest to a place.
    fn between(&self, x: u32, y: u32, place: DVec3, points: &PointSet) -> Option<u32> {
        let distance = |id: u32| {
            let [p, q] = self.lines[id as usize].ends.map(|v| points.at[v as usize]);
            let d = q - p;
            let along = (place - p).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
            (along > 0.0 && along < 1.0).then(|| (p + d * along).distance_squared(place))
        };
        let common = self.of.get(&x)?.iter().copied();
        common
            .filter(|id| self.lines[*id as usize].of.contains(&y))
            .filter_map(|id| distance(id).map(|d| (d, id)))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .map(|found| found.1)
    }

    fn sort(&mut self, at: &[DVec3]) {
        for line in &mut self.lines {
            sort_along(line.ends, &mut line.inner, at);
        }
    }

    /// A cut that runs along an edge of the other triangle has the points of that edge, and the
    /// edge those of the cut.
    fn share_with_edges(&mut self, m: &mut Intersections, points: &PointSet) {
        let alone = |l: &CutLine| l.of.len() == 1;
        let mut edges: Map<u32, Vec<u32>> = Map::default();
        for line in self.lines.iter().filter(|l| alone(l)) {
            edges.extend(line.ends.map(|v| (v, Vec::new())));
        }
        for (id, e) in m.edges.iter().enumerate() {
            for v in e.ends.iter().chain(&e.inner) {
                if let Some(list) = edges.get_mut(v) {
                    list.push(id as u32);
                }
            }
        }
        let at = &points.at;
        for edge in &mut m.edges {
            sort_along(edge.ends, &mut edge.inner, at);
        }
        let mut changed = Vec::new();
        for line in self.lines.iter_mut().filter(|l| alone(l)) {
            let [p, q] = line.ends;
            for &id in &edges[&p] {
                if !edges[&q].contains(&id) {
                    continue;
                }
                let edge = &mut m.edges[id as usize];
                let (o, d) = (at[p as usize], at[q as usize] - at[p as usize]);
                let along = |v: u32| (at[v as usize] - o).dot(d) / d.length_squared();
                let between = edge
                    .inner
                    .iter()
                    .copied()
                    .filter(|&v| v != p && v != q && along(v) > 0.0 && along(v) < 1.0);
                line.inner.extend(between);
                edge.inner.extend(&line.inner);
                changed.push(id);
            }
            sort_along(line.ends, &mut line.inner, at);
        }
        for id in changed {
            let edge = &mut m.edges[id as usize];
            sort_along(edge.ends, &mut edge.inner, at);
        }
    }
}

/// Points between two ends in their order, each once.
fn sort_along(ends: [u32; 2], inner: &mut Vec<u32>, at: &[DVec3]) {
    let (o, d) = (at[ends[0] as usize], at[ends[1] as usize] - at[ends[0] as usize]);
    let along = |v: u32| (at[v as usize] - o).dot(d);
    inner.retain(|v| !ends.contains(v));
    inner.sort_unstable_by(|&x, &y| along(x).total_cmp(&along(y)).then(x.cmp(&y)));
    inner.dedup();
}

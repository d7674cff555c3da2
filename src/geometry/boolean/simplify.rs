//! The faces that the cut left in pieces, in as few and as well shaped faces as their planes allow.
//!
//! The pieces of one plane are triangulated together: points that the cut put on a straight edge or
//! inside a plane are collapsed (the *collinear* case of edge collapse, Garland and Heckbert 1997),
//! then edges within the plane are flipped until the triangulation is Delaunay (Lawson 1977, with
//! exact predicates after Shewchuk 1997). Only points that the cut made go; those of the operands
//! stay, and no point moves.

use glam::DVec3;
use robust::{Coord, incircle, orient2d};

use super::emit::FaceOrigin;
use super::planar::flatten;
use super::points::Map;
use super::ring_joining::joined_rings_where;
use crate::PolyMesh;
use crate::triangulate;

/// A face of a result that is a part of an operand's face.
#[derive(Debug, Clone)]
pub struct CutFace {
    /// The face that it comes from.
    pub origin: FaceOrigin,
    /// Its corners, counter-clockwise seen from outside the result.
    pub corners: Vec<u32>,
}

const NONE: u32 = u32::MAX;
/// An angle whose sine is less is not made by a collapse.
const LEAST_SINE: f64 = 1e-9;

/// A polygon in convex ones, by dropping diagonals of its triangles (Hertel and Mehlhorn 1983).
pub fn convex(corners: &[u32], at: &[DVec3]) -> Vec<Vec<u32>> {
    let flat = flatten(triangulate::area_vector(at, corners));
    let good = |a: u32, b: u32, c: u32| {
        let [a, b, c] = [a, b, c].map(|v| flat(at[v as usize]));
        orient2d(a, b, c) >= 0.0
    };
    let n = corners.len();
    let is_convex = (0..n).all(|i| good(corners[i], corners[(i + 1) % n], corners[(i + 2) % n]));
    if n == 3 || is_convex {
        return vec![corners.to_vec()];
    }
    let mut triangles = Vec::new();
    triangulate::face(at, corners, &mut triangles);
    let triangles: Vec<Vec<u32>> = triangles.into_iter().map(|t| t.to_vec()).collect();
    joined_rings_where(&triangles, good)
}

/// Triangles of one plane.
struct Facet {
    normal: DVec3,
}

/// Its vertices have numbers in the order of their points.
struct Region {
    at: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    origins: Vec<FaceOrigin>,
    /// Facet of each triangle.
    facet: Vec<u32>,
    facets: Vec<Facet>,
    alive: Vec<bool>,
    /// Triangles that changed since edges were last flipped, where all that could be were.
    changed: Vec<bool>,
    /// Triangles at each vertex.
    around: Vec<Vec<u32>>,
}

/// The cut faces as triangles. Points below `own` are the operands'; `flat` is how far the corners
/// of one plane may be from it; `group` gives the group of a face, which no triangle leaves.
pub fn retriangulated(
    cut: &[CutFace],
    own: usize,
    at: &[DVec3],
    flat: f64,
    group: impl Fn(FaceOrigin) -> u32,
) -> Vec<(FaceOrigin, [u32; 3])> {
    let (mut triangles, mut origins) = (Vec::new(), Vec::new());
    for face in cut {
        match face.corners[..] {
            [a, b, c] => triangles.push([a, b, c]),
            _ => triangulate::face(at, &face.corners, &mut triangles),
        }
        origins.resize(triangles.len(), face.origin);
    }
    let mut names: Vec<u32> = triangles.as_flattened().to_vec();
    names.sort_unstable();
    names.dedup();
    let numbers: Map<u32, u32> = names.iter().copied().zip(0..).collect();
    let mut degrees = vec![0usize; names.len()];
    for v in triangles.as_flattened_mut() {
        *v = numbers[v];
        degrees[*v as usize] += 1;
    }
    let mut around: Vec<Vec<u32>> =
        degrees.into_iter().map(|d| Vec::with_capacity(d + 2)).collect();
    for (t, corners) in triangles.iter().enumerate() {
        corners.iter().for_each(|&v| around[v as usize].push(t as u32));
    }
    let count = triangles.len();
    let mut region = Region {
        at: names.iter().map(|&v| at[v as usize]).collect(),
        triangles,
        origins,
        facet: vec![NONE; count],
        facets: Vec::new(),
        alive: vec![true; count],
        changed: vec![true; count],
        around,
    };
    region.find_facets(flat, group);
    region.flip();
    // The points that the cut made come after those of the operands.
    let first_made = names.partition_point(|&v| (v as usize) < own);
    if region.collapse(first_made, flat) {
        region.flip();
    }
    let Region { triangles, origins, alive, .. } = region;
    let made = origins.into_iter().zip(triangles).zip(alive).filter(|(_, alive)| *alive);
    made.map(|((origin, t), _)| (origin, t.map(|v| names[v as usize]))).collect()
}

impl Region {
    fn p(&self, v: u32) -> DVec3 {
        self.at[v as usize]
    }

    fn normal(&self, t: u32) -> DVec3 {
        let [a, b, c] = self.triangles[t as usize].map(|v| self.p(v));
        (b - a).cross(c - a)
    }

    /// The triangles in which an edge runs from `a` to `b` and from `b` to `a`, where there is
    /// exactly one of each.
    fn at_edge(&self, a: u32, b: u32) -> Option<(u32, u32)> {
        let (mut same, mut back) = (NONE, NONE);
        for &t in &self.around[a as usize] {
            let [x, y, z] = self.triangles[t as usize];
            if x != b && y != b && z != b {
                continue;
            }
            for edge in [(x, y), (y, z), (z, x)] {
                let found = if edge == (a, b) {
                    &mut same
                } else if edge == (b, a) {
                    &mut back
                } else {
                    continue;
                };
                if *found != NONE {
                    return None;
                }
                *found = t;
            }
        }
        (same != NONE && back != NONE).then_some((same, back))
    }

    /// The triangle on the other side of an edge, where exactly one runs along it each way.
    fn twin(&self, a: u32, b: u32) -> Option<u32> {
        self.at_edge(a, b).map(|found| found.1)
    }

    /// Grows planes from the largest triangles on.
    fn find_facets(&mut self, flat: f64, group: impl Fn(FaceOrigin) -> u32) {
        let mut order: Vec<(f64, u32)> =
            (0..self.triangles.len() as u32).map(|t| (self.normal(t).length(), t)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for &(_, seed) in &order {
            if self.facet[seed as usize] != NONE {
                continue;
            }
            let id = self.facets.len() as u32;
            let (origin, normal) =
                (self.p(self.triangles[seed as usize][0]), self.normal(seed).normalize_or_zero());
            self.facets.push(Facet { normal });
            self.facet[seed as usize] = id;
            let from = self.origins[seed as usize];
            let mut todo = vec![seed];
            while let Some(t) = todo.pop() {
                let c = self.triangles[t as usize];
                for k in 0..3 {
                    let Some(u) = self.twin(c[k], c[(k + 1) % 3]) else { continue };
                    let other = self.origins[u as usize];
                    if self.facet[u as usize] != NONE
                        || other.operand != from.operand
                        || group(other) != group(from)
                    {
                        continue;
                    }
                    let corners = self.triangles[u as usize].map(|v| self.p(v));
                    let near = corners.iter().all(|&p| (p - origin).dot(normal).abs() <= flat);
                    let own = self.normal(u);
                    let longest = (corners[1] - corners[0])
                        .length_squared()
                        .max((corners[2] - corners[0]).length_squared());
                    // The direction of a triangle as thin as the tolerance says nothing.
                    let thin = own.length_squared() <= 16.0 * flat * flat * longest;
                    if near && (thin || own.dot(normal) > 0.9 * own.length()) {
                        self.facet[u as usize] = id;
                        todo.push(u);
                    }
                }
            }
        }
    }

    /// The neighbours of a vertex in their order, each with the facet of the triangle after it.
    /// None unless its triangles are one closed fan.
    fn fan(&self, v: u32) -> Option<Vec<(u32, u32)>> {
        let around = &self.around[v as usize];
        let mut links: Vec<(u32, u32, u32)> = around
            .iter()
            .map(|&t| {
                let c = self.triangles[t as usize];
                let k = c.iter().position(|&x| x == v).unwrap_or(0);
                (c[(k + 1) % 3], c[(k + 2) % 3], self.facet[t as usize])
            })
            .collect();
        links.sort_unstable();
        let start = links.first()?.0;
        let (mut out, mut at) = (Vec::with_capacity(links.len()), start);
        loop {
            let first = links.partition_point(|l| l.0 < at);
            let here = &links[first..];
            if here.first()?.0 != at || here.get(1).is_some_and(|l| l.0 == at) {
                return None;
            }
            out.push((at, here[0].2));
            at = here[0].1;
            if at == start {
                break;
            }
            if out.len() > links.len() {
                return None;
            }
        }
        (out.len() == links.len() && out.len() >= 3).then_some(out)
    }

    /// Takes points out of straight edges and planes. Returns whether any went.
    fn collapse(&mut self, first_made: usize, flat: f64) -> bool {
        let mut made: Vec<u32> = (first_made as u32..self.around.len() as u32).collect();
        let mut any = false;
        for _ in 0..4 {
            let before = made.len();
            made.retain(|&v| !self.collapse_one(v, flat));
            any |= made.len() < before;
            if made.len() == before {
                break;
            }
        }
        any
    }

    fn collapse_one(&mut self, v: u32, flat: f64) -> bool {
        let Some(fan) = self.fan(v) else { return false };
        let n = fan.len();
        // Neighbours at which the facet changes.
        let creases: Vec<u32> =
            (0..n).filter(|&i| fan[i].1 != fan[(i + n - 1) % n].1).map(|i| fan[i].0).collect();
        let targets: Vec<u32> = match creases[..] {
            [] => fan.iter().map(|f| f.0).collect(),
            [a, b] => {
                let (o, d, x) = (self.p(a), self.p(b) - self.p(a), self.p(v));
                let t = (x - o).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
                if !(t > 0.0 && t < 1.0) || (o + d * t).distance(x) > flat {
                    return false;
                }
                vec![a, b]
            }
            _ => return false,
        };
        let best = targets
            .into_iter()
            .filter_map(|u| self.quality_after(v, u, &fan).map(|q| (q, u)))
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let Some((_, u)) = best else { return false };
        let triangles = std::mem::take(&mut self.around[v as usize]);
        for t in triangles {
            let c = &mut self.triangles[t as usize];
            if c.contains(&u) {
                self.alive[t as usize] = false;
                let c = *c;
                for w in c.into_iter().filter(|&w| w != v) {
                    self.around[w as usize].retain(|&x| x != t);
                }
            } else {
                c.iter_mut().filter(|x| **x == v).for_each(|x| *x = u);
                self.changed[t as usize] = true;
                self.around[u as usize].push(t);
            }
        }
        true
    }

    /// The least sine of an angle after `v` became `u`; None where that is not allowed.
    fn quality_after(&self, v: u32, u: u32, fan: &[(u32, u32)]) -> Option<f64> {
        let n = fan.len();
        let place = fan.iter().position(|f| f.0 == u)?;
        let (before, after) = (fan[(place + n - 1) % n].0, fan[(place + 1) % n].0);
        // Neighbours of both are the two beside the edge alone.
        let common = self.around[u as usize]
            .iter()
            .flat_map(|&t| self.triangles[t as usize])
            .filter(|&w| w != u && w != v && fan.iter().any(|f| f.0 == w));
        if common.into_iter().any(|w| w != before && w != after) {
            return None;
        }
        let mut least = f64::INFINITY;
        for i in 0..n {
            let (b, c) = (fan[i].0, fan[(i + 1) % n].0);
            if b == u || c == u {
                continue;
            }
            let facet = &self.facets[fan[i].1 as usize];
            let (x, y, z) = (self.p(u), self.p(b), self.p(c));
            let project = flatten(facet.normal);
            if orient2d(project(x), project(y), project(z)) <= 0.0 {
                return None;
            }
            let longest = (y - x).length_squared().max((z - x).length_squared());
            let longest = longest.max((z - y).length_squared());
            let sine = (y - x).cross(z - x).dot(facet.normal) / longest;
            if sine <= LEAST_SINE {
                return None;
            }
            least = least.min(sine);
        }
        Some(least)
    }

    /// Flips edges within facets until each facet's triangles are Delaunay.
    fn flip(&mut self) {
        let (mut queue, mut kept) = (Vec::new(), 0);
        for (t, c) in self.triangles.iter().enumerate().filter(|(t, _)| self.alive[*t]) {
            let facet = self.facet[t];
            for k in 0..3 {
                let (a, b) = (c[k], c[(k + 1) % 3]);
                let Some(u) = self.twin(a, b).filter(|_| a < b) else { continue };
                if self.facet[u as usize] != facet {
                    continue;
                }
                // Between two triangles that are as they were, the edge stays.
                if self.changed[t] || self.changed[u as usize] {
                    queue.push((a, b));
                } else {
                    kept += 1;
                }
            }
        }
        let mut left = 16 * (queue.len() + kept) + 64;
        self.changed.fill(false);
        while let Some((a, b)) = queue.pop() {
            if left == 0 {
                self.changed.fill(true);
                return;
            }
            left -= 1;
            if let Some([c, d]) = self.flip_one(a, b) {
                queue.extend([(a, c), (c, b), (b, d), (d, a)]);
            }
        }
    }

    /// Flips an edge where that makes better triangles; the two new ends then.
    fn flip_one(&mut self, a: u32, b: u32) -> Option<[u32; 2]> {
        let (s, t) = self.at_edge(a, b)?;
        let facet = self.facet[s as usize];
        if s == t || self.facet[t as usize] != facet {
            return None;
        }
        let third = |t: u32| self.triangles[t as usize].into_iter().find(|&v| v != a && v != b);
        let (c, d) = (third(s)?, third(t)?);
        if c == d {
            return None;
        }
        // s is (a, b, c), t is (b, a, d).
        let flat = flatten(self.facets[facet as usize].normal);
        let [pa, pb, pc, pd]: [Coord<f64>; 4] = [a, b, c, d].map(|v| flat(self.p(v)));
        if !(orient2d(pc, pa, pd) > 0.0 && orient2d(pd, pb, pc) > 0.0) {
            return None;
        }
        let (first, second) = (orient2d(pa, pb, pc), orient2d(pb, pa, pd));
        let good = first > 0.0 && second > 0.0;
        if good && incircle(pa, pb, pc, pd) <= 0.0 {
            return None;
        }
        if self.around[c as usize].iter().any(|&x| self.triangles[x as usize].contains(&d)) {
            return None;
        }
        self.triangles[s as usize] = [c, a, d];
        self.triangles[t as usize] = [d, b, c];
        for (v, gone, new) in [(b, s, NONE), (a, t, NONE), (d, NONE, s), (c, NONE, t)] {
            let list = &mut self.around[v as usize];
            list.retain(|&x| x != gone);
            if new != NONE {
                list.push(new);
            }
        }
        Some([c, d])
    }
}

/// The group of a face for [`retriangulated`], and its number where colours vary within it.
pub fn group_of(operands: [&PolyMesh; 2], origin: FaceOrigin) -> u32 {
    let mesh = operands[origin.operand as usize];
    if mesh.colours.is_some() {
        return origin.face;
    }
    mesh.groups.as_ref().and_then(|g| g.get(origin.face as usize)).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_cut_in_two_loses_the_point_inside() {
        // Four own corners; points of the cut on two sides and inside.
        let spots = [(0., 0.), (4., 0.), (4., 4.), (0., 4.), (1., 0.), (1., 4.), (1., 2.)];
        let at: Vec<DVec3> = spots.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
        let rings: [&[u32]; 2] = [&[0, 4, 6, 5, 3], &[4, 1, 2, 5, 6]];
        let origin = FaceOrigin { operand: 0, face: 0 };
        let cut = rings.map(|r| CutFace { origin, corners: r.to_vec() });
        let made = retriangulated(&cut, 4, &at, 1e-12, |_| 0);
        // Points on the open border stay, for the faces beyond it have them.
        assert_eq!(made.len(), 4);
        assert!(made.iter().all(|(_, t)| !t.contains(&6)));
        let area: f64 = made.iter().map(|(_, t)| triangulate::area_vector(&at, t).z).sum();
        assert_eq!(area, 32.0);
    }

    #[test]
    fn an_angle_is_two_convex_polygons() {
        let at: Vec<DVec3> = [(0., 0.), (2., 0.), (2., 1.), (1., 1.), (1., 2.), (0., 2.)]
            .map(|(x, y)| DVec3::new(x, y, 0.0))
            .to_vec();
        let made = convex(&[0, 1, 2, 3, 4, 5], &at);
        assert_eq!(made.len(), 2);
        assert_eq!(made.iter().map(Vec::len).sum::<usize>(), 8);
    }
}

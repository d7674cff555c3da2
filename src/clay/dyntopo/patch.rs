//! A piece of the surface taken out to be cut anew: split, collapse, flip, each only where the
//! surface stays a surface and no triangle becomes a sliver.
//!
//! Guarantees: what was a manifold stays one, with the same Euler characteristic (collapses keep
//! the link condition of Dey, Edelsbrunner, Guha and Nekhayev 1999; splits and flips cannot change
//! it). Borders stay where they are. An operation leaves no angle below [`LEAST`] that is smaller
//! than the smallest about it before. Protected vertices stay.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use glam::Vec3;
use sculptd_geometry::portable::PortableMath;

/// An angle below which no operation goes, radians: 3 degrees.
const LEAST: f32 = 0.052;
/// A vertex with this much mask stays where and as it is.
const PROTECTED: f32 = 0.99;
/// Flat enough to flip across: the cosine between the two triangles.
const FLAT: f32 = 0.94;

#[derive(Debug, Default)]
pub(super) struct Patch {
    pub(super) points: Vec<Vec3>,
    pub(super) masks: Vec<f32>,
    pub(super) colours: Vec<[u8; 4]>,
    /// All triangles of the vertex are in the patch: it may be cut about.
    pub(super) whole: Vec<bool>,
    /// The vertex still exists.
    pub(super) alive: Vec<bool>,
    /// The vertex or a triangle of it changed.
    pub(super) touched: Vec<bool>,
    /// For vertices that are new: the one they were made beside.
    pub(super) beside: Vec<u32>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) triangle_ids: Vec<u32>,
    pub(super) gone: Vec<bool>,
    /// Triangles about each vertex.
    pub(super) about: Vec<Vec<u32>>,
    pub(super) next_triangle: u32,
}

/// What is wanted of the triangles within a ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// The centre of the ball, mesh units.
    pub centre: Vec3,
    /// The radius of the ball, mesh units, > 0.
    pub radius: f32,
    /// The wanted length of edges, mesh units, > 0. Longer than 4/3 of it they are split, shorter
    /// than 1/2 collapsed.
    pub edge: f32,
    /// Edges that are too long are split.
    pub split: bool,
    /// Edges that are too short are collapsed.
    pub collapse: bool,
    /// Cuts at most: the work of one dab is bounded.
    pub most: usize,
}

/// What was done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cuts {
    /// Edges that were split.
    pub splits: usize,
    /// Edges that were collapsed.
    pub collapses: usize,
    /// Edges that were flipped.
    pub flips: usize,
}

/// The smallest angle of a triangle, radians; 0 for one without area.
pub(super) fn smallest_angle(a: Vec3, b: Vec3, c: Vec3) -> f32 {
    let area2 = (b - a).cross(c - a).length();
    let at = |p: Vec3, q: Vec3, r: Vec3| area2.portable_atan2((q - p).dot(r - p));
    at(a, b, c).min(at(b, c, a)).min(at(c, a, b))
}

impl Patch {
    fn angle(&self, t: [u32; 3]) -> f32 {
        let [a, b, c] = t.map(|v| self.points[v as usize]);
        smallest_angle(a, b, c)
    }

    fn normal(&self, t: [u32; 3]) -> Vec3 {
        let [a, b, c] = t.map(|v| self.points[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    }

    fn length2(&self, a: u32, b: u32) -> f32 {
        (self.points[a as usize] - self.points[b as usize]).length_squared()
    }

    /// The triangles on an edge, if they are two that run along it in opposite ways, and the corner
    /// of each that is not on it: first that of the triangle with `a` before `b`.
    fn wings(&self, a: u32, b: u32) -> Option<[(u32, u32); 2]> {
        let (mut left, mut right) = (None, None);
        for &t in &self.about[a as usize] {
            let c = self.triangles[t as usize];
            let Some(k) = c.iter().position(|&v| v == a) else { continue };
            let (next, last) = (c[(k + 1) % 3], c[(k + 2) % 3]);
            if next == b && left.replace((t, last)).is_some() {
                return None;
            }
            if last == b && right.replace((t, next)).is_some() {
                return None;
            }
        }
        Some([left?, right?])
    }

    /// Whether a vertex lies amid one closed fan: as many neighbours as triangles.
    fn is_disc(&self, v: u32) -> bool {
        let mut n = self.neighbours(v);
        let all = n.len();
        n.sort_unstable();
        n.dedup();
        // Each neighbour of a closed fan is met twice.
        n.len() * 2 == all && n.len() == self.about[v as usize].len() && n.len() >= 3
    }

    /// Each neighbour, once for each triangle that it shares.
    fn neighbours(&self, v: u32) -> Vec<u32> {
        let ts = self.about[v as usize].iter();
        ts.flat_map(|&t| self.triangles[t as usize]).filter(|&k| k != v).collect()
    }

    fn add(&mut self, t: [u32; 3]) {
        let id = self.triangles.len() as u32;
        self.triangles.push(t);
        self.triangle_ids.push(self.next_triangle);
        self.next_triangle += 1;
        self.gone.push(false);
        for v in t {
            self.about[v as usize].push(id);
            self.touched[v as usize] = true;
        }
    }

    fn remove(&mut self, id: u32) {
        self.gone[id as usize] = true;
        for v in self.triangles[id as usize] {
            self.about[v as usize].retain(|&t| t != id);
            self.touched[v as usize] = true;
        }
    }

    fn split(&mut self, a: u32, b: u32) -> Option<u32> {
        let wings = self.wings(a, b)?;
        let middle = (self.points[a as usize] + self.points[b as usize]) * 0.5;
        let old = wings
            .iter()
            .map(|w| self.angle(self.triangles[w.0 as usize]))
            .fold(f32::INFINITY, f32::min);
        let at = |v: u32| self.points[v as usize];
        let new = wings
            .iter()
            .flat_map(|&(_, c)| {
                [smallest_angle(at(a), middle, at(c)), smallest_angle(middle, at(b), at(c))]
            })
            .fold(f32::INFINITY, f32::min);
        if new < LEAST && new < old {
            return None;
        }
        let m = self.points.len() as u32;
        self.points.push(middle);
        self.masks.push((self.masks[a as usize] + self.masks[b as usize]) * 0.5);
        let (p, q) = (self.colours[a as usize], self.colours[b as usize]);
        self.colours
            .push(std::array::from_fn(|i| (u16::from(p[i]) + u16::from(q[i])).div_ceil(2) as u8));
        self.whole.push(true);
        self.alive.push(true);
        self.touched.push(true);
        self.beside.push(a);
        self.about.push(Vec::with_capacity(6));
        let [(left, c), (right, d)] = wings;
        self.remove(left);
        self.remove(right);
        self.add([a, m, c]);
        self.add([m, b, c]);
        self.add([b, m, d]);
        self.add([m, a, d]);
        Some(m)
    }

    /// Draws `a` and `b` together into `b`, amid both.
    fn collapse(&mut self, a: u32, b: u32, longest: f32) -> bool {
        let Some([(_, c), (_, d)]) = self.wings(a, b) else { return false };
        let free = [a, b, c, d].iter().all(|&v| self.whole[v as usize]);
        if !free || c == d || !self.is_disc(a) || !self.is_disc(b) {
            return false;
        }
        // The link condition: a and b share the wings' corners and nobody else.
        let near_b = self.neighbours(b);
        let mut shared: Vec<u32> =
            self.neighbours(a).into_iter().filter(|v| near_b.contains(v)).collect();
        shared.sort_unstable();
        shared.dedup();
        if shared.len() != 2
            || self.about[c as usize].len() <= 3
            || self.about[d as usize].len() <= 3
        {
            return false;
        }
        let middle = (self.points[a as usize] + self.points[b as usize]) * 0.5;
        let (mut old, mut new) = (f32::INFINITY, f32::INFINITY);
        for (v, other) in [(a, b), (b, a)] {
            for &t in &self.about[v as usize] {
                let corners = self.triangles[t as usize];
                old = old.min(self.angle(corners));
                if corners.contains(&other) {
                    continue;
                }
                let [p, q, r] =
                    corners.map(|k| if k == v { middle } else { self.points[k as usize] });
                let turned = (q - p).cross(r - p).normalize_or_zero();
                let longest_now = (p - q)
                    .length_squared()
                    .max((q - r).length_squared())
                    .max((r - p).length_squared());
                if turned.dot(self.normal(corners)) < 0.3 || longest_now > longest * longest {
                    return false;
                }
                new = new.min(smallest_angle(p, q, r));
            }
        }
        if new < LEAST.max(old * 0.7).min(0.35) {
            return false;
        }
        let mine = self.about[a as usize].clone();
        for t in mine {
            let corners = self.triangles[t as usize];
            if corners.contains(&b) {
                self.remove(t);
                continue;
            }
            for v in corners {
                self.touched[v as usize] = true;
            }
            self.triangles[t as usize] = corners.map(|v| if v == a { b } else { v });
            self.about[b as usize].push(t);
        }
        for &t in &self.about[b as usize] {
            for v in self.triangles[t as usize] {
                self.touched[v as usize] = true;
            }
        }
        self.about[a as usize].clear();
        self.alive[a as usize] = false;
        self.touched[a as usize] = true;
        self.points[b as usize] = middle;
        self.masks[b as usize] = (self.masks[a as usize] + self.masks[b as usize]) * 0.5;
        true
    }

    /// Turns the edge between two triangles into their other diagonal, where that makes the
    /// smallest angle larger.
    fn flip(&mut self, a: u32, b: u32) -> bool {
        let Some([(left, c), (right, d)]) = self.wings(a, b) else { return false };
        let free = [a, b, c, d].iter().all(|&v| self.whole[v as usize]);
        if !free || c == d || self.about[a as usize].len() <= 3 || self.about[b as usize].len() <= 3
        {
            return false;
        }
        if self.neighbours(c).contains(&d) {
            return false;
        }
        let (one, two) = (self.triangles[left as usize], self.triangles[right as usize]);
        let (new_one, new_two) = ([a, d, c], [d, b, c]);
        let old = self.angle(one).min(self.angle(two));
        let new = self.angle(new_one).min(self.angle(new_two));
        let (n, m) = (self.normal(one), self.normal(two));
        let flat = n.dot(m) > FLAT || old < LEAST;
        let (k, l) = (self.normal(new_one), self.normal(new_two));
        let faces = (n + m).normalize_or_zero();
        if !flat || new < old * 1.05 || k.dot(faces) < FLAT || l.dot(faces) < FLAT {
            return false;
        }
        self.remove(left);
        self.remove(right);
        self.add(new_one);
        self.add(new_two);
        true
    }

    /// The edges with both ends within the ball, each once, in the order of its vertices.
    fn edges(&self, d: &Detail) -> Vec<(u32, u32)> {
        let inside = |v: u32| {
            let v = v as usize;
            self.whole[v]
                && self.alive[v]
                && self.masks[v] < PROTECTED
                && (self.points[v] - d.centre).length_squared() <= d.radius * d.radius
        };
        let mut edges = Vec::new();
        for (t, corners) in self.triangles.iter().enumerate() {
            if self.gone[t] {
                continue;
            }
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                if a < b && inside(a) && inside(b) {
                    edges.push((a, b));
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Cuts until the edges within the ball are near the wanted length, or the bound is met.
    pub(super) fn cut(&mut self, d: &Detail) -> Cuts {
        let mut cuts = Cuts::default();
        let longest = d.edge * (4.0 / 3.0);
        if d.split {
            let over = longest * longest;
            let mut heap: BinaryHeap<(u32, Reverse<(u32, u32)>)> = BinaryHeap::new();
            let offer = |heap: &mut BinaryHeap<_>, l2: f32, a: u32, b: u32| {
                if l2 > over {
                    heap.push((l2.to_bits(), Reverse((a.min(b), a.max(b)))));
                }
            };
            for (a, b) in self.edges(d) {
                offer(&mut heap, self.length2(a, b), a, b);
            }
            while let Some((_, Reverse((a, b)))) = heap.pop() {
                if cuts.splits >= d.most {
                    break;
                }
                if let Some(m) = self.split(a, b) {
                    cuts.splits += 1;
                    let mut near = self.neighbours(m);
                    near.sort_unstable();
                    near.dedup();
                    for k in near {
                        if (self.points[k as usize] - d.centre).length_squared()
                            <= d.radius * d.radius
                            && self.whole[k as usize]
                        {
                            offer(&mut heap, self.length2(k, m), k, m);
                        }
                    }
                }
            }
        }
        if d.collapse {
            let under = d.edge * d.edge * 0.25;
            let mut short: Vec<_> = self
                .edges(d)
                .into_iter()
                .map(|(a, b)| (self.length2(a, b).to_bits(), a, b))
                .collect();
            short.retain(|e| f32::from_bits(e.0) < under);
            short.sort_unstable();
            for (_, a, b) in short {
                if cuts.splits + cuts.collapses >= d.most {
                    break;
                }
                let there = self.alive[a as usize] && self.alive[b as usize];
                if there && self.length2(a, b) < under && self.collapse(a, b, longest) {
                    cuts.collapses += 1;
                }
            }
        }
        self.flips(d, &mut cuts);
        cuts
    }

    /// Flips edges until none is better flipped, or each was looked at four times.
    fn flips(&mut self, d: &Detail, cuts: &mut Cuts) {
        let mut edges: VecDeque<_> = self.edges(d).into();
        let mut left = edges.len() * 4;
        while let Some((a, b)) = edges.pop_front() {
            if left == 0 {
                break;
            }
            left -= 1;
            let wings = self.wings(a, b);
            if self.flip(a, b) {
                cuts.flips += 1;
                if let Some([(_, c), (_, e)]) = wings {
                    for (p, q) in [(a, c), (c, b), (b, e), (e, a)] {
                        edges.push_back((p.min(q), p.max(q)));
                    }
                }
            }
        }
    }
}

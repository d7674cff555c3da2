//! A triangle surface that is edited in place: edges are split, collapsed and flipped, and it stays
//! a manifold that keeps its feature lines.
//!
//! Notation: a *line* is an edge of the border or of a crease. A vertex without lines is free; one
//! between two lines slides along them; one where lines end, meet or turn is *pinned* and stays.
//!
//! A collapse obeys the link condition (Dey et al., "Topology preserving edge contraction", 1999):
//! the ends of the edge share exactly the vertices opposite the edge. So the genus, the borders and
//! the number of parts never change, and no part becomes smaller than [`LEAST_PART`] vertices.

use std::collections::BTreeMap;

use glam::DVec3;

/// Marks a triangle that is gone.
pub(super) const GONE: u32 = u32::MAX;
/// The number of vertices that a closed part keeps: those of a cube.
pub(super) const LEAST_PART: u32 = 8;

/// An editable manifold triangle surface.
#[derive(Debug, Clone, Default)]
pub(super) struct EditSurface {
    pub positions: Vec<DVec3>,
    /// `[GONE; 3]` where the triangle is gone.
    pub triangles: Vec<[u32; 3]>,
    /// The triangles around each vertex, in no order that matters; empty: the vertex is gone.
    pub around: Vec<Vec<u32>>,
    /// The other ends of each vertex's lines.
    pub lines: Vec<Vec<u32>>,
    pub pinned: Vec<bool>,
    /// The chain of lines that an unpinned vertex of a line belongs to, or [`GONE`].
    pub chain: Vec<u32>,
    /// The chains of lines between two pinned vertices, the lower one first.
    pub direct: BTreeMap<(u32, u32), u32>,
    /// The connected part of each vertex.
    pub part: Vec<u32>,
    /// The vertices of each part.
    pub part_size: Vec<u32>,
}

impl EditSurface {
    /// Takes triangles that form a manifold; lines are added by the caller.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> EditSurface {
        let n = positions.len();
        let mut around = vec![Vec::new(); n];
        let mut sets = crate::disjoint_sets::DisjointSets::new(n);
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            [a, b, c].iter().for_each(|&v| around[v as usize].push(t as u32));
            sets.join(a, b);
            sets.join(b, c);
        }
        let part: Vec<u32> = (0..n as u32).map(|v| sets.root(v)).collect();
        let mut part_size = vec![0; n];
        part.iter().for_each(|&p| part_size[p as usize] += 1);
        EditSurface {
            positions,
            triangles,
            around,
            lines: vec![Vec::new(); n],
            pinned: vec![false; n],
            chain: vec![GONE; n],
            direct: BTreeMap::new(),
            part,
            part_size,
        }
    }

    pub fn is_line(&self, a: u32, b: u32) -> bool {
        self.lines[a as usize].contains(&b)
    }

    /// Returns the constraint of a vertex: 0 none, 1 a line, 2 its position.
    pub fn rank(&self, v: u32) -> u8 {
        if self.pinned[v as usize] { 2 } else { u8::from(!self.lines[v as usize].is_empty()) }
    }

    /// The chain of the line between two vertices, [`GONE`] where it is not known.
    pub fn chain_between(&self, a: u32, b: u32) -> u32 {
        match [a, b].map(|v| if self.pinned[v as usize] { GONE } else { self.chain[v as usize] }) {
            [GONE, GONE] => self.direct.get(&(a.min(b), a.max(b))).copied().unwrap_or(GONE),
            [GONE, chain] | [chain, _] => chain,
        }
    }

    pub fn add_line(&mut self, a: u32, b: u32) {
        if !self.is_line(a, b) {
            self.lines[a as usize].push(b);
            self.lines[b as usize].push(a);
        }
    }

    /// Pins the vertices where lines end, meet, or turn by more than the angle of this cosine.
    pub fn pin_corners(&mut self, cosine: f64) {
        for v in 0..self.positions.len() {
            let p = self.positions[v];
            self.pinned[v] = match self.lines[v][..] {
                [] => false,
                [a, b] => {
                    let to = (self.positions[a as usize] - p).normalize_or_zero();
                    let from = (p - self.positions[b as usize]).normalize_or_zero();
                    to.dot(from) < cosine
                }
                _ => true,
            };
        }
    }

    /// The vertices that share an edge with `v`, sorted.
    pub fn neighbours(&self, v: u32, out: &mut Vec<u32>) {
        out.clear();
        for &t in &self.around[v as usize] {
            out.extend(self.triangles[t as usize].iter().filter(|&&w| w != v));
        }
        out.sort_unstable();
        out.dedup();
    }

    /// All edges, the lower vertex first, sorted.
    pub fn edges(&self) -> Vec<(u32, u32)> {
        let mut all = Vec::with_capacity(self.triangles.len() * 3 / 2 + 16);
        let mut near = Vec::new();
        for v in 0..self.positions.len() as u32 {
            self.neighbours(v, &mut near);
            all.extend(near.iter().filter(|&&w| w > v).map(|&w| (v, w)));
        }
        all
    }

    /// The triangles on both sides of an edge; the second is [`GONE`] at a border, both where there
    /// is no such edge.
    pub fn sides(&self, a: u32, b: u32) -> [u32; 2] {
        let mut out = [GONE; 2];
        let mut n = 0;
        for &t in &self.around[a as usize] {
            if self.triangles[t as usize].contains(&b) && n < 2 {
                out[n] = t;
                n += 1;
            }
        }
        out
    }

    /// The third corner of triangle `t`.
    pub fn opposite(&self, t: u32, a: u32, b: u32) -> u32 {
        let [x, y, z] = self.triangles[t as usize];
        if x != a && x != b {
            x
        } else if y != a && y != b {
            y
        } else {
            z
        }
    }

    /// Twice the area of triangle `t` with vertex `v` at `p`, as a vector.
    pub fn normal_with(&self, t: u32, v: u32, p: DVec3) -> DVec3 {
        let [a, b, c] =
            self.triangles[t as usize].map(|w| if w == v { p } else { self.positions[w as usize] });
        (b - a).cross(c - a)
    }

    pub fn normal(&self, t: u32) -> DVec3 {
        self.normal_with(t, GONE, DVec3::ZERO)
    }

    /// The sum of the normals around `v`, weighted by area; not of unit length.
    pub fn vertex_normal(&self, v: u32) -> DVec3 {
        self.around[v as usize].iter().map(|&t| self.normal(t)).sum()
    }

    /// Whether `gone` may be merged into `keep` without a change of topology or of the lines.
    pub fn can_collapse(&self, keep: u32, gone: u32) -> bool {
        let (k, g) = (keep as usize, gone as usize);
        if self.pinned[g] || self.part_size[self.part[g] as usize] <= LEAST_PART {
            return false;
        }
        let along = self.is_line(keep, gone);
        if !self.lines[g].is_empty() {
            if !along {
                return false;
            }
            // A loop of three lines stays one.
            if self.lines[g].iter().any(|&x| x != keep && self.is_line(keep, x)) {
                return false;
            }
        }
        let sides = self.sides(keep, gone);
        if sides[0] == GONE || (sides[1] == GONE && !along) {
            return false;
        }
        let facing = sides.map(|t| if t == GONE { GONE } else { self.opposite(t, keep, gone) });
        // Vertices that both ends see.
        let mut shared = 0;
        let mut seen = [GONE; 2];
        for &t in &self.around[g] {
            for &w in &self.triangles[t as usize] {
                if w == gone || w == keep || seen.contains(&w) {
                    continue;
                }
                if self.around[k].iter().any(|&u| self.triangles[u as usize].contains(&w)) {
                    if shared == 2 || !facing.contains(&w) {
                        return false;
                    }
                    seen[shared] = w;
                    shared += 1;
                }
            }
        }
        // Nobody is left with two triangles, unless at a border.
        let needed = facing.iter().filter(|&&w| w != GONE).count();
        shared == needed
            && facing.iter().all(|&w| {
                w == GONE || {
                    let border = self.lines[w as usize].iter().any(|&x| {
                        let s = self.sides(w, x);
                        s[1] == GONE
                    });
                    self.around[w as usize].len() > if border { 1 } else { 3 }
                }
            })
    }

    /// Merges `gone` into `keep`, whose position stays; after [`EditSurface::can_collapse`].
    pub fn collapse(&mut self, keep: u32, gone: u32) {
        let sides = self.sides(keep, gone);
        for t in sides.into_iter().filter(|&t| t != GONE) {
            for v in std::mem::replace(&mut self.triangles[t as usize], [GONE; 3]) {
                self.around[v as usize].retain(|&u| u != t);
            }
        }
        let moved = std::mem::take(&mut self.around[gone as usize]);
        for &t in &moved {
            for v in &mut self.triangles[t as usize] {
                if *v == gone {
                    *v = keep;
                }
            }
        }
        self.around[keep as usize].extend(moved);
        for x in std::mem::take(&mut self.lines[gone as usize]) {
            self.lines[x as usize].retain(|&y| y != gone);
            if x != keep {
                self.add_line(keep, x);
                if self.pinned[keep as usize] && self.pinned[x as usize] {
                    let ends = (keep.min(x), keep.max(x));
                    self.direct.insert(ends, self.chain[gone as usize]);
                }
            }
        }
        self.part_size[self.part[gone as usize] as usize] -= 1;
    }

    /// Puts a vertex at `p` on the edge, and returns it.
    pub fn split(&mut self, a: u32, b: u32, p: DVec3) -> u32 {
        let sides = self.sides(a, b);
        let m = self.positions.len() as u32;
        self.positions.push(p);
        self.around.push(Vec::new());
        self.lines.push(Vec::new());
        self.pinned.push(false);
        self.chain.push(if self.is_line(a, b) { self.chain_between(a, b) } else { GONE });
        let part = self.part[a as usize];
        self.part.push(part);
        self.part_size[part as usize] += 1;
        for t in sides.into_iter().filter(|&t| t != GONE) {
            let old = self.triangles[t as usize];
            let new = self.triangles.len() as u32;
            let with = |from: u32| old.map(|v| if v == from { m } else { v });
            self.triangles[t as usize] = with(b);
            self.triangles.push(with(a));
            self.around[b as usize].retain(|&u| u != t);
            self.around[b as usize].push(new);
            let c = self.opposite(t, a, m);
            self.around[c as usize].push(new);
            self.around[m as usize].extend([t, new]);
        }
        if self.is_line(a, b) {
            self.lines[a as usize].retain(|&x| x != b);
            self.lines[b as usize].retain(|&x| x != a);
            self.add_line(a, m);
            self.add_line(m, b);
        }
        m
    }

    /// The four corners `(a, b, c, d)` of the two triangles at an edge that may be flipped: `a, b,
    /// c` and `b, a, d` are counter-clockwise.
    pub fn flippable(&self, a: u32, b: u32) -> Option<[u32; 4]> {
        let [s, t] = self.sides(a, b);
        if t == GONE || self.is_line(a, b) {
            return None;
        }
        let tri = self.triangles[s as usize];
        let forward = (0..3).any(|k| tri[k] == a && tri[(k + 1) % 3] == b);
        let (s, t) = if forward { (s, t) } else { (t, s) };
        let (c, d) = (self.opposite(s, a, b), self.opposite(t, a, b));
        let taken = c == d
            || self.around[c as usize].iter().any(|&u| self.triangles[u as usize].contains(&d));
        let few = |v: u32| {
            self.around[v as usize].len() <= if self.lines[v as usize].is_empty() { 3 } else { 2 }
        };
        (!taken && !few(a) && !few(b)).then_some([a, b, c, d])
    }

    /// Replaces the edge by the other diagonal; after [`EditSurface::flippable`].
    pub fn flip(&mut self, [a, b, c, d]: [u32; 4]) {
        let [s, t] = self.sides(a, b);
        self.triangles[s as usize] = [c, d, b];
        self.triangles[t as usize] = [d, c, a];
        let mut change = |v: u32, from: u32, to: u32| {
            let list = &mut self.around[v as usize];
            list.retain(|&u| u != from && u != to);
            list.push(to);
        };
        change(a, s, t);
        change(b, t, s);
        for v in [c, d] {
            let list = &mut self.around[v as usize];
            list.retain(|&u| u != s && u != t);
            list.extend([s, t]);
        }
    }

    /// Returns the surface with vertices and triangles renumbered, without the removed ones.
    pub fn compact(&self) -> EditSurface {
        let mut new = vec![GONE; self.positions.len()];
        let mut positions = Vec::new();
        for (v, around) in self.around.iter().enumerate() {
            if !around.is_empty() {
                new[v] = positions.len() as u32;
                positions.push(self.positions[v]);
            }
        }
        let live = self.triangles.iter().filter(|t| t[0] != GONE);
        let triangles = live.map(|t| t.map(|v| new[v as usize])).collect();
        let mut out = EditSurface::new(positions, triangles);
        for v in 0..self.positions.len() {
            if new[v] != GONE {
                let w = new[v] as usize;
                out.pinned[w] = self.pinned[v];
                out.chain[w] = self.chain[v];
                out.lines[w] = self.lines[v].iter().map(|&x| new[x as usize]).collect();
            }
        }
        for (&(a, b), &chain) in &self.direct {
            let (a, b) = (new[a as usize], new[b as usize]);
            if a != GONE && b != GONE {
                out.direct.insert((a.min(b), a.max(b)), chain);
            }
        }
        out
    }
}

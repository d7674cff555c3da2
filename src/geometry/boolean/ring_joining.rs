//! Polygons of one plane joined along the chains of edges that they share, in steps that grow with
//! the smaller polygon: both lists of corners are linked, and each edge knows its twin.

use glam::DVec3;

use super::points::Map;

const NONE: u32 = u32::MAX;

/// Joins polygons that share one chain of edges and touch nowhere else, until none do. No joined
/// polygon runs back along itself.
pub fn joined_rings(rings: &[Vec<u32>], at: &[DVec3]) -> Vec<Vec<u32>> {
    joined_rings_where(rings, |a, o, b| !spike(at, a, o, b))
}

/// As [`joined_rings`], where `accept` takes each corner of the polygon that two become: the corner
/// before it, the corner, and the one after it.
pub fn joined_rings_where(
    rings: &[Vec<u32>],
    accept: impl Fn(u32, u32, u32) -> bool,
) -> Vec<Vec<u32>> {
    let mut all = LinkedRings::new(rings, accept);
    for ring in 0..all.rings.len() as u32 {
        all.grow(ring);
    }
    all.into_rings()
}

/// Returns true if the border runs back along itself at `o`.
fn spike(at: &[DVec3], a: u32, o: u32, b: u32) -> bool {
    let [a, o, b] = [a, o, b].map(|v| at[v as usize]);
    let (u, v) = (a - o, b - o);
    u.dot(v) > 0.0 && u.cross(v).length_squared() <= 1e-18 * u.length_squared() * v.length_squared()
}

/// A corner, and the edge from it to the next one.
#[derive(Clone, Copy)]
struct RingCorner {
    vertex: u32,
    before: u32,
    after: u32,
    /// The corner whose edge runs the other way.
    twin: u32,
    ring: u32,
    /// The neighbours in the list of edges that may still join the growing ring with another.
    open_before: u32,
    open_after: u32,
}

#[derive(Clone, Copy)]
struct LinkedRing {
    /// The first corner; `NONE` once the ring is a part of another.
    first: u32,
    count: usize,
    /// Corners that are not accepted.
    bad: usize,
}

struct LinkedRings<F> {
    rings: Vec<LinkedRing>,
    corners: Vec<RingCorner>,
    /// The last grown ring that has a vertex. The vertices are numbered by first use.
    holder: Vec<u32>,
    names: Vec<u32>,
    accept: F,
}

/// Two rings with one chain of edges in common.
struct CommonChain {
    /// The chain's first and last edges in the growing ring, and their twins.
    first: u32,
    last: u32,
    first_twin: u32,
    last_twin: u32,
    length: usize,
    bad: usize,
}

impl<F: Fn(u32, u32, u32) -> bool> LinkedRings<F> {
    fn new(rings: &[Vec<u32>], accept: F) -> Self {
        let mut numbers: Map<u32, u32> = Map::default();
        let mut out = LinkedRings {
            rings: Vec::with_capacity(rings.len()),
            corners: Vec::with_capacity(rings.iter().map(Vec::len).sum()),
            holder: Vec::new(),
            names: Vec::new(),
            accept,
        };
        for (r, ring) in rings.iter().enumerate() {
            let (start, n) = (out.corners.len() as u32, ring.len() as u32);
            for (i, &v) in (0..n).zip(ring) {
                let vertex = *numbers.entry(v).or_insert_with(|| {
                    out.names.push(v);
                    out.names.len() as u32 - 1
                });
                out.corners.push(RingCorner {
                    vertex,
                    before: start + (i + n - 1) % n,
                    after: start + (i + 1) % n,
                    twin: NONE,
                    ring: r as u32,
                    open_before: NONE,
                    open_after: NONE,
                });
            }
            let first = if n == 0 { NONE } else { start };
            out.rings.push(LinkedRing { first, count: ring.len(), bad: 0 });
        }
        out.holder = vec![NONE; out.names.len()];
        out.find_twins();
        for c in 0..out.corners.len() as u32 {
            let RingCorner { before, after, ring, .. } = out.corners[c as usize];
            out.rings[ring as usize].bad += out.refused(before, c, after);
        }
        out
    }

    /// Pairs the edges that run both ways. A ring that has a corner twice, or an edge that another
    /// one has too, joins with none.
    fn find_twins(&mut self) {
        let mut lone = vec![false; self.rings.len()];
        let mut edges: Map<(u32, u32), u32> = Map::default();
        let mut last = vec![NONE; self.names.len()];
        for (c, corner) in self.corners.iter().enumerate() {
            let seen = std::mem::replace(&mut last[corner.vertex as usize], corner.ring);
            lone[corner.ring as usize] |= seen == corner.ring;
            let edge = (corner.vertex, self.corners[corner.after as usize].vertex);
            if let Some(other) = edges.insert(edge, c as u32) {
                lone[corner.ring as usize] = true;
                lone[self.corners[other as usize].ring as usize] = true;
            }
        }
        for c in 0..self.corners.len() {
            let corner = self.corners[c];
            let edge = (self.corners[corner.after as usize].vertex, corner.vertex);
            let joins = |&t: &u32| !lone[self.corners[t as usize].ring as usize];
            let twin = edges.get(&edge).copied().filter(joins);
            if let Some(twin) = twin.filter(|_| !lone[corner.ring as usize]) {
                self.corners[c].twin = twin;
            }
        }
    }

    fn vertex(&self, c: u32) -> u32 {
        self.corners[c as usize].vertex
    }

    fn before(&self, c: u32) -> u32 {
        self.corners[c as usize].before
    }

    fn after(&self, c: u32) -> u32 {
        self.corners[c as usize].after
    }

    fn twin(&self, c: u32) -> u32 {
        self.corners[c as usize].twin
    }

    /// 1 if the corner `o` between two others is not accepted.
    fn refused(&self, a: u32, o: u32, b: u32) -> usize {
        let [a, o, b] = [a, o, b].map(|c| self.names[self.vertex(c) as usize]);
        usize::from(!(self.accept)(a, o, b))
    }

    /// Joins a ring with others until none is left that it can be joined with: by the first of its
    /// edges that does, each time from its first corner on.
    fn grow(&mut self, ring: u32) {
        let LinkedRing { first, count, .. } = self.rings[ring as usize];
        if first == NONE {
            return;
        }
        let (mut from, mut open) = (first, count);
        let mut c = first;
        for _ in 0..count {
            let corner = &mut self.corners[c as usize];
            (corner.open_before, corner.open_after) = (corner.before, corner.after);
            self.holder[corner.vertex as usize] = ring;
            c = corner.after;
        }
        'again: loop {
            let (mut c, mut left) = (from, open);
            while left > 0 {
                left -= 1;
                let next = self.corners[c as usize].open_after;
                let twin = self.twin(c);
                if twin == NONE || self.corners[twin as usize].ring == ring {
                    // Stays so.
                    self.close(c);
                    open -= 1;
                    from = if c == from { next } else { from };
                } else if let Some(chain) = self.chain(ring, c) {
                    let added = self.join(ring, &chain, open);
                    (from, open) = (added.0, open - chain.length + added.1);
                    continue 'again;
                }
                c = next;
            }
            return;
        }
    }

    /// Removes an edge from the list.
    fn close(&mut self, c: u32) {
        let RingCorner { open_before: b, open_after: a, .. } = self.corners[c as usize];
        self.corners[b as usize].open_after = a;
        self.corners[a as usize].open_before = b;
    }

    /// The chain that holds an edge of a ring, if the two rings can be joined along it.
    fn chain(&self, ring: u32, edge: u32) -> Option<CommonChain> {
        let twin = self.twin(edge);
        let other = self.rings[self.corners[twin as usize].ring as usize];
        let own = self.rings[ring as usize];
        let most = own.count.min(other.count);
        let (mut first, mut first_twin, mut length) = (edge, twin, 1);
        while length < most && self.twin(self.before(first)) == self.after(first_twin) {
            (first, first_twin) = (self.before(first), self.after(first_twin));
            length += 1;
        }
        let (mut last, mut last_twin) = (edge, twin);
        while length < most && self.twin(self.after(last)) == self.before(last_twin) {
            (last, last_twin) = (self.after(last), self.before(last_twin));
            length += 1;
        }
        if length >= most {
            return None;
        }
        let (mut common, mut c) = (0, first_twin);
        for _ in 0..other.count {
            common += usize::from(self.holder[self.vertex(c) as usize] == ring);
            if common > length + 1 {
                return None;
            }
            c = self.after(c);
        }
        // The corners at the chain go, and two come.
        let mut bad = own.bad + other.bad;
        let (mut c, mut t) = (first, self.after(first_twin));
        for _ in 0..=length {
            bad -= self.refused(self.before(c), c, self.after(c));
            bad -= self.refused(self.before(t), t, self.after(t));
            (c, t) = (self.after(c), self.before(t));
        }
        let start = self.after(first_twin);
        bad += self.refused(self.before(first), start, self.after(start));
        bad += self.refused(self.before(last_twin), last_twin, self.after(self.after(last)));
        let chain = CommonChain { first, last, first_twin, last_twin, length, bad };
        (common == length + 1 && bad == 0).then_some(chain)
    }

    /// Joins a ring along a chain, with `open` edges in the list. Returns the first edge of the
    /// list from now on, and the number of edges that came into it.
    fn join(&mut self, ring: u32, chain: &CommonChain, open: usize) -> (u32, usize) {
        let other = self.corners[chain.first_twin as usize].ring as usize;
        let mut c = chain.first;
        for k in 0..chain.length {
            if k > 0 {
                // Only the ends of the chain stay corners.
                let vertex = self.vertex(c);
                self.holder[vertex as usize] = NONE;
            }
            self.close(c);
            c = self.after(c);
        }
        let next = self.corners[chain.last as usize].open_after;
        let (before, after) = (self.before(chain.first), self.after(chain.last));
        let (start, end) = (self.after(chain.first_twin), self.before(chain.last_twin));
        let added = self.rings[other].count - chain.length;
        let mut c = start;
        for _ in 0..added {
            let corner = &mut self.corners[c as usize];
            (corner.ring, corner.open_before, corner.open_after) =
                (ring, corner.before, corner.after);
            self.holder[corner.vertex as usize] = ring;
            c = corner.after;
        }
        let (first, last) = match open > chain.length {
            true => (next, self.corners[next as usize].open_before),
            false => (start, end),
        };
        for (a, b) in [(last, start), (end, first)] {
            self.corners[a as usize].open_after = b;
            self.corners[b as usize].open_before = a;
        }
        for (a, b) in [(before, start), (end, after)] {
            self.corners[a as usize].after = b;
            self.corners[b as usize].before = a;
        }
        self.rings[other].first = NONE;
        let own = &mut self.rings[ring as usize];
        *own = LinkedRing { first: after, count: own.count - chain.length + added, bad: chain.bad };
        (first, added)
    }

    fn into_rings(self) -> Vec<Vec<u32>> {
        let there = self.rings.iter().filter(|r| r.first != NONE);
        let ring = |r: &LinkedRing| {
            let mut c = r.first;
            (0..r.count)
                .map(|_| {
                    let here = c;
                    c = self.after(c);
                    self.names[self.vertex(here) as usize]
                })
                .collect()
        };
        there.map(ring).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same by looking at whole rings, and at all edges again after each step.
    fn joined_slowly(rings: &[Vec<u32>], accept: impl Fn(u32, u32, u32) -> bool) -> Vec<Vec<u32>> {
        let mut rings: Vec<Option<Vec<u32>>> = rings.iter().cloned().map(Some).collect();
        let joined = |p: &[u32], q: &[u32]| {
            let (n, m) = (p.len(), q.len());
            let common = p.iter().filter(|v| q.contains(v)).count();
            let back = |i: usize| {
                let (a, b) = (p[i % n], p[(i + 1) % n]);
                (0..m).any(|k| q[k] == b && q[(k + 1) % m] == a)
            };
            let start = (0..n).find(|&i| back(i) && !back(i + n - 1))?;
            let length = (0..n).take_while(|&k| back(start + k)).count();
            if common != length + 1 || length >= n.min(m) {
                return None;
            }
            let mut out: Vec<u32> = (length..=n).map(|k| p[(start + k) % n]).collect();
            let from = q.iter().position(|&v| v == p[start % n])?;
            out.extend((1..m - length).map(|k| q[(from + k) % m]));
            (out.len() >= 3).then_some(out)
        };
        let good = |r: &[u32]| {
            let n = r.len();
            (0..n).all(|i| accept(r[(i + n - 1) % n], r[i], r[(i + 1) % n]))
        };
        let mut i = 0;
        while i < rings.len() {
            let Some(own) = rings[i].clone() else {
                i += 1;
                continue;
            };
            let made = (0..own.len()).find_map(|k| {
                let (a, b) = (own[k], own[(k + 1) % own.len()]);
                let has =
                    |r: &Vec<u32>| (0..r.len()).any(|k| (r[k], r[(k + 1) % r.len()]) == (b, a));
                let j = rings.iter().position(|r| r.as_ref().is_some_and(has))?;
                let other = rings[j].as_ref().filter(|_| j != i)?;
                joined(&own, other).filter(|r| good(r)).map(|r| (j, r))
            });
            match made {
                Some((j, r)) => (rings[j], rings[i]) = (None, Some(r)),
                None => i += 1,
            }
        }
        rings.into_iter().flatten().collect()
    }

    #[test]
    fn rings_are_those_of_looking_at_all_edges_again() {
        let mut seed = 7u64;
        let mut dice = |n: u64| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 40) % n
        };
        for round in 0..300 {
            // Cells of a grid, some of them halved, some left out, in any order, from any corner.
            let side = 2 + dice(6) as u32;
            let at: Vec<DVec3> = (0..(side + 1) * (side + 1))
                .map(|v| {
                    let (x, y) = (v % (side + 1), v / (side + 1));
                    DVec3::new(f64::from(x), f64::from(y * y), 0.0)
                })
                .collect();
            let mut rings: Vec<Vec<u32>> = Vec::new();
            for cell in 0..side * side {
                let a = cell / side * (side + 1) + cell % side;
                let [b, c, d] = [a + 1, a + side + 2, a + side + 1];
                match dice(4) {
                    0 => {}
                    1 => rings.push(vec![a, b, c, d]),
                    2 => rings.extend([vec![a, b, c], vec![a, c, d]]),
                    _ => rings.extend([vec![a, b, d], vec![b, c, d]]),
                }
            }
            for i in (1..rings.len()).rev() {
                let n = rings[i].len() as u64;
                rings[i].rotate_left(dice(n) as usize);
                rings.swap(i, dice(i as u64 + 1) as usize);
            }
            let no_spike = |a, o, b| !spike(&at, a, o, b);
            let convex = |a: u32, o: u32, b: u32| {
                let [a, o, b] = [a, o, b].map(|v| at[v as usize]);
                (o - a).cross(b - o).z >= 0.0
            };
            assert_eq!(joined_rings(&rings, &at), joined_slowly(&rings, no_spike), "{round}");
            let made = joined_rings_where(&rings, convex);
            assert_eq!(made, joined_slowly(&rings, convex), "{round}");
        }
    }

    #[test]
    fn rings_that_touch_themselves_or_share_an_edge_stay() {
        let at = vec![DVec3::ZERO; 8];
        let twice = vec![vec![0, 1, 2, 3, 1, 4], vec![1, 0, 5], vec![6, 7, 0], vec![6, 7, 1]];
        assert_eq!(joined_rings(&twice, &at), twice);
        assert!(joined_rings(&[Vec::new()], &at).is_empty());
    }
}

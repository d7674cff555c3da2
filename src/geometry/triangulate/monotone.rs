//! Large simple polygons into triangles in n log n steps: a sweep divides the polygon into pieces
//! that are monotone along y (Garey, Johnson, Preparata and Tarjan, "Triangulating a simple
//! polygon", 1978), each piece is cut from top to bottom with a stack, and a bounded number of
//! flips (Lawson 1977) makes the triangles rounder.
//!
//! Signs are exact (Shewchuk's `orient2d`), and no point is computed. A polygon that touches or
//! crosses itself gives `None`, never triangles that overlap.

use rayon::prelude::*;
use robust::{Coord, incircle, orient2d};

const NONE: u32 = u32::MAX;

/// Flips allowed a corner. Random and smooth polygons need fewer than three.
const MOST_FLIPS: usize = 16;

/// Returns the triangles of a polygon that runs counter-clockwise, two fewer than its corners, each
/// counter-clockwise; `None` if the polygon touches or crosses itself. Diagonals that are not
/// `allowed` are flipped where the polygon has another one.
pub fn triangles(
    points: &[Coord<f64>],
    allowed: impl Fn(usize, usize) -> bool,
) -> Option<Vec<[u32; 3]>> {
    let order = Order::new(points)?;
    let pieces = Pieces::new(points, &order)?;
    let mut out = pieces.cut(&order)?;
    improve(points, &mut out, allowed);
    Some(out)
}

/// The corners from top to bottom, and from left to right where they are equally high.
struct Order {
    corners: Vec<u32>,
    /// Place of each corner in `corners`.
    rank: Vec<u32>,
}

impl Order {
    /// None where two corners are at one place.
    fn new(points: &[Coord<f64>]) -> Option<Order> {
        let compare = |&i: &u32, &j: &u32| {
            let (p, q) = (points[i as usize], points[j as usize]);
            q.y.total_cmp(&p.y).then(p.x.total_cmp(&q.x))
        };
        let mut corners: Vec<u32> = (0..points.len() as u32).collect();
        corners.par_sort_unstable_by(compare);
        let same = |w: &[u32]| {
            let (p, q) = (points[w[0] as usize], points[w[1] as usize]);
            (p.x, p.y) == (q.x, q.y)
        };
        if corners.windows(2).any(same) {
            return None;
        }
        let mut rank = vec![0; points.len()];
        corners.iter().enumerate().for_each(|(i, &c)| rank[c as usize] = i as u32);
        Some(Order { corners, rank })
    }

    fn above(&self, i: usize, j: usize) -> bool {
        self.rank[i] < self.rank[j]
    }
}

/// The edges at the height of the sweep that have the inside on their right, from left to right: a
/// treap (Seidel and Aragon 1996). Edge `i` goes down from corner `i` to the next.
struct ActiveEdges<'a> {
    points: &'a [Coord<f64>],
    /// Both children of each edge, and what it hangs on.
    children: Vec<[u32; 2]>,
    parent: Vec<u32>,
    priority: Vec<u32>,
    root: u32,
}

impl<'a> ActiveEdges<'a> {
    fn new(points: &'a [Coord<f64>]) -> Self {
        let n = points.len();
        let mixed = |edge: u32| {
            let mixed = (edge ^ (edge >> 16)).wrapping_mul(0x7feb_352d);
            (mixed ^ (mixed >> 15)).wrapping_mul(0x846c_a68b)
        };
        ActiveEdges {
            points,
            children: vec![[NONE; 2]; n],
            parent: vec![NONE; n],
            priority: (0..n as u32).map(mixed).collect(),
            root: NONE,
        }
    }

    fn outranks(&self, edge: u32, other: u32) -> bool {
        self.priority[edge as usize] > self.priority[other as usize]
    }

    /// The edge next to a place on its left, and where a new edge from there hangs. None where the
    /// place is on an edge.
    fn find(&self, p: Coord<f64>) -> Option<(u32, u32, usize)> {
        let (mut at, mut left, mut parent, mut side) = (self.root, NONE, NONE, 0);
        while at != NONE {
            let next = (at as usize + 1) % self.points.len();
            let turn = orient2d(self.points[at as usize], self.points[next], p);
            if turn == 0.0 {
                return None;
            }
            side = usize::from(turn > 0.0);
            if side == 1 {
                left = at;
            }
            parent = at;
            at = self.children[at as usize][side];
        }
        Some((left, parent, side))
    }

    /// Hangs `new`, or nothing, where `old` was.
    fn attach(&mut self, new: u32, old: u32, parent: u32) {
        if new != NONE {
            self.parent[new as usize] = parent;
        }
        match parent {
            NONE => self.root = new,
            _ => {
                let side = usize::from(self.children[parent as usize][1] == old);
                self.children[parent as usize][side] = new;
            }
        }
    }

    /// Turns the edge `child` up over its parent.
    fn lift(&mut self, child: u32) {
        let parent = self.parent[child as usize];
        let above = self.parent[parent as usize];
        let side = usize::from(self.children[parent as usize][1] == child);
        let inner = self.children[child as usize][1 - side];
        self.attach(child, parent, above);
        self.children[parent as usize][side] = inner;
        if inner != NONE {
            self.parent[inner as usize] = parent;
        }
        self.children[child as usize][1 - side] = parent;
        self.parent[parent as usize] = child;
    }

    fn insert(&mut self, edge: u32, parent: u32, side: usize) {
        self.children[edge as usize] = [NONE; 2];
        self.parent[edge as usize] = parent;
        if parent == NONE {
            self.root = edge;
            return;
        }
        self.children[parent as usize][side] = edge;
        while self.parent[edge as usize] != NONE && self.outranks(edge, self.parent[edge as usize])
        {
            self.lift(edge);
        }
    }

    fn remove(&mut self, edge: u32) {
        loop {
            let [left, right] = self.children[edge as usize];
            if left == NONE || right == NONE {
                let child = if left == NONE { right } else { left };
                self.attach(child, edge, self.parent[edge as usize]);
                self.parent[edge as usize] = NONE;
                return;
            }
            self.lift(if self.outranks(left, right) { left } else { right });
        }
    }

    /// Puts the edge that follows at the lower end of another in the other's place.
    fn replace(&mut self, old: u32, new: u32) {
        self.children[new as usize] = self.children[old as usize];
        self.attach(new, old, self.parent[old as usize]);
        for child in self.children[new as usize].into_iter().filter(|c| *c != NONE) {
            self.parent[child as usize] = new;
        }
        self.priority[new as usize] = self.priority[old as usize];
    }
}

/// The polygon in loops that are monotone. Each corner is a node, and a further one for each
/// diagonal at it.
struct Pieces<'a> {
    points: &'a [Coord<f64>],
    /// Corner of each node.
    corner: Vec<u32>,
    next: Vec<u32>,
    prev: Vec<u32>,
    /// Another node of the same corner.
    twin: Vec<u32>,
    diagonals: usize,
}

impl<'a> Pieces<'a> {
    fn new(points: &'a [Coord<f64>], order: &Order) -> Option<Pieces<'a>> {
        let n = points.len();
        let around = |i: usize, by: usize| ((i + by) % n) as u32;
        let mut out = Pieces {
            points,
            corner: (0..n as u32).collect(),
            next: (0..n).map(|i| around(i, 1)).collect(),
            prev: (0..n).map(|i| around(i, n - 1)).collect(),
            twin: vec![NONE; n],
            diagonals: 0,
        };
        let mut active = ActiveEdges::new(points);
        // The lowest corner above that sees the edge, and whether the boundary ends there.
        let mut helper: Vec<(u32, bool)> = vec![(NONE, false); n];
        for &v in &order.corners {
            let i = v as usize;
            let (before, after) = ((i + n - 1) % n, (i + 1) % n);
            let p = points[i];
            let down = (!order.above(before, i), order.above(i, after));
            let bend = orient2d(points[before], p, points[after]);
            match down {
                // Both neighbours are below.
                (true, true) => {
                    let (left, parent, side) = active.find(p)?;
                    if bend < 0.0 {
                        let (other, _) = *helper.get(left as usize)?;
                        out.divide(v, other)?;
                        helper[left as usize] = (v, false);
                    } else if bend == 0.0 {
                        return None;
                    }
                    active.insert(v, parent, side);
                    helper[i] = (v, false);
                }
                // Both are above.
                (false, false) => {
                    if bend == 0.0 {
                        return None;
                    }
                    out.end(v, helper[before])?;
                    active.remove(before as u32);
                    if bend < 0.0 {
                        let (left, ..) = active.find(p)?;
                        out.end(v, *helper.get(left as usize)?)?;
                        helper[left as usize] = (v, true);
                    }
                }
                // The boundary goes down, with the inside on its right.
                (false, true) => {
                    out.end(v, helper[before])?;
                    active.replace(before as u32, v);
                    helper[i] = (v, false);
                }
                (true, false) => {
                    let (left, ..) = active.find(p)?;
                    out.end(v, *helper.get(left as usize)?)?;
                    helper[left as usize] = (v, false);
                }
            }
        }
        Some(out)
    }

    /// A diagonal up to a helper below which the boundary ended.
    fn end(&mut self, v: u32, (helper, merged): (u32, bool)) -> Option<()> {
        if merged { self.divide(v, helper) } else { Some(()) }
    }

    /// The node of a corner from which the inside is seen towards another corner.
    fn node(&self, corner: u32, towards: u32) -> Option<u32> {
        let place = |node: u32| self.points[self.corner[node as usize] as usize];
        let (a, p) = (self.points[corner as usize], self.points[towards as usize]);
        let mut node = corner;
        while node != NONE {
            let (b, c) = (place(self.prev[node as usize]), place(self.next[node as usize]));
            let (first, second) = (orient2d(b, a, p) > 0.0, orient2d(a, c, p) > 0.0);
            let convex = orient2d(b, a, c) > 0.0;
            if if convex { first && second } else { first || second } {
                return Some(node);
            }
            node = self.twin[node as usize];
        }
        None
    }

    /// Divides a loop by the diagonal between two of its corners.
    fn divide(&mut self, i: u32, j: u32) -> Option<()> {
        if i == j || j == NONE {
            return None;
        }
        let (a, b) = (self.node(i, j)?, self.node(j, i)?);
        let (a, b) = (a as usize, b as usize);
        let (x, y) = (self.corner.len(), self.corner.len() + 1);
        let (after, before) = (self.next[a], self.prev[b]);
        self.corner.extend([i, j]);
        self.next.extend([after, x as u32]);
        self.prev.extend([y as u32, before]);
        self.twin.extend([self.twin[a], self.twin[b]]);
        (self.twin[a], self.twin[b]) = (x as u32, y as u32);
        (self.next[a], self.prev[b]) = (b as u32, a as u32);
        self.prev[after as usize] = x as u32;
        self.next[before as usize] = y as u32;
        self.diagonals += 1;
        Some(())
    }

    /// The triangles of all loops. None where a loop is not monotone, or a diagonal joined two.
    fn cut(&self, order: &Order) -> Option<Vec<[u32; 3]>> {
        let mut done = vec![false; self.corner.len()];
        let (mut out, mut loops) = (Vec::with_capacity(self.points.len() - 2), 0);
        let (mut ring, mut sorted, mut stack) = (Vec::new(), Vec::new(), Vec::new());
        for start in 0..self.corner.len() {
            if done[start] {
                continue;
            }
            ring.clear();
            let mut node = start;
            while !done[node] {
                done[node] = true;
                ring.push(self.corner[node]);
                node = self.next[node] as usize;
            }
            loops += 1;
            if ring.len() < 3 {
                return None;
            }
            self.cut_one(&mut ring, order, &mut sorted, &mut stack, &mut out)?;
        }
        (loops == self.diagonals + 1).then_some(out)
    }

    fn cut_one(
        &self,
        ring: &mut [u32],
        order: &Order,
        sorted: &mut Vec<(u32, bool)>,
        stack: &mut Vec<(u32, bool)>,
        out: &mut Vec<[u32; 3]>,
    ) -> Option<()> {
        let rank = |v: u32| order.rank[v as usize];
        let top = (0..ring.len()).min_by_key(|&k| rank(ring[k]))?;
        ring.rotate_left(top);
        let bottom = (0..ring.len()).max_by_key(|&k| rank(ring[k]))?;
        // The left side runs down, the right side up.
        let (left, right) = ring.split_at(bottom);
        if !left.is_sorted_by_key(|&v| rank(v))
            || !right.is_sorted_by_key(|&v| std::cmp::Reverse(rank(v)))
        {
            return None;
        }
        sorted.clear();
        let (mut l, mut r) = (0, right.len());
        while l < left.len() || r > 0 {
            let from_left = r == 0 || l < left.len() && rank(left[l]) < rank(right[r - 1]);
            if from_left {
                sorted.push((left[l], true));
                l += 1;
            } else {
                r -= 1;
                sorted.push((right[r], false));
            }
        }
        let mut push = |a: u32, b: u32, c: u32| {
            let [p, q, r] = [a, b, c].map(|v| self.points[v as usize]);
            (orient2d(p, q, r) > 0.0).then(|| out.push([a, b, c]))
        };
        // A triangle of one corner and two on the stack, the upper one first.
        let way = |v: u32, upper: u32, lower: u32, left: bool| {
            if left { [v, upper, lower] } else { [v, lower, upper] }
        };
        stack.clear();
        stack.extend(&sorted[..2]);
        for (k, &(v, left)) in sorted.iter().enumerate().skip(2) {
            let &(last, side) = stack.last()?;
            if k + 1 == sorted.len() || left != side {
                // The stack is on the other side; at the bottom, it is on the side of its last.
                for w in stack.windows(2) {
                    let [a, b, c] = way(v, w[0].0, w[1].0, side);
                    push(a, b, c)?;
                }
                stack.clear();
                stack.push((last, side));
            } else {
                while let [.., (upper, _), (lower, _)] = stack[..] {
                    let [a, b, c] = way(v, upper, lower, left);
                    let [p, q, r] = [a, b, c].map(|v| self.points[v as usize]);
                    if orient2d(p, q, r) <= 0.0 {
                        break;
                    }
                    push(a, b, c)?;
                    stack.pop();
                }
            }
            stack.push((v, left));
        }
        Some(())
    }
}

/// Flips diagonals to those of rounder triangles, and away from those that are not allowed.
fn improve(
    points: &[Coord<f64>],
    triangles: &mut [[u32; 3]],
    allowed: impl Fn(usize, usize) -> bool,
) {
    // Side k of a triangle goes from its corner k to the next. Across it: triangle * 3 + side.
    let n = points.len() as u32;
    let corners = |t: [u32; 3], k: usize| (t[k], t[(k + 1) % 3]);
    let mut half: Vec<(u64, u32)> = Vec::with_capacity(3 * triangles.len());
    for (t, &triangle) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = corners(triangle, k);
            let gap = a.abs_diff(b);
            if gap != 1 && gap != n - 1 {
                half.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), (3 * t + k) as u32));
            }
        }
    }
    half.par_sort_unstable();
    let mut across = vec![NONE; 3 * triangles.len()];
    let mut queue = std::collections::VecDeque::with_capacity(half.len() / 2);
    for w in half.chunk_by(|a, b| a.0 == b.0) {
        let [x, y] = w else { continue };
        across[x.1 as usize] = y.1;
        across[y.1 as usize] = x.1;
        queue.push_back(x.1);
    }
    drop(half);
    let mut left = MOST_FLIPS * points.len();
    while let Some(x) = queue.pop_front() {
        let y = across[x as usize];
        if y == NONE {
            continue;
        }
        let (t, k) = (x as usize / 3, x as usize % 3);
        let (u, m) = (y as usize / 3, y as usize % 3);
        let (a, b) = corners(triangles[t], k);
        let (c, d) = (triangles[t][(k + 2) % 3], triangles[u][(m + 2) % 3]);
        let at = |v: u32| points[v as usize];
        // Robust's sign is positive inside the circle.
        let better = match (allowed(a as usize, b as usize), allowed(c as usize, d as usize)) {
            (true, true) => incircle(at(a), at(b), at(c), at(d)) > 0.0,
            (now, then) => !now && then,
        };
        if !better || orient2d(at(c), at(d), at(b)) <= 0.0 || orient2d(at(d), at(c), at(a)) <= 0.0 {
            continue;
        }
        // From a-b-c and b-a-d to c-a-d and c-d-b.
        let (bc, ca) = (3 * t + (k + 1) % 3, 3 * t + (k + 2) % 3);
        let (ad, db) = (3 * u + (m + 1) % 3, 3 * u + (m + 2) % 3);
        let outer = [ca, ad, db, bc].map(|s| across[s]);
        triangles[t] = [c, a, d];
        triangles[u] = [c, d, b];
        let sides = [3 * t, 3 * t + 1, 3 * u + 1, 3 * u + 2];
        for (&side, &other) in sides.iter().zip(&outer) {
            across[side] = other;
            if other != NONE {
                across[other as usize] = side as u32;
                queue.push_back(side as u32);
            }
        }
        across[3 * t + 2] = (3 * u) as u32;
        across[3 * u] = (3 * t + 2) as u32;
        left -= 1;
        if left == 0 {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::PolyMesh;
    use crate::triangulate::area_vector;

    fn polar(radius: f64, angle: f64) -> (f64, f64) {
        (radius * angle.cos(), radius * angle.sin())
    }

    /// A band that goes up and down, a spiral band, and a star with random points.
    fn shapes(n: usize) -> [(&'static str, Vec<(f64, f64)>); 3] {
        let half = n / 2;
        let band = |f: &dyn Fn(usize, bool) -> (f64, f64)| -> Vec<(f64, f64)> {
            let there = (0..half).map(|i| f(i, false));
            there.chain((0..half).rev().map(|i| f(i, true))).collect()
        };
        let zigzag = |i: usize, back: bool| {
            (i as f64, if i.is_multiple_of(2) { 0.0 } else { 50.0 } + f64::from(u8::from(back)))
        };
        let spiral = |i: usize, back: bool| {
            let width = if back { 0.0 } else { 0.4 };
            polar(1.0 + i as f64 / 100.0 + width, i as f64 * TAU / 100.0)
        };
        let mut seed = 7u64;
        let mut unit = || {
            seed = seed.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let star = (0..n).map(|i| polar(9.0 + unit(), i as f64 * TAU / n as f64)).collect();
        [("zigzag", band(&zigzag)), ("spiral", band(&spiral)), ("star", star)]
    }

    #[test]
    fn large_polygons_with_deep_bays_are_covered_once() {
        for n in [20_000, 200_000] {
            for (name, outline) in shapes(n) {
                let mut mesh = PolyMesh::new();
                mesh.positions = outline.iter().map(|p| glam::DVec3::new(p.0, p.1, 1.0)).collect();
                mesh.push_face(&(0..n as u32).collect::<Vec<_>>());
                let whole = area_vector(&mesh.positions, mesh.face(0)).z;
                let (made, _) = mesh.triangles();
                assert_eq!(made.len(), n - 2, "{name}");
                let areas = made.iter().map(|t| area_vector(&mesh.positions, t).z * whole.signum());
                assert!(areas.clone().all(|a| a > 0.0), "{name} of {n}: a triangle is inverted");
                let sum: f64 = areas.sum();
                assert!((sum - whole.abs()).abs() <= 1e-9 * sum, "{name}: {sum} of {whole}");
            }
        }
    }

    #[test]
    fn a_polygon_that_touches_or_crosses_itself_is_left_to_ears() {
        let of = |list: &[(f64, f64)]| {
            let points: Vec<_> = list.iter().map(|&(x, y)| Coord { x, y }).collect();
            triangles(&points, |_, _| true)
        };
        let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)];
        assert_eq!(of(&square).map(|t| t.len()), Some(2));
        // A corner on an edge, two corners in one place, and edges that cross.
        assert!(of(&[(0., 0.), (2., 0.), (2., 2.), (1., 0.), (0., 2.)]).is_none());
        assert!(of(&[(0., 0.), (1., 1.), (2., 0.), (2., 2.), (1., 1.), (0., 2.)]).is_none());
        assert!(of(&[(0., 0.), (2., 0.), (0., 2.), (2., 2.), (3., 5.)]).is_none());
    }

    #[test]
    fn diagonals_that_are_not_allowed_are_flipped() {
        let points: Vec<_> = (0..64)
            .map(|i| polar(1.0, f64::from(i) * TAU / 64.0))
            .map(|(x, y)| Coord { x, y })
            .collect();
        let sides = |all: &[[u32; 3]]| -> Vec<(usize, usize)> {
            let of = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
            let all = all.iter().flat_map(of).map(|(a, b)| (a.min(b), a.max(b)));
            let inner = all.filter(|(a, b)| b - a > 1 && b - a < 63);
            inner.map(|(a, b)| (a as usize, b as usize)).collect()
        };
        let first = triangles(&points, |_, _| true).expect("simple");
        let taken = sides(&first)[10];
        let allowed = |a: usize, b: usize| (a.min(b), a.max(b)) != taken;
        let second = triangles(&points, allowed).expect("simple");
        assert_eq!(second.len(), 62);
        assert!(sides(&second).iter().all(|&(a, b)| allowed(a, b)));
    }
}

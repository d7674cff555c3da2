//! Split, collapse and flip, each only where the surface stays a surface and no triangle becomes a
//! sliver.
//!
//! Guarantees: what was a manifold stays one, with the same Euler characteristic (collapses keep
//! the link condition of Dey, Edelsbrunner, Guha and Nekhayev 1999; splits and flips cannot change
//! it). Borders stay where they are. No vertex gets more than [`MOST_NEIGHBOURS`] neighbours or
//! fewer than three. An operation leaves no angle below 3 degrees that is smaller than the smallest
//! about it before, and turns no triangle by more than about 70 degrees. Protected vertices stay.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::sync::Arc;

use glam::{Vec3, Vec4};

use super::edit::{CLOSED, DEAD, Edit, MOST_NEIGHBOURS, OPEN};
use super::scan::{Candidate, EdgeTask};
use super::shape::{FLAT, FLIP_BELOW, FLIP_GAIN, LEAST, normal, sine2};
use super::{Cuts, Detail, PAGE_WRITE, PROTECTED, Within};
use crate::page::Page;
use crate::page_sets::HIDDEN;

/// The triangles of a moved vertex may turn so far, as a cosine: further is a fold.
const TURN: f32 = 0.35;
/// The squared sine above which a collapse never fails for its angles: 20 degrees.
const GOOD: f32 = 0.117;

/// An edge to be split: its squared length, its ends, and the ball that asks.
type Long = (u32, Reverse<(u32, u32)>, u8);

/// The lists of one pass, kept from pass to pass.
#[derive(Debug, Default)]
pub(crate) struct Queues {
    long: BinaryHeap<Long>,
    short: Vec<(u32, u32, u32, u8)>,
    flips: VecDeque<(u32, u32, u8)>,
}

impl Queues {
    /// Makes room for what a tick's work usually needs.
    pub(crate) fn reserve(&mut self) {
        self.long.reserve(1 << 13);
        self.short.reserve(1 << 12);
        self.flips.reserve(1 << 14);
    }
}

/// One pass over the edges that were found, page by page.
pub(crate) struct Pass<'a> {
    pub(crate) edit: &'a mut Edit,
    pub(crate) queues: &'a mut Queues,
    pub(crate) pages: &'a [Arc<Page>],
    pub(crate) balls: &'a [Detail],
    pub(crate) within: Within<'a>,
    pub(crate) cuts: Cuts,
    /// Counted work at most.
    pub(crate) budget: usize,
}

fn mean_colour(a: u32, b: u32) -> u32 {
    let (p, q) = (a.to_le_bytes(), b.to_le_bytes());
    let mean: [u8; 4] =
        std::array::from_fn(|i| (u16::from(p[i]) + u16::from(q[i])).div_ceil(2) as u8);
    u32::from_le_bytes(mean)
}

fn sorted(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Pass<'_> {
    /// Changes what was found in a page: the longest edges first, then the shortest, then flips.
    /// False where the budget was used up before all were tried.
    pub(crate) fn run(&mut self, found: &[Candidate]) -> bool {
        self.queues.long.clear();
        self.queues.short.clear();
        self.queues.flips.clear();
        for c in found {
            let [a, b] = c.ends.map(|end| self.edit.handle(self.pages, end));
            match c.task {
                EdgeTask::Split => self.queues.long.push((!c.rank, Reverse((a, b)), c.ball)),
                EdgeTask::Collapse => self.queues.short.push((c.rank, a, b, c.ball)),
                EdgeTask::Flip => self.queues.flips.push_back((a, b, c.ball)),
            }
        }
        while !self.queues.long.is_empty() {
            if self.is_spent() {
                return false;
            }
            if let Some((length, Reverse((a, b)), ball)) = self.queues.long.pop() {
                self.split(a, b, f32::from_bits(length), ball);
            }
        }
        let short = std::mem::take(&mut self.queues.short);
        for &(_, a, b, ball) in &short {
            if self.is_spent() {
                break;
            }
            self.collapse(a, b, ball);
        }
        self.queues.short = short;
        if self.is_spent() {
            return false;
        }
        // Each flip betters the smallest angle about its edge, so they come to an end; the bound
        // is for numbers that round.
        let mut left = 8 * self.queues.flips.len() + 64;
        while let Some((a, b, ball)) = self.queues.flips.pop_front() {
            if self.is_spent() {
                return false;
            }
            if left == 0 {
                break;
            }
            left -= 1;
            self.flip(a, b, ball);
        }
        true
    }

    /// Whether the budget is used up, with what writing the changed pages and half as many beside
    /// them will count.
    pub(crate) fn is_spent(&self) -> bool {
        self.cuts.work + self.edit.dirty.len() * (PAGE_WRITE + PAGE_WRITE / 2) >= self.budget
    }

    fn load(&mut self, h: u32) {
        self.edit.load(self.pages, h);
    }

    fn length2(&self, a: u32, b: u32) -> f32 {
        (self.edit.at(a) - self.edit.at(b)).length_squared()
    }

    fn mask(&self, h: u32) -> f32 {
        self.edit.points[h as usize].w
    }

    fn may_change(&self, h: u32, ball: u8) -> bool {
        self.mask(h) < PROTECTED
            && self.edit.sets[h as usize] & HIDDEN == 0
            && self.balls[ball as usize].contains(self.edit.at(h))
            && self.within.is_none_or(|within| within(self.edit.at(h)))
    }

    /// The corners opposite an edge: `c` left of it, seen from `a` to `b`, and `d` right of it.
    /// None where the edge is on a border, or its surroundings are not one surface.
    fn wings(&mut self, a: u32, b: u32) -> Option<(u32, u32)> {
        self.load(a);
        self.load(b);
        let e = &self.edit;
        if !e.has_ring(a) || !e.has_ring(b) || e.is(a, DEAD) || e.is(b, DEAD) {
            return None;
        }
        let beside = |of: u32, to: u32| {
            let ring = e.ring(of);
            let n = ring.len();
            let k = ring.iter().position(|&v| v == to)?;
            let once = ring[k + 1..].iter().all(|&v| v != to);
            let inner = e.is(of, CLOSED) || (k > 0 && k + 1 < n);
            (once && inner && n >= 3).then(|| (ring[(k + 1) % n], ring[(k + n - 1) % n]))
        };
        let (c, d) = beside(a, b)?;
        if beside(b, a)? != (d, c) || c == d {
            return None;
        }
        self.load(c);
        self.load(d);
        let e = &self.edit;
        let sound = e.has_ring(c)
            && e.has_ring(d)
            && e.has_triangle([c, a, b])
            && e.has_triangle([d, b, a]);
        sound.then_some((c, d))
    }

    fn offer(&mut self, a: u32, b: u32, ball: u8) {
        let length = self.length2(a, b);
        let longest = self.balls[ball as usize].longest();
        if length > longest * longest && self.may_change(a, ball) && self.may_change(b, ball) {
            let (a, b) = sorted(a, b);
            self.queues.long.push((length.to_bits(), Reverse((a, b)), ball));
        }
    }

    fn consider_flips(&mut self, edges: [(u32, u32); 4], ball: u8) {
        for (a, b) in edges {
            let (a, b) = sorted(a, b);
            self.queues.flips.push_back((a, b, ball));
        }
    }

    /// Puts a vertex in the middle of an edge.
    fn split(&mut self, a: u32, b: u32, length: f32, ball: u8) {
        self.cuts.work += 1;
        let Some((c, d)) = self.wings(a, b) else { return };
        let e = &self.edit;
        if self.length2(a, b) != length
            || [c, d].iter().any(|&v| e.ring(v).len() >= MOST_NEIGHBOURS)
        {
            return;
        }
        let (pa, pb, pc, pd) = (e.at(a), e.at(b), e.at(c), e.at(d));
        let middle: Vec4 = (e.points[a as usize] + e.points[b as usize]) * 0.5;
        let m = middle.truncate();
        let old = sine2(pa, pb, pc).min(sine2(pb, pa, pd));
        let new =
            sine2(pa, m, pc).min(sine2(m, pb, pc)).min(sine2(pb, m, pd)).min(sine2(m, pa, pd));
        if new < LEAST && new < old {
            return;
        }
        // A new edge that would be collapsed in turn: let a flip come first.
        let ball_of = &self.balls[ball as usize];
        let shortest = ball_of.shortest() * ball_of.shortest();
        let near = (pc - m).length_squared().min((pd - m).length_squared());
        if ball_of.collapse && near < shortest && length < 4.0 * ball_of.longest().powi(2) {
            self.queues.flips.push_back((a, b, ball));
            return;
        }
        let colour = mean_colour(e.colours[a as usize], e.colours[b as usize]);
        let e = &mut *self.edit;
        let v = e.make(a, middle, colour);
        e.rings[v as usize][..4].copy_from_slice(&[a, d, b, c]);
        e.valence[v as usize] = 4;
        e.replace_neighbour(a, b, v);
        e.replace_neighbour(b, a, v);
        e.insert_after(c, a, v);
        e.insert_after(d, b, v);
        [a, b, c, d].iter().for_each(|&h| e.mark(h));
        e.created.extend([[a, v, c], [v, b, c], [b, v, d], [v, a, d]]);
        self.cuts.splits += 1;
        for k in [a, b, c, d] {
            self.offer(k, v, ball);
        }
        for (p, q) in [(a, c), (c, b), (b, d), (d, a)] {
            self.offer(p, q, ball);
        }
        self.consider_flips([(a, c), (c, b), (b, d), (d, a)], ball);
    }

    /// Draws `a` and `b` together into `b`, in the middle of both.
    fn collapse(&mut self, a: u32, b: u32, ball: u8) {
        self.cuts.work += 2;
        let Some((c, d)) = self.wings(a, b) else { return };
        let ball_of = &self.balls[ball as usize];
        let (under, longest) = (ball_of.shortest().powi(2), ball_of.longest().powi(2));
        let e = &self.edit;
        let free = e.is(a, CLOSED)
            && e.is(b, CLOSED)
            && self.may_change(a, ball)
            && self.may_change(b, ball)
            && self.length2(a, b) < under;
        let count = e.ring(a).len() + e.ring(b).len();
        // A wing's corner loses a neighbour: three must be left, two on a border.
        let least = |h: u32| if e.is(h, OPEN) { 3 } else { 4 };
        if !free
            || count > MOST_NEIGHBOURS + 4
            || count < 7
            || e.ring(c).len() < least(c)
            || e.ring(d).len() < least(d)
        {
            return;
        }
        // The link condition: a and b share the wings' corners and nobody else.
        if e.ring(a).iter().filter(|&v| e.ring(b).contains(v)).count() != 2 {
            return;
        }
        let mut around = [0u32; MOST_NEIGHBOURS];
        let size = e.ring(a).len();
        around[..size].copy_from_slice(e.ring(a));
        let around = &around[..size];
        for &n in around {
            self.load(n);
        }
        let e = &self.edit;
        if around.iter().any(|&n| !e.has_ring(n)) {
            return;
        }
        let middle: Vec4 = (e.points[a as usize] + e.points[b as usize]) * 0.5;
        let m = middle.truncate();
        let (mut old, mut new) = (f32::INFINITY, f32::INFINITY);
        for (v, other) in [(a, b), (b, a)] {
            let (ring, here) = (e.ring(v), e.at(v));
            for (k, &p) in ring.iter().enumerate() {
                let q = ring[(k + 1) % ring.len()];
                let (pp, pq) = (e.at(p), e.at(q));
                old = old.min(sine2(here, pp, pq));
                if p == other || q == other {
                    continue;
                }
                let far = (pp - m).length_squared();
                if far > longest || normal(m, pp, pq).dot(normal(here, pp, pq)) < TURN {
                    return;
                }
                new = new.min(sine2(m, pp, pq));
            }
        }
        if new < LEAST.max(old * 0.5).min(GOOD) {
            return;
        }
        let e = &mut *self.edit;
        // The fan of `a` from c to d, the way that does not pass b.
        let from = around.iter().position(|&n| n == c).unwrap_or(0);
        let mut between = [0u32; MOST_NEIGHBOURS];
        let mut inner = 0;
        for k in 1..size {
            let n = around[(from + k) % size];
            if n == d {
                break;
            }
            between[inner] = n;
            inner += 1;
        }
        let between = &between[..inner];
        for &n in between {
            e.replace_neighbour(n, a, b);
        }
        e.remove_neighbour(c, a);
        e.remove_neighbour(d, a);
        match between.first() {
            None => e.remove_neighbour(b, a),
            Some(&first) => {
                e.replace_neighbour(b, a, first);
                for pair in between.windows(2) {
                    e.insert_after(b, pair[0], pair[1]);
                }
            }
        }
        e.points[b as usize] = middle;
        e.colours[b as usize] = mean_colour(e.colours[a as usize], e.colours[b as usize]);
        e.mark(a);
        e.state[a as usize] |= DEAD;
        e.mark(b);
        let mut last = c;
        for &n in between.iter().chain([&d]) {
            e.created.push([b, last, n]);
            last = n;
        }
        self.cuts.collapses += 1;
        let mut ring = [0u32; MOST_NEIGHBOURS];
        let size = self.edit.ring(b).len();
        ring[..size].copy_from_slice(self.edit.ring(b));
        for (k, &n) in ring[..size].iter().enumerate() {
            // The normals about it turn with it.
            self.load(n);
            self.edit.mark_turned(n);
            let next = ring[(k + 1) % size];
            for (p, q) in [sorted(b, n), sorted(n, next)] {
                self.queues.flips.push_back((p, q, ball));
            }
        }
    }

    /// Turns the edge between two triangles into their other diagonal, where that makes the
    /// smallest angle larger.
    fn flip(&mut self, a: u32, b: u32, ball: u8) {
        if !self.edit.is_placed(a) || !self.edit.is_placed(b) {
            self.load(a);
            self.load(b);
        }
        if !self.may_change(a, ball) || !self.may_change(b, ball) {
            return;
        }
        self.cuts.work += 1;
        let Some((c, d)) = self.wings(a, b) else { return };
        let e = &self.edit;
        let (pa, pb, pc, pd) = (e.at(a), e.at(b), e.at(c), e.at(d));
        let old = sine2(pa, pb, pc).min(sine2(pb, pa, pd));
        if old > FLIP_BELOW {
            return;
        }
        let room = [a, b].iter().all(|&v| e.is(v, CLOSED) && e.ring(v).len() > 3)
            && [c, d].iter().all(|&v| e.is(v, CLOSED) && e.ring(v).len() < MOST_NEIGHBOURS)
            && !e.ring(c).contains(&d);
        let new = sine2(pa, pd, pc).min(sine2(pd, pb, pc));
        if !room || new < old * FLIP_GAIN {
            return;
        }
        let (n, m): (Vec3, Vec3) = (normal(pa, pb, pc), normal(pb, pa, pd));
        let faces = (n + m).normalize_or_zero();
        let flat = n.dot(m) > FLAT || old < LEAST;
        if !flat || normal(pa, pd, pc).dot(faces) < FLAT || normal(pd, pb, pc).dot(faces) < FLAT {
            return;
        }
        let e = &mut *self.edit;
        e.remove_neighbour(a, b);
        e.remove_neighbour(b, a);
        e.insert_after(c, a, d);
        e.insert_after(d, b, c);
        [a, b, c, d].iter().for_each(|&h| e.mark(h));
        e.created.extend([[a, d, c], [d, b, c]]);
        self.cuts.flips += 1;
        self.consider_flips([(a, c), (c, b), (b, d), (d, a)], ball);
    }
}

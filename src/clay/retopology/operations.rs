//! Split, collapse and flip, each only where the surface stays a surface and no triangle becomes a
//! sliver.
//!
//! Guarantees: what was a manifold stays one, with the same Euler characteristic (collapses keep
//! the link condition of Dey, Edelsbrunner, Guha and Nekhayev 1999; splits and flips cannot change
//! it). Borders stay where they are. No vertex gets more than [`MOST_NEIGHBOURS`] neighbours or
//! fewer than three. An operation leaves no angle below 3 degrees that is smaller than the smallest
//! about it before, and turns no triangle by more than about 70 degrees. Protected vertices stay.
//!
//! Brushes squeeze triangles, so a triangle with an angle below 3 degrees is repaired wherever one
//! of its corners is in a ball. Its longest edge is flipped, else two of its corners are joined,
//! else one is slid along the surface ([`super::collapse`]), which may then turn a triangle by 90
//! degrees. A few cannot be repaired: their angles stayed above 1 degree in 50,000 random dabs.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::sync::Arc;

use glam::{Vec3, Vec4};

use super::edit::{CLOSED, DEAD, Edit, MOST_NEIGHBOURS};
use super::scan::{Candidate, EdgeTask};
use super::shape::{FLAT, FLIP_BELOW, FLIP_GAIN, LEAST, by_area, normal, sine2};
use super::{Cuts, Detail, PAGE_WRITE, PROTECTED, Within};
use crate::page::Page;
use crate::page_sets::HIDDEN;

/// The triangles of a moved vertex may turn so far, as a cosine: further is a fold.
pub(super) const TURN: f32 = 0.35;

/// An edge to be split: its squared length, its ends, and the ball that asks.
type Long = (u32, Reverse<(u32, u32)>, u8);

/// The lists of one pass, kept from pass to pass.
#[derive(Debug, Default)]
pub(crate) struct Queues {
    long: BinaryHeap<Long>,
    short: Vec<(u32, u32, u32, u8)>,
    slivers: Vec<(u32, u32, u8)>,
    pub(super) flips: VecDeque<(u32, u32, u8)>,
}

impl Queues {
    /// Makes room for what a tick's work usually needs.
    pub(crate) fn reserve(&mut self) {
        self.long.reserve(1 << 13);
        self.short.reserve(1 << 12);
        self.slivers.reserve(1 << 12);
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
    /// Vertices may be moved along the surface where nothing else ends a sliver.
    pub(crate) slides: bool,
    pub(crate) cuts: Cuts,
    /// Counted work at most.
    pub(crate) budget: usize,
}

pub(super) fn mean_colour(a: u32, b: u32) -> u32 {
    let (p, q) = (a.to_le_bytes(), b.to_le_bytes());
    let mean: [u8; 4] =
        std::array::from_fn(|i| (u16::from(p[i]) + u16::from(q[i])).div_ceil(2) as u8);
    u32::from_le_bytes(mean)
}

pub(super) fn sorted(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Pass<'_> {
    /// Changes what was found in a page: the longest edges first, then the shortest, then flips.
    /// False where the budget was used up before all were tried.
    pub(crate) fn run(&mut self, found: &[Candidate]) -> bool {
        self.queues.long.clear();
        self.queues.short.clear();
        self.queues.flips.clear();
        self.queues.slivers.clear();
        for c in found {
            let [a, b] = c.ends.map(|end| self.edit.handle(self.pages, end));
            match c.task {
                EdgeTask::Split => self.queues.long.push((!c.rank, Reverse((a, b)), c.ball)),
                EdgeTask::Collapse => self.queues.short.push((c.rank, a, b, c.ball)),
                EdgeTask::Flip => self.queues.flips.push_back((a, b, c.ball)),
                EdgeTask::Merge => self.queues.slivers.push((a, b, c.ball)),
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
        if !self.run_flips() {
            return false;
        }
        let slivers = std::mem::take(&mut self.queues.slivers);
        let mut tried = slivers.iter();
        while !self.is_spent()
            && let Some(&(a, b, ball)) = tried.next()
        {
            self.merge(a, b, ball);
        }
        let all = tried.len() == 0;
        self.queues.slivers = slivers;
        all && self.run_flips()
    }

    /// Flips what waits for it. False where the budget was used up before all were tried.
    fn run_flips(&mut self) -> bool {
        // Each flip betters the smallest angle about its edge, so they come to an end; the bound
        // is for numbers that round.
        let mut left = 8 * self.queues.flips.len() + 64;
        while let Some((a, b, ball)) = self.queues.flips.pop_front() {
            if self.is_spent() {
                return false;
            }
            if left == 0 {
                self.queues.flips.clear();
                break;
            }
            left -= 1;
            self.flip(a, b, ball);
        }
        true
    }

    /// Returns true if the budget is used up, including the cost of writing the changed pages and
    /// half as many neighbouring pages.
    pub(crate) fn is_spent(&self) -> bool {
        self.cuts.work + self.edit.dirty.len() * (PAGE_WRITE + PAGE_WRITE / 2) >= self.budget
    }

    pub(super) fn load(&mut self, h: u32) {
        self.edit.load(self.pages, h);
    }

    pub(super) fn length2(&self, a: u32, b: u32) -> f32 {
        (self.edit.at(a) - self.edit.at(b)).length_squared()
    }

    pub(super) fn may_change(&self, h: u32, ball: u8) -> bool {
        self.balls[ball as usize].contains(self.edit.at(h)) && self.is_free(h)
    }

    /// Returns true if a vertex may be changed, whatever ball it is in.
    pub(super) fn is_free(&self, h: u32) -> bool {
        self.edit.points[h as usize].w < PROTECTED
            && self.edit.sets[h as usize] & HIDDEN == 0
            && self.within.is_none_or(|within| within(self.edit.at(h)))
    }

    /// The corners opposite an edge: `c` left of it, seen from `a` to `b`, and `d` right of it.
    /// None where the edge is on a border, or its surroundings are not one surface.
    pub(super) fn wings(&mut self, a: u32, b: u32) -> Option<(u32, u32)> {
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
            || !e.are_open(&[a, b, c, d])
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

    /// Turns the edge between two triangles into their other diagonal, where that makes the
    /// smallest angle larger.
    fn flip(&mut self, a: u32, b: u32, ball: u8) {
        if !self.edit.is_placed(a) || !self.edit.is_placed(b) {
            self.load(a);
            self.load(b);
        }
        if !self.is_free(a) || !self.is_free(b) {
            return;
        }
        self.cuts.work += 1;
        let Some((c, d)) = self.wings(a, b) else { return };
        let e = &self.edit;
        let (pa, pb, pc, pd) = (e.at(a), e.at(b), e.at(c), e.at(d));
        let old = sine2(pa, pb, pc).min(sine2(pb, pa, pd));
        // A sliver may reach out of the ball.
        let ball_of = &self.balls[ball as usize];
        let inside = ball_of.contains(pa) && ball_of.contains(pb);
        if old > if inside { FLIP_BELOW } else { LEAST } {
            return;
        }
        let room = [a, b].iter().all(|&v| e.is(v, CLOSED) && e.ring(v).len() > 3)
            && [c, d].iter().all(|&v| e.is(v, CLOSED) && e.ring(v).len() < MOST_NEIGHBOURS)
            && e.are_open(&[a, b, c, d])
            && !e.ring(c).contains(&d);
        let new = sine2(pa, pd, pc).min(sine2(pd, pb, pc));
        if !room || new < old * FLIP_GAIN {
            return;
        }
        let (n, m): (Vec3, Vec3) = (normal(pa, pb, pc), normal(pb, pa, pd));
        let sliver = old < LEAST;
        // A sliver faces anywhere: by area, it hardly counts.
        let faces = if sliver { by_area(pa, pb, pc) + by_area(pb, pa, pd) } else { n + m };
        let faces = faces.normalize_or_zero();
        let least = if sliver { TURN } else { FLAT };
        let flat = n.dot(m) > FLAT || sliver;
        if !flat || normal(pa, pd, pc).dot(faces) < least || normal(pd, pb, pc).dot(faces) < least {
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

//! Two vertices become one: where an edge is too short, and where a triangle is a sliver.

use glam::{Vec3, Vec4};

use super::edit::{CLOSED, DEAD, MOST_NEIGHBOURS, NONE, OPEN};
use super::operations::{Pass, TURN, mean_colour, sorted};
use super::shape::{LEAST, by_area, normal, sine2};

/// The squared sine above which a collapse never fails for its angles: 20 degrees.
const GOOD: f32 = 0.117;
/// By how much joining two vertices must raise the squared sine of the smallest angle where that
/// stays below 3 degrees: about twice the angle.
const SLIVER_GAIN: f32 = 4.0;

/// As [`TURN`], for slivers that nothing else mends: no triangle turns to its other side.
const LAST_TURN: f32 = 0.0;

/// The triangles about two vertices that become one.
#[derive(Debug, Clone, Copy)]
struct JoinedShape {
    /// The squared sine of the smallest angle before and after.
    old: f32,
    new: f32,
    /// The square of the longest edge after.
    far: f32,
    /// The least cosine between a triangle before and after; of slivers, against the mean of all.
    turn: f32,
}

impl Pass<'_> {
    /// Draws `a` and `b` together into `b`, in the middle of both, where they are too near.
    pub(super) fn collapse(&mut self, a: u32, b: u32, ball: u8) {
        self.cuts.work += 2;
        let Some((c, d)) = self.wings(a, b) else { return };
        let ball_of = &self.balls[ball as usize];
        let (under, longest) = (ball_of.shortest().powi(2), ball_of.longest().powi(2));
        let asked =
            self.may_change(a, ball) && self.may_change(b, ball) && self.length2(a, b) < under;
        if !asked || !self.may_join(a, b, c, d) {
            return;
        }
        let middle = (self.edit.points[a as usize] + self.edit.points[b as usize]) * 0.5;
        let shape = self.joined(a, b, middle.truncate());
        let fine = shape.far <= longest
            && shape.turn >= TURN
            && shape.new >= LEAST.max(shape.old * 0.5).min(GOOD);
        if fine {
            let colours = &self.edit.colours;
            let colour = mean_colour(colours[a as usize], colours[b as usize]);
            self.join([a, b, c, d], middle, colour, ball);
        }
    }

    /// Joins two corners of a sliver beside the edge from `a` to `b`, if there is one still: the
    /// shortest edge first, into whichever place leaves the widest angles.
    pub(super) fn merge(&mut self, a: u32, b: u32, ball: u8) {
        self.cuts.work += 2;
        let Some((c, d)) = self.wings(a, b) else { return };
        let e = &self.edit;
        let thin = |h: u32| sine2(e.at(a), e.at(b), e.at(h));
        let apex = if thin(c) <= thin(d) { c } else { d };
        if thin(apex) >= LEAST {
            return;
        }
        let mut edges = [(a, b), (b, apex), (apex, a)].map(|(p, q)| (self.length2(p, q), p, q));
        edges.sort_unstable_by(|p, q| p.0.total_cmp(&q.0));
        self.cuts.work += 4;
        // Crumpled triangles may have to turn farther than others.
        for least in [TURN, LAST_TURN] {
            if edges.iter().any(|&(_, p, q)| self.merge_edge(p, q, least, ball))
                || self.slides && self.slide([a, b, apex], least, ball)
            {
                return;
            }
        }
    }

    /// Moves the corner of a sliver whose triangles gain most by it, along the surface, towards the
    /// middle of its neighbours.
    fn slide(&mut self, corners: [u32; 3], least: f32, ball: u8) -> bool {
        let mut best: Option<(f32, u32, Vec3)> = None;
        for v in corners {
            self.load(v);
            let e = &self.edit;
            let open = e.is(v, CLOSED) && e.are_open(&[v]) && e.are_open(e.ring(v));
            if !open || !self.is_free(v) {
                continue;
            }
            let (ring, here) = (e.ring(v), e.at(v));
            let away = ring.iter().map(|&n| e.at(n) - here).sum::<Vec3>() / ring.len() as f32;
            let faced = self.mean_normal(&[v]);
            let along = away - faced * faced.dot(away);
            for share in [1.0, 0.5, 0.25] {
                let place = here + along * share;
                let shape = self.moved(v, NONE, place, || faced);
                let fine = shape.turn >= least
                    && (shape.new >= LEAST || shape.new > SLIVER_GAIN * shape.old)
                    && best.is_none_or(|b| shape.new > b.0);
                if fine {
                    best = Some((shape.new, v, place));
                }
            }
        }
        let Some((_, v, place)) = best else { return false };
        let e = &mut *self.edit;
        e.points[v as usize] = place.extend(e.points[v as usize].w);
        e.mark(v);
        self.cuts.slides += 1;
        self.turn_about(v, ball);
        true
    }

    fn merge_edge(&mut self, a: u32, b: u32, least: f32, ball: u8) -> bool {
        let Some((c, d)) = self.wings(a, b) else { return false };
        let (free_a, free_b) = (self.is_free(a), self.is_free(b));
        if !(free_a || free_b) || !self.may_join(a, b, c, d) {
            return false;
        }
        let e = &self.edit;
        let (pa, pb) = (e.points[a as usize], e.points[b as usize]);
        let (ca, cb) = (e.colours[a as usize], e.colours[b as usize]);
        let (sa, sb) = (e.sets[a as usize], e.sets[b as usize]);
        let mut best: Option<(f32, Vec4, u32, u16)> = None;
        let places = [
            (free_a && free_b, (pa + pb) * 0.5, mean_colour(ca, cb), sb),
            (free_a, pb, cb, sb),
            (free_b, pa, ca, sa),
        ];
        for (_, place, colour, set) in places.into_iter().filter(|p| p.0) {
            let shape = self.joined(a, b, place.truncate());
            let fine = shape.turn >= least
                && (shape.new >= LEAST || shape.new > SLIVER_GAIN * shape.old)
                && best.is_none_or(|b| shape.new > b.0);
            if fine {
                best = Some((shape.new, place, colour, set));
            }
        }
        let Some((_, place, colour, set)) = best else { return false };
        self.edit.sets[b as usize] = set;
        self.join([a, b, c, d], place, colour, ball);
        true
    }

    /// Returns true if merging `a` and `b` keeps the surface a manifold: the link condition, and
    /// the bounds on the number of neighbours. Loads all rings around them.
    fn may_join(&mut self, a: u32, b: u32, c: u32, d: u32) -> bool {
        let e = &self.edit;
        let count = e.ring(a).len() + e.ring(b).len();
        // A wing's corner loses a neighbour: three must be left, two on a border.
        let least = |h: u32| if e.is(h, OPEN) { 3 } else { 4 };
        let room = e.is(a, CLOSED)
            && e.is(b, CLOSED)
            && (7..=MOST_NEIGHBOURS + 4).contains(&count)
            && e.ring(c).len() >= least(c)
            && e.ring(d).len() >= least(d)
            && e.are_open(e.ring(a))
            && e.are_open(e.ring(b));
        // a and b share the wings' corners and nobody else.
        if !room || e.ring(a).iter().filter(|&v| e.ring(b).contains(v)).count() != 2 {
            return false;
        }
        let mut around = [0u32; MOST_NEIGHBOURS];
        let size = e.ring(a).len();
        around[..size].copy_from_slice(e.ring(a));
        around[..size].iter().all(|&n| {
            self.load(n);
            self.edit.has_ring(n)
        })
    }

    /// Returns the shape of the triangles around `a` and `b` with both moved to `place`.
    fn joined(&self, a: u32, b: u32, place: Vec3) -> JoinedShape {
        let mean = || self.mean_normal(&[a, b]);
        let (p, q) = (self.moved(a, b, place, mean), self.moved(b, a, place, mean));
        JoinedShape {
            old: p.old.min(q.old),
            new: p.new.min(q.new),
            far: p.far.max(q.far),
            turn: p.turn.min(q.turn),
        }
    }

    /// Returns the shape of the triangles around `v` with it moved to `place`, without those at the
    /// vertex `gone`. `mean` gives the normal that slivers are compared with.
    fn moved(&self, v: u32, gone: u32, place: Vec3, mean: impl Fn() -> Vec3) -> JoinedShape {
        let e = &self.edit;
        let mut shape =
            JoinedShape { old: f32::INFINITY, new: f32::INFINITY, far: 0.0, turn: f32::INFINITY };
        let (ring, here) = (e.ring(v), e.at(v));
        for (k, &p) in ring.iter().enumerate() {
            let q = ring[(k + 1) % ring.len()];
            let (pp, pq) = (e.at(p), e.at(q));
            let before = sine2(here, pp, pq);
            shape.old = shape.old.min(before);
            if p == gone || q == gone {
                continue;
            }
            let faced = if before < LEAST { mean() } else { normal(here, pp, pq) };
            shape.far = shape.far.max((pp - place).length_squared());
            shape.turn = shape.turn.min(normal(place, pp, pq).dot(faced));
            shape.new = shape.new.min(sine2(place, pp, pq));
        }
        shape
    }

    /// The mean normal of the triangles about some vertices, by area.
    fn mean_normal(&self, of: &[u32]) -> Vec3 {
        let e = &self.edit;
        let mut sum = Vec3::ZERO;
        for &v in of {
            let (ring, here) = (e.ring(v), e.at(v));
            for (k, &p) in ring.iter().enumerate() {
                sum += by_area(here, e.at(p), e.at(ring[(k + 1) % ring.len()]));
            }
        }
        sum.normalize_or_zero()
    }

    /// Merges `a` into `b`, which moves to `place`; `c` and `d` are the wings' corners.
    fn join(&mut self, [a, b, c, d]: [u32; 4], place: Vec4, colour: u32, ball: u8) {
        let e = &mut *self.edit;
        let mut around = [0u32; MOST_NEIGHBOURS];
        let size = e.ring(a).len();
        around[..size].copy_from_slice(e.ring(a));
        let around = &around[..size];
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
        e.points[b as usize] = place;
        e.colours[b as usize] = colour;
        e.mark(a);
        e.state[a as usize] |= DEAD;
        e.mark(b);
        let mut last = c;
        for &n in between.iter().chain([&d]) {
            e.created.push([b, last, n]);
            last = n;
        }
        self.cuts.collapses += 1;
        self.turn_about(b, ball);
    }

    /// The triangles about a vertex are others now: the normals about it turn with them.
    fn turn_about(&mut self, v: u32, ball: u8) {
        let mut ring = [0u32; MOST_NEIGHBOURS];
        let size = self.edit.ring(v).len();
        ring[..size].copy_from_slice(self.edit.ring(v));
        for (k, &n) in ring[..size].iter().enumerate() {
            self.load(n);
            self.edit.mark_turned(n);
            let next = ring[(k + 1) % size];
            for (p, q) in [sorted(v, n), sorted(n, next)] {
                self.queues.flips.push_back((p, q, ball));
            }
        }
    }
}

//! A box tree with eight children a node and no pointers. The leaves follow the order of a balanced
//! k-d tree, so eight neighbours in that order make a good node. A refit is one pass from the
//! leaves up.
//!
//! One type serves both levels: over a page's triangles (a leaf is eight triangles) and over the
//! clay's pages (a leaf is a page). Memory: 192 bytes for eight leaves, an eighth more for the
//! levels above.

use glam::{Vec3, Vec4};

use sculptd_geometry::simd::leaves::Leaves;
use sculptd_geometry::simd::wide::Prepared;

/// The triangles of one leaf of a page's tree.
pub(super) const LEAF: usize = 8;

/// Eight boxes: lower sides, then upper ones, axis by axis.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Planes([[f32; 8]; 6]);

impl Planes {
    /// Boxes that nothing meets.
    pub(super) const EMPTY: Planes = Planes([
        [f32::INFINITY; 8],
        [f32::INFINITY; 8],
        [f32::INFINITY; 8],
        [f32::NEG_INFINITY; 8],
        [f32::NEG_INFINITY; 8],
        [f32::NEG_INFINITY; 8],
    ]);

    #[inline(always)]
    fn set(&mut self, lane: usize, lo: Vec3, hi: Vec3) {
        for axis in 0..3 {
            self.0[axis][lane] = lo[axis];
            self.0[3 + axis][lane] = hi[axis];
        }
    }

    #[inline(always)]
    fn union(&self) -> (Vec3, Vec3) {
        let fold = |side: &[f32; 8], pick: fn(f32, f32) -> f32| {
            let mut four = [0.0; 4];
            for i in 0..4 {
                four[i] = pick(side[i], side[i + 4]);
            }
            pick(pick(four[0], four[1]), pick(four[2], four[3]))
        };
        let less = |a: f32, b: f32| if a < b { a } else { b };
        let more = |a: f32, b: f32| if a > b { a } else { b };
        let p = &self.0;
        (
            Vec3::new(fold(&p[0], less), fold(&p[1], less), fold(&p[2], less)),
            Vec3::new(fold(&p[3], more), fold(&p[4], more), fold(&p[5], more)),
        )
    }

    fn area(&self) -> f32 {
        let p = &self.0;
        (0..8)
            .map(|i| {
                let d = [p[3][i] - p[0][i], p[4][i] - p[1][i], p[5][i] - p[2][i]];
                if d[0] < 0.0 { 0.0 } else { d[0] * d[1] + d[1] * d[2] + d[2] * d[0] }
            })
            .sum()
    }
}

/// A ray, and by how much boxes grow for it: the triangle test's shear rounds a corner by less.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoxRay {
    pub(super) ready: Prepared,
    near: [f32; 3],
    far: [f32; 3],
}

impl BoxRay {
    /// `reach`: the largest coordinate in play.
    pub(super) fn new(origin: Vec3, dir: Vec3, reach: f32) -> Self {
        let ready = Prepared::new(origin.to_array(), dir.to_array(), 0.0);
        let pad = reach.max(origin.abs().max_element()) * 1e-6;
        let shift = |sign: f32| {
            let mut o = origin.to_array();
            for axis in 0..3 {
                o[axis] += if dir[axis].is_sign_negative() { -pad } else { pad } * sign;
            }
            o
        };
        // The near side moves towards the ray, the far side away: as if the origin moved the other
        // way.
        BoxRay { ready, near: shift(1.0), far: shift(-1.0) }
    }

    /// Returns the distance at which the ray enters one box, if that is before `far`.
    #[inline(always)]
    pub(super) fn enters(&self, lo: Vec3, hi: Vec3, far: f32) -> Option<f32> {
        let mut planes = Planes::EMPTY;
        planes.set(0, lo, hi);
        let mut near = [0.0; 8];
        (self.slabs(&planes, far, &mut near) & 1 == 1).then_some(near[0])
    }

    /// Returns a bit for each of eight boxes that the ray meets before `far`, and stores where it
    /// enters each.
    #[inline(always)]
    fn slabs(&self, node: &Planes, far: f32, near: &mut [f32; 8]) -> u32 {
        let r = &self.ready;
        let (n, f) = (
            [&node.0[r.near()[0]], &node.0[r.near()[1]], &node.0[r.near()[2]]],
            [&node.0[r.far()[0]], &node.0[r.far()[1]], &node.0[r.far()[2]]],
        );
        let more = |a: f32, b: f32| if a > b { a } else { b };
        let less = |a: f32, b: f32| if a < b { a } else { b };
        let mut mask = 0;
        let mut exit = [0.0f32; 8];
        for i in 0..8 {
            let at = |a: usize| (n[a][i] - self.near[a]) * r.inverse()[a];
            near[i] = more(more(at(0), at(1)), more(at(2), 0.0));
        }
        for i in 0..8 {
            let at = |a: usize| (f[a][i] - self.far[a]) * r.inverse()[a];
            exit[i] = less(less(at(0), at(1)), less(at(2), far)) * 1.000_000_5;
        }
        for i in 0..8 {
            mask |= u32::from(near[i] <= exit[i]) << i;
        }
        mask
    }
}

/// Levels at most: 8^10 leaves are more than 32 bits count.
const LEVELS: usize = 10;

#[derive(Debug, Clone, Default)]
pub(super) struct BoxTree {
    /// The lowest level first, the root last.
    nodes: Vec<Planes>,
    leaves: usize,
}

impl BoxTree {
    /// Makes room for `leaves` leaves, all empty boxes. Allocates only when it was smaller before.
    pub(super) fn reset(&mut self, leaves: usize) {
        self.leaves = leaves;
        let mut total = 0;
        let mut level = leaves.div_ceil(8).max(1);
        loop {
            total += level;
            if level == 1 {
                break;
            }
            level = level.div_ceil(8);
        }
        self.nodes.clear();
        self.nodes.resize(total, Planes::EMPTY);
    }

    /// Makes room for this many leaves; the tree stays as it is.
    pub(super) fn reserve(&mut self, leaves: usize) {
        // The levels above the lowest are an eighth of it together, and a few.
        let nodes = leaves.div_ceil(8) * 8 / 7 + LEVELS;
        self.nodes.reserve(nodes.saturating_sub(self.nodes.len()));
    }

    pub(super) fn copy_from(&mut self, other: &BoxTree) {
        self.leaves = other.leaves;
        self.nodes.clear();
        self.nodes.extend_from_slice(&other.nodes);
    }

    /// Returns true if both trees have the same boxes.
    pub(super) fn same(&self, other: &BoxTree) -> bool {
        self.leaves == other.leaves
            && self.nodes.iter().map(|n| n.0).eq(other.nodes.iter().map(|n| n.0))
    }

    pub(super) fn leaves(&self) -> usize {
        self.leaves
    }

    pub(super) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Planes>()
    }

    /// First node of each level, lowest first, and the number of levels.
    fn levels(&self) -> ([usize; LEVELS], usize) {
        let mut starts = [0; LEVELS];
        let mut at = 0;
        let mut level = self.leaves.div_ceil(8).max(1);
        let mut depth = 0;
        loop {
            starts[depth] = at;
            depth += 1;
            at += level;
            if level == 1 {
                return (starts, depth);
            }
            level = level.div_ceil(8);
        }
    }

    pub(super) fn set_leaf(&mut self, leaf: usize, lo: Vec3, hi: Vec3) {
        self.nodes[leaf / 8].set(leaf % 8, lo, hi);
    }

    /// Carries one leaf's new box up to the root.
    pub(super) fn refit_path(&mut self, leaf: usize) {
        let (starts, depth) = self.levels();
        let mut i = leaf / 8;
        for level in 1..depth {
            let (lo, hi) = self.nodes[starts[level - 1] + i].union();
            self.nodes[starts[level] + i / 8].set(i % 8, lo, hi);
            i /= 8;
        }
    }

    /// Carries all leaves' boxes up; returns the box around everything.
    #[inline(always)]
    pub(super) fn refit_all(&mut self) -> (Vec3, Vec3) {
        let (starts, depth) = self.levels();
        for level in 1..depth {
            for child in starts[level - 1]..starts[level] {
                let (lo, hi) = self.nodes[child].union();
                let i = child - starts[level - 1];
                self.nodes[starts[level] + i / 8].set(i % 8, lo, hi);
            }
        }
        self.bounds()
    }

    /// The box around everything; inverted when there is nothing.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        self.nodes.last().map_or((Vec3::INFINITY, Vec3::NEG_INFINITY), Planes::union)
    }

    /// Sum of the boxes' half areas over the root's: what a random ray pays, in box tests.
    pub(super) fn cost(&self) -> f32 {
        let (lo, hi) = self.bounds();
        let d = hi - lo;
        let root = d.x * d.y + d.y * d.z + d.z * d.x;
        if root > 0.0 { self.nodes.iter().map(Planes::area).sum::<f32>() / root } else { 0.0 }
    }

    /// The leaves' boxes from the vertices that each has, and everything above them. Of eight
    /// leaves in a row that `moved` does not take, the boxes stay.
    #[inline(always)]
    pub(super) fn refit_leaves(
        &mut self,
        leaves: &Leaves,
        points: &[Vec4],
        moved: impl Fn(usize) -> bool,
    ) -> (Vec3, Vec3) {
        for (i, node) in self.nodes.iter_mut().enumerate().take(leaves.len().div_ceil(8)) {
            if moved(i) {
                leaves.boxes(i, points, &mut node.0);
            }
        }
        self.refit_all()
    }

    /// Calls `visit` with each leaf that the ray enters, roughly nearest first, until none is
    /// nearer than the bound that `visit` returns. `visit` gets the leaf and the bound so far.
    #[inline(always)]
    pub(super) fn walk_ray(
        &self,
        ray: &BoxRay,
        mut far: f32,
        mut visit: impl FnMut(usize, f32) -> f32,
    ) {
        let (starts, depth) = self.levels();
        // A node's index within its level and the level, and where the ray enters it; leaves have
        // level 0.
        let mut stack = [(0u32, 0u8, 0.0f32); LEVELS * 8];
        stack[0] = (0, depth as u8, 0.0);
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (at, level, enter) = stack[top];
            if enter > far {
                continue;
            }
            if level == 0 {
                far = visit(at as usize, far);
                continue;
            }
            let node = &self.nodes[starts[level as usize - 1] + at as usize];
            let mut near = [0.0f32; 8];
            let mut mask = ray.slabs(node, far, &mut near);
            let base = top;
            while mask != 0 {
                let i = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                // The nearest on top.
                let mut j = top;
                while j > base && stack[j - 1].2 < near[i] {
                    stack[j] = stack[j - 1];
                    j -= 1;
                }
                stack[j] = (at * 8 + i as u32, level - 1, near[i]);
                top += 1;
            }
        }
    }

    /// Calls `visit` with each leaf whose box `touches` takes, in ascending order.
    pub(super) fn walk_boxes(
        &self,
        touches: impl Fn(Vec3, Vec3) -> bool,
        mut visit: impl FnMut(usize),
    ) {
        let (starts, depth) = self.levels();
        let mut stack = [(0u32, 0u8); LEVELS * 8];
        stack[0] = (0, depth as u8);
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (at, level) = stack[top];
            if level == 0 {
                visit(at as usize);
                continue;
            }
            let p = &self.nodes[starts[level as usize - 1] + at as usize].0;
            for i in (0..8).rev() {
                let (lo, hi) =
                    (Vec3::new(p[0][i], p[1][i], p[2][i]), Vec3::new(p[3][i], p[4][i], p[5][i]));
                if lo.x <= hi.x && touches(lo, hi) {
                    stack[top] = (at * 8 + i as u32, level - 1);
                    top += 1;
                }
            }
        }
    }
}

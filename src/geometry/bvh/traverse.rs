//! The walk down the tree, written once and compiled for each processor.

use super::{Bvh8, LEAF, Pack, Ray, TreeHit, WideNode};
use crate::simd::wide::{Prepared, Wide, WideWork};

/// Rays that take turns in an interleaved traversal ([`super::interleaved`]).
pub(super) const LANES: usize = 4;

/// A subtree still to visit: in the upper half where the ray enters it, in the lower half its
/// place. As whole numbers two of them are put in order without a branch that the processor would
/// have to guess. Floats that are not negative have the order of their bits; where the ray may
/// start behind its origin the order is only less good.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct StackEntry(i64);

impl StackEntry {
    #[inline(always)]
    pub fn new(at: u32, near: f32) -> Self {
        StackEntry((near.to_bits() as i64) << 32 | at as i64)
    }

    #[inline(always)]
    pub fn at(self) -> u32 {
        self.0 as u32
    }

    #[inline(always)]
    pub fn near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

/// The subtrees still to visit; kept between rays so that it is made once.
#[derive(Debug, Clone, Default)]
pub struct TraversalStack(Vec<StackEntry>);

impl TraversalStack {
    /// An empty stack; the first ray makes it as large as its tree needs.
    pub fn new() -> Self {
        TraversalStack::default()
    }

    #[inline(always)]
    pub(super) fn slots(&mut self, tree: &Bvh8) -> &mut [StackEntry] {
        let need = tree.stack * LANES;
        if self.0.len() < need {
            self.0.resize(need, StackEntry(0));
        }
        &mut self.0
    }
}

/// Visits leaves roughly nearest first until none is nearer than the bound that `leaf` returns.
#[inline(always)]
fn walk<W: Wide>(
    w: W,
    tree: &Bvh8,
    ray: &Ray,
    slots: &mut [StackEntry],
    mut leaf: impl FnMut(&Prepared, u32, f32) -> f32,
) {
    if tree.nodes.is_empty() {
        return;
    }
    let ready = Prepared::new(ray.origin.to_array(), ray.dir.to_array(), ray.t_min);
    let mut t_max = ray.t_max;
    let mut near = [0.0f32; 8];
    let mut top = 0;
    let mut at = 0u32;
    'next: loop {
        // Down, until a leaf or a dead end.
        while at & LEAF == 0 {
            let node = &tree.nodes[at as usize];
            let mask = w.boxes(&ready, node, t_max, &mut near);
            if mask == 0 {
                break;
            }
            at = open(w, tree, node, mask, &near, slots, &mut top);
        }
        if at & LEAF != 0 {
            t_max = leaf(&ready, at & !LEAF, t_max);
            if t_max < ray.t_min {
                return;
            }
        }
        loop {
            if top == 0 {
                return;
            }
            top -= 1;
            if slots[top].near() <= t_max {
                at = slots[top].at();
                continue 'next;
            }
        }
    }
}

/// Of the children in `mask`, which is not empty, the nearest, to go on with; the others wait, the
/// nearest of them on top.
#[inline(always)]
pub(super) fn open<W: Wide>(
    w: W,
    tree: &Bvh8,
    node: &WideNode,
    mut mask: u32,
    near: &[f32; 8],
    slots: &mut [StackEntry],
    top: &mut usize,
) -> u32 {
    let child = |mask: u32| {
        let i = mask.trailing_zeros() as usize & 7;
        StackEntry::new(node.child[i], near[i])
    };
    let mut best = child(mask);
    mask &= mask - 1;
    if mask == 0 {
        return best.at();
    }
    let other = child(mask);
    mask &= mask - 1;
    let base = *top;
    *top += 1;
    slots[base] = best.max(other);
    fetch(w, tree, slots[base].at());
    best = best.min(other);
    while mask != 0 {
        let other = child(mask);
        mask &= mask - 1;
        let one = best.max(other);
        best = best.min(other);
        let mut j = *top;
        while j > base && slots[j - 1] < one {
            slots[j] = slots[j - 1];
            j -= 1;
        }
        slots[j] = one;
        fetch(w, tree, one.at());
        *top += 1;
    }
    best.at()
}

/// Asks for what is visited later, before it is needed.
#[inline(always)]
pub(super) fn fetch<W: Wide>(w: W, tree: &Bvh8, at: u32) {
    if at & LEAF == 0 {
        w.fetch(&tree.nodes, at as usize);
    } else {
        w.fetch(&tree.packs, (at & !LEAF) as usize);
    }
}

/// The nearest of a leaf's triangles and of what was found before; the new bound.
#[inline(always)]
pub(super) fn nearest_of<W: Wide>(
    w: W,
    ready: &Prepared,
    pack: &Pack,
    mut t_max: f32,
    best: &mut Option<TreeHit>,
    accept: impl Fn(u32) -> bool,
) -> f32 {
    let mut hits = w.triangles(ready, pack, t_max);
    ready.settle_all(pack, t_max, &accept, &mut hits);
    let mut mask = hits.mask;
    while mask != 0 {
        let i = mask.trailing_zeros() as usize & 3;
        mask &= mask - 1;
        let (t, triangle) = (hits.t[i], pack.id[i]);
        let nearer = best.is_none_or(|b| t < b.t || (t == b.t && triangle < b.triangle));
        if nearer && accept(triangle) {
            // A ray that begins on a triangle gives -0.
            *best = Some(TreeHit { t: t + 0.0, triangle, u: hits.u[i], v: hits.v[i] });
            t_max = t;
        }
    }
    t_max
}

pub(super) struct ClosestHit<'a, A> {
    pub tree: &'a Bvh8,
    pub ray: &'a Ray,
    pub accept: A,
    pub stack: &'a mut [StackEntry],
}

impl<A: Fn(u32) -> bool> WideWork for ClosestHit<'_, A> {
    type Output = Option<TreeHit>;

    #[inline(always)]
    fn run<W: Wide>(self, w: W) -> Option<TreeHit> {
        closest(w, self.tree, self.ray, self.stack, self.accept)
    }
}

#[inline(always)]
fn closest<W: Wide>(
    w: W,
    tree: &Bvh8,
    ray: &Ray,
    stack: &mut [StackEntry],
    accept: impl Fn(u32) -> bool,
) -> Option<TreeHit> {
    let mut best = None::<TreeHit>;
    walk(w, tree, ray, stack, |ready, pack, t_max| {
        nearest_of(w, ready, &tree.packs[pack as usize], t_max, &mut best, &accept)
    });
    best
}

/// The nearest hits of many rays, one after the other.
pub(super) struct OneByOne<'a, A> {
    pub tree: &'a Bvh8,
    pub rays: &'a [Ray],
    /// The filter for the triangles that ray `i` may hit.
    pub accept: A,
    pub stack: &'a mut [StackEntry],
    /// One for each ray.
    pub hits: &'a mut [Option<TreeHit>],
}

impl<A: Fn(usize, u32) -> bool> WideWork for OneByOne<'_, A> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        for (i, (ray, hit)) in self.rays.iter().zip(self.hits).enumerate() {
            *hit = closest(w, self.tree, ray, self.stack, |t| (self.accept)(i, t));
        }
    }
}

pub(super) struct EachHit<'a, V> {
    pub tree: &'a Bvh8,
    pub ray: &'a Ray,
    pub visit: V,
    pub stack: &'a mut [StackEntry],
}

impl<V: FnMut(TreeHit) -> bool> WideWork for EachHit<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self, w: W) {
        let tree = self.tree;
        walk(w, tree, self.ray, self.stack, |ready, pack, t_max| {
            let pack = &tree.packs[pack as usize];
            let mut hits = w.triangles(ready, pack, t_max);
            ready.settle_all(pack, t_max, |_| true, &mut hits);
            let mut mask = hits.mask;
            while mask != 0 {
                let i = mask.trailing_zeros() as usize & 3;
                mask &= mask - 1;
                if !(self.visit)(TreeHit {
                    t: hits.t[i],
                    triangle: pack.id[i],
                    u: hits.u[i],
                    v: hits.v[i],
                }) {
                    // Nothing is nearer than this: the walk ends.
                    return f32::NEG_INFINITY;
                }
            }
            t_max
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::job::Job;
    use crate::shapes;

    #[test]
    fn a_ray_that_is_no_number_meets_nothing_and_ends() {
        let ball = shapes::icosphere(1.0, 12);
        let tree = Bvh8::build_for_rays(&ball, &Job::default()).unwrap();
        let nan = Vec3::new(f32::NAN, 0.0, 0.0);
        for (origin, dir) in [
            (nan, Vec3::Z),
            (Vec3::splat(f32::NAN), Vec3::Z),
            (Vec3::ZERO, nan),
            (Vec3::ZERO, Vec3::splat(f32::NAN)),
            (Vec3::ZERO, Vec3::ZERO),
            (Vec3::splat(f32::INFINITY), Vec3::NEG_X),
        ] {
            let ray = Ray::new(origin, dir);
            assert!(tree.closest_hit(ray, |_| true).is_none(), "{origin} {dir}");
            assert!(tree.all_hits(ray).is_empty(), "{origin} {dir}");
            let (mut stack, mut hits) = (TraversalStack::new(), Vec::new());
            tree.closest_hits(&mut stack, &[ray; 5], |_, _| true, &mut hits);
            assert_eq!(hits, vec![None; 5], "{origin} {dir}");
        }
    }
}

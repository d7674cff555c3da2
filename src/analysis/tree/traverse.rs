//! The walk down the tree, written once and compiled for each processor.

use super::{LEAF, Ray, TreeHit, WideTree};
use crate::simd::wide::{Prepared, Wide, WideWork};

/// A subtree still to visit, and where the ray enters it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Waiting {
    at: u32,
    near: f32,
}

/// The subtrees still to visit; kept between rays so that it is made once.
#[derive(Debug, Clone, Default)]
pub struct Stack(Vec<Waiting>);

impl Stack {
    pub fn new() -> Self {
        Stack::default()
    }

    #[inline(always)]
    pub(super) fn slots(&mut self, tree: &WideTree) -> &mut [Waiting] {
        if self.0.len() < tree.stack {
            self.0.resize(tree.stack, Waiting { at: 0, near: 0.0 });
        }
        &mut self.0
    }
}

/// Visits leaves roughly nearest first until none is nearer than the bound that `leaf` returns.
#[inline(always)]
fn walk<W: Wide>(
    w: W,
    tree: &WideTree,
    ray: &Ray,
    slots: &mut [Waiting],
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
            let mut mask = w.boxes(&ready, node, t_max, &mut near);
            if mask == 0 {
                break;
            }
            let first = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let mut best = Waiting { at: node.child[first & 7], near: near[first & 7] };
            if mask == 0 {
                at = best.at;
                continue;
            }
            // The nearest goes on; the others wait, the nearest of them on top.
            let base = top;
            while mask != 0 {
                let i = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                let mut one = Waiting { at: node.child[i], near: near[i] };
                if one.near < best.near {
                    std::mem::swap(&mut one, &mut best);
                }
                let mut j = top;
                while j > base && slots[j - 1].near < one.near {
                    slots[j] = slots[j - 1];
                    j -= 1;
                }
                slots[j] = one;
                top += 1;
            }
            at = best.at;
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
            if slots[top].near <= t_max {
                at = slots[top].at;
                continue 'next;
            }
        }
    }
}

pub(super) struct Closest<'a, A> {
    pub tree: &'a WideTree,
    pub ray: &'a Ray,
    pub accept: A,
    pub stack: &'a mut [Waiting],
}

impl<A: Fn(u32) -> bool> WideWork for Closest<'_, A> {
    type Out = Option<TreeHit>;

    #[inline(always)]
    fn run<W: Wide>(self, w: W) -> Option<TreeHit> {
        let mut best = None::<TreeHit>;
        let tree = self.tree;
        walk(w, tree, self.ray, self.stack, |ready, pack, mut t_max| {
            let pack = &tree.packs[pack as usize];
            let hits = w.triangles(ready, pack, t_max);
            let mut mask = hits.mask;
            while mask != 0 {
                let i = mask.trailing_zeros() as usize & 3;
                mask &= mask - 1;
                let (t, triangle) = (hits.t[i], pack.id[i]);
                let nearer = best.is_none_or(|b| t < b.t || (t == b.t && triangle < b.triangle));
                if nearer && (self.accept)(triangle) {
                    best = Some(TreeHit { t, triangle, u: hits.u[i], v: hits.v[i] });
                    t_max = t;
                }
            }
            t_max
        });
        best
    }
}

pub(super) struct Each<'a, V> {
    pub tree: &'a WideTree,
    pub ray: &'a Ray,
    pub visit: V,
    pub stack: &'a mut [Waiting],
}

impl<V: FnMut(TreeHit) -> bool> WideWork for Each<'_, V> {
    type Out = ();

    #[inline(always)]
    fn run<W: Wide>(mut self, w: W) {
        let tree = self.tree;
        walk(w, tree, self.ray, self.stack, |ready, pack, t_max| {
            let pack = &tree.packs[pack as usize];
            let hits = w.triangles(ready, pack, t_max);
            let mut mask = hits.mask;
            while mask != 0 {
                let i = mask.trailing_zeros() as usize & 3;
                mask &= mask - 1;
                if !(self.visit)(TreeHit { t: hits.t[i], triangle: pack.id[i], u: hits.u[i], v: hits.v[i] }) {
                    // Nothing is nearer than this: the walk ends.
                    return f32::NEG_INFINITY;
                }
            }
            t_max
        });
    }
}

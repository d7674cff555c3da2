//! Several rays at once down the tree. One ray's walk is a chain: what a node says decides which is
//! read next, and the processor waits for memory, for the boxes' verdict, for the branch. Rays do
//! not depend on each other, so a few take turns, one node or leaf each: while one's next node is
//! on its way from memory, the others work.

use super::traverse::{LANES, StackEntry, fetch, nearest_of, open};
use super::{Bvh8, LEAF, Ray, TreeHit};
use crate::simd::wide::{Prepared, Wide, WideWork};

/// The nearest hits of many rays.
pub(super) struct Interleaved<'a, A> {
    pub tree: &'a Bvh8,
    pub rays: &'a [Ray],
    /// The filter for the triangles that ray `i` may hit.
    pub accept: A,
    /// [`LANES`] times the tree's need.
    pub stack: &'a mut [StackEntry],
    /// One for each ray.
    pub hits: &'a mut [Option<TreeHit>],
}

/// One ray under way.
#[derive(Clone, Copy)]
struct RayLane {
    ready: Prepared,
    t_max: f32,
    best: Option<TreeHit>,
    /// Index of the ray.
    ray: usize,
    at: u32,
    /// Its part of the stack starts at `floor` and ends before `top`.
    floor: usize,
    top: usize,
}

impl RayLane {
    #[inline(always)]
    fn start(rays: &[Ray], ray: usize, floor: usize) -> RayLane {
        let Ray { origin, dir, t_min, t_max } = rays[ray];
        let ready = Prepared::new(origin.to_array(), dir.to_array(), t_min);
        RayLane { ready, t_max, best: None, ray, at: 0, floor, top: floor }
    }
}

impl<A: Fn(usize, u32) -> bool> WideWork for Interleaved<'_, A> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        let Interleaved { tree, rays, accept, stack, hits } = self;
        hits.fill(None);
        if tree.nodes.is_empty() || rays.is_empty() {
            return;
        }
        let mut lanes: [RayLane; LANES] =
            std::array::from_fn(|i| RayLane::start(rays, i.min(rays.len() - 1), i * tree.stack));
        let mut near = [0.0f32; 8];
        let mut next = LANES;
        if rays.len() >= LANES {
            'turns: loop {
                for lane in &mut lanes {
                    if !step(w, tree, lane, stack, &mut near, &accept) {
                        hits[lane.ray] = lane.best;
                        lane.ray = usize::MAX;
                        if next == rays.len() {
                            break 'turns;
                        }
                        *lane = RayLane::start(rays, next, lane.floor);
                        next += 1;
                    }
                }
            }
        }
        // Fewer are left than may take turns.
        for lane in lanes.iter_mut().take(rays.len()).filter(|lane| lane.ray != usize::MAX) {
            while step(w, tree, lane, stack, &mut near, &accept) {}
            hits[lane.ray] = lane.best;
        }
    }
}

/// One node or leaf for one ray; false at the ray's end.
#[inline(always)]
fn step<W: Wide>(
    w: W,
    tree: &Bvh8,
    lane: &mut RayLane,
    stack: &mut [StackEntry],
    near: &mut [f32; 8],
    accept: &impl Fn(usize, u32) -> bool,
) -> bool {
    if lane.at & LEAF == 0 {
        let node = &tree.nodes[lane.at as usize];
        let mask = w.boxes(&lane.ready, node, lane.t_max, near);
        if mask != 0 {
            lane.at = open(w, tree, node, mask, near, stack, &mut lane.top);
            fetch(w, tree, lane.at);
            return true;
        }
    } else {
        let pack = &tree.packs[(lane.at & !LEAF) as usize];
        lane.t_max =
            nearest_of(w, &lane.ready, pack, lane.t_max, &mut lane.best, |t| accept(lane.ray, t));
    }
    while lane.top > lane.floor {
        lane.top -= 1;
        if stack[lane.top].near() <= lane.t_max {
            lane.at = stack[lane.top].at();
            fetch(w, tree, lane.at);
            return true;
        }
    }
    false
}

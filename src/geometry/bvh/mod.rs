//! The eight-wide tree: rays and closest points against a triangle mesh that does not change.
//!
//! Guaranteed: a ray never slips between two triangles that share an edge or a vertex (watertight
//! test); the answer is the same with and without AVX2 and does not depend on the tree's shape (of
//! two triangles at the same distance the one of lower index wins). Not guaranteed: distances
//! better than single precision gives them, about 1e-6 of the larger of the mesh's extent and the
//! ray's distance from it, on slivers too.
//!
//! Built as a binary tree by parallel locally-ordered clustering (PLOC: Meister and Bittner,
//! "Parallel locally-ordered clustering for bounding volume hierarchy construction", 2018, crate
//! `obvhs`), improved by a short reinsertion ("Parallel reinsertion for bounding volume hierarchy
//! optimization", 2018, the same authors), then collapsed into wide nodes at the least expected
//! cost (`collapse.rs`). Rays are tested as Woop, Benthin and Wald do ([`crate::simd::wide`]).
//!
//! The workspace has three trees of boxes, each for what the others cannot do:
//!
//! - [`Bvh8`], here: single precision, static, the fastest for millions of rays and nearest points.
//!   Its build looks for the best tree, which is worth it for many queries only.
//! - `boolean::box_tree`: double precision and no padding, so that a pair of boxes that do not meet
//!   proves that two triangles do not; two trees are descended together.
//! - `boxtree` of the clay crate: no pointers and a fixed shape, so that a dab refits the few
//!   leaves that it touched, and a copy of a page is a copy of bytes.

mod build;
mod closest;
mod collapse;
mod interleaved;
mod refit;
mod traverse;

use glam::Vec3;

use crate::TriMesh;
use crate::job::{Cancelled, Job};
use crate::simd::wide;
pub use refit::Parents;
pub use traverse::TraversalStack;

pub use crate::simd::wide::{LEAF, NO_TRIANGLE, Pack, WideNode};
pub(crate) use closest::push_children;
pub use closest::{Feature, NearestPoint, REACH, nearest_on_triangle};

/// A ray; `dir` need not be of unit length, `t` counts in its lengths. Hits with `t_min <= t <=
/// t_max` count.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Where `t` is 0.
    pub origin: Vec3,
    /// The direction; not zero.
    pub dir: Vec3,
    /// The least `t` that counts; may be negative.
    pub t_min: f32,
    /// The largest `t` that counts; infinity for an unbounded ray.
    pub t_max: f32,
}

impl Ray {
    /// Unbounded ahead, from the origin itself.
    pub fn new(origin: Vec3, dir: Vec3) -> Self {
        Ray { origin, dir, t_min: 0.0, t_max: f32::INFINITY }
    }
}

/// The place where a ray hits a triangle: at `origin + t * dir`, and at `(1 - u - v) a + u b + v c`
/// of its corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TreeHit {
    /// In lengths of the ray's `dir`.
    pub t: f32,
    /// Index into the mesh's `triangles`.
    pub triangle: u32,
    /// The weight of corner `b`, 0 to 1.
    pub u: f32,
    /// The weight of corner `c`, 0 to 1.
    pub v: f32,
}

/// The tree. It copies the corners, in the order in which rays meet them, and keeps no reference to
/// the mesh.
#[derive(Debug, Clone)]
pub struct Bvh8 {
    nodes: Vec<WideNode>,
    packs: Vec<Pack>,
    bounds: (Vec3, Vec3),
    /// Entries that a traversal can have waiting at once.
    stack: usize,
    scalar: bool,
}

/// Bytes of leaves from which on a tree is read from memory rather than from the processor's
/// caches.
const CACHED: usize = 16 << 20;

impl Bvh8 {
    /// Builds the tree in about 0.35 us a triangle on one core. Triangles with a coordinate that is
    /// not finite or is beyond [`REACH`], or with a corner index past the end, are left out: no ray
    /// and no point meets them. `job` is looked at between the phases, of which none takes more
    /// than about 40 ms per 100,000 triangles.
    pub fn build(mesh: &TriMesh, job: &Job) -> Result<Bvh8, Cancelled> {
        build::build(mesh, false, job)
    }

    /// Builds a tree for [`Self::closest_hit`] and its variants only. Where many triangles are long
    /// and slanted, as in parts from a modeller, they are in several boxes and several leaves each.
    /// A ray through such a part is several times faster. [`Self::each_hit`] and [`Self::packs`]
    /// report these triangles more than once.
    pub fn build_for_rays(mesh: &TriMesh, job: &Job) -> Result<Bvh8, Cancelled> {
        build::build(mesh, true, job)
    }

    /// The same tree that answers without AVX2; for the comparison of the two.
    pub fn without_simd(mut self) -> Bvh8 {
        self.scalar = true;
        self
    }

    /// Lower and upper corner of the box around all triangles; an empty tree has them inverted
    /// (+inf, -inf).
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// No triangle at all.
    pub fn is_empty(&self) -> bool {
        self.packs.is_empty()
    }

    /// The wide nodes. Node 0 is the root; children come after their parent. The boxes are padded
    /// by about 1e-6 of the extent.
    pub fn nodes(&self) -> &[WideNode] {
        &self.nodes
    }

    /// The leaves, each of one to four triangles; unused lanes hold NaN and [`NO_TRIANGLE`].
    pub fn packs(&self) -> &[Pack] {
        &self.packs
    }

    /// Entries that a depth-first traversal needs at most when it pushes every child of a node at
    /// once.
    pub fn stack_need(&self) -> usize {
        self.stack
    }

    /// Returns true if plain Rust was requested; for [`wide::dispatch`].
    pub fn scalar(&self) -> bool {
        self.scalar
    }

    /// The nearest hit on a triangle that `accept` takes.
    pub fn closest_hit(&self, ray: Ray, accept: impl Fn(u32) -> bool) -> Option<TreeHit> {
        self.closest_hit_with(&mut TraversalStack::new(), ray, accept)
    }

    /// The same for many rays: `stack` is reused, which saves about a tenth of a short ray's time.
    #[inline]
    pub fn closest_hit_with(
        &self,
        stack: &mut TraversalStack,
        ray: Ray,
        accept: impl Fn(u32) -> bool,
    ) -> Option<TreeHit> {
        let stack = stack.slots(self);
        wide::dispatch(self.scalar, traverse::ClosestHit { tree: self, ray: &ray, accept, stack })
    }

    /// Finds the nearest hit of each ray on a triangle that `accept` (called with the ray's index)
    /// allows; resizes `hits` to the length of `rays`. Returns the same hits as
    /// [`Self::closest_hit`]. In a tree too large for the caches it is a fifth faster, because rays
    /// take turns.
    #[inline]
    pub fn closest_hits(
        &self,
        stack: &mut TraversalStack,
        rays: &[Ray],
        accept: impl Fn(usize, u32) -> bool,
        hits: &mut Vec<Option<TreeHit>>,
    ) {
        hits.clear();
        hits.resize(rays.len(), None);
        let (tree, stack) = (self, stack.slots(self));
        if self.packs.len() * size_of::<Pack>() < CACHED {
            wide::dispatch(self.scalar, traverse::OneByOne { tree, rays, accept, stack, hits });
        } else {
            wide::dispatch(
                self.scalar,
                interleaved::Interleaved { tree, rays, accept, stack, hits },
            );
        }
    }

    /// Any hit on a triangle that `accept` takes: is the way between `t_min` and `t_max` blocked?
    #[inline]
    pub fn any_hit(&self, ray: Ray, accept: impl Fn(u32) -> bool) -> bool {
        let mut found = false;
        self.each_hit(ray, |hit| {
            found |= accept(hit.triangle);
            !found
        });
        found
    }

    /// Every hit, each triangle once, in no order; `visit` returns whether to go on.
    #[inline]
    pub fn each_hit(&self, ray: Ray, visit: impl FnMut(TreeHit) -> bool) {
        let mut stack = TraversalStack::new();
        let stack = stack.slots(self);
        wide::dispatch(self.scalar, traverse::EachHit { tree: self, ray: &ray, visit, stack });
    }

    /// Every hit, nearest first; equal distances by triangle.
    pub fn all_hits(&self, ray: Ray) -> Vec<TreeHit> {
        let mut hits = Vec::new();
        self.each_hit(ray, |hit| {
            hits.push(hit);
            true
        });
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        hits
    }
}

//! From triangles to the wide tree.

use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::splits::split_aabbs_precise;
use obvhs::triangle::Triangle;

use super::collapse::CollapsePlan;
use super::{Bvh8, LEAF, NO_TRIANGLE, Pack, WideNode};
use crate::TriMesh;
use crate::job::{Cancelled, Job};

/// Share of the nodes that each reinsertion pass looks at.
const REINSERTION: f32 = 0.02;
/// Boxes grow by this share of the largest coordinate: the triangle test's shear rounds a corner by
/// less.
pub(super) const PAD: f32 = 1e-6;

/// The ratio of the boxes' area to the triangles' area above which long slanted triangles are put
/// into several boxes. Well-shaped triangles have about 1.5, in any orientation.
const SLANTED: f32 = 6.0;
/// The greatest number of halvings of such a triangle's box.
const HALVINGS: usize = 12;
/// The number of boxes per triangle, over the whole mesh, at which splitting stops; the last
/// halving may double it.
const MOST_BOXES: usize = 3;

/// `several`: whether a triangle may be in several leaves.
pub(super) fn build(mesh: &TriMesh, several: bool, job: &Job) -> Result<Bvh8, Cancelled> {
    let corners = |t: u32| -> Option<[Vec3; 3]> {
        let [a, b, c] = mesh.triangles[t as usize].map(|v| mesh.positions.get(v as usize).copied());
        Some([a?, b?, c?]).filter(|c| {
            c.iter().all(|p| p.is_finite() && p.abs().max_element() <= super::REACH as f32)
        })
    };
    let mut used = Vec::with_capacity(mesh.triangles.len());
    let mut boxes = Vec::with_capacity(mesh.triangles.len());
    let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for t in 0..mesh.triangles.len() as u32 {
        let Some([a, b, c]) = corners(t) else { continue };
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        bounds = (bounds.0.min(lo), bounds.1.max(hi));
        boxes.push(Aabb::new(lo.into(), hi.into()));
        used.push(t);
    }
    let mut tree = Bvh8 { nodes: Vec::new(), packs: Vec::new(), bounds, stack: 0, scalar: false };
    if used.is_empty() {
        return Ok(tree);
    }
    job.check()?;
    let mut starts = None;
    if several {
        let before = used.len();
        used = split(&mut boxes, used, corners);
        if used.len() == before {
            starts = pairs(&mut boxes, &used, &mesh.triangles);
        }
        job.check()?;
    }
    let used = BoxedTriangles { used, starts };
    let count = boxes.len();
    // A search threshold above 0 ruins the tree of long thin triangles, the surface of most
    // mechanical parts.
    let mut binary = PlocBuilder::with_capacity(count).build(
        PlocSearchDistance::Low,
        &boxes,
        (0..count as u32).collect(),
        SortPrecision::U64,
        0,
    );
    job.check()?;
    ReinsertionOptimizer::default().run(&mut binary, REINSERTION, Some(vec![1.0, 0.5, 0.25]));
    job.check()?;
    let plan = CollapsePlan::new(&binary, |i| used.of(i).len() as u32);
    job.check()?;

    let (lo, hi) = bounds;
    let pad = Vec3::splat(lo.abs().max(hi.abs()).max_element() * PAD);
    let mut maker = Bvh8Builder {
        binary: &binary,
        plan: &plan,
        used: &used,
        pad,
        corners,
        tree: &mut tree,
        depth: 0,
    };
    maker.tree.nodes.reserve(used.used.len() / 12);
    maker.tree.packs.reserve(used.used.len() / 2);
    maker.root();
    tree.stack = maker_stack(maker.depth);
    Ok(tree)
}

/// Two triangles that share an edge go into one box where that has at most this share of their own
/// boxes' area.
const PAIRED: f32 = 0.75;

/// The triangles in each of the boxes that a tree is built from.
struct BoxedTriangles {
    used: Vec<u32>,
    /// The start of each box's triangles in `used`, and the end of the last; `None`: one per box.
    starts: Option<Vec<u32>>,
}

impl BoxedTriangles {
    /// The triangles of box `i`.
    fn of(&self, i: u32) -> &[u32] {
        let i = i as usize;
        match &self.starts {
            Some(starts) => &self.used[starts[i] as usize..starts[i + 1] as usize],
            None => &self.used[i..=i],
        }
    }
}

/// Joins the boxes of triangles that follow each other and share an edge, as the halves of
/// quadrilaterals do in most files: a leaf holds both in any case, and the tree takes half the time
/// to build. Where each box's triangles start; none where too few are joined to be worth it.
fn pairs(boxes: &mut Vec<Aabb>, used: &[u32], triangles: &[[u32; 3]]) -> Option<Vec<u32>> {
    let mut starts = Vec::with_capacity(used.len() + 1);
    let mut joined = Vec::with_capacity(used.len());
    let mut i = 0;
    while i < used.len() {
        starts.push(i as u32);
        let one = boxes[i];
        i += 1;
        if let Some(&next) = used.get(i) {
            let (t, u) = (triangles[used[i - 1] as usize], triangles[next as usize]);
            let both = one.union(&boxes[i]);
            let apart = one.half_area() + boxes[i].half_area();
            let shared = t.iter().filter(|v| u.contains(v)).count();
            if shared >= 2 && both.half_area() <= apart * PAIRED {
                joined.push(both);
                i += 1;
                continue;
            }
        }
        joined.push(one);
    }
    if joined.len() * 8 > used.len() * 7 {
        return None;
    }
    starts.push(used.len() as u32);
    *boxes = joined;
    Some(starts)
}

/// Puts the triangles of `used` that fill little of their boxes into several boxes each, where many
/// do; the triangle of each box. ("Early split clipping": Ernst and Greiner 2007, as `obvhs` does
/// it.)
fn split(
    boxes: &mut Vec<Aabb>,
    used: Vec<u32>,
    corners: impl Fn(u32) -> Option<[Vec3; 3]>,
) -> Vec<u32> {
    let triangles: Vec<Triangle> = used
        .iter()
        .filter_map(|&t| corners(t))
        .map(|[a, b, c]| Triangle { v0: a.into(), v1: b.into(), v2: c.into() })
        .collect();
    let area = |t: &Triangle| (t.v1 - t.v0).cross(t.v2 - t.v0).length() * 0.5;
    let filled: f64 = triangles.iter().map(|t| f64::from(area(t))).sum();
    let halves = boxes.iter().map(|b| b.half_area());
    let (all, most) =
        halves.fold((0.0f64, 0.0f32), |(all, most), a| (all + f64::from(a), most.max(a)));
    if all <= filled * f64::from(SLANTED) || !all.is_finite() {
        return used;
    }
    let mean = (all / boxes.len() as f64) as f32;
    let mut of: Vec<u32> = (0..used.len() as u32).collect();
    // The preset of `obvhs`, one halving at a time: a giant among a million small triangles would
    // be cut into thousands.
    let (low, high) = (mean * 3.0, (mean * 4.0).max(mean * 0.9 + most * 0.1));
    for _ in 0..HALVINGS {
        let before = boxes.len();
        split_aabbs_precise(boxes, &mut of, &triangles, low, high, 1.8, 1.6, 1, 12);
        if boxes.len() == before || boxes.len() >= MOST_BOXES * triangles.len() {
            break;
        }
    }
    of.into_iter().map(|i| used[i as usize]).collect()
}

/// Seven wait on each level.
fn maker_stack(depth: usize) -> usize {
    depth * 7 + 8
}

struct Bvh8Builder<'a, C> {
    binary: &'a Bvh2,
    plan: &'a CollapsePlan<'a>,
    used: &'a BoxedTriangles,
    pad: Vec3,
    corners: C,
    tree: &'a mut Bvh8,
    depth: usize,
}

impl<C: Fn(u32) -> Option<[Vec3; 3]>> Bvh8Builder<'_, C> {
    fn root(&mut self) {
        // (binary node, wide node to fill, depth); a work list, for the binary tree may be deeper
        // than the thread's stack.
        let mut todo = vec![(0usize, 0usize, 1usize)];
        self.tree.nodes.push(empty());
        while let Some((from, to, depth)) = todo.pop() {
            self.depth = self.depth.max(depth);
            let (children, n) = self.plan.children(from);
            for (lane, &c) in children[..n].iter().enumerate() {
                let b = self.binary.nodes[c];
                let child = if self.plan.is_leaf(c) {
                    self.leaf(c)
                } else {
                    let index = self.tree.nodes.len();
                    self.tree.nodes.push(empty());
                    todo.push((c, index, depth + 1));
                    index as u32
                };
                let node = &mut self.tree.nodes[to];
                node.child[lane] = child;
                let (lo, hi) = (b.min - self.pad, b.max + self.pad);
                for axis in 0..3 {
                    node.planes[axis][lane] = lo[axis];
                    node.planes[3 + axis][lane] = hi[axis];
                }
            }
        }
    }

    fn leaf(&mut self, from: usize) -> u32 {
        let mut pack = Pack { v: [[[f32::NAN; 4]; 3]; 3], id: [NO_TRIANGLE; 4] };
        let (ids, count) = self.plan.boxes(from);
        let inside = ids[..count].iter().flat_map(|&i| self.used.of(i));
        for (lane, &t) in inside.enumerate() {
            let Some(corners) = (self.corners)(t) else { continue };
            pack.id[lane] = t;
            for (c, p) in corners.iter().enumerate() {
                for axis in 0..3 {
                    pack.v[c][axis][lane] = p[axis];
                }
            }
        }
        self.tree.packs.push(pack);
        LEAF | (self.tree.packs.len() - 1) as u32
    }
}

fn empty() -> WideNode {
    let mut planes = [[f32::INFINITY; 8]; 6];
    planes[3..].fill([f32::NEG_INFINITY; 8]);
    // No box meets these. A ray that is not a number meets them all the same, and then must not go
    // back to the root.
    WideNode { planes, child: [LEAF; 8] }
}

//! The nearest point of the mesh, exactly.
//!
//! Single precision bounds how near and how far each triangle can be, and so finds the few that may
//! be nearest; double precision decides between them. The bounds are widened by single precision's
//! own rounding. So the answer is that of a double-precision search over all triangles, of two
//! equally near the one of lower index.

use glam::DVec3;

use super::{Bvh8, LEAF, NO_TRIANGLE};
use crate::simd::wide::{self, Wide, WideWork};

/// The part of a triangle that holds the nearest point. `Edge(k)` runs from corner `k` to the next
/// corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// The interior.
    Face,
    /// An edge without its ends, by its first corner, 0 to 2.
    Edge(u8),
    /// A corner, 0 to 2.
    Vertex(u8),
}

/// The nearest point of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    /// The square of the distance, in the square of the mesh's unit.
    pub distance_squared: f64,
    /// The point of the mesh.
    pub point: DVec3,
    /// Index into the mesh's `triangles`.
    pub triangle: u32,
    /// The part of the triangle that holds the point.
    pub feature: Feature,
}

impl NearestPoint {
    /// The distance, in the mesh's unit.
    pub fn distance(&self) -> f64 {
        self.distance_squared.sqrt()
    }
}

/// The nearest point of triangle `a`, `b`, `c` to `p`, by the seven regions of its plane (Ericson,
/// "Real-Time Collision Detection", 2005, 5.1.5). A triangle without area is three segments.
pub fn nearest_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> (DVec3, Feature) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    let normal = ab.cross(ac);
    if normal == DVec3::ZERO {
        return nearest_on_segments(p, [a, b, c]);
    }
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Vertex(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Vertex(1));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Vertex(2));
    }
    // The sides by the normal, not by products of the dots above: those cancel on slivers.
    let wc = normal.dot(ap.cross(bp));
    if wc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let wb = normal.dot(cp.cross(ap));
    if wb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let wa = normal.dot(bp.cross(cp));
    let (e4, e5) = (d4 - d3, d5 - d6);
    if wa <= 0.0 && e4 >= 0.0 && e5 >= 0.0 {
        return (b + (c - b) * (e4 / (e4 + e5)), Feature::Edge(1));
    }
    if wa < 0.0 || wb < 0.0 || wc < 0.0 {
        // Rounding put the point in no region: it is next to a side.
        return nearest_on_segments(p, [a, b, c]);
    }
    (p - normal * (ap.dot(normal) / normal.length_squared()), Feature::Face)
}

fn nearest_on_segments(p: DVec3, corners: [DVec3; 3]) -> (DVec3, Feature) {
    let mut best = (f64::INFINITY, corners[0], Feature::Vertex(0));
    for k in 0..3 {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let along = to - from;
        let length = along.length_squared();
        let t = if length > 0.0 { (p - from).dot(along) / length } else { 0.0 };
        let (q, feature) = if t <= 0.0 {
            (from, Feature::Vertex(k as u8))
        } else if t >= 1.0 {
            (to, Feature::Vertex(((k + 1) % 3) as u8))
        } else {
            (from + along * t, Feature::Edge(k as u8))
        };
        let d = p.distance_squared(q);
        if d < best.0 {
            best = (d, q, feature);
        }
    }
    (best.1, best.2)
}

impl Bvh8 {
    /// Squares of lengths must fit single precision: neither the mesh nor `p` may reach beyond
    /// [`REACH`].
    pub(crate) fn out_of_range(&self, p: DVec3) -> bool {
        let (lo, hi) = self.bounds;
        // Not a number is out of range too.
        let within =
            p.abs().max_element() <= REACH && lo.abs().max(hi.abs()).max_element() as f64 <= REACH;
        !within || p.is_nan() || self.nodes.is_empty()
    }

    /// The nearest point of the mesh; `None` where nothing lies within `within` (a distance,
    /// infinity allowed), the mesh is empty, or `p` or the mesh reach beyond [`REACH`]. A good
    /// bound makes the search faster, never different.
    #[inline]
    pub fn nearest(&self, p: DVec3, within: f64) -> Option<NearestPoint> {
        self.nearest_of(p, within, &[])
    }

    /// The same for a mesh whose corners in double precision are `corners`, one entry a triangle of
    /// the mesh that the tree was built from, which has them rounded: the answer is exact for what
    /// was rounded. No corners: as [`Bvh8::nearest`].
    #[inline]
    pub fn nearest_of(
        &self,
        p: DVec3,
        within: f64,
        corners: &[[DVec3; 3]],
    ) -> Option<NearestPoint> {
        if self.out_of_range(p) {
            return None;
        }
        wide::dispatch(self.scalar, NearestSearch { tree: self, p, within, corners })
    }

    /// Returns the greatest error of a corner rounded to single precision.
    pub(crate) fn rounding(&self) -> f32 {
        let (lo, hi) = self.bounds;
        lo.abs().max(hi.abs()).max_element() * 1.2e-7
    }
}

struct NearestSearch<'a> {
    tree: &'a Bvh8,
    p: DVec3,
    within: f64,
    /// Corners in double precision, or none.
    corners: &'a [[DVec3; 3]],
}

/// The filter's error, in units of the largest length that enters it: about 20 roundings of 6e-8.
const SLACK: f32 = 1.5e-6;
const INLINE: usize = 128;
/// Largest coordinate of a mesh or a point that distances are asked of.
pub const REACH: f64 = 1e15;

impl WideWork for NearestSearch<'_> {
    type Output = Option<NearestPoint>;

    #[inline(always)]
    fn run<W: Wide>(self, wide: W) -> Option<NearestPoint> {
        let NearestSearch { tree, p: exact, within, corners } = self;
        let p = exact.as_vec3().to_array();
        // The greatest error from rounding the point itself.
        let mut moved = p[0].abs().max(p[1].abs()).max(p[2].abs()) * 1.2e-7;
        if !corners.is_empty() {
            // And rounding the corners: that a triangle seems nearer, and that another seems
            // farther.
            moved += 2.0 * tree.rounding();
        }
        let limit = within * within;
        let mut exactly = ExactDecision { tree, p: exact, moved, limit, corners, best: None };
        let mut radius = exactly.radius();
        let mut bound = square(radius);
        let mut maybe = [(0.0f32, 0u32); MAYBE];
        let mut count = 0;
        let mut inline = [(0.0f32, 0u32); INLINE];
        let mut heap =
            if tree.stack > INLINE { vec![(0.0f32, 0u32); tree.stack] } else { Vec::new() };
        let stack: &mut [(f32, u32)] = if heap.is_empty() { &mut inline } else { &mut heap };
        let mut top = 0;
        let mut at = 0u32;
        'walk: loop {
            if at & LEAF == 0 {
                let node = &tree.nodes[at as usize];
                let mut near = [0.0f32; 8];
                let mask = wide.near_boxes(p, node, bound, &mut near);
                top = push_children(stack, top, mask, &near, &node.child);
            } else {
                let number = at & !LEAF;
                let (mut low, mut high) = ([0.0f32; 4], [0.0f32; 4]);
                wide.near_triangles(p, &tree.packs[number as usize], SLACK, &mut low, &mut high);
                let least = high[0].min(high[1]).min(high[2].min(high[3])) + moved;
                if least < radius {
                    radius = least;
                    bound = square(radius);
                }
                for i in 0..4 {
                    if low[i] > radius {
                        continue;
                    }
                    if count == MAYBE {
                        exactly.settle(&maybe);
                        count = 0;
                        radius = radius.min(exactly.radius());
                        bound = square(radius);
                    }
                    maybe[count] = (low[i], number << 2 | i as u32);
                    count += 1;
                }
            }
            loop {
                if top == 0 {
                    break 'walk;
                }
                top -= 1;
                if stack[top].0 <= bound {
                    at = stack[top].1;
                    break;
                }
            }
        }
        for &one in &maybe[..count] {
            if one.0 <= radius {
                exactly.settle(&[one]);
                radius = radius.min(exactly.radius());
            }
        }
        exactly.best
    }
}

/// Puts the children of a node that `mask` tells, each with how near it is, on the stack at `top`,
/// the farthest at the bottom. Returns the new top.
#[inline(always)]
pub(crate) fn push_children(
    stack: &mut [(f32, u32)],
    mut top: usize,
    mut mask: u32,
    near: &[f32; 8],
    child: &[u32; 8],
) -> usize {
    let base = top;
    while mask != 0 {
        let i = mask.trailing_zeros() as usize & 7;
        mask &= mask - 1;
        let mut j = top;
        while j > base && stack[j - 1].0 < near[i] {
            stack[j] = stack[j - 1];
            j -= 1;
        }
        stack[j] = (near[i], child[i]);
        top += 1;
    }
    top
}

/// Triangles that wait for the double-precision test.
const MAYBE: usize = 32;

/// The square of a radius, rounded up. Finite always: what is infinitely far is a child that is not
/// there.
#[inline(always)]
fn square(radius: f32) -> f32 {
    (radius * radius * (1.0 + SLACK)).min(f32::MAX)
}

/// The double-precision side of a search.
struct ExactDecision<'a> {
    tree: &'a Bvh8,
    p: DVec3,
    moved: f32,
    limit: f64,
    corners: &'a [[DVec3; 3]],
    best: Option<NearestPoint>,
}

impl ExactDecision<'_> {
    /// The best distance so far, rounded up to what single precision may find in its place.
    #[inline(always)]
    fn radius(&self) -> f32 {
        self.limit.sqrt() as f32 * (1.0 + 2.0 * SLACK) + self.moved
    }

    /// Looks at triangles, by pack and lane.
    #[inline(always)]
    fn settle(&mut self, some: &[(f32, u32)]) {
        for &(_, which) in some {
            let (pack, i) = (&self.tree.packs[which as usize >> 2], which as usize & 3);
            let id = pack.id[i];
            if id == NO_TRIANGLE {
                continue;
            }
            let rounded =
                || pack.v.map(|c| DVec3::new(c[0][i].into(), c[1][i].into(), c[2][i].into()));
            let corners = self.corners.get(id as usize).copied().unwrap_or_else(rounded);
            let (point, feature) = nearest_on_triangle(self.p, corners);
            let d = self.p.distance_squared(point);
            let better = match &self.best {
                None => d <= self.limit,
                Some(b) => d < self.limit || (d == self.limit && id < b.triangle),
            };
            if better {
                self.best =
                    Some(NearestPoint { distance_squared: d, point, triangle: id, feature });
                self.limit = d;
            }
        }
    }
}

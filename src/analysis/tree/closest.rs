//! The nearest point of the mesh, exactly.
//!
//! Single precision finds the few triangles that may be nearest, double precision decides between them: the filter's own
//! rounding, bounded below, widens what it lets through. So the answer is that of a double-precision search over all
//! triangles, of two equally near the one of lower index.

use glam::DVec3;

use super::{LEAF, NO_TRIANGLE, Node, Pack, WideTree};
use crate::simd::wide::{self, Wide, WideWork};

/// Which part of a triangle holds the nearest point. `Edge(k)` runs from corner `k` to corner `k + 1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    Face,
    Edge(u8),
    Vertex(u8),
}

/// The nearest point of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    pub distance_squared: f64,
    pub point: DVec3,
    /// Index into the mesh's `triangles`.
    pub triangle: u32,
    pub feature: Feature,
}

impl Nearest {
    pub fn distance(&self) -> f64 {
        self.distance_squared.sqrt()
    }
}

/// The nearest point of triangle `a`, `b`, `c` to `p`, by the seven regions of its plane (Ericson, "Real-Time Collision
/// Detection", 2005, 5.1.5). A triangle without area is three segments.
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

impl WideTree {
    /// Squares of lengths must fit single precision: neither the mesh nor `p` may reach beyond [`REACH`].
    pub(crate) fn out_of_range(&self, p: DVec3) -> bool {
        let (lo, hi) = self.bounds;
        // Not a number is out of range too.
        let within = p.abs().max_element() <= REACH && lo.abs().max(hi.abs()).max_element() as f64 <= REACH;
        !within || p.is_nan() || self.nodes.is_empty()
    }

    /// The nearest point of the mesh; `None` where nothing lies within `within` (a distance, infinity allowed), the mesh is
    /// empty, or `p` or the mesh reach beyond [`REACH`]. A good bound makes the search faster, never different.
    #[inline]
    pub fn nearest(&self, p: DVec3, within: f64) -> Option<Nearest> {
        if self.out_of_range(p) {
            return None;
        }
        wide::dispatch(self.scalar, Search { tree: self, p, within })
    }
}

struct Search<'a> {
    tree: &'a WideTree,
    p: DVec3,
    within: f64,
}

/// The filter's error, in units of the largest length that enters it: about 20 roundings of 6e-8.
const SLACK: f32 = 1.5e-6;
const INLINE: usize = 128;
/// Largest coordinate of a mesh or a point that distances are asked of.
pub const REACH: f64 = 1e15;

/// Squared distances of the eight boxes from `p`; an unused box is infinitely far.
#[inline(always)]
fn box_distances(node: &Node, p: [f32; 3]) -> [f32; 8] {
    let mut out = [0.0f32; 8];
    for axis in 0..3 {
        for i in 0..8 {
            let below = node.planes[axis][i] - p[axis];
            let above = p[axis] - node.planes[3 + axis][i];
            let d = if below > above { below } else { above };
            let d = if d > 0.0 { d } else { 0.0 };
            out[i] += d * d;
        }
    }
    out
}

/// Squared distances of the four triangles from `p`, and the square of the largest length that entered each.
#[inline(always)]
fn triangle_distances(pack: &Pack, p: [f32; 3]) -> ([f32; 4], [f32; 4]) {
    let mut v = [[[0.0f32; 4]; 3]; 3];
    for c in 0..3 {
        for axis in 0..3 {
            for i in 0..4 {
                v[c][axis][i] = pack.v[c][axis][i] - p[axis];
            }
        }
    }
    #[inline(always)]
    fn dot(a: &[[f32; 4]; 3], b: &[[f32; 4]; 3]) -> [f32; 4] {
        std::array::from_fn(|i| a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i])
    }
    #[inline(always)]
    fn cross(a: &[[f32; 4]; 3], b: &[[f32; 4]; 3]) -> [[f32; 4]; 3] {
        std::array::from_fn(|x| {
            let (y, z) = ((x + 1) % 3, (x + 2) % 3);
            std::array::from_fn(|i| a[y][i] * b[z][i] - a[z][i] * b[y][i])
        })
    }
    #[inline(always)]
    fn minus(a: &[[f32; 4]; 3], b: &[[f32; 4]; 3]) -> [[f32; 4]; 3] {
        std::array::from_fn(|x| std::array::from_fn(|i| a[x][i] - b[x][i]))
    }
    let e = [minus(&v[1], &v[0]), minus(&v[2], &v[1]), minus(&v[0], &v[2])];
    let n = cross(&e[0], &e[1]);
    let nn = dot(&n, &n);
    let height = dot(&v[0], &n);
    let (mut near, mut size) = ([f32::INFINITY; 4], [0.0f32; 4]);
    let mut inside = [true; 4];
    for k in 0..3 {
        let (along, from) = (dot(&v[k], &e[k]), dot(&v[k], &v[k]));
        let length = dot(&e[k], &e[k]);
        // Outside of this side: the origin is right of it, seen along the normal.
        let side = dot(&cross(&e[k], &n), &v[k]);
        for i in 0..4 {
            let t = -along[i] / length[i];
            let t = if t > 0.0 { t } else { 0.0 };
            let t = if t < 1.0 { t } else { 1.0 };
            let q: [f32; 3] = std::array::from_fn(|x| v[k][x][i] + e[k][x][i] * t);
            let d = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
            near[i] = if d < near[i] { d } else { near[i] };
            size[i] = if from[i] > size[i] { from[i] } else { size[i] };
            inside[i] &= side[i] >= 0.0;
        }
    }
    for i in 0..4 {
        let flat = height[i] * height[i] / nn[i];
        near[i] = if inside[i] && flat < near[i] { flat } else { near[i] };
    }
    (near, size)
}

impl WideWork for Search<'_> {
    type Out = Option<Nearest>;

    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> Option<Nearest> {
        let Search { tree, p, within } = self;
        let exact = p;
        let p = p.as_vec3().to_array();
        // What rounding the point itself may cost.
        let moved = p[0].abs().max(p[1].abs()).max(p[2].abs()) * 1.2e-7;
        let mut best = None::<Nearest>;
        let mut limit = within * within;
        // The boxes' bound, in single precision and rounded up.
        let widen = |limit: f64| {
            let r = limit.sqrt() as f32 * (1.0 + 2.0 * SLACK) + moved;
            // Finite always: what is infinitely far is a child that is not there.
            (r, (r * r * (1.0 + SLACK)).min(f32::MAX))
        };
        let (mut radius, mut bound) = widen(limit);
        let mut inline = [(0.0f32, 0u32); INLINE];
        let mut heap = if tree.stack > INLINE { vec![(0.0f32, 0u32); tree.stack] } else { Vec::new() };
        let stack: &mut [(f32, u32)] = if heap.is_empty() { &mut inline } else { &mut heap };
        let mut top = 0;
        let mut at = 0u32;
        'walk: loop {
            'down: {
                if at & LEAF == 0 {
                    let node = &tree.nodes[at as usize];
                    let near = box_distances(node, p);
                    let base = top;
                    for i in 0..8 {
                        if near[i] <= bound {
                            // The farthest at the bottom.
                            let mut j = top;
                            while j > base && stack[j - 1].0 < near[i] {
                                stack[j] = stack[j - 1];
                                j -= 1;
                            }
                            stack[j] = (near[i], node.child[i]);
                            top += 1;
                        }
                    }
                    break 'down;
                }
                let pack = &tree.packs[(at & !LEAF) as usize];
                let (near, size) = triangle_distances(pack, p);
                for i in 0..4 {
                    let id = pack.id[i];
                    let reach = radius + SLACK * size[i].sqrt();
                    // Not `near > reach`: a sliver's NaN goes to the exact test.
                    if id == NO_TRIANGLE || near[i] > reach * reach {
                        continue;
                    }
                    let corners = [0, 1, 2].map(|c| {
                        DVec3::new(pack.v[c][0][i] as f64, pack.v[c][1][i] as f64, pack.v[c][2][i] as f64)
                    });
                    let (point, feature) = nearest_on_triangle(exact, corners);
                    let d = exact.distance_squared(point);
                    let better = match &best {
                        None => d <= limit,
                        Some(b) => d < limit || (d == limit && id < b.triangle),
                    };
                    if better {
                        best = Some(Nearest { distance_squared: d, point, triangle: id, feature });
                        limit = d;
                        (radius, bound) = widen(limit);
                    }
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
        best
    }
}

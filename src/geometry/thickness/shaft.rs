//! The shaft under a facet: everything that rays along the facet's normal can meet (Haines and
//! Wallace, "Shaft culling for efficient ray-traced radiosity", 1991).
//!
//! A ray along the normal of a flat facet meets a flat facet at a depth that is linear in where it
//! starts. So the least depth over a facet is at a corner of the part of the other facet that lies
//! in the shaft, and the part is found by clipping (Sutherland and Hodgman 1974). No sampling is
//! involved.

use glam::{DVec2, DVec3, Vec3};

use crate::bvh::{Bvh8, LEAF, NO_TRIANGLE, Pack};
use crate::simd::wide::{self, Wide, WideWork};

/// Corners that a triangle can have after five cuts, and four more for halving.
const CORNERS: usize = 16;

/// A convex polygon over a facet: each corner is (x, y, depth) in the shaft's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patch {
    corners: [DVec3; CORNERS],
    count: usize,
}

impl Patch {
    fn new(corners: [DVec3; 3]) -> Patch {
        let mut all = [DVec3::ZERO; CORNERS];
        all[..3].copy_from_slice(&corners);
        Patch { corners: all, count: 3 }
    }

    pub fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// Keeps the part where `side` is not negative. `side` is linear.
    pub fn cut(&mut self, side: impl Fn(DVec3) -> f64) {
        let mut out = [DVec3::ZERO; CORNERS];
        let mut n = 0;
        let Some(&last) = self.corners().last() else { return };
        let (mut from, mut before) = (last, side(last));
        for &to in self.corners() {
            let now = side(to);
            if (before < 0.0) != (now < 0.0) && n < CORNERS {
                out[n] = from + (to - from) * (before / (before - now));
                n += 1;
            }
            if now >= 0.0 && n < CORNERS {
                out[n] = to;
                n += 1;
            }
            (from, before) = (to, now);
        }
        (self.corners, self.count) = (out, n);
    }

    /// The corner of least depth.
    pub fn lowest(&self) -> Option<DVec3> {
        self.corners().iter().copied().reduce(|a, b| if b.z < a.z { b } else { a })
    }

    /// The mean of the corners.
    pub fn middle(&self) -> DVec3 {
        self.corners().iter().sum::<DVec3>() / self.count.max(1) as f64
    }

    /// The area in the facet's plane.
    pub fn area(&self) -> f64 {
        let Some(&o) = self.corners().first() else { return 0.0 };
        let twice = |w: &[DVec3]| (w[0] - o).truncate().perp_dot((w[1] - o).truncate());
        self.corners().windows(2).map(twice).sum::<f64>().abs() * 0.5
    }

    /// Narrower than `width` in the facet's plane.
    pub fn narrow(&self, width: f64) -> bool {
        let Some(&last) = self.corners().last() else { return true };
        let mut around = 0.0;
        let mut from = last;
        for &to in self.corners() {
            around += (to - from).truncate().length();
            from = to;
        }
        self.area() <= around * 0.5 * width
    }

    /// Both halves across the longest extent.
    pub fn halves(&self) -> [Patch; 2] {
        let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for c in self.corners() {
            lo = lo.min(c.truncate());
            hi = hi.max(c.truncate());
        }
        let (size, middle) = (hi - lo, (lo + hi) * 0.5);
        let axis = usize::from(size.y > size.x);
        let (mut below, mut above) = (*self, *self);
        below.cut(|c| middle[axis] - c[axis]);
        above.cut(|c| c[axis] - middle[axis]);
        [below, above]
    }
}

/// The shaft under one triangle of a facet.
#[derive(Debug, Clone, Copy)]
pub(super) struct FacetShaft {
    origin: DVec3,
    x: DVec3,
    y: DVec3,
    /// Into what is measured, of unit length.
    pub into: DVec3,
    /// The corners in the plane, counter-clockwise.
    flat: [DVec2; 3],
    /// Of each side the normal into the shaft and where it begins.
    sides: [(DVec2, f64); 3],
    /// The least height of the triangle.
    pub height: f64,
    pub area: f64,
}

impl FacetShaft {
    /// Under the triangle `corners`; `into` is the direction to measure in. The sides are moved
    /// inwards by `erode`. `None` where the triangle is narrower than four times that.
    pub fn new([a, b, c]: [DVec3; 3], into: DVec3, erode: f64) -> Option<FacetShaft> {
        let x = (b - a).normalize_or_zero();
        let y = into.cross(x);
        let flat = [a, b, c].map(|p| DVec2::new((p - a).dot(x), (p - a).dot(y)));
        let twice = (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
        let flat = if twice < 0.0 { [flat[0], flat[2], flat[1]] } else { flat };
        let mut longest = 0.0f64;
        let sides = [0, 1, 2].map(|k| {
            let edge = flat[(k + 1) % 3] - flat[k];
            longest = longest.max(edge.length());
            let inward = edge.perp().normalize_or_zero();
            (inward, inward.dot(flat[k]) + erode)
        });
        let height = twice.abs() / longest;
        (height > 4.0 * erode && height.is_finite()).then_some(FacetShaft {
            origin: a,
            x,
            y,
            into,
            flat,
            sides,
            height,
            area: twice.abs() * 0.5,
        })
    }

    /// A place of the shaft's frame in space.
    pub fn place(&self, p: DVec3) -> DVec3 {
        self.origin + self.x * p.x + self.y * p.y + self.into * p.z
    }

    /// The foot of a place of the shaft's frame on the facet.
    pub fn foot(&self, p: DVec3) -> DVec3 {
        self.origin + self.x * p.x + self.y * p.y
    }

    /// The part of a triangle in the shaft, from depth `least` on.
    pub fn clip(&self, corners: [DVec3; 3], least: f64) -> Patch {
        let mut patch = Patch::new(corners.map(|p| {
            let p = p - self.origin;
            DVec3::new(p.dot(self.x), p.dot(self.y), p.dot(self.into))
        }));
        for (inward, from) in self.sides {
            patch.cut(|c| inward.dot(c.truncate()) - from);
        }
        patch.cut(|c| c.z - least);
        patch
    }

    /// The part of a line in the shaft, made wider by `wider` on each side, from depth `least` on.
    pub fn clip_line(&self, ends: [DVec3; 2], least: f64, wider: f64) -> Option<[DVec3; 2]> {
        let [a, b] = ends.map(|p| {
            let p = p - self.origin;
            DVec3::new(p.dot(self.x), p.dot(self.y), p.dot(self.into))
        });
        let (mut from, mut to) = (0.0f64, 1.0f64);
        let mut cut = |at_a: f64, at_b: f64| {
            if at_a < 0.0 && at_b < 0.0 {
                to = -1.0;
            } else if at_a < 0.0 {
                from = from.max(at_a / (at_a - at_b));
            } else if at_b < 0.0 {
                to = to.min(at_a / (at_a - at_b));
            }
        };
        for (inward, side) in self.sides {
            let side = side - wider;
            cut(inward.dot(a.truncate()) - side, inward.dot(b.truncate()) - side);
        }
        cut(a.z - least, b.z - least);
        (from <= to).then(|| [a.lerp(b, from), a.lerp(b, to)])
    }

    /// The whole facet as a patch at depth 0.
    pub fn four(&self) -> [[DVec3; 3]; 4] {
        let [a, b, c] = self.flat.map(|p| self.foot(p.extend(0.0)));
        let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    }

    /// Calls `visit` with each triangle of the tree that may reach into the shaft above `depth`,
    /// and its corners; it returns the depth from then on. A triangle may come more than once.
    pub fn each_below(&self, tree: &Bvh8, depth: f64, visit: impl FnMut(u32, [Vec3; 3]) -> f64) {
        let walk = ShaftWalk { tree, shaft: self, depth, visit };
        wide::dispatch(tree.scalar(), walk);
    }
}

/// A half space: what is inside has a product with `normal` of at least `from`.
#[derive(Clone, Copy)]
struct HalfSpace {
    normal: [f32; 3],
    from: f32,
    /// Index into [`wide::WideNode::planes`] of the side of a box that reaches farthest in.
    far: [usize; 3],
}

impl HalfSpace {
    fn new(normal: DVec3, from: f64, slack: f64) -> HalfSpace {
        let n = normal.as_vec3();
        let far = [0, 1, 2].map(|a| if n[a] >= 0.0 { 3 + a } else { a });
        // Zeros would make no number of the infinite sides of an unused box.
        let normal = n.to_array().map(|x| if x == 0.0 { 1e-30 } else { x });
        HalfSpace { normal, from: (from - slack) as f32, far }
    }
}

struct ShaftWalk<'a, V> {
    tree: &'a Bvh8,
    shaft: &'a FacetShaft,
    depth: f64,
    visit: V,
}

impl<V: FnMut(u32, [Vec3; 3]) -> f64> WideWork for ShaftWalk<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self, _: W) {
        let (tree, p) = (self.tree, self.shaft);
        if tree.nodes().is_empty() {
            return;
        }
        let (lo, hi) = tree.bounds();
        let reach = f64::from(lo.abs().max(hi.abs()).max_element());
        let slack = reach * 2e-6;
        let side = |(inward, from): (DVec2, f64)| {
            let normal = p.x * inward.x + p.y * inward.y;
            HalfSpace::new(normal, from + normal.dot(p.origin), slack)
        };
        let under = p.into.dot(p.origin);
        let top = HalfSpace::new(p.into, under, slack);
        let bottom = |depth: f64| HalfSpace::new(-p.into, -(under + depth.min(4.0 * reach)), slack);
        let [s0, s1, s2] = p.sides.map(side);
        let mut planes = [bottom(self.depth), top, s0, s1, s2];
        // The box around the shaft rejects what passes all planes beside a corner.
        let around = |depth: f64| {
            let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for f in p.flat {
                let a = p.foot(f.extend(0.0));
                let b = a + p.into * depth.min(4.0 * reach);
                lo = lo.min(a).min(b);
                hi = hi.max(a).max(b);
            }
            let slack = Vec3::splat(slack as f32);
            ((lo.as_vec3() - slack).to_array(), (hi.as_vec3() + slack).to_array())
        };
        let mut bounds = around(self.depth);
        let mut inline = [0u32; 128];
        let mut heap = Vec::new();
        let need = tree.stack_need();
        let stack: &mut [u32] = if need > inline.len() {
            heap.resize(need, 0);
            &mut heap
        } else {
            &mut inline
        };
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let at = stack[waiting];
            if at & LEAF == 0 {
                let node = &tree.nodes()[at as usize];
                let mut meets = [true; 8];
                for axis in 0..3 {
                    let (below, above) = (&node.planes[axis], &node.planes[3 + axis]);
                    for i in 0..8 {
                        meets[i] &= below[i] <= bounds.1[axis] && above[i] >= bounds.0[axis];
                    }
                }
                for h in &planes {
                    let [px, py, pz] = h.far.map(|f| &node.planes[f]);
                    for i in 0..8 {
                        let most = px[i] * h.normal[0] + py[i] * h.normal[1] + pz[i] * h.normal[2];
                        meets[i] &= most >= h.from;
                    }
                }
                for i in 0..8 {
                    if meets[i] {
                        stack[waiting] = node.child[i];
                        waiting += 1;
                    }
                }
                continue;
            }
            let pack = &tree.packs()[(at & !LEAF) as usize];
            let meets = lanes_inside(pack, &planes);
            for lane in 0..4 {
                if !meets[lane] || pack.id[lane] == NO_TRIANGLE {
                    continue;
                }
                let corner = |k: usize| {
                    Vec3::new(pack.v[k][0][lane], pack.v[k][1][lane], pack.v[k][2][lane])
                };
                let depth = (self.visit)(pack.id[lane], [corner(0), corner(1), corner(2)]);
                if depth < self.depth {
                    self.depth = depth;
                    planes[0] = bottom(depth);
                    bounds = around(depth);
                }
            }
        }
    }
}

/// Of the four triangles those of which a corner is in each half space.
#[inline(always)]
fn lanes_inside(pack: &Pack, planes: &[HalfSpace; 5]) -> [bool; 4] {
    let mut meets = [true; 4];
    for h in planes {
        let mut inside = [false; 4];
        for corner in &pack.v {
            for i in 0..4 {
                let d = corner[0][i] * h.normal[0]
                    + corner[1][i] * h.normal[1]
                    + corner[2][i] * h.normal[2];
                inside[i] |= d >= h.from;
            }
        }
        for i in 0..4 {
            meets[i] &= inside[i];
        }
    }
    meets
}

//! The inner tests of the eight-wide tree, each in AVX2 and in plain Rust with the same bits: one
//! ray against eight boxes, one ray against four triangles, and the same two for the distance of a
//! point. The order of operations is the same in both, there is no fused multiply-add, and
//! `max`/`min` return their second argument on NaN in both (as the processor does).
//!
//! Boxes: slabs, the far side widened by two roundings (Ize, "Robust BVH ray traversal", 2013).
//! Triangles: Woop, Benthin and Wald, "Watertight ray/triangle intersection", JCGT 2013. The
//! vertices are sheared into a frame in which the ray is the z axis. The product terms of an edge
//! function are rounded monotonically, so the sign of their difference is exact or the difference
//! is zero; zero counts as inside on both sides. So a ray cannot slip through an edge or a vertex
//! of a closed surface. The signs say which triangle is met; where on the ray is another matter:
//! the weights of a sliver's corners are known to its length squared over its area, in roundings.
//! What that leaves unsure is computed again in double precision ([`Prepared::settle_all`]).

use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

use glam::{DVec3, Vec4};

use super::rings::{Hexes, Rows};

/// One vertex coordinate of four triangles, and so on: `v[corner][axis][lane]`. Lanes without a
/// triangle hold NaN, which fails every comparison, and the id [`NO_TRIANGLE`].
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct Pack {
    /// The coordinates, in the mesh's unit.
    pub v: [[[f32; 4]; 3]; 3],
    /// The index of each triangle in the mesh that the tree was built from.
    pub id: [u32; 4],
}

/// The id in an empty lane of a [`Pack`].
pub const NO_TRIANGLE: u32 = u32::MAX;

/// Eight boxes and what is in them.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct WideNode {
    /// `planes[axis]` are the lower sides, `planes[3 + axis]` the upper ones. An unused child has
    /// +inf below and -inf above.
    pub planes: [[f32; 8]; 6],
    /// A node's index, or, with [`LEAF`] set, a pack's.
    pub child: [u32; 8],
}

/// The bit of [`WideNode::child`] that separates a pack from a node.
pub const LEAF: u32 = 1 << 31;

/// A ray made ready for both tests. The fields are private because the tests trust the indices.
#[derive(Debug, Clone, Copy)]
pub struct Prepared {
    origin: [f32; 3],
    dir: [f32; 3],
    inverse: [f32; 3],
    /// The same for the far sides, so much larger that rounding never loses a box.
    wider: [f32; 3],
    /// Index into [`WideNode::planes`], below 6, of the side that the ray meets first, and last,
    /// per axis.
    near: [usize; 3],
    far: [usize; 3],
    /// The axes, below 3, in the order in which the triangle test reads them: the last is the ray's
    /// longest.
    k: [usize; 3],
    /// The origin in that order.
    turned: [f32; 3],
    shear: [f32; 3],
    t_min: f32,
}

impl Prepared {
    /// Index into [`WideNode::planes`], below 6, of the side that the ray meets first, per axis.
    #[inline(always)]
    pub fn near(&self) -> [usize; 3] {
        self.near
    }

    /// The same of the side that it meets last.
    #[inline(always)]
    pub fn far(&self) -> [usize; 3] {
        self.far
    }

    /// One over the direction, finite.
    #[inline(always)]
    pub fn inverse(&self) -> [f32; 3] {
        self.inverse
    }

    /// Prepares a ray from `origin` along `dir`, which is not zero; hits before `t_min` do not
    /// count.
    #[inline(always)]
    pub fn new(origin: [f32; 3], dir: [f32; 3], t_min: f32) -> Self {
        let a = dir.map(f32::abs);
        // The longest axis, the first of equals. Without branches: which it is cannot be guessed.
        let not_x = (a[1].max(a[2]) > a[0]) as usize;
        let kz = not_x + (not_x & (a[2] > a[1]) as usize);
        let (kx, ky) = ([1, 2, 0][kz], [2, 0, 1][kz]);
        // A zero component would make 0 * inf = NaN on a slab's own plane; 1e36 cannot, and no t is
        // so large.
        let inverse = dir.map(|d| if d.abs() < 1e-36 { 1e36f32.copysign(d) } else { 1.0 / d });
        let s = dir.map(|d| d.is_sign_negative() as usize * 3);
        Prepared {
            origin,
            dir,
            inverse,
            wider: inverse.map(|x| x * WIDEN),
            near: [s[0], 1 + s[1], 2 + s[2]],
            far: [3 - s[0], 4 - s[1], 5 - s[2]],
            k: [kx, ky, kz],
            turned: [origin[kx], origin[ky], origin[kz]],
            shear: [dir[kx] * inverse[kz], dir[ky] * inverse[kz], inverse[kz]],
            t_min,
        }
    }

    /// Returns where the ray meets the plane of triangle `i` of `pack`, which it hits according to
    /// the signs. The result is limited to the range of the corners, because the signs may be wrong
    /// by a rounding of the corners. `known` is the result of single precision, for a triangle seen
    /// exactly edge on.
    #[inline(never)]
    fn settle(&self, pack: &Pack, i: usize, known: [f32; 3]) -> [f32; 3] {
        let d = DVec3::from_array(self.dir.map(f64::from));
        let corner = |c: usize| {
            DVec3::from_array(std::array::from_fn(|a| {
                f64::from(pack.v[c][a][i]) - f64::from(self.origin[a])
            }))
        };
        let [a, b, c] = [0, 1, 2].map(corner);
        let (to_b, to_c) = (b - a, c - a);
        let p = d.cross(to_c);
        let det = to_b.dot(p);
        // From the first corner to the ray's origin, which is 0.
        let q = (-a).cross(to_b);
        let (u, v, t) = (-a.dot(p) / det, d.dot(q) / det, to_c.dot(q) / det);
        if !(u.is_finite() && v.is_finite() && t.is_finite()) {
            return known;
        }
        let ends = DVec3::new(a.dot(d), b.dot(d), c.dot(d)) / d.length_squared();
        let weights = DVec3::new(1.0 - u - v, u, v).max(DVec3::ZERO);
        let all = weights.element_sum();
        let t = t.max(ends.min_element()).min(ends.max_element());
        [t as f32, (weights.y / all) as f32, (weights.z / all) as f32]
    }

    /// Decides the lanes of `hits.unsure` that `accept` (called with the triangle's id) allows.
    /// Replaces the results of single precision; a lane is a hit if the result is on the valid part
    /// of the ray.
    #[inline(always)]
    pub fn settle_all(
        &self,
        pack: &Pack,
        t_max: f32,
        accept: impl Fn(u32) -> bool,
        hits: &mut PackHits,
    ) {
        while hits.unsure != 0 {
            let i = hits.unsure.trailing_zeros() as usize & 3;
            hits.unsure &= hits.unsure - 1;
            if !accept(pack.id[i]) {
                continue;
            }
            [hits.t[i], hits.u[i], hits.v[i]] =
                self.settle(pack, i, [hits.t[i], hits.u[i], hits.v[i]]);
            let counts = hits.t[i] >= self.t_min && hits.t[i] <= t_max;
            hits.mask |= u32::from(counts) << i;
        }
    }
}

/// Single precision is sure of a hit where the roundings of the corners' weights, which are the
/// triangle's length squared over its area, seen along the ray, move the hit by at most this many
/// roundings of the farthest corner's distance: some 1e-6 of that.
const SURE: f32 = 1.0;

/// Widens the far side so that rounding never loses a box: 1 + 2 gamma(3), and one rounding more of
/// that product.
const WIDEN: f32 = 1.000_000_5;

/// Squared sine of the angle from which on a triangle's plane is sure to a few roundings: below it
/// the plane bounds the distance from below only.
const WIDE: f32 = 0.1;

/// A set of hits in a pack: which lanes, and where.
#[derive(Debug, Clone, Copy)]
pub struct PackHits {
    /// Bit `i` is set where the ray meets triangle `i`.
    pub mask: u32,
    /// Bit `i` is set where it meets triangle `i` and single precision cannot say at which `t`:
    /// [`Prepared::settle_all`] decides.
    pub unsure: u32,
    /// In lengths of the ray's direction, for the lanes in `mask`.
    pub t: [f32; 4],
    /// Weights of the second and the third corner.
    pub u: [f32; 4],
    /// The weight of the third corner.
    pub v: [f32; 4],
}

/// The tests. Both implementations give the same bits.
pub trait Wide: Copy {
    /// Returns which of the eight boxes the ray meets between its `t_min` and `t_max`, and writes
    /// the t at which it enters each.
    fn boxes(self, ray: &Prepared, node: &WideNode, t_max: f32, near: &mut [f32; 8]) -> u32;
    /// Returns which of the four triangles the ray meets between its `t_min` and `t_max`, both
    /// included, and which are left to [`Prepared::settle_all`].
    fn triangles(self, ray: &Prepared, pack: &Pack, t_max: f32) -> PackHits;
    /// Squared distances of the eight boxes from `p`, and which of them are at most `bound`, which
    /// is finite: an unused box is infinitely far.
    fn near_boxes(self, p: [f32; 3], node: &WideNode, bound: f32, out: &mut [f32; 8]) -> u32;
    /// Bounds of the four triangles' distances from `p`: nowhere is a triangle nearer than `low`,
    /// and somewhere it is as near as `high`. `slack` is the rounding's share of the largest
    /// distance of a corner. A sliver of which single precision cannot tell gets 0 and infinity,
    /// and so does an empty lane.
    fn near_triangles(
        self,
        p: [f32; 3],
        pack: &Pack,
        slack: f32,
        low: &mut [f32; 4],
        high: &mut [f32; 4],
    );
    /// Asks the memory for `of[at]`; nothing where there is no such place.
    fn fetch<T>(self, of: &[T], at: usize);
    /// Writes the normals of as many vertices of `to`, from the first on, as go fast, and says how
    /// many.
    fn ring_normals(self, hexes: &Hexes, points: &[Vec4], to: &mut Rows<'_>) -> usize;
}

/// Plain Rust.
#[derive(Debug, Clone, Copy)]
pub struct PortableLanes;

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

impl Wide for PortableLanes {
    #[inline(always)]
    fn boxes(self, r: &Prepared, node: &WideNode, t_max: f32, near: &mut [f32; 8]) -> u32 {
        let mut mask = 0;
        for i in 0..8 {
            let at = |plane: usize, axis: usize, inverse: [f32; 3]| {
                (node.planes[plane][i] - r.origin[axis]) * inverse[axis]
            };
            let n = |axis: usize| at(r.near[axis], axis, r.inverse);
            let f = |axis: usize| at(r.far[axis], axis, r.wider);
            let n = max(max(n(0), n(1)), max(n(2), r.t_min));
            let f = min(min(f(0), f(1)), min(f(2), t_max));
            near[i] = n;
            mask |= ((n <= f) as u32) << i;
        }
        mask
    }

    #[inline(always)]
    fn triangles(self, r: &Prepared, p: &Pack, t_max: f32) -> PackHits {
        let mut out = PackHits { mask: 0, unsure: 0, t: [0.0; 4], u: [0.0; 4], v: [0.0; 4] };
        for i in 0..4 {
            let corner = |c: usize| {
                let z = p.v[c][r.k[2]][i] - r.origin[r.k[2]];
                let x = (p.v[c][r.k[0]][i] - r.origin[r.k[0]]) - r.shear[0] * z;
                let y = (p.v[c][r.k[1]][i] - r.origin[r.k[1]]) - r.shear[1] * z;
                (x, y, z * r.shear[2])
            };
            let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (corner(0), corner(1), corner(2));
            let u = cx * by - cy * bx;
            let v = ax * cy - ay * cx;
            let w = bx * ay - by * ax;
            let same = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
            let det = (u + v) + w;
            let t = ((u * az + v * bz) + w * cz) / det;
            if !same || det == 0.0 {
                continue;
            }
            (out.t[i], out.u[i], out.v[i]) = (t, v / det, w / det);
            let size = [ax, ay, bx, by, cx, cy].map(f32::abs).into_iter().fold(0.0, max);
            let (low, high) = (min(min(az, bz), cz), max(max(az, bz), cz));
            let far = max(high.abs(), low.abs());
            let unsure = (size * size) * (high - low) > (far * SURE) * det.abs();
            out.mask |= u32::from(!unsure && t >= r.t_min && t <= t_max) << i;
            out.unsure |= u32::from(unsure) << i;
        }
        out
    }

    #[inline(always)]
    fn near_boxes(self, p: [f32; 3], node: &WideNode, bound: f32, out: &mut [f32; 8]) -> u32 {
        let mut mask = 0;
        for i in 0..8 {
            let d: [f32; 3] = std::array::from_fn(|a| {
                max(max(node.planes[a][i] - p[a], p[a] - node.planes[3 + a][i]), 0.0)
            });
            out[i] = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
            mask |= u32::from(out[i] <= bound) << i;
        }
        mask
    }

    #[inline(always)]
    fn near_triangles(
        self,
        p: [f32; 3],
        pack: &Pack,
        slack: f32,
        low: &mut [f32; 4],
        high: &mut [f32; 4],
    ) {
        let dot = |a: [f32; 3], b: [f32; 3]| (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
        let minus = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let cross = |a: [f32; 3], b: [f32; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        for i in 0..4 {
            let v: [[f32; 3]; 3] = std::array::from_fn(|c| minus(pack.v[c].map(|axis| axis[i]), p));
            let e = [minus(v[1], v[0]), minus(v[2], v[1]), minus(v[0], v[2])];
            let n = cross(e[0], e[1]);
            let (mut near, mut size, mut inside) = (f32::INFINITY, 0.0f32, true);
            for k in 0..3 {
                let t = min(max((0.0 - dot(v[k], e[k])) / dot(e[k], e[k]), 0.0), 1.0);
                let q: [f32; 3] = std::array::from_fn(|a| v[k][a] + e[k][a] * t);
                near = min(dot(q, q), near);
                size = max(dot(v[k], v[k]), size);
                // Outside of this side: the origin is right of it, seen along the normal.
                inside &= dot(cross(e[k], n), v[k]) >= 0.0;
            }
            let (height, area) = (dot(v[0], n), dot(n, n));
            let flat = min(height * height / area, near);
            let wide = area >= WIDE * (dot(e[0], e[0]) * dot(e[1], e[1]));
            let room = slack * size.sqrt();
            low[i] = max(if inside { flat } else { near }.sqrt() - room, 0.0);
            high[i] = min(if inside && wide { flat } else { near }.sqrt() + room, f32::INFINITY);
        }
    }

    #[inline(always)]
    fn fetch<T>(self, _: &[T], _: usize) {}

    #[inline(always)]
    fn ring_normals(self, _: &Hexes, _: &[Vec4], _: &mut Rows<'_>) -> usize {
        0
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::super::rings::{self, Hexes, Rows};
    use super::super::token::Avx2;
    use super::{Pack, PackHits, Prepared, SURE, WIDE, Wide, WideNode};
    use glam::Vec4;
    use std::arch::x86_64::*;

    impl Wide for Avx2 {
        #[inline(always)]
        fn boxes(self, r: &Prepared, node: &WideNode, t_max: f32, near: &mut [f32; 8]) -> u32 {
            // SAFETY: the token proves AVX2; `near` and `far` are below 6, as only `Prepared::new`
            // makes them; all loads and stores are within the arrays they take their address from.
            unsafe {
                let at = |plane: usize, axis: usize, inverse: [f32; 3]| {
                    let p = _mm256_load_ps(node.planes.get_unchecked(plane).as_ptr());
                    let from = _mm256_sub_ps(p, _mm256_set1_ps(r.origin[axis]));
                    _mm256_mul_ps(from, _mm256_set1_ps(inverse[axis]))
                };
                let near_side = |axis: usize| at(r.near[axis], axis, r.inverse);
                let far_side = |axis: usize| at(r.far[axis], axis, r.wider);
                let n = _mm256_max_ps(
                    _mm256_max_ps(near_side(0), near_side(1)),
                    _mm256_max_ps(near_side(2), _mm256_set1_ps(r.t_min)),
                );
                let f = _mm256_min_ps(
                    _mm256_min_ps(far_side(0), far_side(1)),
                    _mm256_min_ps(far_side(2), _mm256_set1_ps(t_max)),
                );
                _mm256_storeu_ps(near.as_mut_ptr(), n);
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(n, f)) as u32
            }
        }

        #[inline(always)]
        fn triangles(self, r: &Prepared, p: &Pack, t_max: f32) -> PackHits {
            let mut out = PackHits { mask: 0, unsure: 0, t: [0.0; 4], u: [0.0; 4], v: [0.0; 4] };
            // SAFETY: the token proves AVX2 (and so SSE); `k` is below 3, as only `Prepared::new`
            // makes it; all loads and stores are within their arrays.
            unsafe {
                let o = r.turned.map(|x| _mm_set1_ps(x));
                let s = r.shear.map(|s| _mm_set1_ps(s));
                let corner = |c: usize| {
                    let get = |a: usize| {
                        let v = p.v[c].get_unchecked(r.k[a]).as_ptr();
                        _mm_sub_ps(_mm_load_ps(v), o[a])
                    };
                    let z = get(2);
                    let x = _mm_sub_ps(get(0), _mm_mul_ps(s[0], z));
                    let y = _mm_sub_ps(get(1), _mm_mul_ps(s[1], z));
                    (x, y, _mm_mul_ps(z, s[2]))
                };
                let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (corner(0), corner(1), corner(2));
                let edge = |a, b, c, d| _mm_sub_ps(_mm_mul_ps(a, b), _mm_mul_ps(c, d));
                let (u, v, w) = (edge(cx, by, cy, bx), edge(ax, cy, ay, cx), edge(bx, ay, by, ax));
                let zero = _mm_setzero_ps();
                let up = |x| _mm_cmp_ps::<_CMP_GE_OQ>(x, zero);
                let down = |x| _mm_cmp_ps::<_CMP_LE_OQ>(x, zero);
                let same = _mm_or_ps(
                    _mm_and_ps(_mm_and_ps(up(u), up(v)), up(w)),
                    _mm_and_ps(_mm_and_ps(down(u), down(v)), down(w)),
                );
                if _mm_movemask_ps(same) == 0 {
                    return out;
                }
                let det = _mm_add_ps(_mm_add_ps(u, v), w);
                let sum =
                    _mm_add_ps(_mm_add_ps(_mm_mul_ps(u, az), _mm_mul_ps(v, bz)), _mm_mul_ps(w, cz));
                let t = _mm_div_ps(sum, det);
                let within = _mm_and_ps(
                    _mm_cmp_ps::<_CMP_GE_OQ>(t, _mm_set1_ps(r.t_min)),
                    _mm_cmp_ps::<_CMP_LE_OQ>(t, _mm_set1_ps(t_max)),
                );
                let met = _mm_and_ps(same, _mm_cmp_ps::<_CMP_NEQ_OQ>(det, zero));
                let abs = |x| _mm_andnot_ps(_mm_set1_ps(-0.0), x);
                let most = |a, b, c| _mm_max_ps(_mm_max_ps(a, b), c);
                let size =
                    _mm_max_ps(most(abs(ax), abs(bx), abs(cx)), most(abs(ay), abs(by), abs(cy)));
                let (low, high) = (_mm_min_ps(_mm_min_ps(az, bz), cz), most(az, bz, cz));
                let far = _mm_max_ps(abs(high), abs(low));
                let unsure = _mm_and_ps(
                    met,
                    _mm_cmp_ps::<_CMP_GT_OQ>(
                        _mm_mul_ps(_mm_mul_ps(size, size), _mm_sub_ps(high, low)),
                        _mm_mul_ps(_mm_mul_ps(far, _mm_set1_ps(SURE)), abs(det)),
                    ),
                );
                out.unsure = _mm_movemask_ps(unsure) as u32;
                let sure = _mm_andnot_ps(unsure, _mm_and_ps(met, within));
                out.mask = _mm_movemask_ps(sure) as u32;
                if out.mask | out.unsure != 0 {
                    _mm_storeu_ps(out.t.as_mut_ptr(), t);
                    _mm_storeu_ps(out.u.as_mut_ptr(), _mm_div_ps(v, det));
                    _mm_storeu_ps(out.v.as_mut_ptr(), _mm_div_ps(w, det));
                }
            }
            out
        }

        #[inline(always)]
        fn near_boxes(self, p: [f32; 3], node: &WideNode, bound: f32, out: &mut [f32; 8]) -> u32 {
            // SAFETY: the token proves AVX2; all loads and stores are within their arrays.
            unsafe {
                let square = |a: usize| {
                    let at = _mm256_set1_ps(p[a]);
                    let below = _mm256_sub_ps(_mm256_load_ps(node.planes[a].as_ptr()), at);
                    let above = _mm256_sub_ps(at, _mm256_load_ps(node.planes[3 + a].as_ptr()));
                    let d = _mm256_max_ps(_mm256_max_ps(below, above), _mm256_setzero_ps());
                    _mm256_mul_ps(d, d)
                };
                let d = _mm256_add_ps(_mm256_add_ps(square(0), square(1)), square(2));
                _mm256_storeu_ps(out.as_mut_ptr(), d);
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(d, _mm256_set1_ps(bound))) as u32
            }
        }

        #[inline(always)]
        fn near_triangles(
            self,
            p: [f32; 3],
            pack: &Pack,
            slack: f32,
            low: &mut [f32; 4],
            high: &mut [f32; 4],
        ) {
            type Three = [__m128; 3];
            // SAFETY: the token proves AVX2 (and so SSE); all loads are within the pack, which is
            // aligned.
            unsafe {
                let dot = |a: Three, b: Three| {
                    let xy = _mm_add_ps(_mm_mul_ps(a[0], b[0]), _mm_mul_ps(a[1], b[1]));
                    _mm_add_ps(xy, _mm_mul_ps(a[2], b[2]))
                };
                let minus = |a: Three, b: Three| {
                    [_mm_sub_ps(a[0], b[0]), _mm_sub_ps(a[1], b[1]), _mm_sub_ps(a[2], b[2])]
                };
                let det = |a, b, c, d| _mm_sub_ps(_mm_mul_ps(a, b), _mm_mul_ps(c, d));
                let cross = |a: Three, b: Three| {
                    [
                        det(a[1], b[2], a[2], b[1]),
                        det(a[2], b[0], a[0], b[2]),
                        det(a[0], b[1], a[1], b[0]),
                    ]
                };
                let origin = [_mm_set1_ps(p[0]), _mm_set1_ps(p[1]), _mm_set1_ps(p[2])];
                let corner = |c: usize| {
                    let at = |a: usize| _mm_load_ps(pack.v[c][a].as_ptr());
                    minus([at(0), at(1), at(2)], origin)
                };
                let (v0, v1, v2) = (corner(0), corner(1), corner(2));
                let (e0, e1, e2) = (minus(v1, v0), minus(v2, v1), minus(v0, v2));
                let n = cross(e0, e1);
                let (zero, one) = (_mm_setzero_ps(), _mm_set1_ps(1.0));
                let segment = |v: Three, e: Three| {
                    let t = _mm_div_ps(_mm_sub_ps(zero, dot(v, e)), dot(e, e));
                    let t = _mm_min_ps(_mm_max_ps(t, zero), one);
                    let along = |a: usize| _mm_add_ps(v[a], _mm_mul_ps(e[a], t));
                    let q = [along(0), along(1), along(2)];
                    dot(q, q)
                };
                let within =
                    |v: Three, e: Three| _mm_cmp_ps::<_CMP_GE_OQ>(dot(cross(e, n), v), zero);
                let far = |v: Three| dot(v, v);
                let inf = _mm_set1_ps(f32::INFINITY);
                let near = _mm_min_ps(segment(v0, e0), inf);
                let near = _mm_min_ps(segment(v2, e2), _mm_min_ps(segment(v1, e1), near));
                let size = _mm_max_ps(far(v2), _mm_max_ps(far(v1), _mm_max_ps(far(v0), zero)));
                let inside = _mm_and_ps(_mm_and_ps(within(v0, e0), within(v1, e1)), within(v2, e2));
                let (height, area) = (dot(v0, n), dot(n, n));
                let flat = _mm_min_ps(_mm_div_ps(_mm_mul_ps(height, height), area), near);
                let sides = _mm_mul_ps(_mm_set1_ps(WIDE), _mm_mul_ps(dot(e0, e0), dot(e1, e1)));
                let wide = _mm_and_ps(inside, _mm_cmp_ps::<_CMP_GE_OQ>(area, sides));
                let room = _mm_mul_ps(_mm_set1_ps(slack), _mm_sqrt_ps(size));
                let below = _mm_sub_ps(_mm_sqrt_ps(_mm_blendv_ps(near, flat, inside)), room);
                let above = _mm_add_ps(_mm_sqrt_ps(_mm_blendv_ps(near, flat, wide)), room);
                // Both give their second argument where the first is not a number.
                _mm_storeu_ps(low.as_mut_ptr(), _mm_max_ps(below, zero));
                _mm_storeu_ps(high.as_mut_ptr(), _mm_min_ps(above, inf));
            }
        }

        #[inline(always)]
        fn fetch<T>(self, of: &[T], at: usize) {
            let Some(one) = of.get(at) else { return };
            let start = std::ptr::from_ref(one).cast::<i8>();
            for line in 0..size_of::<T>().div_ceil(64) {
                // SAFETY: a hint reads nothing; the token proves the processor has it.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line * 64)) };
            }
        }

        #[inline(always)]
        fn ring_normals(self, hexes: &Hexes, points: &[Vec4], to: &mut Rows<'_>) -> usize {
            rings::normals_avx2(self, hexes, points, to)
        }
    }
}

/// Work that is written once and compiled for each kind of processor. `run` must be
/// `#[inline(always)]`, or it is not compiled for AVX2.
pub trait WideWork {
    /// The result of the work.
    type Output;
    /// Does the work with the tests of `w`.
    fn run<W: Wide>(self, w: W) -> Self::Output;
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn with_avx2<J: WideWork>(work: J) -> J::Output {
    work.run(super::token::Avx2(()))
}

/// Runs `work` compiled for AVX2 where the processor has it (and `scalar` is not asked for), else
/// in plain Rust.
#[inline(always)]
pub fn dispatch<J: WideWork>(scalar: bool, work: J) -> J::Output {
    #[cfg(target_arch = "x86_64")]
    if !scalar && has_fast() {
        // SAFETY: the features were found on this processor.
        return unsafe { with_avx2(work) };
    }
    work.run(PortableLanes)
}

/// The detected processor: 0 unknown, 1 has the features of `has_fast`, 2 lacks them.
static KNOWN: AtomicU8 = AtomicU8::new(0);

/// From here on all work is done in plain Rust, as on a processor without AVX2: the same bits,
/// slower. For those who compare processors.
pub fn use_portable() {
    KNOWN.store(2, Relaxed);
}

/// AVX2 came together with BMI in every processor (Haswell, Excavator); both are checked all the
/// same, once.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) fn has_fast() -> bool {
    match KNOWN.load(Relaxed) {
        1 => true,
        2 => false,
        _ => {
            use std::arch::is_x86_feature_detected as has;
            let all =
                has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt");
            KNOWN.store(if all { 1 } else { 2 }, Relaxed);
            all
        }
    }
}

//! Cotangent weights of a closed ring, four triangles at a time.
//!
//! Between two neighbours `b` and `c` of a vertex, relative to it, the triangle's doubled area `A =
//! |b x c|` is under both cotangents that face the vertex's edges: `(c.c - b.c) / A` weighs `b`,
//! `(b.b - b.c) / A` weighs `c` (Pinkall and Polthier 1993). `A` comes from the same products: `A^2
//! = b.b c.c - (b.c)^2` (Lagrange), which loses digits only where the angle is so flat that the
//! clamp rules anyway. Products of four pairs are turned about in registers and summed as lanes.

use glam::{Mat4, Vec3, Vec4};

use crate::PageIn;
use sculptd_geometry::simd::cotangents::MAX_COT;

/// Neighbours that are weighed together.
pub const LANES: usize = 8;

/// Four dot products of the first three lanes.
#[inline(always)]
fn dots(a: [Vec4; 4], b: [Vec4; 4]) -> Vec4 {
    let p = Mat4::from_cols(a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]).transpose();
    (p.x_axis + p.y_axis) + p.z_axis
}

/// For four triangles their two cotangents each: what weighs `b`, what weighs `c`. No triangle, no
/// weight.
#[inline(always)]
fn cotangents(bb: Vec4, bc: Vec4, cc: Vec4) -> (Vec4, Vec4) {
    let area2 = bb * cc - bc * bc;
    let some = area2.cmpgt(Vec4::ZERO);
    let root = |v: Vec4| Vec4::new(v.x.sqrt(), v.y.sqrt(), v.z.sqrt(), v.w.sqrt());
    let inverse = Vec4::select(some, Vec4::ONE / root(area2), Vec4::ZERO);
    let (least, most) = (Vec4::splat(-MAX_COT), Vec4::splat(MAX_COT));
    (((cc - bc) * inverse).max(least).min(most), ((bb - bc) * inverse).max(least).min(most))
}

/// The weighted sum of the neighbours of own vertex `v` relative to its place, and the sum of
/// weights. An edge's two cotangents are clamped each, and their sum to 0 from below: two obtuse
/// angles would push instead of pull. For closed rings of up to [`LANES`] neighbours.
#[inline(always)]
pub fn closed(page: &PageIn<'_>, v: usize) -> (Vec3, f32) {
    let rows = page.rows();
    let p = rows[v];
    let mut d = [Vec4::ZERO; LANES + 1];
    let mut n = 0;
    for k in page.ring(v).take(LANES) {
        d[n] = rows[k as usize] - p;
        n += 1;
    }
    d[n] = d[0];
    let (low, high) = ([d[0], d[1], d[2], d[3]], [d[4], d[5], d[6], d[7]]);
    let (bb_low, bb_high) = (dots(low, low), dots(high, high));
    let bc_low = dots(low, [d[1], d[2], d[3], d[4]]);
    let bc_high = dots(high, [d[5], d[6], d[7], d[8]]);
    let last = if n == LANES { bb_low.x } else { 0.0 };
    let cc_low = Vec4::new(bb_low.y, bb_low.z, bb_low.w, bb_high.x);
    let cc_high = Vec4::new(bb_high.y, bb_high.z, bb_high.w, last);
    let (b_low, c_low) = cotangents(bb_low, bc_low, cc_low);
    let (b_high, c_high) = cotangents(bb_high, bc_high, cc_high);
    // The weight of neighbour i comes from triangle i and the one before; the last triangle's
    // second corner is the first one.
    let mut c = [0.0, c_low.x, c_low.y, c_low.z, c_low.w, c_high.x, c_high.y, c_high.z, c_high.w];
    (c[0], c[n]) = (c[n], 0.0);
    let own = |lanes: [f32; 4]| Vec4::from_array(lanes);
    let w_low = (b_low + own([c[0], c[1], c[2], c[3]])).max(Vec4::ZERO);
    let w_high = (b_high + own([c[4], c[5], c[6], c[7]])).max(Vec4::ZERO);
    let (w_low, w_high) = (w_low.to_array(), w_high.to_array());
    // A row past the ring is zero, but for the one that repeats the first: it has been weighed.
    d[n] = Vec4::ZERO;
    let sum = ((d[0] * w_low[0] + d[1] * w_low[1]) + (d[2] * w_low[2] + d[3] * w_low[3]))
        + ((d[4] * w_high[0] + d[5] * w_high[1]) + (d[6] * w_high[2] + d[7] * w_high[3]));
    let all = own(w_low) + own(w_high);
    (sum.truncate(), (all.x + all.y) + (all.z + all.w))
}

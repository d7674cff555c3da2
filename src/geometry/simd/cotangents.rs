//! Cotangent-weighted sums about vertices with a closed ring of six, eight vertices at a time where
//! the processor can.
//!
//! Between two neighbours `b` and `c` of a vertex, relative to it, the triangle's doubled area `A =
//! |b x c|` is under both cotangents that face the vertex's edges: `(c.c - b.c) / A` weighs `b`,
//! `(b.b - b.c) / A` weighs `c` (Pinkall and Polthier 1993). `A` comes from the same products: `A^2
//! = b.b c.c - (b.c)^2` (Lagrange), which loses digits only where the angle is so flat that the
//! clamp rules anyway. An edge's two cotangents are clamped each, and their sum to 0 from below:
//! two obtuse angles would push instead of pull.

use glam::Vec4;

use super::rings::Hexes;

/// Cotangents beyond 20 belong to angles under 3 degrees: needles, whose weights would rule the
/// ring.
pub const MAX_COT: f32 = 20.0;

/// One number, or the same of several vertices. Both give the same bits; of a comparison with NaN
/// the second is taken.
trait Lanes: Copy {
    fn all(value: f32) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    /// One over the root of what is above zero, else zero.
    fn inverse_root(self) -> Self;
}

impl Lanes for f32 {
    #[inline(always)]
    fn all(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self - other
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * other
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn inverse_root(self) -> Self {
        if self > 0.0 { 1.0 / self.sqrt() } else { 0.0 }
    }
}

#[inline(always)]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

/// Returns the weights of a triangle's two neighbours: the first for `b`, the second for `c`.
#[inline(always)]
fn pair<L: Lanes>(bb: L, cc: L, bc: L) -> (L, L) {
    let inverse = bb.mul(cc).sub(bc.mul(bc)).inverse_root();
    let (least, most) = (L::all(-MAX_COT), L::all(MAX_COT));
    (cc.sub(bc).mul(inverse).max(least).min(most), bb.sub(bc).mul(inverse).max(least).min(most))
}

/// The weighted sum of the neighbours' places relative to the vertex, and the sum of the weights.
/// Written out: an array's `map` and a closure are not always inlined into code for wider
/// instructions.
#[inline(always)]
fn weigh<L: Lanes>(d: &[[L; 3]; 6]) -> ([L; 3], L) {
    let zero = L::all(0.0);
    let (mut x, mut y, mut z, mut weights) = (zero, zero, zero, zero);
    let first = dot(d[0], d[0]);
    let last = dot(d[5], d[5]);
    let (_, mut before) = pair(last, first, dot(d[5], d[0]));
    let mut bb = first;
    for k in 0..6 {
        let next = d[(k + 1) % 6];
        let cc = dot(next, next);
        let (b, c) = pair(bb, cc, dot(d[k], next));
        let weight = b.add(before).max(zero);
        (before, bb) = (c, cc);
        x = x.add(d[k][0].mul(weight));
        y = y.add(d[k][1].mul(weight));
        z = z.add(d[k][2].mul(weight));
        weights = weights.add(weight);
    }
    ([x, y, z], weights)
}

/// About one vertex: the sum in the first three lanes, the weights in the fourth. None where its
/// ring is not among `hexes`.
#[inline(always)]
pub fn about(hexes: &Hexes, points: &[Vec4], v: usize) -> Option<Vec4> {
    let (ring, p) = (hexes.get(v)?, points[v]);
    let mut d = [[0.0; 3]; 6];
    for (d, &k) in d.iter_mut().zip(ring) {
        let [x, y, z, _] = (points[k as usize] - p).to_array();
        *d = [x, y, z];
    }
    let ([x, y, z], weights) = weigh(&d);
    Some(Vec4::new(x, y, z, weights))
}

/// About each vertex of `who`, which must have its ring among `hexes`.
pub fn about_each(hexes: &Hexes, points: &[Vec4], who: &[u16], out: &mut [Vec4]) {
    #[cfg(target_arch = "x86_64")]
    if super::wide::has_fast() {
        // SAFETY: the features were found on this processor.
        unsafe { wide::about_each(hexes, points, who, out) };
        return;
    }
    one_by_one(hexes, points, who, out);
}

fn one_by_one(hexes: &Hexes, points: &[Vec4], who: &[u16], out: &mut [Vec4]) {
    for (out, &v) in out.iter_mut().zip(who) {
        *out = about(hexes, points, v as usize).unwrap_or(Vec4::ZERO);
    }
}

#[cfg(target_arch = "x86_64")]
mod wide {
    use std::arch::x86_64::*;

    use glam::Vec4;

    use super::{Lanes, weigh};
    use crate::simd::rings::{Hexes, joined};

    // Each method is only sound where AVX2 is, which is where `about_each` below inlines it: the
    // type is private to it.
    #[derive(Clone, Copy)]
    struct Eight(__m256);

    impl Lanes for Eight {
        #[inline(always)]
        fn all(value: f32) -> Self {
            // SAFETY: see the type; so for all of these.
            Eight(unsafe { _mm256_set1_ps(value) })
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: see the type.
            Eight(unsafe { _mm256_add_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: see the type.
            Eight(unsafe { _mm256_sub_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: see the type.
            Eight(unsafe { _mm256_mul_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: see the type.
            Eight(unsafe { _mm256_max_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: see the type.
            Eight(unsafe { _mm256_min_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn inverse_root(self) -> Self {
            // SAFETY: see the type.
            unsafe {
                let some = _mm256_cmp_ps::<_CMP_GT_OQ>(self.0, _mm256_setzero_ps());
                let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_sqrt_ps(self.0));
                Eight(_mm256_and_ps(some, inverse))
            }
        }
    }

    /// Eight rows turned into their first three lanes.
    ///
    /// # Safety
    /// All of `at` are below the length of what `rows` points to; the processor has AVX2.
    #[inline(always)]
    unsafe fn turned(rows: *const f32, at: &[usize; 8]) -> [Eight; 3] {
        // SAFETY: as the caller promised.
        unsafe {
            let a = joined(rows, at[0], at[4]);
            let b = joined(rows, at[1], at[5]);
            let c = joined(rows, at[2], at[6]);
            let d = joined(rows, at[3], at[7]);
            let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
            let (ab_z, cd_z) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
            [
                Eight(_mm256_shuffle_ps::<0b01_00_01_00>(ab, cd)),
                Eight(_mm256_shuffle_ps::<0b11_10_11_10>(ab, cd)),
                Eight(_mm256_shuffle_ps::<0b01_00_01_00>(ab_z, cd_z)),
            ]
        }
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn about_each(hexes: &Hexes, points: &[Vec4], who: &[u16], out: &mut [Vec4]) {
        assert!(hexes.rows() <= points.len(), "rings of another page");
        let rows = points.as_ptr().cast::<f32>();
        for (who, out) in who.chunks(8).zip(out.chunks_mut(8)) {
            // The last few are filled up with the first of them.
            let mut at = [who[0] as usize; 8];
            let Some(ring) = hexes.get(at[0]) else { continue };
            let mut rings = [ring; 8];
            for (i, &v) in who.iter().enumerate() {
                let Some(ring) = hexes.get(v as usize) else { return };
                (at[i], rings[i]) = (v as usize, ring);
            }
            let mut d = [[Eight(_mm256_setzero_ps()); 3]; 6];
            // SAFETY: every vertex in `hexes` and every index in its rings is below `rows`; `lanes`
            // has room for eight.
            unsafe {
                let p = turned(rows, &at);
                for k in 0..6 {
                    for (at, ring) in at.iter_mut().zip(rings) {
                        *at = ring[k] as usize;
                    }
                    let b = turned(rows, &at);
                    d[k] = [b[0].sub(p[0]), b[1].sub(p[1]), b[2].sub(p[2])];
                }
                let (sum, weights) = weigh(&d);
                let mut lanes = [[0.0f32; 8]; 4];
                _mm256_storeu_ps(lanes[0].as_mut_ptr(), sum[0].0);
                _mm256_storeu_ps(lanes[1].as_mut_ptr(), sum[1].0);
                _mm256_storeu_ps(lanes[2].as_mut_ptr(), sum[2].0);
                _mm256_storeu_ps(lanes[3].as_mut_ptr(), weights.0);
                for (i, out) in out.iter_mut().enumerate() {
                    *out = Vec4::new(lanes[0][i], lanes[1][i], lanes[2][i], lanes[3][i]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_give_the_same_bits() {
        let mut state = 7u32;
        let mut next = move || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            state >> 8
        };
        let mut points: Vec<Vec4> = (0..90)
            .map(|_| Vec4::from_array([(); 4].map(|()| next() as f32 / 1e5 - 80.0)))
            .collect();
        // Places that coincide: triangles without an area.
        points[5] = points[6];
        points[7] = points[6];
        let hexes = Hexes::new((0..67).map(|_| [(); 6].map(|()| (next() % 90) as u16)).collect());
        let who: Vec<u16> = (0..67).filter(|v| v % 5 != 1).collect();
        let (mut wide, mut one) = (vec![Vec4::ZERO; who.len()], vec![Vec4::ONE; who.len()]);
        about_each(&hexes, &points, &who, &mut wide);
        one_by_one(&hexes, &points, &who, &mut one);
        let bits =
            |v: &[Vec4]| v.iter().map(|v| v.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&wide), bits(&one));
    }
}

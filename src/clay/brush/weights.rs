//! How much a brush does to each vertex of a page, computed for all of them at once: loops over
//! plain arrays without a branch, which the compiler turns into wide instructions, the same bits
//! with any width.

use glam::Vec3;

use crate::{PAGE_VERTICES, PageIn};

/// Vertices looked at together.
pub(super) const BLOCK: usize = 64;
/// Own vertices of the largest page.
pub(super) const MOST: usize = PAGE_VERTICES.next_multiple_of(BLOCK);

/// One page's weights, on the stack.
#[derive(Debug)]
pub struct Weights {
    weight: [f32; MOST],
}

impl Weights {
    /// Returns room for one page's weights. Not a closure parameter: the compiler may leave a
    /// closure outside the code that [`sculptd_geometry::simd::wide::dispatch`] compiles for the
    /// processor.
    #[inline(always)]
    pub fn zero() -> Weights {
        Weights { weight: [0.0; MOST] }
    }

    /// Computes the weight of each owned vertex of `page` by its squared distance to `centre`:
    /// `profile(d2) * (1 - mask)` within `radius2`, else 0. Returns how many are within, and
    /// whether a vertex within turns away by more than a right angle. Vertices that face away from
    /// `normal` are left alone as in [`super::Dab::facing`]; a zero normal leaves none alone.
    #[inline(always)]
    pub fn sphere(
        &mut self,
        page: &PageIn<'_>,
        centre: Vec3,
        normal: Vec3,
        radius2: f32,
        profile: impl Fn(f32) -> f32,
    ) -> (usize, bool) {
        let normals = page.normal_rows();
        let own = page.own().min(MOST);
        let (mut within, mut turned) = (0u32, 0u32);
        let blocks = page.rows()[..own].chunks(BLOCK).zip(normals[..own].chunks(BLOCK));
        for ((rows, normals), weights) in blocks.zip(self.weight.chunks_mut(BLOCK)) {
            let (mut d2, mut free) = ([f32::INFINITY; BLOCK], [0.0f32; BLOCK]);
            for ((row, d2), free) in rows.iter().zip(&mut d2).zip(&mut free) {
                let [x, y, z, mask] = row.to_array();
                let (x, y, z) = (x - centre.x, y - centre.y, z - centre.z);
                *d2 = x * x + y * y + z * z;
                *free = 1.0 - mask;
            }
            let inside = d2.iter().map(|d2| u32::from(*d2 < radius2)).sum::<u32>();
            within += inside;
            if inside == 0 {
                weights.fill(0.0);
                continue;
            }
            for ((row, free), d2) in normals.iter().zip(&mut free).zip(&d2) {
                let [x, y, z, _] = row.to_array();
                let c = x * normal.x + y * normal.y + z * normal.z;
                *free *= facing(c);
                turned |= u32::from((*d2 < radius2) & (c < 0.0));
            }
            for ((&d2, &free), weight) in d2.iter().zip(&free).zip(weights.iter_mut()) {
                let w = profile(d2) * free;
                *weight = if d2 < radius2 { w } else { 0.0 };
            }
        }
        (within as usize, turned != 0)
    }

    /// Every weight, for [`super::weigh`].
    #[inline(always)]
    pub(super) fn all_mut(&mut self) -> &mut [f32; MOST] {
        &mut self.weight
    }

    /// Returns the computed weights, block by block; zeros beyond the last owned vertex.
    #[inline(always)]
    pub(super) fn blocks(&self) -> impl Iterator<Item = &[f32; BLOCK]> {
        self.weight.as_chunks::<BLOCK>().0.iter()
    }

    /// Returns the computed weights, one for each owned vertex.
    #[inline]
    pub fn of(&self, page: &PageIn<'_>) -> &[f32] {
        &self.weight[..page.own().min(MOST)]
    }
}

/// See [`super::Dab::facing`]; `c` is the cosine between the normals.
#[inline(always)]
pub(super) fn facing(c: f32) -> f32 {
    ((c + 0.5) * 2.0).max(0.0).min(1.0)
}

/// `e^x` for `x <= 0`, with an error below 2e-7 of the result; 0 below -87. No table, no branch, no
/// fused multiply-add: it runs eight at a time and gives the same bits one at a time.
///
/// `x = (n + f) ln 2` with `f` in [-1/2, 1/2]; `2^f` by its series to the sixth power, `2^n` by the
/// exponent's bits.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // Adding 1.5 * 2^23 rounds to a whole number and leaves it in the low bits.
    const ROUND: f32 = 12_582_912.0;
    let y = x.max(-87.0) * std::f32::consts::LOG2_E;
    let shifted = y + ROUND;
    let f = (y - (shifted - ROUND)) * std::f32::consts::LN_2;
    let mut p = 1.0 / 720.0;
    p = p * f + 1.0 / 120.0;
    p = p * f + 1.0 / 24.0;
    p = p * f + 1.0 / 6.0;
    p = p * f + 0.5;
    p = p * f + 1.0;
    p = p * f + 1.0;
    let scale = f32::from_bits(shifted.to_bits().wrapping_add(127) << 23);
    if x < -87.0 { 0.0 } else { p * scale }
}

/// The natural logarithm of `x` in 0.001 to 1, by Halley's iteration on [`exp`], to the precision
/// of that.
#[inline]
pub fn ln(x: f32) -> f32 {
    let mut y = x - 1.0;
    for _ in 0..8 {
        let e = exp(y);
        y = (y + 2.0 * (x - e) / (x + e)).min(0.0);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::{exp, ln};

    #[test]
    fn ln_undoes_exp() {
        assert_eq!(ln(1.0), 0.0);
        for i in 1..=1000 {
            let x = i as f32 / 1000.0;
            assert!((exp(ln(x)) - x).abs() < 1e-6 * x.max(0.1), "{x}: {}", ln(x));
        }
    }

    #[test]
    fn exp_is_close_to_the_true_one() {
        let mut worst = 0.0f64;
        for i in 0..=400_000 {
            let x = -(i as f32) * 1e-4;
            let truth = f64::from(x).exp();
            worst = worst.max((f64::from(exp(x)) - truth).abs() / truth);
        }
        // The argument's own rounding grows with |x|: at 40 it is 40 * 6e-8 of the result.
        assert!(worst < 4e-6, "{worst}");
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-1000.0), 0.0);
        assert_eq!(exp(f32::NEG_INFINITY), 0.0);
    }
}

//! How much a brush does to each vertex of a page, computed for all of them at once: loops over plain arrays without a
//! branch, which the compiler turns into wide instructions, the same bits with any width.

use std::cell::RefCell;

use glam::Vec3;

use crate::mesh::PageIn;

/// Room for one page's numbers, one set a thread.
#[derive(Debug, Default)]
pub struct Weights {
    d2: Vec<f32>,
    free: Vec<f32>,
    weight: Vec<f32>,
}

thread_local! {
    static WEIGHTS: RefCell<Weights> = RefCell::default();
}

impl Weights {
    /// Calls `work` with this thread's room. Not to be nested.
    pub fn with<T>(work: impl FnOnce(&mut Weights) -> T) -> T {
        WEIGHTS.with_borrow_mut(work)
    }

    /// The weight of each own vertex of `page` by its squared distance to `centre`: `profile(d2) * (1 - mask)` within
    /// `radius2`, else 0. Returns how many lie within.
    #[inline(always)]
    pub fn sphere(
        &mut self,
        page: &PageIn<'_>,
        centre: Vec3,
        radius2: f32,
        profile: impl Fn(f32) -> f32,
    ) -> usize {
        let own = page.own();
        for v in [&mut self.d2, &mut self.free, &mut self.weight] {
            v.resize(own.max(v.len()), 0.0);
        }
        let (d2, free, weight) = (&mut self.d2[..own], &mut self.free[..own], &mut self.weight[..own]);
        for ((row, d2), free) in page.rows()[..own].iter().zip(d2.iter_mut()).zip(free.iter_mut()) {
            let [x, y, z, mask] = row.to_array();
            let (x, y, z) = (x - centre.x, y - centre.y, z - centre.z);
            *d2 = x * x + y * y + z * z;
            *free = 1.0 - mask;
        }
        let mut within = 0u32;
        for ((&d2, &free), weight) in d2.iter().zip(free.iter()).zip(weight.iter_mut()) {
            let inside = d2 < radius2;
            within += u32::from(inside);
            let w = profile(d2) * free;
            *weight = if inside { w } else { 0.0 };
        }
        within as usize
    }

    /// What [`Weights::sphere`] computed, one an own vertex.
    pub fn of(&self, page: &PageIn<'_>) -> &[f32] {
        &self.weight[..page.own()]
    }
}

/// `e^x` for `x <= 0`, with an error below 2e-7 of the result; 0 below -87. No table, no branch, no fused multiply-add:
/// it runs eight at a time and gives the same bits one at a time.
///
/// `x = (n + f) ln 2` with `f` in [-1/2, 1/2]; `2^f` by its series to the sixth power, `2^n` by the exponent's bits.
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

#[cfg(test)]
mod tests {
    use super::exp;

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

//! What goes with a sum of products: bias, clamping, a residual, slopes of a PReLU.

use pulp::Simd;

use super::tflite::OutputRange;

/// Steps that are applied while the results are in registers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Epilogue {
    /// One a channel, filled up with zeros to whole vectors.
    pub bias: Vec<f32>,
    /// Applied to the sum.
    pub range: OutputRange,
    /// Slopes for negative results after the residual, filled up like the bias.
    pub slopes: Option<Vec<f32>>,
}

/// Loads a vector; lanes past the end of the slice are zero.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, from: &[f32]) -> S::f32s {
    match S::as_simd_f32s(from) {
        ([vector, ..], _) => *vector,
        ([], tail) => simd.partial_load_f32s(tail),
    }
}

/// Stores a vector; lanes past the end of the slice are dropped.
#[inline(always)]
pub(super) fn store<S: Simd>(simd: S, to: &mut [f32], value: S::f32s) {
    match S::as_mut_simd_f32s(to) {
        ([vector, ..], _) => *vector = value,
        ([], tail) => simd.partial_store_f32s(tail, value),
    }
}

impl Epilogue {
    /// Returns the bias of the vector of channels that begins at `channel`: sums begin with it, in
    /// the order in which LiteRT adds.
    #[inline(always)]
    pub(super) fn bias<S: Simd>(&self, simd: S, channel: usize) -> S::f32s {
        load(simd, self.bias.get(channel..).unwrap_or_default())
    }

    /// Finishes the vector of channels that begins at `channel`; `residual` begins there too.
    #[inline(always)]
    pub(super) fn finish<S: Simd>(
        &self,
        simd: S,
        sum: S::f32s,
        channel: usize,
        residual: Option<&[f32]>,
    ) -> S::f32s {
        let mut value = sum;
        if self.range != OutputRange::ALL {
            let (low, high) = (simd.splat_f32s(self.range.0), simd.splat_f32s(self.range.1));
            value = simd.min_f32s(simd.max_f32s(value, low), high);
        }
        if let Some(residual) = residual {
            value = simd.add_f32s(value, load(simd, residual));
        }
        if let Some(slopes) = &self.slopes {
            let zero = simd.splat_f32s(0.0);
            let below = simd.min_f32s(value, zero);
            let slope = load(simd, &slopes[channel..]);
            value = simd.mul_add_e_f32s(below, slope, simd.max_f32s(value, zero));
        }
        value
    }
}

//! Convolutions of each channel by itself.
//!
//! The input is copied once, with its border of zeros, into planes of one vector of channels. A
//! row of a plane is contiguous, so a few neighbouring results share their loads.

use pulp::Simd;

use super::epilogue::{Epilogue, store};
use super::tflite::{TensorShape, Window};

/// A depthwise convolution with its weights in vectors, plane by plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PackedDepthwise {
    pub window: Window,
    weights: Vec<f32>,
    /// Weights before packing.
    count: usize,
}

impl PackedDepthwise {
    /// Packs `[row][column][channel]` weights for vectors of `lanes` numbers.
    pub fn new(weights: &[f32], channels: usize, window: Window, lanes: usize) -> Self {
        let taps = window.size.0 * window.size.1;
        let planes = channels.div_ceil(lanes);
        let mut packed = vec![0.0; planes * taps * lanes];
        for (tap, row) in weights.chunks_exact(channels.max(1)).enumerate() {
            for (channel, weight) in row.iter().enumerate() {
                packed[(channel / lanes * taps + tap) * lanes + channel % lanes] = *weight;
            }
        }
        PackedDepthwise { window, weights: packed, count: weights.len() }
    }

    /// Returns the weights of each of so many channels.
    pub fn taps(&self, channels: usize) -> usize {
        self.count / channels.max(1)
    }

    /// Computes all pixels. `scratch` is memory for one plane.
    #[inline(always)]
    pub fn run<S: Simd>(
        &self,
        simd: S,
        epilogue: &Epilogue,
        (input, from): (&[f32], TensorShape),
        (output, to): (&mut [f32], TensorShape),
        residual: Option<&[f32]>,
        scratch: &mut Vec<f32>,
    ) {
        let lanes = S::F32_LANES;
        let Window { size, stride, .. } = self.window;
        // The plane has all rows and columns that any window reaches.
        let height = (to.h - 1) * stride.0 + size.0;
        let width = (to.w - 1) * stride.1 + size.1;
        // Vectors past the last window, so that a tile of eight may read them.
        let line = width + 8 * stride.1;
        scratch.clear();
        scratch.resize(height * line * lanes, 0.0);
        let taps = size.0 * size.1;
        for (plane, weights) in self.weights.chunks_exact(taps * lanes).enumerate() {
            let channel = plane * lanes;
            fill(simd, &self.window, (input, from), channel, scratch, (height, line));
            let (vectors, _) = S::as_simd_f32s(scratch.as_slice());
            let (taps, _) = S::as_simd_f32s(weights);
            let strip = Strip { epilogue, taps, channel, channels: to.c };
            for y in 0..to.h {
                let rows = &vectors[y * stride.0 * line..][..size.0 * line];
                let out = &mut output[y * to.w * to.c..][..to.w * to.c];
                let residual = residual.map(|r| &r[y * to.w * to.c..][..to.w * to.c]);
                match (size.1, stride.1) {
                    (3, 1) => strip.line::<3, 1, 10, 6>(simd, rows, line, out, residual),
                    (3, 2) => strip.line::<3, 2, 17, 9>(simd, rows, line, out, residual),
                    (5, 1) => strip.line::<5, 1, 12, 8>(simd, rows, line, out, residual),
                    (5, 2) => strip.line::<5, 2, 19, 11>(simd, rows, line, out, residual),
                    (columns, step) => {
                        strip.any(simd, rows, (line, columns, step), out, residual);
                    }
                }
            }
        }
    }
}

/// Copies one vector of channels into a plane; its border stays zero.
#[inline(always)]
fn fill<S: Simd>(
    simd: S,
    window: &Window,
    (input, from): (&[f32], TensorShape),
    channel: usize,
    plane: &mut [f32],
    (height, line): (usize, usize),
) {
    let lanes = S::F32_LANES;
    let used = lanes.min(from.c - channel);
    let (vectors, _) = S::as_mut_simd_f32s(plane);
    for y in 0..from.h.min(height.saturating_sub(window.pad.0)) {
        let to = &mut vectors[(y + window.pad.0) * line..][..line];
        let to = &mut to[window.pad.1..];
        let source = &input[y * from.w * from.c..][..from.w * from.c];
        if used == lanes {
            for (to, pixel) in to.iter_mut().zip(source.chunks_exact(from.c)) {
                *to = super::epilogue::load(simd, &pixel[channel..]);
            }
        } else {
            for (to, pixel) in to.iter_mut().zip(source.chunks_exact(from.c)) {
                *to = simd.partial_load_f32s(&pixel[channel..]);
            }
        }
    }
}

/// One vector of channels along one row of results.
struct Strip<'a, S: Simd> {
    epilogue: &'a Epilogue,
    taps: &'a [S::f32s],
    channel: usize,
    channels: usize,
}

impl<S: Simd> Strip<'_, S> {
    /// A row in tiles of eight results, then four, then single ones. `EIGHT` and `FOUR` are the
    /// inputs that such a tile reads in a row.
    #[inline(always)]
    fn line<const COLUMNS: usize, const STEP: usize, const EIGHT: usize, const FOUR: usize>(
        &self,
        simd: S,
        rows: &[S::f32s],
        line: usize,
        out: &mut [f32],
        residual: Option<&[f32]>,
    ) {
        let width = out.len() / self.channels;
        let mut x = 0;
        while x + 8 <= width {
            self.tile::<COLUMNS, STEP, EIGHT, 8>(simd, rows, line, x, out, residual);
            x += 8;
        }
        // The last tiles may compute past the row's end; those results are dropped.
        while x < width {
            self.tile::<COLUMNS, STEP, FOUR, 4>(simd, rows, line, x, out, residual);
            x += 4;
        }
    }

    #[inline(always)]
    fn tile<const COLUMNS: usize, const STEP: usize, const READ: usize, const COUNT: usize>(
        &self,
        simd: S,
        rows: &[S::f32s],
        line: usize,
        x: usize,
        out: &mut [f32],
        residual: Option<&[f32]>,
    ) {
        let mut sums = [self.epilogue.bias(simd, self.channel); COUNT];
        let (taps, _) = self.taps.as_chunks::<COLUMNS>();
        for (row, taps) in rows.chunks_exact(line).zip(taps) {
            let Some(inputs) = row[x * STEP..].first_chunk::<READ>() else { return };
            for (column, tap) in taps.iter().enumerate() {
                for (i, sum) in sums.iter_mut().enumerate() {
                    *sum = simd.mul_add_e_f32s(inputs[i * STEP + column], *tap, *sum);
                }
            }
        }
        self.put(simd, &sums, x, out, residual);
    }

    /// Any window, one result at a time.
    #[inline(always)]
    fn any(
        &self,
        simd: S,
        rows: &[S::f32s],
        (line, columns, step): (usize, usize, usize),
        out: &mut [f32],
        residual: Option<&[f32]>,
    ) {
        for x in 0..out.len() / self.channels {
            let mut sum = self.epilogue.bias(simd, self.channel);
            for (row, taps) in rows.chunks_exact(line).zip(self.taps.chunks_exact(columns)) {
                for (input, tap) in row[x * step..].iter().zip(taps) {
                    sum = simd.mul_add_e_f32s(*input, *tap, sum);
                }
            }
            self.put(simd, &[sum], x, out, residual);
        }
    }

    #[inline(always)]
    fn put(&self, simd: S, sums: &[S::f32s], x: usize, out: &mut [f32], residual: Option<&[f32]>) {
        for (i, sum) in sums.iter().enumerate() {
            let range = (x + i) * self.channels + self.channel..(x + i + 1) * self.channels;
            let residual = residual.and_then(|r| r.get(range.clone()));
            let Some(to) = out.get_mut(range) else { return };
            store(simd, to, self.epilogue.finish(simd, *sum, self.channel, residual));
        }
    }
}

//! Convolutions as products of a matrix of pixels with packed weights.

use pulp::Simd;

use super::epilogue::{Epilogue, store};
use super::tflite::{TensorShape, Window};

/// Rows of pixels that pass over all weights together: their inputs stay in the cache.
const BLOCK: usize = 48;

/// A convolution with its weights packed for vectors of a given length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PackedConvolution {
    pub window: Window,
    /// Two vectors of output channels for each input number, panel by panel.
    panels: Vec<f32>,
    /// Input numbers of one output: window times channels.
    depth: usize,
    outputs: usize,
}

impl PackedConvolution {
    /// Packs `[output][input]` weights for vectors of `lanes` numbers.
    pub fn new(weights: &[f32], outputs: usize, window: Window, lanes: usize) -> Self {
        let depth = weights.len() / outputs.max(1);
        let width = 2 * lanes;
        let count = outputs.div_ceil(width);
        let mut panels = vec![0.0; count * depth * width];
        for (output, row) in weights.chunks_exact(depth.max(1)).enumerate() {
            let (panel, lane) = (output / width, output % width);
            for (i, weight) in row.iter().enumerate() {
                panels[(panel * depth + i) * width + lane] = *weight;
            }
        }
        PackedConvolution { window, panels, depth, outputs }
    }

    /// Returns the input numbers of one output.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Computes all pixels. `scratch` is memory for gathered windows.
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
        let direct = self.window.size == (1, 1) && self.window.stride == (1, 1);
        let (pixels, depth, n) = (to.h * to.w, self.depth, self.outputs);
        if !direct {
            scratch.resize(BLOCK * depth, 0.0);
        }
        for first in (0..pixels).step_by(BLOCK) {
            let count = BLOCK.min(pixels - first);
            let rows = if direct {
                &input[first * depth..(first + count) * depth]
            } else {
                for i in 0..count {
                    let (y, x) = ((first + i) / to.w, (first + i) % to.w);
                    gather(&self.window, input, from, (y, x), &mut scratch[i * depth..][..depth]);
                }
                &scratch[..count * depth]
            };
            let out = &mut output[first * n..(first + count) * n];
            let residual = residual.map(|r| &r[first * n..(first + count) * n]);
            self.block(simd, epilogue, rows, out, residual);
        }
    }

    #[inline(always)]
    fn block<S: Simd>(
        &self,
        simd: S,
        epilogue: &Epilogue,
        rows: &[f32],
        out: &mut [f32],
        residual: Option<&[f32]>,
    ) {
        let width = 2 * S::F32_LANES;
        let most = if S::REGISTER_COUNT >= 32 { 12 } else { 6 };
        let count = out.len() / self.outputs;
        // Tiles of equal height, so that none is left with a single row.
        let tall = count.div_ceil(count.div_ceil(most).max(1));
        for (panel, weights) in self.panels.chunks_exact(self.depth * width).enumerate() {
            let column = panel * width;
            let (vectors, _) = S::as_simd_f32s(weights);
            let (pairs, _) = vectors.as_chunks::<2>();
            let mut row = 0;
            while row < count {
                let here = tall.min(count - row);
                let tile = Tile {
                    pairs,
                    rows: &rows[row * self.depth..],
                    epilogue,
                    column,
                    outputs: self.outputs,
                };
                let at = row * self.outputs;
                let residual = residual.map(|r| &r[at..]);
                let out = &mut out[at..];
                match here {
                    1 => tile.run::<1>(simd, out, residual),
                    2 => tile.run::<2>(simd, out, residual),
                    3 => tile.run::<3>(simd, out, residual),
                    4 => tile.run::<4>(simd, out, residual),
                    5 => tile.run::<5>(simd, out, residual),
                    6 => tile.run::<6>(simd, out, residual),
                    7 => tile.run::<7>(simd, out, residual),
                    8 => tile.run::<8>(simd, out, residual),
                    9 => tile.run::<9>(simd, out, residual),
                    10 => tile.run::<10>(simd, out, residual),
                    11 => tile.run::<11>(simd, out, residual),
                    _ => tile.run::<12>(simd, out, residual),
                }
                row += here;
            }
        }
    }
}

/// A few rows times one panel.
struct Tile<'a, S: Simd> {
    pairs: &'a [[S::f32s; 2]],
    rows: &'a [f32],
    epilogue: &'a Epilogue,
    column: usize,
    outputs: usize,
}

impl<S: Simd> Tile<'_, S> {
    #[inline(always)]
    fn run<const ROWS: usize>(&self, simd: S, out: &mut [f32], residual: Option<&[f32]>) {
        let (pairs, depth) = (self.pairs, self.pairs.len());
        let mut rows = [&self.rows[..0]; ROWS];
        for (i, row) in rows.iter_mut().enumerate() {
            *row = &self.rows[i * depth..][..depth];
        }
        let mut sums = [[simd.splat_f32s(0.0); 2]; ROWS];
        for (k, [first, second]) in pairs.iter().enumerate() {
            for (sum, row) in sums.iter_mut().zip(&rows) {
                let x = simd.splat_f32s(row[k]);
                sum[0] = simd.mul_add_e_f32s(x, *first, sum[0]);
                sum[1] = simd.mul_add_e_f32s(x, *second, sum[1]);
            }
        }
        for (i, sum) in sums.iter().enumerate() {
            for (half, sum) in sum.iter().enumerate() {
                let column = self.column + half * S::F32_LANES;
                if column >= self.outputs {
                    break;
                }
                let range = i * self.outputs + column..(i + 1) * self.outputs;
                let residual = residual.map(|r| &r[range.clone()]);
                let value = self.epilogue.finish(simd, *sum, column, residual);
                store(simd, &mut out[range], value);
            }
        }
    }
}

/// Copies the window of one output pixel; outside the input it is zero.
#[inline(always)]
fn gather(
    window: &Window,
    input: &[f32],
    from: TensorShape,
    (y, x): (usize, usize),
    to: &mut [f32],
) {
    let (rows, columns) = window.size;
    let line = columns * from.c;
    // The window's first column, which may lie left of the input.
    let left = (x * window.stride.1) as isize - window.pad.1 as isize;
    let skipped = usize::try_from(-left).unwrap_or(0).min(columns);
    let begin = usize::try_from(left).unwrap_or(0).min(from.w);
    let kept = (columns - skipped).min(from.w - begin);
    for row in 0..rows {
        let to = &mut to[row * line..][..line];
        let y = (y * window.stride.0 + row).checked_sub(window.pad.0).filter(|y| *y < from.h);
        to.fill(0.0);
        if let Some(y) = y {
            let source = &input[(y * from.w + begin) * from.c..][..kept * from.c];
            to[skipped * from.c..][..source.len()].copy_from_slice(source);
        }
    }
}

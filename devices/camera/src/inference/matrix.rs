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
    /// Two vectors of output channels for each input number, panel by panel; the last panel has one
    /// vector if that is enough.
    panels: Vec<f32>,
    /// Input numbers of one output: window times channels.
    depth: usize,
    outputs: usize,
}

impl PackedConvolution {
    /// Packs `[output][input]` weights for vectors of `lanes` numbers.
    pub fn new(weights: &[f32], outputs: usize, window: Window, lanes: usize) -> Self {
        let depth = weights.len() / outputs.max(1);
        let vectors = outputs.div_ceil(lanes);
        let mut panels = vec![0.0; vectors * depth * lanes];
        for (output, row) in weights.chunks_exact(depth.max(1)).enumerate() {
            let (panel, lane) = (output / (2 * lanes), output % (2 * lanes));
            // Vectors of this panel.
            let width = 2.min(vectors - 2 * panel) * lanes;
            let from = panel * depth * 2 * lanes;
            for (i, weight) in row.iter().enumerate() {
                panels[from + i * width + lane] = *weight;
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
                    copy_window(
                        &self.window,
                        input,
                        from,
                        (y, x),
                        &mut scratch[i * depth..][..depth],
                    );
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
        let lanes = S::F32_LANES;
        let most = if S::REGISTER_COUNT >= 32 { 12 } else { 6 };
        let count = out.len() / self.outputs;
        // Tiles of equal height, so that none is left with a single row.
        let tall = count.div_ceil(count.div_ceil(most).max(1));
        for (panel, weights) in self.panels.chunks(self.depth * 2 * lanes).enumerate() {
            let (vectors, _) = S::as_simd_f32s(weights);
            let is_wide = vectors.len() == 2 * self.depth;
            let mut row = 0;
            while row < count {
                let here = tall.min(count - row);
                let tile = Tile {
                    vectors,
                    rows: &rows[row * self.depth..],
                    epilogue,
                    column: panel * 2 * lanes,
                    outputs: self.outputs,
                };
                let at = row * self.outputs;
                let residual = residual.map(|r| &r[at..]);
                if is_wide {
                    tile.of_height::<2>(simd, here, &mut out[at..], residual);
                } else {
                    tile.of_height::<1>(simd, here, &mut out[at..], residual);
                }
                row += here;
            }
        }
    }
}

/// A few rows times one panel.
struct Tile<'a, S: Simd> {
    vectors: &'a [S::f32s],
    rows: &'a [f32],
    epilogue: &'a Epilogue,
    column: usize,
    outputs: usize,
}

impl<S: Simd> Tile<'_, S> {
    #[inline(always)]
    fn of_height<const WIDE: usize>(
        &self,
        simd: S,
        height: usize,
        out: &mut [f32],
        residual: Option<&[f32]>,
    ) {
        match height {
            1 => self.run::<1, WIDE>(simd, out, residual),
            2 => self.run::<2, WIDE>(simd, out, residual),
            3 => self.run::<3, WIDE>(simd, out, residual),
            4 => self.run::<4, WIDE>(simd, out, residual),
            5 => self.run::<5, WIDE>(simd, out, residual),
            6 => self.run::<6, WIDE>(simd, out, residual),
            7 => self.run::<7, WIDE>(simd, out, residual),
            8 => self.run::<8, WIDE>(simd, out, residual),
            9 => self.run::<9, WIDE>(simd, out, residual),
            10 => self.run::<10, WIDE>(simd, out, residual),
            11 => self.run::<11, WIDE>(simd, out, residual),
            _ => self.run::<12, WIDE>(simd, out, residual),
        }
    }

    #[inline(always)]
    fn run<const ROWS: usize, const WIDE: usize>(
        &self,
        simd: S,
        out: &mut [f32],
        residual: Option<&[f32]>,
    ) {
        let (steps, _) = self.vectors.as_chunks::<WIDE>();
        let depth = steps.len();
        let mut rows = [&self.rows[..0]; ROWS];
        for (i, row) in rows.iter_mut().enumerate() {
            *row = &self.rows[i * depth..][..depth];
        }
        let mut bias = [simd.splat_f32s(0.0); WIDE];
        for (half, bias) in bias.iter_mut().enumerate() {
            *bias = self.epilogue.bias(simd, self.column + half * S::F32_LANES);
        }
        let mut sums = [bias; ROWS];
        for (k, weights) in steps.iter().enumerate() {
            for (sum, row) in sums.iter_mut().zip(&rows) {
                let x = simd.splat_f32s(row[k]);
                for (sum, weight) in sum.iter_mut().zip(weights) {
                    *sum = simd.mul_add_e_f32s(x, *weight, *sum);
                }
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
fn copy_window(
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

//! The operators that are neither a convolution nor hot. Plain loops: the compiler vectorises them
//! for the processor that the caller was dispatched to.

use super::tflite::{OutputRange, TensorShape, Window};

/// Slopes for negative values, one a channel.
#[inline(always)]
pub(super) fn prelu(input: &[f32], slopes: &[f32], output: &mut [f32]) {
    let pixels = input.chunks_exact(slopes.len()).zip(output.chunks_exact_mut(slopes.len()));
    for (from, to) in pixels {
        for ((to, x), slope) in to.iter_mut().zip(from).zip(slopes) {
            *to = x.max(0.0) + x.min(0.0) * slope;
        }
    }
}

/// Sum of two tensors.
#[inline(always)]
pub(super) fn sum(a: &[f32], b: &[f32], range: OutputRange, output: &mut [f32]) {
    for ((to, a), b) in output.iter_mut().zip(a).zip(b) {
        *to = (a + b).max(range.0).min(range.1);
    }
}

/// Channels filled up with zeros.
#[inline(always)]
pub(super) fn pad_channels(input: &[f32], from: usize, output: &mut [f32], to: usize) {
    for (from, to) in input.chunks_exact(from).zip(output.chunks_exact_mut(to)) {
        let (copied, zero) = to.split_at_mut(from.len());
        copied.copy_from_slice(from);
        zero.fill(0.0);
    }
}

/// Largest value of each window; outside the input nothing counts.
#[inline(always)]
pub(super) fn max_pool(
    window: &Window,
    (input, from): (&[f32], TensorShape),
    (output, to): (&mut [f32], TensorShape),
) {
    for (i, out) in output.chunks_exact_mut(to.c).enumerate() {
        let (y, x) = (i / to.w, i % to.w);
        out.fill(f32::MIN);
        for row in 0..window.size.0 {
            let y = (y * window.stride.0 + row).checked_sub(window.pad.0);
            let Some(y) = y.filter(|y| *y < from.h) else { continue };
            for column in 0..window.size.1 {
                let x = (x * window.stride.1 + column).checked_sub(window.pad.1);
                let Some(x) = x.filter(|x| *x < from.w) else { continue };
                let pixel = &input[(y * from.w + x) * from.c..][..from.c];
                for (to, x) in out.iter_mut().zip(pixel) {
                    *to = to.max(*x);
                }
            }
        }
    }
}

/// Bilinear enlargement: the centres of the pixels stay where they are.
#[inline(always)]
pub(super) fn resize(
    (input, from): (&[f32], TensorShape),
    (output, to): (&mut [f32], TensorShape),
) {
    let place = |i: usize, from: usize, to: usize| {
        let at = ((i as f32 + 0.5) * (from as f32 / to as f32) - 0.5).max(0.0);
        let low = (at as usize).min(from - 1);
        (low, (low + 1).min(from - 1), at - low as f32)
    };
    for (i, out) in output.chunks_exact_mut(to.c).enumerate() {
        let (top, bottom, down) = place(i / to.w, from.h, to.h);
        let (left, right, across) = place(i % to.w, from.w, to.w);
        let pixel = |y: usize, x: usize| &input[(y * from.w + x) * from.c..][..from.c];
        let corners =
            (pixel(top, left), pixel(top, right), pixel(bottom, left), pixel(bottom, right));
        for (k, to) in out.iter_mut().enumerate() {
            let above = corners.0[k] + (corners.1[k] - corners.0[k]) * across;
            let below = corners.2[k] + (corners.3[k] - corners.2[k]) * across;
            *to = above + (below - above) * down;
        }
    }
}

/// Mean over all pixels.
#[inline(always)]
pub(super) fn mean(input: &[f32], output: &mut [f32]) {
    output.fill(0.0);
    let pixels = (input.len() / output.len().max(1)).max(1);
    for pixel in input.chunks_exact(output.len().max(1)) {
        for (to, x) in output.iter_mut().zip(pixel) {
            *to += x;
        }
    }
    for to in output {
        *to /= pixels as f32;
    }
}

/// Logistic function.
pub(super) fn logistic(input: &[f32], output: &mut [f32]) {
    for (to, x) in output.iter_mut().zip(input) {
        *to = 1.0 / (1.0 + (-x).exp());
    }
}

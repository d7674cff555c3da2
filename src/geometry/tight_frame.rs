//! A frame in which the boxes around a mesh's triangles are small.

use glam::{DMat3, DVec3};

/// A frame in which the boxes around triangles are much smaller, where there is one: thin ribs that
/// run all one way, but along no axis, have boxes that nearly all meet. From a sample of the
/// triangles; the axes are those of the sum of their edges' squares.
pub(crate) fn tight_frame(positions: &[DVec3], triangles: &[[u32; 3]]) -> Option<DMat3> {
    const SAMPLES: usize = 4096;
    let step = triangles.len().div_ceil(SAMPLES).max(1);
    let some: Vec<[DVec3; 3]> = triangles
        .iter()
        .step_by(step)
        .map(|t| t.map(|v| positions[v as usize]))
        .filter(|t| t.iter().all(|p| p.is_finite()))
        .collect();
    let mut sum = DMat3::ZERO;
    for [a, b, c] in &some {
        for e in [*b - *a, *c - *b, *a - *c] {
            sum += DMat3::from_cols(e * e.x, e * e.y, e * e.z);
        }
    }
    let turn = principal_axes(sum).transpose();
    let size = |frame: DMat3| -> f64 {
        let half = |t: &[DVec3; 3]| {
            let [a, b, c] = t.map(|p| frame * (p - t[0]));
            let d = a.max(b).max(c) - a.min(b).min(c);
            d.x * d.y + d.y * d.z + d.z * d.x
        };
        some.iter().map(half).sum()
    };
    (turn.is_finite() && size(turn) < 0.5 * size(DMat3::IDENTITY)).then_some(turn)
}

/// The axes of a symmetric matrix as columns (Jacobi's rotations, 1846).
fn principal_axes(matrix: DMat3) -> DMat3 {
    let (mut m, mut axes) = (matrix, DMat3::IDENTITY);
    for _ in 0..8 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let off = m.col(j)[i];
            if off == 0.0 {
                continue;
            }
            let angle = 0.5 * (2.0 * off).atan2(m.col(i)[i] - m.col(j)[j]);
            let (s, c) = angle.sin_cos();
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(i)[i] = c;
            turn.col_mut(i)[j] = s;
            turn.col_mut(j)[i] = -s;
            turn.col_mut(j)[j] = c;
            m = turn.transpose() * m * turn;
            axes *= turn;
        }
    }
    axes
}

//! Vertex normals: the sum of the triangles' area vectors, brought to unit length.
//!
//! Around a vertex with neighbours `d0, d1, ...` (relative to it) the sum is `d0 x d1 + d1 x d2 +
//! ...`. A cross product is `yzx(a * yzx(b) - yzx(a) * b)`, so one shuffle a neighbour and one at
//! the end suffice. The order of the sum is the ring's, which the topology fixes: the same bits
//! whoever computes it.

use glam::{Vec3, Vec4, Vec4Swizzles};

use super::page::{BLOCK, BREAK, Page, PageTopology, Ring};
use sculptd_geometry::simd::rings;
use sculptd_geometry::simd::rings::{LENGTHS, Rows};
use sculptd_geometry::simd::wide::Wide;

/// A vertex whose position changed.
pub(super) const MOVED: u8 = 1;
/// A vertex whose normal is another now.
pub(super) const TURNED: u8 = 2;
/// A vertex whose mask or colour changed.
pub(super) const PAINTED: u8 = 4;
/// A vertex that is in another face set now.
pub(super) const GROUPED: u8 = 16;
/// The page has other layers; of a page, never of a vertex.
pub(super) const LAYERED: u8 = 8;

/// The sum of area vectors about own vertex `v` of any ring but those in [`PageTopology::hexes`],
/// twice the area each.
#[inline(always)]
fn area_sum(t: &PageTopology, points: &[Vec4], v: usize) -> Vec4 {
    let ring = t.ring(v);
    let p = points[v];
    let mut sum = Vec4::ZERO;
    let [first, rest @ ..] = ring else { return sum };
    let first = points[*first as usize] - p;
    let first_turned = first.yzxw();
    let (mut last, mut last_turned) = (first, first_turned);
    if t.kinds[v] == Ring::ManyFans {
        for &k in rest {
            let d = points[(k & !BREAK) as usize] - p;
            let turned = d.yzxw();
            if k & BREAK == 0 {
                sum += last * turned - last_turned * d;
            }
            (last, last_turned) = (d, turned);
        }
    } else {
        for &k in rest {
            let d = points[k as usize] - p;
            let turned = d.yzxw();
            sum += last * turned - last_turned * d;
            (last, last_turned) = (d, turned);
        }
        if t.kinds[v] == Ring::Closed {
            sum += last * first_turned - last_turned * first;
        }
    }
    sum.yzxw()
}

/// The unit vector along a sum of area vectors; zero for a sum of nothing. The fourth lane is
/// nothing.
#[inline(always)]
fn unit(sum: Vec4) -> Vec4 {
    let length2 = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
    if LENGTHS.contains(&length2) { sum * (1.0 / length2.sqrt()) } else { unit_of_extremes(sum) }
}

/// As [`unit`], for sums whose squared length leaves the range of single precision.
#[cold]
fn unit_of_extremes(sum: Vec4) -> Vec4 {
    let n = sum.truncate();
    let largest = n.abs().max_element();
    if largest > 0.0 && largest.is_finite() {
        (n / largest).normalize_or_zero().extend(0.0)
    } else {
        Vec4::ZERO
    }
}

/// The unit normals of own vertices `first..first + out.len()`, at most [`BLOCK`] of them; zero
/// where all triangles are degenerate. The fourth lanes are nothing.
#[inline(always)]
fn of_block(t: &PageTopology, points: &[Vec4], first: usize, out: &mut [Vec4]) {
    let regular = t.hexes.len().saturating_sub(first).min(out.len());
    rings::sums(&t.hexes, points, first.min(t.hexes.len()), &mut out[..regular]);
    for (i, sum) in out.iter_mut().enumerate().skip(regular) {
        *sum = area_sum(t, points, first + i);
    }
    // Square roots and divisions of several overlap in wide instructions.
    let mut inverse = [0.0f32; BLOCK];
    for (inverse, sum) in inverse.iter_mut().zip(&*out) {
        *inverse = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
    }
    let odd = inverse[..out.len()].iter().fold(false, |odd, l| odd | !LENGTHS.contains(l));
    for inverse in &mut inverse {
        *inverse = 1.0 / inverse.sqrt();
    }
    for (sum, inverse) in out.iter_mut().zip(inverse) {
        *sum = if odd { unit(*sum) } else { *sum * inverse };
    }
}

/// The unit normal of own vertex `v`, zero where all its triangles are degenerate.
pub(super) fn of_vertex(t: &PageTopology, points: &[Vec4], v: usize) -> Vec3 {
    let mut one = [Vec4::ZERO];
    of_block(t, points, v, &mut one);
    one[0].truncate()
}

/// Computes every own normal of a page.
pub(super) fn all(page: &mut Page) {
    let Page { topology: t, points, normals, .. } = page;
    for first in (0..t.own).step_by(BLOCK) {
        let mut fresh = [Vec4::ZERO; BLOCK];
        let rows = &mut normals[first..t.own.min(first + BLOCK)];
        of_block(t, points, first, &mut fresh[..rows.len()]);
        for (row, n) in rows.iter_mut().zip(fresh) {
            *row = n.truncate().extend(row.w);
        }
    }
}

/// Updates the normals of a page whose vertices in the blocks `touched` moved: recomputes the
/// affected owned ones, and copies the others from `old`. Marks owned vertices whose normal changed
/// as [`TURNED`].
#[inline(always)]
pub(super) fn around_moved<W: Wide>(
    w: W,
    page: &mut Page,
    old: &[Vec4],
    marks: &mut [u8],
    touched: u32,
) {
    let Page { topology: t, points, normals, .. } = page;
    normals.resize(old.len(), Vec4::ZERO);
    let (own, halo) = normals.split_at_mut(t.own);
    let (old, old_halo) = old.split_at(t.own);
    halo.copy_from_slice(old_halo);
    let blocks = own
        .chunks_mut(BLOCK)
        .zip(old.chunks(BLOCK))
        .zip(marks.chunks_mut(BLOCK))
        .zip(&t.ring_blocks);
    for (b, (((rows, old), marks), &near)) in blocks.enumerate() {
        if near & touched == 0 {
            rows.copy_from_slice(old);
            continue;
        }
        let first = b * BLOCK;
        let done =
            w.ring_normals(&t.hexes, points, &mut Rows { first, old, rows, marks, mark: TURNED });
        if done == rows.len() {
            continue;
        }
        let (rows, old, marks) = (&mut rows[done..], &old[done..], &mut marks[done..]);
        let mut fresh = [Vec4::ZERO; BLOCK];
        of_block(t, points, first + done, &mut fresh[..rows.len()]);
        for (((row, old), mark), n) in rows.iter_mut().zip(old).zip(marks).zip(fresh) {
            let bits = |v: Vec4| v.to_array().map(f32::to_bits);
            let ([x, y, z, _], [ox, oy, oz, colour]) = (bits(n), bits(*old));
            *mark |= if (x ^ ox) | (y ^ oy) | (z ^ oz) != 0 { TURNED } else { 0 };
            *row = n.truncate().extend(f32::from_bits(colour));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Clay;
    use super::*;
    use sculptd_geometry::shapes;
    use sculptd_geometry::simd::wide::{WideWork, dispatch};

    struct Around<'a>(&'a mut Page, &'a [Vec4], &'a mut [u8], u32);

    impl WideWork for Around<'_> {
        type Output = ();
        #[inline(always)]
        fn run<W: Wide>(self, w: W) {
            around_moved(w, self.0, self.1, self.2, self.3);
        }
    }

    /// Moved vertices, some onto one another: tiny triangles and none.
    fn disturbed(page: &Page) -> Page {
        let mut page = page.copy();
        for v in 0..page.points.len() {
            let k = v as f32;
            let nudge = Vec4::new((k * 0.7).sin(), (k * 1.3).cos(), (k * 2.1).sin(), 0.0);
            page.points[v] += nudge * if v % 7 == 0 { 0.0 } else { 0.003 };
            if v % 11 < 6 && v > 200 {
                page.points[v] *= Vec4::new(1e-18, 1e-18, 1e-18, 1.0);
            }
        }
        page
    }

    #[test]
    fn wide_and_plain_normals_are_the_same_bits() {
        let clay = Clay::build(&shapes::sphere_of_about(10_000), &Default::default()).unwrap();
        for (touched, page) in [(u32::MAX, &clay.pages[3]), (0b1011, &clay.pages[5])] {
            let (mut wide, mut plain) = (disturbed(page), disturbed(page));
            let own = page.own();
            let (mut wide_marks, mut plain_marks) = (vec![0; own], vec![0; own]);
            dispatch(false, Around(&mut wide, &page.normals, &mut wide_marks, touched));
            dispatch(true, Around(&mut plain, &page.normals, &mut plain_marks, touched));
            let bits = |page: &Page| {
                page.normals.iter().map(|n| n.to_array().map(f32::to_bits)).collect::<Vec<_>>()
            };
            assert_eq!(bits(&wide), bits(&plain));
            assert_eq!(wide_marks, plain_marks);
            assert!(wide_marks.contains(&TURNED));
        }
    }
}

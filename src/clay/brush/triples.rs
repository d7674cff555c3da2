//! The coordinates of a block of vertices, one row for each coordinate: the layout that a loop over
//! vertices needs to run in wide instructions. A page stores a vertex as one row of four. Four rows
//! at a time are transposed to one row per coordinate, and back.

use glam::{Mat4, Vec3, Vec4};

use super::weights::BLOCK;

/// The x, the y and the z of a block of vertices, each in a row.
#[derive(Debug)]
#[repr(align(32))]
pub struct Triples([[f32; BLOCK]; 3]);

impl Triples {
    /// Outside of every footprint.
    pub(super) const NOWHERE: Triples = Triples([[f32::INFINITY; BLOCK]; 3]);
    /// Zeros.
    pub const ZERO: Triples = Triples([[0.0; BLOCK]; 3]);

    /// The first three lanes of each row, 64 at most; zeros beyond the last.
    #[inline(always)]
    pub fn of(rows: &[Vec4]) -> Triples {
        let mut out = Triples::ZERO;
        out.fill(rows, Vec3::ZERO);
        out
    }

    /// Takes the first three lanes of each row, 64 at most, measured from `origin`.
    #[inline(always)]
    pub fn fill(&mut self, rows: &[Vec4], origin: Vec3) {
        let [x, y, z] = &mut self.0;
        let from = [origin.x, origin.y, origin.z].map(Vec4::splat);
        let fours = x.chunks_exact_mut(4).zip(y.chunks_exact_mut(4)).zip(z.chunks_exact_mut(4));
        for (four, ((x, y), z)) in rows.chunks_exact(4).zip(fours) {
            let turned = turn(four);
            (turned.x_axis - from[0]).write_to_slice(x);
            (turned.y_axis - from[1]).write_to_slice(y);
            (turned.z_axis - from[2]).write_to_slice(z);
        }
        let whole = rows.len() / 4 * 4;
        for (i, row) in rows.iter().enumerate().skip(whole) {
            let v = row.truncate() - origin;
            (x[i], y[i], z[i]) = (v.x, v.y, v.z);
        }
    }

    /// A row of four for each vertex, the last lane zero.
    #[inline(always)]
    pub fn rows(&self) -> [Vec4; BLOCK] {
        let [x, y, z] = &self.0;
        let mut rows = [Vec4::ZERO; BLOCK];
        for (i, four) in rows.chunks_exact_mut(4).enumerate() {
            let at = 4 * i;
            let [x, y, z] = [x, y, z].map(|row| Vec4::from_slice(&row[at..at + 4]));
            let turned = Mat4::from_cols(x, y, z, Vec4::ZERO).transpose();
            (four[0], four[1]) = (turned.x_axis, turned.y_axis);
            (four[2], four[3]) = (turned.z_axis, turned.w_axis);
        }
        rows
    }

    /// The x, the y and the z, each in a row.
    #[inline(always)]
    pub fn coordinates(&self) -> [&[f32; BLOCK]; 3] {
        self.0.each_ref()
    }

    /// One of them.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3 {
        let [x, y, z] = &self.0;
        Vec3::new(x[i], y[i], z[i])
    }

    /// Sets one of them.
    #[inline(always)]
    pub fn set(&mut self, i: usize, v: Vec3) {
        (self.0[0][i], self.0[1][i], self.0[2][i]) = (v.x, v.y, v.z);
    }

    /// Calls `of` with each, for a row of what it answers.
    #[inline(always)]
    pub fn each(&self, of: impl Fn(Vec3) -> f32) -> [f32; BLOCK] {
        let mut out = [0.0; BLOCK];
        for (i, out) in out.iter_mut().enumerate() {
            *out = of(self.get(i));
        }
        out
    }
}

/// The fourth lane of each row, 64 at most; zeros beyond the last.
#[inline(always)]
pub(super) fn fourth_lanes(rows: &[Vec4]) -> [f32; BLOCK] {
    let mut out = [0.0; BLOCK];
    for (four, out) in rows.chunks_exact(4).zip(out.chunks_exact_mut(4)) {
        turn(four).w_axis.write_to_slice(out);
    }
    let whole = rows.len() / 4 * 4;
    for (row, out) in rows.iter().zip(&mut out).skip(whole) {
        *out = row.w;
    }
    out
}

/// Four rows of four, turned about.
#[inline(always)]
fn turn(four: &[Vec4]) -> Mat4 {
    Mat4::from_cols(four[0], four[1], four[2], four[3]).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_triples_and_come_back() {
        for count in [0, 1, 3, 4, 7, 63, BLOCK] {
            let rows: Vec<Vec4> =
                (0..count).map(|i| Vec4::new(i as f32, 0.1 * i as f32, -3.0, 0.5)).collect();
            let triples = Triples::of(&rows);
            let back = triples.rows();
            for (i, row) in back.iter().enumerate() {
                let known = rows.get(i).map_or(Vec4::ZERO, |row| row.with_w(0.0));
                assert_eq!(*row, known, "{i} of {count}");
                assert_eq!(triples.get(i), known.truncate());
            }
            let lanes = fourth_lanes(&rows);
            assert!(lanes.iter().enumerate().all(|(i, w)| *w == if i < count { 0.5 } else { 0.0 }));
        }
    }

    #[test]
    fn what_is_measured_from_an_origin_is_the_difference_to_the_bit() {
        let rows: Vec<Vec4> = (0..9).map(|i| Vec4::splat(1.0 / (i as f32 + 3.0))).collect();
        let origin = Vec3::new(0.1, 0.7, -1e-9);
        let mut triples = Triples::NOWHERE;
        triples.fill(&rows, origin);
        for (i, row) in rows.iter().enumerate() {
            assert_eq!(triples.get(i), row.truncate() - origin);
        }
        assert_eq!(triples.get(9), Vec3::INFINITY);
    }
}

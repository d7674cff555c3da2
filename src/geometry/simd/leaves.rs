//! The boxes of a tree's leaves, from the rows of their vertices.

use glam::{Mat4, Vec4};

/// The vertices of each leaf, each once. Every index is below the number of rows, which is checked
/// once, so the inner loop needs no bounds checks.
#[derive(Debug, Clone, Default)]
pub struct Leaves {
    /// Each leaf's vertices, padded to a multiple of four with the last one: a loop of two or three
    /// turns is predictable.
    corners: Vec<u16>,
    /// The end of each leaf's vertices.
    ends: Vec<u16>,
    rows: usize,
}

impl Leaves {
    /// None where there are more corners than 16 bits count.
    pub fn new(leaves: impl Iterator<Item = Vec<u16>>) -> Option<Self> {
        let (mut corners, mut ends) = (Vec::new(), Vec::new());
        for leaf in leaves {
            corners.extend_from_slice(&leaf);
            let last = leaf.last().copied();
            corners
                .extend(last.into_iter().cycle().take(leaf.len().next_multiple_of(4) - leaf.len()));
            ends.push(u16::try_from(corners.len()).ok()?);
        }
        let rows = corners.iter().max().map_or(0, |&most| most as usize + 1);
        Some(Leaves { corners, ends, rows })
    }

    /// Forgets all leaves and makes room for this many leaves and corners.
    pub fn reserve(&mut self, leaves: usize, corners: usize) {
        self.corners.clear();
        self.ends.clear();
        self.rows = 0;
        self.corners.reserve(corners);
        self.ends.reserve(leaves);
    }

    /// Refills with leaves of `each` triangles in a row. `seen` has an entry for each row, all
    /// `u16::MAX`; entries of visited vertices change. Returns false if there are more corners than
    /// 16 bits count.
    ///
    /// # Panics
    /// Panics if a corner has no entry in `seen`.
    #[must_use]
    pub fn refill(&mut self, triangles: &[[u16; 3]], each: usize, seen: &mut [u16]) -> bool {
        self.corners.clear();
        self.ends.clear();
        self.rows = 0;
        for (leaf, some) in triangles.chunks(each).enumerate() {
            let first = self.corners.len();
            for &v in some.iter().flatten() {
                let met = &mut seen[v as usize];
                if *met != leaf as u16 {
                    *met = leaf as u16;
                    self.corners.push(v);
                    self.rows = self.rows.max(v as usize + 1);
                }
            }
            let last = self.corners.last().copied().unwrap_or(0);
            let whole = first + (self.corners.len() - first).next_multiple_of(4);
            self.corners.resize(whole, last);
            let Ok(end) = u16::try_from(whole) else { return false };
            self.ends.push(end);
        }
        true
    }

    /// The number of leaves.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns true if there is no leaf.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The vertices of leaf `i`; the last may come again.
    pub fn corners(&self, i: usize) -> &[u16] {
        let from = if i == 0 { 0 } else { self.ends[i - 1] as usize };
        &self.corners[from..self.ends[i] as usize]
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> usize {
        (self.corners.len() + self.ends.len()) * 2
    }

    /// The boxes of leaves `8 * i..8 * i + 8`: lower sides, then upper ones, axis by axis. Those of
    /// leaves past the last are inverted and infinite.
    #[inline(always)]
    pub fn boxes(&self, i: usize, points: &[Vec4], planes: &mut [[f32; 8]; 6]) {
        assert!(self.rows <= points.len(), "leaves of another page");
        let (mut los, mut his) = ([Vec4::INFINITY; 8], [Vec4::NEG_INFINITY; 8]);
        let mut from = if i == 0 { 0 } else { self.ends[8 * i - 1] as usize };
        let last = self.ends.len().min(8 * i + 8);
        for ((lo, hi), &end) in los.iter_mut().zip(&mut his).zip(&self.ends[8 * i..last]) {
            let (mut least, mut most) = (*lo, *hi);
            for four in self.corners[from..end as usize].chunks_exact(4) {
                for &v in four {
                    // SAFETY: every corner is below `rows` (`Leaves::new`), and there are as many
                    // points.
                    let p = unsafe { *points.get_unchecked(v as usize) };
                    (least, most) = (least.min(p), most.max(p));
                }
            }
            from = end as usize;
            (*lo, *hi) = (least, most);
        }
        for (rows, first) in [(&los, 0), (&his, 3)] {
            for half in [0, 4] {
                let turned =
                    Mat4::from_cols(rows[half], rows[half + 1], rows[half + 2], rows[half + 3])
                        .transpose();
                for (axis, row) in
                    [turned.x_axis, turned.y_axis, turned.z_axis].into_iter().enumerate()
                {
                    planes[first + axis][half..half + 4].copy_from_slice(&row.to_array());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_hold_their_vertices_and_no_more() {
        let points: Vec<Vec4> = (0..40)
            .map(|i| Vec4::new((i * 7 % 40) as f32, -(i as f32), (i * i % 11) as f32, 9.0))
            .collect();
        let sets: Vec<Vec<u16>> =
            (0..11).map(|i| (i..i + 3 + i % 6).map(|v| v * 2).collect()).collect();
        let leaves = Leaves::new(sets.iter().cloned()).unwrap();
        for node in 0..2 {
            let mut planes = [[0.0; 8]; 6];
            leaves.boxes(node, &points, &mut planes);
            for lane in 0..8 {
                for axis in 0..3 {
                    let of = || {
                        sets.get(8 * node + lane)
                            .into_iter()
                            .flatten()
                            .map(|&v| points[v as usize][axis])
                    };
                    assert_eq!(planes[axis][lane], of().fold(f32::INFINITY, f32::min));
                    assert_eq!(planes[3 + axis][lane], of().fold(f32::NEG_INFINITY, f32::max));
                }
            }
        }
    }
}

//! Which triangles of two surfaces may intersect. Most of a surface is far from the other: a coarse
//! grid over the common box rejects it at a few operations a triangle, and only the rest gets a
//! tree.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::boolean::box_tree::{Span, SpanTree};
use crate::job::{Cancelled, Job};
use crate::tight_frame::tight_frame;

/// Cells a side: one row is one word.
const CELLS: usize = 128;
/// With fewer triangles the tree alone is as quick.
const FEW: usize = 2048;

/// Triangles over places of their own.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceView<'a> {
    /// Corners of each triangle, counter-clockwise.
    pub triangles: &'a [[u32; 3]],
    /// The positions of the corners.
    pub at: &'a [DVec3],
    /// Subtracted from each corner before it is looked up.
    pub base: u32,
}

impl SurfaceView<'_> {
    /// Returns the positions of the corners of a triangle.
    pub fn corners(&self, t: u32) -> [DVec3; 3] {
        self.triangles[t as usize].map(|v| self.at[(v - self.base) as usize])
    }

    /// A frame in which the boxes of some triangles are small, where there is a better one than the
    /// axes, and the largest error of a place in it.
    fn tight_frame(&self, some: &[u32]) -> Option<(DMat3, f64)> {
        if some.len() < FEW {
            return None;
        }
        let corners: Vec<DVec3> = some.iter().flat_map(|&t| self.corners(t)).collect();
        let triangles: Vec<[u32; 3]> =
            (0..some.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let turn = tight_frame(&corners, &triangles)?;
        let reach = corners.iter().fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
        Some((turn, reach * 1e-14))
    }

    /// The box around a triangle.
    pub fn span(&self, t: u32) -> Span {
        let [a, b, c] = self.corners(t);
        Span { lo: a.min(b).min(c), hi: a.max(b).max(c) }
    }
}

/// Pairs of one triangle of each whose boxes, grown by `slack`, meet: ascending. The boxes are
/// along the axes, or in a frame in which they are much smaller: triangles that are nearer to each
/// other than `slack` are among the pairs either way.
pub fn pairs(
    surfaces: [SurfaceView<'_>; 2],
    bounds: [Span; 2],
    slack: f64,
    job: &Job,
) -> Result<Vec<(u32, u32)>, Cancelled> {
    let both = Span { lo: bounds[0].lo.max(bounds[1].lo), hi: bounds[0].hi.min(bounds[1].hi) }
        .grown(slack);
    if !both.lo.cmple(both.hi).all() {
        return Ok(Vec::new());
    }
    let all = |s: usize| 0..surfaces[s].triangles.len() as u32;
    let few = surfaces.iter().map(|s| s.triangles.len()).sum::<usize>() < FEW;
    let [first, second] = if few {
        // The marks of the grid alone would take longer.
        let near = |s: usize| {
            let other = bounds[1 - s];
            let meets = |t: &u32| {
                let corners = surfaces[s].corners(*t);
                Span::of(corners).grown(slack).meets(&both) && reaches(corners, other, slack)
            };
            all(s).filter(meets).collect::<Vec<u32>>()
        };
        [near(0), near(1)]
    } else {
        let grid = CellGrid::over(both, slack);
        let (first, marked) = grid.sift(&surfaces[0], all(0).into_par_iter(), None, job);
        job.check()?;
        let (second, marked) = grid.sift(&surfaces[1], all(1).into_par_iter(), Some(&marked), job);
        job.check()?;
        let (first, _) = if first.len() > FEW {
            grid.sift(&surfaces[0], first.into_par_iter(), Some(&marked), job)
        } else {
            (first, Marked::default())
        };
        [first, second]
    };
    job.check()?;
    // Of the surface of which more is left.
    let most = usize::from(second.len() > first.len());
    let turned = surfaces[most].tight_frame(if most == 0 { &first } else { &second });
    let side = |s: usize, left: &[u32]| {
        let span = |&t: &u32| match turned {
            // Places in the other frame are off by rounding.
            Some((turn, room)) => Span::of(surfaces[s].corners(t).map(|p| turn * p)).grown(room),
            None => surfaces[s].span(t),
        };
        let spans: Vec<Span> = left.iter().map(span).collect();
        SpanTree::build(&spans, job).map(|tree| (spans, tree))
    };
    let (a, b) = if few {
        (side(0, &first), side(1, &second))
    } else {
        rayon::join(|| side(0, &first), || side(1, &second))
    };
    let ((own, tree), (others, other)) = (a?, b?);
    let mut out = Vec::new();
    tree.pairs(&own, &other, &others, slack, job, |i, j| {
        out.push((first[i as usize], second[j as usize]))
    })?;
    if few {
        out.sort_unstable();
    } else {
        out.par_sort_unstable();
    }
    Ok(out)
}

/// Returns false where a box is on one side of a triangle's plane, or beyond one of its edges, by
/// much more than `slack`. Long triangles have boxes that meet a small tool far beside them.
fn reaches([a, b, c]: [DVec3; 3], other: Span, slack: f64) -> bool {
    let n = (b - a).cross(c - a);
    let (middle, half) = ((other.lo + other.hi) * 0.5, (other.hi - other.lo) * 0.5);
    // The least and the largest distance along a direction, in its length.
    let along = |o: DVec3, d: DVec3| ((middle - o).dot(d), half.dot(d.abs()));
    let (height, room) = along(a, n);
    height.abs() <= room + 4.0 * slack * n.length()
        && [(a, b), (b, c), (c, a)].iter().all(|&(o, p)| {
            let out = (p - o).cross(n);
            let (far, room) = along(o, out);
            far <= room + 4.0 * slack * out.length()
        })
}

/// A grid over the box in which both surfaces are.
struct CellGrid {
    both: Span,
    slack: f64,
    scale: DVec3,
}

/// Cells in which a surface's boxes are; one bit a cell, a word a row. Empty: none was marked.
#[derive(Default)]
struct Marked(Vec<u128>);

impl Marked {
    fn join(mut self, other: Marked) -> Marked {
        if self.0.is_empty() {
            return other;
        }
        self.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a |= b);
        self
    }
}

impl CellGrid {
    fn over(both: Span, slack: f64) -> CellGrid {
        let size = both.hi - both.lo;
        let scale = size.to_array().map(|d| if d > 0.0 { CELLS as f64 / d } else { 0.0 });
        CellGrid { both, slack, scale: scale.into() }
    }

    /// First and last cell of a box on each axis; rounding is monotone, so boxes that meet have a
    /// cell in common.
    fn cells(&self, s: &Span) -> [(usize, usize); 3] {
        let cell = |x: f64, k: usize| {
            (((x - self.both.lo[k]) * self.scale[k]).max(0.0) as usize).min(CELLS - 1)
        };
        [0, 1, 2].map(|k| (cell(s.lo[k], k), cell(s.hi[k], k)))
    }

    /// The triangles of the list that reach the box and, where cells are given, a marked cell; and
    /// the cells they are in. A cancelled job leaves some out.
    fn sift(
        &self,
        surface: &SurfaceView<'_>,
        list: impl IndexedParallelIterator<Item = u32>,
        by: Option<&Marked>,
        job: &Job,
    ) -> (Vec<u32>, Marked) {
        // Few and large parts: each has separate marks.
        let least = (list.len() / (2 * rayon::current_num_threads())).max(1 << 13);
        let part = |mut to: (Vec<u32>, Marked), t: u32| {
            if t % 4096 == 0 && job.cancelled() {
                return to;
            }
            let s = surface.span(t).grown(self.slack);
            if !s.meets(&self.both) {
                return to;
            }
            let [x, y, z] = self.cells(&s);
            let row = (u128::MAX >> (CELLS - 1 - x.1)) & (u128::MAX << x.0);
            let rows = || (z.0..=z.1).flat_map(|k| (y.0..=y.1).map(move |j| k * CELLS + j));
            if by.is_some_and(|m| m.0.is_empty() || !rows().any(|r| m.0[r] & row != 0)) {
                return to;
            }
            if to.1.0.is_empty() {
                to.1.0.resize(CELLS * CELLS, 0);
            }
            rows().for_each(|r| to.1.0[r] |= row);
            to.0.push(t);
            to
        };
        list.with_min_len(least).fold(Default::default, part).reduce(
            Default::default,
            |mut a, b| {
                a.0.extend(b.0);
                (a.0, a.1.join(b.1))
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::icosphere;

    #[test]
    fn the_grid_loses_no_pair() {
        let job = Job::default();
        let (a, b) = (icosphere(1.0, 16).to_poly(), icosphere(0.8, 12).to_poly());
        for shift in
            [DVec3::ZERO, DVec3::new(0.7, 0.3, 0.2), DVec3::new(1.9, 0.0, 0.0), DVec3::splat(3.0)]
        {
            let moved: Vec<DVec3> = b.positions.iter().map(|p| *p + shift).collect();
            let (ta, tb) = (a.triangles().0, b.triangles().0);
            let surfaces = [
                SurfaceView { triangles: &ta, at: &a.positions, base: 0 },
                SurfaceView { triangles: &tb, at: &moved, base: 0 },
            ];
            let got = pairs(surfaces, surfaces.map(|s| Span::of(s.at.iter().copied())), 1e-6, &job)
                .expect("runs");
            let mut want = Vec::new();
            for i in 0..ta.len() as u32 {
                let s = surfaces[0].span(i).grown(1e-6);
                want.extend(
                    (0..tb.len() as u32).filter(|&j| s.meets(&surfaces[1].span(j))).map(|j| (i, j)),
                );
            }
            assert_eq!(got, want, "{shift}");
            assert_eq!(want.is_empty(), shift.x != 0.7);
        }
    }
}

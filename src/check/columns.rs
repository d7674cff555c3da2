//! Cells of faces, and what a ray from each of them meets: the columns of support under faces that
//! look down, and the parts of faces that a mould cannot release.
//!
//! A face is cut into equal cells no larger than a share of the part's plan, and each cell is
//! measured by one ray from its centre. A column between two flat faces is exact. The error comes
//! from cells that a step of what is below divides; the sum states one standard deviation of it, by
//! the differences of neighbouring cells (collapsed strata: Cochran, "Sampling Techniques", 1977,
//! section 5A.12), which overestimates it.

use glam::DVec3;
use rayon::prelude::*;
use sculptd_geometry::job::{Cancelled, Job};

use crate::part::{PreparedPart, Standing};

/// The number of cells that a face as large as the part's plan is cut into.
pub const CELLS: f64 = 65_536.0;
/// Most cells on one side of a face.
const MOST_ON_A_SIDE: f64 = 512.0;
/// Faces of one task.
const CHUNK: usize = 256;

/// A sum over cells.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CellSum {
    /// The sum of each cell's area times its value.
    pub total: f64,
    /// The variance of `total`.
    pub variance: f64,
}

impl CellSum {
    /// One standard deviation of the total.
    pub fn error(&self) -> f64 {
        self.variance.max(0.0).sqrt()
    }

    /// Adds another sum.
    pub fn add(&mut self, other: &CellSum) {
        self.total += other.total;
        self.variance += other.variance;
    }
}

/// The area of a cell: the part's surface in [`CELLS`] parts, by its box.
pub fn cell_area(part: &PreparedPart, cells: f64) -> f64 {
    let [x, y, z] = part.sizes.dimensions;
    (x * y + y * z + z * x) / 3.0 / cells
}

/// The centres of the cells of a triangle, and the number of them.
fn cells(corners: [DVec3; 3], area: f64, cell: f64) -> impl Iterator<Item = DVec3> {
    let k = if cell > 0.0 { (area / cell).sqrt().ceil().clamp(1.0, MOST_ON_A_SIDE) } else { 1.0 };
    let n = k as usize;
    let [a, b, c] = corners;
    let (u, v) = ((b - a) / k, (c - a) / k);
    (0..n).flat_map(move |i| {
        (0..n - i).flat_map(move |j| {
            let o = a + u * i as f64 + v * j as f64;
            let upper = (j + 1 < n - i).then(|| o + (u + v) * (2.0 / 3.0));
            std::iter::once(o + (u + v) / 3.0).chain(upper)
        })
    })
}

/// The sum of `value` over the cells of a triangle, each weighted by its area.
pub fn over_cells(
    corners: [DVec3; 3],
    area: f64,
    cell: f64,
    value: impl FnMut(DVec3) -> f64,
) -> CellSum {
    let (mut count, mut sum, mut squares, mut last) = (0usize, 0.0, 0.0, 0.0);
    for value in cells(corners, area, cell).map(value) {
        count += 1;
        sum += value;
        if count % 2 == 0 {
            squares += (last - value) * (last - value);
        }
        last = value;
    }
    let own = area / count as f64;
    CellSum { total: sum * own, variance: squares * own * own }
}

/// The volume of support under each of `faces` (triangles that look down): the column from each
/// cell to the first face below that looks up, or to the plate.
pub fn support_columns(
    part: &PreparedPart,
    stand: &Standing,
    faces: &[u32],
    cell: f64,
    job: &Job,
) -> Result<Vec<CellSum>, Cancelled> {
    let one = |&t: &u32| {
        let Some(corners) = part.corners(t) else { return CellSum::default() };
        let plan = part.areas[t as usize] * -part.normals[t as usize].dot(stand.up);
        over_cells(corners, plan.max(0.0), cell, |p| column(part, stand, p))
    };
    let chunks = faces.par_chunks(CHUNK).map(|chunk| {
        job.check()?;
        Ok(chunk.iter().map(one).collect::<Vec<_>>())
    });
    Ok(chunks.collect::<Result<Vec<_>, Cancelled>>()?.concat())
}

/// The height of the support under a point.
pub fn column(part: &PreparedPart, stand: &Standing, p: DVec3) -> f64 {
    let to_plate = (p.dot(stand.up) - stand.plate).max(0.0);
    match part.distance_along(p, -stand.up, 0.0) {
        Some((d, _)) if d < to_plate => d,
        _ => to_plate,
    }
}

/// `count` points spread over the surface by area, with their triangles.
pub fn surface_points(part: &PreparedPart, count: usize) -> Vec<(DVec3, u32)> {
    let all: f64 = part.areas.iter().sum();
    let step = all / count as f64;
    let (mut out, mut at, mut sum) = (Vec::with_capacity(count), step * 0.5, 0.0);
    for t in 0..part.triangles() as u32 {
        sum += part.areas[t as usize];
        let Some(corners) = part.corners(t) else { continue };
        while at < sum && out.len() < count {
            out.push((point_in(corners, out.len()), t));
            at += step;
        }
    }
    out
}

/// The `i`-th point of a sequence that fills a triangle evenly (Roberts, "The unreasonable
/// effectiveness of quasirandom sequences", 2018).
pub fn point_in([a, b, c]: [DVec3; 3], i: usize) -> DVec3 {
    let i = i as f64;
    let mut u = (0.5 + i * 0.754_877_666_246_692_7).fract();
    let mut v = (0.5 + i * 0.569_840_290_998_053_3).fract();
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    a + (b - a) * u + (c - a) * v
}

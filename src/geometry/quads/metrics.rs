//! How good a quad mesh is.

use crate::PolyMesh;
use crate::bvh::Bvh8;
use crate::deviation::deviation;
use crate::edges::EdgeTable;
use crate::job::{Cancelled, Job};
use crate::portable::PortableMath;
use crate::{CentredMesh, TriMesh};

/// Distances are exact to this share of the mesh's size, beside their two per cent.
const RESOLUTION: f64 = 1e-7;

/// The figures of a quad mesh, and of how far it is from the surface that it was made of.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct QuadMetrics {
    /// Faces of four corners.
    pub quads: usize,
    /// Faces of three corners.
    pub triangles: usize,
    /// Faces of five corners or more.
    pub other: usize,
    /// The least angle of a quad, in degrees; `None` without quads, as the two that follow.
    pub least_angle: Option<f64>,
    /// The greatest angle of a quad, in degrees.
    pub greatest_angle: Option<f64>,
    /// The mean deviation of the quads' angles from 90 degrees.
    pub mean_deviation: Option<f64>,
    /// The share of the vertices with four faces, or with two on a border, 0 to 1.
    pub regular: f64,
    /// Upper bounds of the distance from the new mesh to the old one, and from the old one to the
    /// new, in the mesh's unit: no place is farther, and some place is nearly as far (see
    /// [`deviation`]).
    pub hausdorff: [f64; 2],
}

/// The figures of `made`, which was made of `from`.
pub fn metrics(made: &PolyMesh, from: &PolyMesh, job: &Job) -> Result<QuadMetrics, Cancelled> {
    let mut out = QuadMetrics {
        quads: 0,
        triangles: 0,
        other: 0,
        least_angle: None,
        greatest_angle: None,
        mean_deviation: None,
        regular: 0.0,
        hausdorff: [0.0; 2],
    };
    let (mut least, mut greatest, mut off_square): (f64, f64, f64) = (180.0, 0.0, 0.0);
    for face in made.faces() {
        match face.len() {
            3 => out.triangles += 1,
            4 => out.quads += 1,
            _ => out.other += 1,
        }
        if face.len() != 4 {
            continue;
        }
        for k in 0..4 {
            let at = |i: usize| made.positions[face[(k + i) % 4] as usize];
            let (u, v) = (at(1) - at(0), at(3) - at(0));
            let angle = u.cross(v).length().portable_atan2(u.dot(v)).to_degrees();
            least = least.min(angle);
            greatest = greatest.max(angle);
            off_square += (angle - 90.0).abs();
        }
    }
    if out.quads > 0 {
        out.least_angle = Some(least);
        out.greatest_angle = Some(greatest);
        out.mean_deviation = Some(off_square / (out.quads * 4) as f64);
    }
    out.regular = regular(made);
    job.check()?;
    let old = CentredMesh::new(from, 1.0);
    let new = CentredMesh::about(made, old.centre, 1.0);
    let (lo, hi) = old.mesh.bounds();
    let resolution = f64::from(lo.distance(hi)) * RESOLUTION;
    let farthest = |from: &TriMesh, to: &TriMesh| {
        let found = deviation(from, to, &Bvh8::build(to, job)?, resolution, job)?;
        Ok(found.at_most)
    };
    out.hausdorff = [farthest(&new.mesh, &old.mesh)?, farthest(&old.mesh, &new.mesh)?];
    Ok(out)
}

fn regular(mesh: &PolyMesh) -> f64 {
    let n = mesh.positions.len();
    let (mut faces, mut border) = (vec![0u32; n], vec![false; n]);
    mesh.corners.iter().for_each(|&v| faces[v as usize] += 1);
    for halves in EdgeTable::of(mesh).each().filter(|h| h.len() == 1) {
        border[halves[0].ends.0 as usize] = true;
        border[halves[0].ends.1 as usize] = true;
    }
    let good = (0..n).filter(|&v| faces[v] == if border[v] { 2 } else { 4 }).count();
    good as f64 / n.max(1) as f64
}

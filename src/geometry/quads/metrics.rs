//! How good a quad mesh is.

use glam::DVec3;
use rayon::prelude::*;

use crate::PolyMesh;
use crate::bvh::Bvh8;
use crate::edges::EdgeTable;
use crate::job::{Cancelled, Job};
use crate::portable::PortableMath;
use crate::{CentredMesh, TriMesh};

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
    /// Greatest distance from the new mesh to the old one, and from the old one to the new, in the
    /// mesh's unit: over the vertices and nine more points of every triangle.
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
    let (mut least, mut greatest, mut deviation): (f64, f64, f64) = (180.0, 0.0, 0.0);
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
            deviation += (angle - 90.0).abs();
        }
    }
    if out.quads > 0 {
        out.least_angle = Some(least);
        out.greatest_angle = Some(greatest);
        out.mean_deviation = Some(deviation / (out.quads * 4) as f64);
    }
    out.regular = regular(made);
    job.check()?;
    let old = CentredMesh::new(from, 1.0);
    let new = CentredMesh::about(made, old.centre, 1.0);
    out.hausdorff = [farthest(&new.mesh, &old.mesh, job)?, farthest(&old.mesh, &new.mesh, job)?];
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

/// The greatest distance of a sample of `a` to `b`.
fn farthest(a: &TriMesh, b: &TriMesh, job: &Job) -> Result<f64, Cancelled> {
    const PARTS: usize = 3;
    let tree = Bvh8::build(b, job)?;
    let each = |t: usize| -> Result<f64, Cancelled> {
        if t % 256 == 0 {
            job.check()?;
        }
        let [p, q, r] = a.corners(t).map(|p| p.as_dvec3());
        let mut worst: f64 = 0.0;
        for i in 0..=PARTS {
            for j in 0..=PARTS - i {
                let (u, v) = (i as f64 / PARTS as f64, j as f64 / PARTS as f64);
                let at: DVec3 = p + (q - p) * u + (r - p) * v;
                if let Some(n) = tree.nearest(at, f64::INFINITY) {
                    worst = worst.max(n.distance());
                }
            }
        }
        Ok(worst)
    };
    let all: Vec<f64> =
        (0..a.triangles.len()).into_par_iter().map(each).collect::<Result<_, _>>()?;
    Ok(all.into_iter().fold(0.0, f64::max))
}

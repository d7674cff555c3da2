//! Points of the input that the quads do not reach: tips and thin ends, which smoothing draws in.
//! The nearest vertex is pulled out to the farthest of them.

use glam::DVec3;
use rayon::prelude::*;

use super::pairing::squareness;
use super::quad_surface::{QuadSurface, corners};
use super::surface::GONE;
use crate::TriMesh;
use crate::bvh::Bvh8;
use crate::job::{Cancelled, Job};

/// A point is not reached from this distance on, in sides of a quad.
const MISSED: f64 = 0.35;
const ROUNDS: usize = 4;

/// Pulls free vertices to the points of `input` that are farthest from the quads; which it pulled.
pub(super) fn reach_out(
    s: &mut QuadSurface,
    input: &TriMesh,
    step: f64,
    job: &Job,
) -> Result<Vec<u32>, Cancelled> {
    let mut pulled = Vec::new();
    for _ in 0..ROUNDS {
        job.check()?;
        let (mesh, of) = triangles(s);
        let tree = Bvh8::build(&mesh, job)?;
        // The nearest vertex of a point that is missed, and the distance.
        let each = |p: &glam::Vec3| -> Option<(f64, u32, DVec3)> {
            let p = p.as_dvec3();
            let n = tree.nearest(p, f64::INFINITY)?;
            if n.distance() < MISSED * step {
                return None;
            }
            let face = &s.faces[of[n.triangle as usize] as usize];
            let far = |v: u32| s.positions[v as usize].distance_squared(p);
            let v = corners(face).iter().copied().min_by(|&a, &b| far(a).total_cmp(&far(b)))?;
            Some((n.distance(), v, p))
        };
        let mut missed: Vec<_> = input.positions.par_iter().filter_map(each).collect();
        missed.sort_by(|x, y| x.1.cmp(&y.1).then(y.0.total_cmp(&x.0)));
        let mut moved = 0;
        for of_vertex in missed.chunk_by(|x, y| x.1 == y.1) {
            let (_, v, to) = of_vertex[0];
            if pull(s, v, to) {
                moved += 1;
                pulled.push(v);
            }
        }
        if moved == 0 {
            break;
        }
    }
    Ok(pulled)
}

/// Moves `v` to `p`, or part of the way, as far as the faces around stay upright.
fn pull(s: &mut QuadSurface, v: u32, p: DVec3) -> bool {
    if !s.lines[v as usize].is_empty() || s.around[v as usize].is_empty() {
        return false;
    }
    let from = s.positions[v as usize];
    for share in [1.0, 0.5] {
        s.positions[v as usize] = from.lerp(p, share);
        let upright = s.around[v as usize].iter().all(|&f| {
            let face = s.faces[f as usize];
            face[3] == GONE
                || squareness(
                    face.map(|w| s.positions[w as usize]),
                    s.normal(f).normalize_or_zero(),
                ) > 0.03
        });
        if upright {
            return true;
        }
    }
    s.positions[v as usize] = from;
    false
}

/// The faces as triangles, and the face of each.
fn triangles(s: &QuadSurface) -> (TriMesh, Vec<u32>) {
    let mut mesh = TriMesh {
        positions: s.positions.iter().map(|p| p.as_vec3()).collect(),
        ..TriMesh::default()
    };
    let mut of = Vec::new();
    for (f, &[a, b, c, d]) in s.faces.iter().enumerate().filter(|(_, face)| face[0] != GONE) {
        mesh.triangles.push([a, b, c]);
        of.push(f as u32);
        if d != GONE {
            mesh.triangles.push([a, c, d]);
            of.push(f as u32);
        }
    }
    (mesh, of)
}

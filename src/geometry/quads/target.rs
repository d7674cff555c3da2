//! Where vertices are put: the nearest point of the input surface, or of its lines.

use glam::DVec3;

use super::input::QuadInput;
use crate::TriMesh;
use crate::bvh::Bvh8;
use crate::job::{Cancelled, Job};

/// The input surface and its lines, ready for projection.
pub(super) struct ProjectionTarget {
    tree: Bvh8,
    normals: Vec<DVec3>,
    chains: Vec<Bvh8>,
}

impl ProjectionTarget {
    pub fn of(input: &QuadInput, job: &Job) -> Result<ProjectionTarget, Cancelled> {
        let tree = Bvh8::build(&input.mesh, job)?;
        let chains = input.chains.iter().map(|c| Bvh8::build(c, job)).collect::<Result<_, _>>()?;
        Ok(ProjectionTarget { tree, normals: face_normals(&input.mesh), chains })
    }

    /// The nearest point of the surface if the surface there faces the way of `normal`, which need
    /// not be of unit length (zero: any way); else `p` itself.
    pub fn surface(&self, p: DVec3, normal: DVec3) -> DVec3 {
        match self.tree.nearest(p, f64::INFINITY) {
            Some(n) if self.normals[n.triangle as usize].dot(normal) >= 0.0 => n.point,
            _ => p,
        }
    }

    /// The nearest point of the surface whichever way it faces, and the normal there.
    pub fn nearest(&self, p: DVec3) -> Option<(DVec3, DVec3)> {
        let n = self.tree.nearest(p, f64::INFINITY)?;
        Some((n.point, self.normals[n.triangle as usize]))
    }

    /// The nearest point of a chain of lines; `p` where there is no such chain.
    pub fn line(&self, p: DVec3, chain: u32) -> DVec3 {
        let near = self.chains.get(chain as usize).and_then(|c| c.nearest(p, f64::INFINITY));
        near.map_or(p, |n| n.point)
    }
}

/// Unit normals; zero for triangles without area.
fn face_normals(mesh: &TriMesh) -> Vec<DVec3> {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
            (b - a).cross(c - a).normalize_or_zero()
        })
        .collect()
}

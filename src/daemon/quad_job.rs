//! Quads that follow the shape of the object, on the thread of whoever asks: one step of undo.
//!
//! Clay is made of triangles, so each quad is cut in two; an export writes the quads as long as
//! nothing changes the triangles. With levels the quads are the lowest level of a multiresolution
//! object, and each finer level is laid onto the old surface: its detail comes back.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::carry_over::OldPlace;
use crate::operations::basis::{Basis, Placing};
use crate::operations::{Computed, OperationError, in_place};
use crate::{Published, carry_over, polygons};
use sculptd_clay::{Level, Levels};
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::quads::{QuadSettings, quad_remesh};
use sculptd_geometry::{TriMesh, self_intersection};

/// Finer levels at most.
pub const MOST_LEVELS: u32 = 6;

/// Parameters of a quad remesh.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadsWanted {
    /// Approximate number of quads.
    pub quads: usize,
    /// Edges whose faces meet at more than this angle, in degrees, are kept; `None`: none.
    pub creases: Option<f64>,
    /// Polylines on the surface, in the mesh's unit, that the quads follow.
    pub guides: Vec<Vec<DVec3>>,
    /// So many finer levels on top, with the detail of the old surface; at most [`MOST_LEVELS`].
    pub levels: u32,
}

impl Default for QuadsWanted {
    fn default() -> Self {
        QuadsWanted { quads: 5000, creases: None, guides: Vec::new(), levels: 0 }
    }
}

/// Result of a quad remesh. Volumes are in the mesh's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadsMade {
    /// Faces of four corners and of three, on the lowest level.
    pub quads: usize,
    pub other_faces: usize,
    /// Of the level that is shown.
    pub vertices: usize,
    pub triangles: usize,
    /// Before and after.
    pub volume: [f64; 2],
    /// Pairs of triangles of the level that is shown that cross each other.
    pub self_intersections: usize,
    /// Vertices of finer levels that have no place on the old surface with its side facing the same
    /// way: they are as smooth as the level below leaves them.
    pub without_detail: usize,
    /// Changes made before remeshing.
    pub warnings: Vec<String>,
}

/// Returns the command that installs the quads as one step of undo, and their figures.
///
/// # Errors
/// Returns an error for numbers out of range, a surface that [`quad_remesh`] refuses, a cancelled
/// job, or an object that keeps changing.
pub fn quads(
    now: &Published,
    wanted: &QuadsWanted,
    job: &Job,
) -> Result<Computed<QuadsMade>, OperationError> {
    if wanted.levels > MOST_LEVELS {
        return Err(OperationError::QuadLevels(wanted.levels));
    }
    let old = now.mesh.to_tri();
    let settings = QuadSettings {
        quads: wanted.quads,
        creases: wanted.creases,
        guides: wanted.guides.clone(),
    };
    let done = quad_remesh(&old.to_poly(), &settings, job)?;
    let quads = done.mesh.faces().filter(|f| f.len() == 4).count();
    let other_faces = done.mesh.face_count() - quads;
    let mut plain = done.mesh.triangulate().0;
    let solid = DistanceSolid::build(&old, job)?;
    let old_masks = now.mesh.masks();
    // Masks and colours of the old surface, for a level.
    let dressed = |mut mesh: TriMesh, places: &[Option<OldPlace>]| {
        mesh.colours = carry_over::colours(&old, places);
        let masks = old_masks.as_ref().map(|m| carry_over::values(&old, m, places));
        Level { mesh, masks }
    };
    let places = carry_over::places(&old, &solid, &plain.positions, job)?;
    plain.colours = carry_over::colours(&old, &places);
    polygons::remember(done.mesh, &plain);
    let mut level = dressed(plain, &places);
    let mut levels: Option<Levels> = None;
    let mut without_detail = 0;
    for _ in 0..wanted.levels {
        let (mut finer, all) = Levels::up(levels.as_ref(), &level, job)?;
        let places = carry_over::places(&old, &solid, &finer.mesh.positions, job)?;
        let normals = normals(&finer.mesh);
        without_detail = 0;
        for ((p, n), place) in finer.mesh.positions.iter_mut().zip(&normals).zip(&places) {
            match place.filter(|place| place.normal(&old).dot(*n) > 0.0) {
                Some(place) => *p = place.point.as_vec3(),
                None => without_detail += 1,
            }
        }
        level = dressed(finer.mesh, &places);
        levels = Some(all);
    }
    let new = level.mesh;
    let positions: Vec<DVec3> = new.positions.iter().map(|p| p.as_dvec3()).collect();
    let crossings = self_intersection::count(&positions, &new.triangles, job)?;
    let made = QuadsMade {
        quads,
        other_faces,
        vertices: new.positions.len(),
        triangles: new.triangles.len(),
        volume: [measures(&old).volume, measures(&new).volume],
        self_intersections: crossings.pairs,
        without_detail,
        warnings: done.warnings,
    };
    let queued = in_place(Arc::new(new), level.masks, levels.map(Arc::new), job)?;
    let basis = Basis::of_active(now, Placing::Nearest);
    Ok(Computed::of_clay(now, queued, made).following(basis))
}

/// The normal of each vertex, weighted by area; not of length 1.
fn normals(mesh: &TriMesh) -> Vec<DVec3> {
    let mut out = vec![DVec3::ZERO; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(t).map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        corners.iter().for_each(|&v| out[v as usize] += normal);
    }
    out
}

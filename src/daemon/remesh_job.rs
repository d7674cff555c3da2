//! Voxel remeshing of the object in the caller's thread: one closed surface of even triangles. It
//! follows strokes made meanwhile, so that none is lost.

use std::sync::Arc;

use glam::Vec3;

use crate::operations::basis::{Basis, Placing};
use crate::operations::{Computed, OperationError, in_place};
use crate::{Published, carry_over};
use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::remesh::{LostParts, Remade, RemeshSettings, remesh};

/// Voxels along the longest side of the object, least and greatest.
pub const SIDE: (usize, usize) = (8, 1024);

/// Parameters of a voxel remesh.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wanted {
    /// Edge of a voxel in the mesh's unit; `None`: the mean edge of the current triangles.
    pub voxel: Option<f32>,
    /// True to keep edges sharp.
    pub sharp: bool,
}

/// Result of a voxel remesh. Lengths and volumes are in the mesh's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remeshed {
    /// Edge of a voxel: the one wanted, but for what makes the longest side a whole number of them.
    pub voxel: f32,
    pub vertices: usize,
    pub triangles: usize,
    /// Volume before and after: parts thinner than a voxel or two are lost or grow together.
    pub volume: [f64; 2],
    /// Pairs of triangles that cross each other.
    pub crossings: usize,
    /// Parts of the old surface further than a voxel from the new one.
    pub lost: Option<LostParts>,
}

/// The mean edge of the triangles; 0 without any.
pub fn mean_edge(mesh: &TriMesh) -> f32 {
    let each = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(Vec3::as_dvec3);
        a.distance(b) + b.distance(c) + c.distance(a)
    };
    let n = mesh.triangles.len();
    let sum: f64 = (0..n).map(each).sum();
    (sum / (3 * n.max(1)) as f64) as f32
}

/// Computes the remeshed object: one step of undo.
///
/// # Errors
/// A voxel that gives fewer or more than [`SIDE`] along the longest side, an object that encloses
/// nothing, a cancelled job, and an object that is changed again and again.
pub fn remeshed(
    now: &Published,
    wanted: &Wanted,
    job: &Job,
) -> Result<Computed<Remeshed>, OperationError> {
    let old = now.mesh.to_tri();
    let (lo, hi) = old.bounds();
    let longest = (hi - lo).max_element();
    let voxel = wanted.voxel.unwrap_or_else(|| mean_edge(&old)).max(f32::MIN_POSITIVE);
    let side = (longest / voxel).round();
    if !(side >= SIDE.0 as f32 && side <= SIDE.1 as f32) {
        let (least, most) = (longest / SIDE.1 as f32, longest / SIDE.0 as f32);
        return Err(OperationError::Voxel { voxel, least, most });
    }
    let solid = DistanceSolid::build(&old, job)?;
    let settings = RemeshSettings { side: side as usize, sharp: wanted.sharp };
    let Remade { mesh: new, crossings, lost } = remesh(&old, &solid, settings, job)?;
    let masks = now.mesh.masks();
    let places = |_: &Vec<f32>| carry_over::places(&old, &solid, &new.positions, job);
    let at = masks.as_ref().map(places).transpose()?;
    let masks = masks.zip(at).map(|(m, at)| carry_over::values(&old, &m, &at));
    let found = Remeshed {
        voxel: longest / side,
        vertices: new.positions.len(),
        triangles: new.triangles.len(),
        volume: [measures(&old).volume, measures(&new).volume],
        crossings,
        lost,
    };
    let queued = in_place(Arc::new(new), masks, None, job)?;
    let basis = Basis::of_active(now, Placing::Nearest);
    Ok(Computed::of_clay(now, queued, found).following(basis))
}

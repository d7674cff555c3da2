//! Decimation of the object for printing and the web, on the thread of whoever asks: fewer
//! triangles, with the border of the mask kept and without new self-intersections. One step of
//! undo.

use std::sync::Arc;

use crate::operations::basis::{Basis, Placing};
use crate::operations::{Computed, OperationError, in_place};
use crate::{Published, carry_over};
use sculptd_geometry::decimate::{DecimationTarget, decimate};
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;

/// The fewest triangles that can be asked for: a tetrahedron.
pub const LEAST: usize = 4;
/// From here on a vertex is masked, for the border of the mask.
const MASKED: f32 = 0.5;

/// Target of a decimation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecimateWanted {
    /// Stop at this many triangles.
    pub triangles: usize,
    /// Stop before the surface moves by more than about this, in the mesh's unit; `None`: no bound.
    pub max_error: Option<f32>,
}

/// Result of a decimation. Volumes are in the mesh's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecimateMade {
    pub vertices: usize,
    /// More than requested if the error bound or the shape allows no fewer.
    pub triangles: usize,
    pub triangles_before: usize,
    /// Before and after.
    pub volume: [f64; 2],
    /// Pairs of triangles that cross where none did before.
    pub new_crossings: usize,
    /// Number of repeated, more careful computations because of crossings.
    pub repeated: usize,
}

/// Computes the decimated object as one step of undo.
///
/// # Errors
/// Returns an error for a target out of range, a cancelled job, or an object that keeps changing.
pub fn decimated(
    now: &Published,
    wanted: &DecimateWanted,
    job: &Job,
) -> Result<Computed<DecimateMade>, OperationError> {
    if wanted.triangles < LEAST && wanted.max_error.is_none() {
        return Err(OperationError::Triangles(wanted.triangles));
    }
    let old = now.mesh.to_tri();
    let masks = now.mesh.masks();
    let marked: Option<Vec<bool>> =
        masks.as_ref().map(|m| m.iter().map(|&x| x >= MASKED).collect());
    let target = DecimationTarget {
        triangles: wanted.triangles,
        error: wanted.max_error.map_or(f64::INFINITY, f64::from),
        single: true,
    };
    let done = decimate(&old.to_poly(), marked.as_deref(), target, job)?;
    let mut new = done.mesh.triangulate().0;
    if new.triangles.is_empty() {
        return Err(OperationError::Nothing);
    }
    let mut carried = None;
    if masks.is_some() || old.colours.is_some() {
        let solid = DistanceSolid::build(&old, job)?;
        let places = carry_over::places(&old, &solid, &new.positions, job)?;
        new.colours = carry_over::colours(&old, &places);
        carried = masks.map(|m| carry_over::values(&old, &m, &places));
    }
    let made = DecimateMade {
        vertices: new.positions.len(),
        triangles: new.triangles.len(),
        triangles_before: old.triangles.len(),
        volume: [measures(&old).volume, measures(&new).volume],
        new_crossings: done.new_crossings,
        repeated: done.repeated,
    };
    let queued = in_place(Arc::new(new), carried, None, job)?;
    let basis = Basis::of_active(now, Placing::Nearest);
    Ok(Computed::of_clay(now, queued, made).following(basis))
}

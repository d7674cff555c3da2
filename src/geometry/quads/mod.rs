//! Field-aligned quad remeshing: a mesh of quads of even size that follow the shape, its creases
//! and borders, and strokes drawn as guides.
//!
//! The stages, one module each:
//!
//! 1. `input`: triangles, welded and manifold, in a frame whose unit is the side of a quad.
//! 2. `even`: even triangles of two fifths of that side.
//! 3. `orientation`, `position`: the fields of Jakob et al., "Instant Field-Aligned Meshes"
//!    (2015), on the levels of `hierarchy`.
//! 4. `lattice`: the triangles of one lattice point are merged by edge collapses. Unlike the greedy
//!    extraction of the paper this keeps a closed manifold closed and manifold, with the same
//!    genus, whatever the fields are.
//! 5. `pairing`: triangles are joined to quads by a maximum matching.
//! 6. `cleanup`, `smooth`, `reach`: irregular vertices are removed, quads are made square, and
//!    vertices are projected onto the input surface and its tips.
//!
//! Guaranteed: closed input gives a closed manifold of the same genus; creases and borders are
//! chains of edges of the result and their corners stay; the same bits with any number of threads.
//! Not guaranteed: all quads (faces between creases leave a triangle where their sides do not fit
//! each other, and a quad that stays reflex is cut), as few irregular vertices as an integer-
//! constrained parameterisation has (QuadriFlow, Huang et al. 2018), and freedom from self-
//! intersections where the surface is thinner than a quad.

mod cleanup;
mod creases;
mod even;
mod guides;
mod hierarchy;
mod input;
mod lattice;
mod metrics;
mod orientation;
mod pairing;
mod position;
mod quad_surface;
mod reach;
mod smooth;
mod surface;
mod target;
#[cfg(test)]
mod tests;

use glam::DVec3;

pub use metrics::{QuadMetrics, metrics};

use crate::job::{Cancelled, Job};
use crate::{PolyMesh, TriMesh};
use hierarchy::FieldLevel;
use input::QuadInput;
use quad_surface::{QuadSurface, corners};
use surface::EditSurface;
use target::ProjectionTarget;

/// The fewest quads that can be asked for.
pub const LEAST_QUADS: usize = 6;
/// The most quads that can be asked for.
pub const MOST_QUADS: usize = 1_000_000;

/// The settings of the new mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct QuadSettings {
    /// The approximate number of quads, [`LEAST_QUADS`] to [`MOST_QUADS`].
    pub quads: usize,
    /// Edges whose faces turn by more than this angle, in degrees, 0 to 180, are kept; `None`:
    /// none.
    pub creases: Option<f64>,
    /// Polylines on the surface, in the mesh's unit, that the edges of the quads follow.
    pub guides: Vec<Vec<DVec3>>,
}

/// A quad mesh and what was changed to make it.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadMesh {
    /// Quads, and triangles where there had to be some.
    pub mesh: PolyMesh,
    /// The changes made to the input first.
    pub warnings: Vec<String>,
}

/// The reason why there is no quad mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum QuadError {
    /// The job was cancelled.
    #[error("{0}")]
    Cancelled(#[from] Cancelled),
    /// A coordinate is not a number.
    #[error("expected finite coordinates, found others")]
    NotFinite,
    /// The mesh has no area.
    #[error("expected a surface with an area, found none")]
    Empty,
    /// Edges of more than two faces.
    #[error(
        "expected a manifold surface, found {0} edges with more than two faces; \
         remesh with voxels first"
    )]
    NonManifold(usize),
    /// The faces cannot be made to agree on a side.
    #[error("expected a surface of two sides, found {0} edges whose faces cannot agree")]
    OneSided(usize),
    /// The number of quads is out of range.
    #[error("expected {LEAST_QUADS} to {MOST_QUADS} quads, found {0}")]
    Count(usize),
}

/// The length of the even triangles' edges, in sides of a quad.
const FINE: f64 = 0.4;
/// The number of size corrections that approach the number of quads.
const SIZES: usize = 3;
/// The accepted relative error of the number of quads.
const NEAR_ENOUGH: f64 = 0.05;

/// A quad mesh of the surface `mesh`, which may be open and of several parts.
pub fn quad_remesh(
    mesh: &PolyMesh,
    settings: &QuadSettings,
    job: &Job,
) -> Result<QuadMesh, QuadError> {
    if !(LEAST_QUADS..=MOST_QUADS).contains(&settings.quads) {
        return Err(QuadError::Count(settings.quads));
    }
    let mut input = input::prepare(mesh, settings, job)?;
    let target = ProjectionTarget::of(&input, job)?;
    job.progress(0.1);
    let mut fine = std::mem::take(&mut input.surface);
    even::even_out(&mut fine, &target, FINE, job)?;
    job.progress(0.3);
    let mut finest = FieldLevel::of(&fine);
    guides::apply(&mut finest, &settings.guides, &input, &target);
    let levels = hierarchy::levels(finest);
    let field = orientation::orientations(&levels, job)?;
    job.progress(0.4);
    let mut step = 1.0;
    let mut best: Option<(f64, QuadSurface)> = None;
    for round in 0..SIZES {
        let made = at_step(&fine, &levels, &field, &target, &input.mesh, step, job)?;
        let found = made.faces.iter().filter(|f| f[0] != surface::GONE).count();
        let ratio = found as f64 / settings.quads as f64;
        let off = (ratio - 1.0).abs();
        if best.as_ref().is_none_or(|b| off < b.0) {
            best = Some((off, made));
        }
        job.progress(0.4 + 0.5 * (round + 1) as f32 / SIZES as f32);
        if off <= NEAR_ENOUGH {
            break;
        }
        step *= ratio.sqrt().clamp(0.5, 2.0);
    }
    let Some((_, surface)) = best else { return Err(QuadError::Empty) };
    job.progress(1.0);
    Ok(QuadMesh { mesh: to_file(&surface, &input), warnings: input.warnings })
}

/// The quads of side `step`, in the frame.
fn at_step(
    fine: &EditSurface,
    levels: &[FieldLevel],
    field: &[DVec3],
    target: &ProjectionTarget,
    input: &TriMesh,
    step: f64,
    job: &Job,
) -> Result<QuadSurface, Cancelled> {
    let frames = position::positions(levels, field, step, job)?;
    let mut coarse = fine.clone();
    lattice::collapse_to_lattice(&mut coarse, &frames, step, job)?;
    lattice::settle(&mut coarse, target, step, job)?;
    let partner = pairing::pair(&coarse, job)?;
    let mut quads = QuadSurface::new(&coarse, pairing::faces(&coarse, &partner));
    for _ in 0..4 {
        cleanup::run_pass(&mut quads, job)?;
        smooth::smooth(&mut quads, target, step, 6, job)?;
    }
    for _ in 0..12 {
        smooth::smooth(&mut quads, target, step, 3, job)?;
        if cleanup::mend_folded(&mut quads) == 0 {
            break;
        }
    }
    if cleanup::cut_folded(&mut quads) > 0 {
        smooth::smooth(&mut quads, target, step, 4, job)?;
    }
    // Vertices moved to the tips stay while the others follow.
    let pulled = reach::reach_out(&mut quads, input, step, job)?;
    pulled.iter().for_each(|&v| quads.pinned[v as usize] = true);
    smooth::smooth(&mut quads, target, step, 3, job)?;
    Ok(quads)
}

/// The mesh in the unit of the file, without what is gone.
fn to_file(s: &QuadSurface, input: &QuadInput) -> PolyMesh {
    let mut out = PolyMesh::new();
    let mut new = vec![surface::GONE; s.positions.len()];
    for face in s.faces.iter().filter(|f| f[0] != surface::GONE) {
        let own: Vec<u32> = corners(face)
            .iter()
            .map(|&v| {
                let slot = &mut new[v as usize];
                if *slot == surface::GONE {
                    *slot = out.positions.len() as u32;
                    out.positions.push(s.positions[v as usize] * input.unit + input.centre);
                }
                *slot
            })
            .collect();
        out.push_face(&own);
    }
    out
}

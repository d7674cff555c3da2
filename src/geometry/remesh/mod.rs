//! Voxel remeshing: a new mesh from the sampled distance to an old one, even triangles, one closed
//! surface, whatever the old one was. The surface is extracted by dual marching cubes (Nielson
//! 2004, see [`dual`]) and projected onto the old one; with sharp edges its vertices are placed as
//! dual contouring does (Ju et al. 2002). Where it would cross itself, vertices go back into their
//! cells.

pub mod dual;
mod lost;
mod sharp;
mod untangle;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::distance::DistanceSolid;
use super::grid::{DistanceGrid, MAX_SAMPLES};
use crate::TriMesh;
use crate::bvh::REACH;
use crate::job::{Cancelled, Job};
pub use lost::LostParts;
pub(crate) use lost::lost_parts;
use sharp::{Middles, SharpSurface};
use untangle::{CalmPlaces, untangle};

/// The resolution of the new mesh, and the treatment of sharp edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RemeshSettings {
    /// Samples along the longest side of the box, 8 to 1024.
    pub side: usize,
    /// True to place vertices at the meeting point of the faces around (Ju et al., "Dual contouring
    /// of Hermite data", 2002) instead of in their middle.
    pub sharp: bool,
}

impl Default for RemeshSettings {
    fn default() -> Self {
        RemeshSettings { side: 256, sharp: false }
    }
}

/// The reason why there is no new mesh.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RemeshError {
    /// The job was cancelled.
    #[error("{0}")]
    Cancelled(#[from] Cancelled),
    /// The mesh encloses nothing that the samples can see.
    #[error(
        "the mesh encloses no volume that the samples see: it is thinner than they are apart, or \
         open. Use more samples a side"
    )]
    Empty,
    /// Nothing of the part is so far inside.
    #[error(
        "nothing is left: {asked} is larger than half of the part's greatest thickness, which is \
         about {:.3}. Use less than {deepest:.3}, or a larger --side if {asked} is only just below \
         that",
        deepest * 2.0
    )]
    TooDeep {
        /// The wall or the offset, in the mesh's unit.
        asked: f64,
        /// The distance of the deepest place from the surface, to about a sample's spacing.
        deepest: f64,
    },
    /// The resolution is out of range, or the grid would have more than [`MAX_SAMPLES`] samples.
    #[error("expected 8 to 1024 samples a side, found {0}")]
    Side(usize),
}

/// Samples outside the mesh on each side.
pub(super) const MARGIN: usize = 3;

/// The box of the solid, larger by `more` on each side, as a grid's layout.
pub(super) fn layout(
    solid: &DistanceSolid,
    more: f64,
    side: usize,
) -> Result<DistanceGrid, RemeshError> {
    if !(8..=1024).contains(&side) {
        return Err(RemeshError::Side(side));
    }
    if solid.tree.is_empty() {
        return Err(RemeshError::Empty);
    }
    let (lo, hi) = solid.tree.bounds();
    if !(lo.abs().max(hi.abs()).max_element() as f64 + more < REACH) {
        return Err(RemeshError::Empty);
    }
    let (lo, hi) = (lo.as_dvec3() - more, hi.as_dvec3() + more);
    let mut grid = DistanceGrid::layout((lo, hi), side - 1, MARGIN);
    // The box's sides run half way between samples, or as near to it as one sample more makes them:
    // a sample on a face has no sign, and its cell would come out empty.
    for axis in 0..3 {
        let beyond = (lo[axis] - grid.origin[axis]) / grid.spacing;
        if (beyond.fract() - 0.5).abs() > 0.25 {
            grid.size[axis] += 1;
            grid.origin[axis] -= 0.5 * grid.spacing;
        }
    }
    let [x, y, z] = grid.size;
    if x * y * z > MAX_SAMPLES { Err(RemeshError::Side(side)) } else { Ok(grid) }
}

/// The result of a remeshing.
#[derive(Debug, Clone, PartialEq)]
pub struct Remade {
    /// The new mesh.
    pub mesh: TriMesh,
    /// Pairs of its triangles that cross each other.
    pub crossings: usize,
    /// The parts of the old surface farther than a voxel from the new one; `None` if there are
    /// none.
    pub lost: Option<LostParts>,
}

/// Voxel remeshing: one closed 2-manifold around everything that is inside `mesh`, its vertices on
/// the old surface (or, where a hole was closed, between its rims), with the old colours. `solid`
/// was built from `mesh`.
pub fn remesh(
    mesh: &TriMesh,
    solid: &DistanceSolid,
    settings: RemeshSettings,
    job: &Job,
) -> Result<Remade, RemeshError> {
    let mut grid = DistanceGrid::band([solid], |[d]| d, layout(solid, 0.0, settings.side)?, job)?;
    let h = grid.spacing;
    let sharp = SharpSurface { solid, origin: grid.origin, h };
    let (mut positions, triangles) = if settings.sharp {
        dual::extract_sampled(&grid, &sharp, job)?
    } else {
        dual::extract(&grid, |points: &[DVec3]| onto(solid, middle(points), h), job)?
    };
    if triangles.is_empty() {
        return Err(RemeshError::Empty);
    }
    let calm = || {
        // Joined as the surface is, so that the vertices correspond.
        let calm = Middles(settings.sharp.then_some(&sharp));
        let middles = dual::extract_sampled(&grid, &calm, job)?.0;
        grid.values.par_iter_mut().for_each(|v| *v = if *v < 0.0 { -1.0 } else { 1.0 });
        Ok(CalmPlaces { middles, halves: dual::extract_sampled(&grid, &calm, job)?.0 })
    };
    let is_folded = |corners| settings.sharp && sharp.is_folded(corners);
    let crossings = untangle(&mut positions, &triangles, is_folded, calm, job)?;
    let colours = colours(mesh, solid, &positions, job)?;
    let lost = lost_parts(mesh, solid, &positions, h);
    job.progress(1.0);
    Ok(Remade { mesh: TriMesh { positions, triangles, colours }, crossings, lost })
}

/// Returns the middle of some points.
pub(super) fn middle(points: &[DVec3]) -> DVec3 {
    points.iter().sum::<DVec3>() / points.len() as f64
}

/// The place on the old surface nearest to `p`, less a fiftieth of the way: two vertices that meet
/// at a corner stay two.
fn onto(solid: &DistanceSolid, p: DVec3, h: f64) -> DVec3 {
    match solid.tree.nearest(p, h) {
        Some(n) => p + (n.point - p) * 0.98,
        None => p,
    }
}

/// The old colours at new places.
fn colours(
    mesh: &TriMesh,
    solid: &DistanceSolid,
    positions: &[Vec3],
    job: &Job,
) -> Result<Option<Vec<[u8; 4]>>, Cancelled> {
    let Some(old) = mesh.colours.as_ref().filter(|c| c.len() == mesh.positions.len()) else {
        return Ok(None);
    };
    let each = |p: &Vec3| -> Result<[u8; 4], Cancelled> {
        job.check()?;
        let Some(n) = solid.tree.nearest(p.as_dvec3(), f64::INFINITY) else { return Ok([255; 4]) };
        let [a, b, c] = mesh.corners(n.triangle as usize).map(Vec3::as_dvec3);
        let area = |p: DVec3, q: DVec3| (p - n.point).cross(q - n.point).length();
        let w = [area(b, c), area(c, a), area(a, b)];
        let sum = w[0] + w[1] + w[2];
        let w = if sum > 0.0 { w.map(|x| x / sum) } else { [1.0, 0.0, 0.0] };
        let t = mesh.triangles[n.triangle as usize];
        Ok(std::array::from_fn(|k| {
            (0..3).map(|i| old[t[i] as usize][k] as f64 * w[i]).sum::<f64>().round() as u8
        }))
    };
    positions.par_iter().map(each).collect::<Result<_, _>>().map(Some)
}

//! The active object made symmetric: one side of a mirror plane of the brush is replaced by the
//! mirror image of the other. One step of undo.
//!
//! The kept half and its mirror image are solids whose cut faces lie on one plane, so that their
//! union has no seam.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::operations::basis::{Basis, Placing};
use crate::operations::{Computed, OperationError, in_place};
use crate::{Published, carry_over};
use sculptd_check::repair::combined;
use sculptd_check::repair::flat_base::base_tool;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::{PolyMesh, repair, self_intersection};

/// A vertex within this share of the object's size of the plane is on it: the cut makes them, and
/// single precision rounds them.
const ON_PLANE: f64 = 1e-6;

/// The plane, and the side that is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SymmetriseWanted {
    /// Normal of the plane through the middle of the object: 0 for x, 1 for y, 2 for z.
    pub axis: usize,
    /// Keeps the side towards which the axis points; the other becomes its mirror image.
    pub keeps_positive: bool,
}

/// Result of making an object symmetric. Volumes are in the mesh's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetriseMade {
    pub vertices: usize,
    pub triangles: usize,
    /// Before and after.
    pub volume: [f64; 2],
    /// Pairs of triangles that cross each other.
    pub crossings: usize,
}

/// The mirror plane in the frame of the object.
#[derive(Debug, Clone, Copy)]
struct MirrorPlane {
    transform: ObjectTransform,
    inverse: ObjectTransform,
    axis: usize,
    /// Where it meets the axis, in the world's frame.
    at: f64,
}

impl MirrorPlane {
    /// The distance of a place from the plane along the axis, in the world's unit.
    fn height(&self, p: DVec3) -> f64 {
        self.transform.apply(p)[self.axis] - self.at
    }

    fn moved(&self, p: DVec3, height: impl Fn(f64) -> f64) -> DVec3 {
        let mut world = self.transform.apply(p);
        world[self.axis] = self.at + height(world[self.axis] - self.at);
        self.inverse.apply(world)
    }

    fn mirrored(&self, mesh: &PolyMesh) -> PolyMesh {
        let mut out = mesh.clone();
        out.positions.iter_mut().for_each(|p| *p = self.moved(*p, |h| -h));
        repair::flip(&mut out);
        out
    }
}

/// Computes the symmetric object as one step of undo.
///
/// # Errors
/// Returns an error if the object is no solid, if the plane does not cut it, and if the job was
/// cancelled.
pub fn symmetrised(
    now: &Published,
    wanted: SymmetriseWanted,
    job: &Job,
) -> Result<Computed<SymmetriseMade>, OperationError> {
    let transform = now.transform();
    let inverse = transform.inverse();
    let axis = wanted.axis.min(2);
    let plane = MirrorPlane { transform, inverse, axis, at: f64::from(now.middle[axis]) };
    let sign = if wanted.keeps_positive { 1.0 } else { -1.0 };
    let old = now.mesh.to_tri();
    let whole = old.to_poly();
    // The tool lies below the plane along this direction.
    let kept = inverse.apply(DVec3::AXES[axis] * sign) - inverse.apply(DVec3::ZERO);
    let kept = kept.normalize_or_zero();
    let on_plane = inverse.apply(now.middle.as_dvec3()).dot(kept);
    let low = whole.positions.iter().map(|p| p.dot(kept)).fold(f64::INFINITY, f64::min);
    let tool = base_tool(&whole, kept, on_plane - low)?;
    let (mut half, _) = combined(&whole, &tool, Operation::Difference, job)?;
    let (lo, hi) = transform.bounds(now.mesh.bounds());
    let slack = f64::from((hi - lo).max_element()) * ON_PLANE;
    for p in &mut half.positions {
        if plane.height(*p).abs() <= slack {
            *p = plane.moved(*p, |_| 0.0);
        }
    }
    // Rounded as clay rounds, so that the union joins what would cross once it is rounded.
    let mut twin = plane.mirrored(&half);
    for p in half.positions.iter_mut().chain(&mut twin.positions) {
        *p = p.as_vec3().as_dvec3();
    }
    let (joined, _) = combined(&half, &twin, Operation::Union, job)?;
    let mut new = joined.triangulate().0;
    if new.triangles.is_empty() {
        return Err(OperationError::Nothing);
    }
    let masks = now.mesh.masks();
    let mut carried = None;
    if masks.is_some() || old.colours.is_some() {
        let solid = DistanceSolid::build(&old, job)?;
        let kept_side = |p: &Vec3| plane.moved(p.as_dvec3(), |h| h.abs() * sign).as_vec3();
        let from: Vec<Vec3> = new.positions.iter().map(kept_side).collect();
        let places = carry_over::places(&old, &solid, &from, job)?;
        new.colours = carry_over::colours(&old, &places);
        carried = masks.map(|m| carry_over::values(&old, &m, &places));
    }
    let at: Vec<DVec3> = new.positions.iter().map(|p| p.as_dvec3()).collect();
    let made = SymmetriseMade {
        vertices: new.positions.len(),
        triangles: new.triangles.len(),
        volume: [measures(&old).volume, measures(&new).volume],
        crossings: self_intersection::pairs(&at, &new.triangles, job)?.len(),
    };
    let queued = in_place(Arc::new(new), carried, None, job)?;
    let basis = Basis::of_active(now, Placing::Nearest);
    Ok(Computed::of_clay(now, queued, made).following(basis))
}

//! The walls below a limit alone: for a check, which asks for nothing that is thicker. What is
//! deeper than the limit costs nothing, so that this takes a fraction of a whole measurement.

use super::MeasuredSide;
use super::ThinFacets;
use super::least::Solid;
use super::measuring::single;
use super::opposed::may_be_thin;
use super::surface::WeldedSurface;
use crate::bvh::Bvh8;
use crate::job::{Cancelled, Job};

/// Returns every facet of `surface` with a wall (or a gap) below `limit` by the ray along its
/// normal. No place is left out: a facet that is not listed has no such wall. `tree` is over the
/// same mesh, and `grain` the greatest error of its coordinates besides the rounding to single
/// precision. A tie passes.
///
/// ```
/// use glam::DVec3;
/// use sculptd_geometry::bvh::Bvh8;
/// use sculptd_geometry::job::Job;
/// use sculptd_geometry::shapes;
/// use sculptd_geometry::thickness::{MeasuredSide, WeldedSurface, walls_below};
///
/// let slab = shapes::cuboid(DVec3::ZERO, DVec3::new(50.0, 50.0, 3.0)).triangulate().0;
/// let job = Job::default();
/// let tree = Bvh8::build(&slab, &job).expect("not cancelled");
/// let surface = WeldedSurface::new(&slab, 0.7);
/// let thin = |limit: f64| {
///     walls_below(&surface, &tree, MeasuredSide::Wall, limit, 0.0, &job).expect("not cancelled")
/// };
/// assert!(thin(3.0).facets.is_empty());
/// assert_eq!(thin(3.1).regions(0.0, 10).len(), 2);
/// ```
pub fn walls_below(
    surface: &WeldedSurface,
    tree: &Bvh8,
    side: MeasuredSide,
    limit: f64,
    grain: f64,
    job: &Job,
) -> Result<ThinFacets, Cancelled> {
    let inside_out = if surface.faults.inside_out { -1.0 } else { 1.0 };
    let sign = if side == MeasuredSide::Wall { inside_out } else { -inside_out };
    let grain = grain + single(tree);
    let tilts = surface.tilts(grain);
    let solid = Solid { tree, surface, sign, grain, tilts: &tilts, opposed_only: false };
    let order = may_be_thin(surface, tree, sign, limit, job)?;
    let facets = solid.thin(&order, limit - solid.tolerance(), false, job)?;
    Ok(ThinFacets { limit, facets })
}

//! Orthographic projection of a solid: its shadow's outline and area, by three methods.
//!
//! *Exact*: the silhouette edges resolved into polygons, right to about 1e-14 of the extent, or to
//! the bound that it states where edges nearly coincide. *Sample*: random points of the plane,
//! classified as inside or outside by rays; the area has the standard error of a binomial share,
//! the outline is the points' alpha shape. *March*: the same with rays through a sampled distance;
//! the mesh decides rays that come closer to the surface than the samples' error, so that the
//! stated error is the points' alone.

mod draw;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::alpha_shape::alpha_shape;
use super::distance::DistanceSolid;
use super::grid::DistanceGrid;
use super::march::{MarchOutcome, march};
pub use super::silhouette::{PlaneRegion, ProjectionPlane, ShadowOutline, outline, outline_of};
use crate::bvh::Ray;
use crate::job::{Cancelled, Job};
pub use draw::{png, svg};

/// Points of one task.
const CHUNK: usize = 512;

/// The test for each random point.
#[derive(Debug, Clone, Copy)]
pub enum PointTest<'a> {
    /// The mesh, by its tree.
    Rays,
    /// A sampled distance; a hit is nearer than the length.
    Marching(&'a DistanceGrid, f64),
}

/// Random points of the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct ProjectionSamples {
    /// The rectangle that they fill.
    pub lo: DVec2,
    /// The upper corner of the rectangle.
    pub hi: DVec2,
    /// Points whose line meets the solid.
    pub inside: Vec<DVec2>,
    /// Points whose line misses it.
    pub outside: Vec<DVec2>,
    /// The rectangle's area times the share of points inside.
    pub area: f64,
    /// One standard deviation of `area`.
    pub standard_error: f64,
    /// The alpha that [`ProjectionSamples::shape`] takes unless told: 2.5 times the points' mean
    /// spacing.
    pub alpha: f64,
}

impl ProjectionSamples {
    /// The alpha shape of the points inside: its polygons and area. Low by about its perimeter
    /// times half the spacing.
    pub fn shape(&self, alpha: f64) -> (Vec<PlaneRegion>, f64) {
        alpha_shape(&self.inside, alpha)
    }
}

/// The exact area of a shadow.
pub fn area(polygons: &[PlaneRegion]) -> f64 {
    polygons.iter().map(PlaneRegion::area).sum()
}

/// The rectangle of the plane that holds the shadow.
pub fn rectangle(solid: &DistanceSolid, plane: &ProjectionPlane) -> Option<(DVec2, DVec2)> {
    let mut used =
        solid.topology.positions.iter().map(|p| plane.flat(p.as_dvec3())).filter(|p| p.is_finite());
    let first = used.next()?;
    Some(used.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p))))
}

/// Classifies each point of the plane: does the line through it along the plane's normal meet the
/// solid?
pub fn classify(
    solid: &DistanceSolid,
    plane: &ProjectionPlane,
    points: &[DVec2],
    by: PointTest,
    job: &Job,
) -> Result<Vec<bool>, Cancelled> {
    let (lo, hi) = solid.tree.bounds();
    if solid.tree.is_empty() {
        return Ok(vec![false; points.len()]);
    }
    // From before the box, with room for rounding.
    let (centre, size) = ((lo + hi).as_dvec3() * 0.5, (hi - lo).as_dvec3().length());
    let back = plane.towards * (centre.dot(plane.towards) + size);
    let dir = -plane.towards;
    let mut out = vec![false; points.len()];
    out.par_chunks_mut(CHUNK).zip(points.par_chunks(CHUNK)).try_for_each(|(out, points)| {
        job.check()?;
        for (o, &p) in out.iter_mut().zip(points) {
            let origin = plane.solid(p) + back;
            let by_mesh =
                || solid.tree.any_hit(Ray::new(origin.as_vec3(), dir.as_vec3()), |_| true);
            *o = match by {
                PointTest::Rays => by_mesh(),
                PointTest::Marching(grid, epsilon) => match march(grid, origin, dir, epsilon) {
                    MarchOutcome::Hit(_) => true,
                    MarchOutcome::Miss => false,
                    MarchOutcome::Unsure => by_mesh(),
                },
            };
        }
        Ok(())
    })?;
    Ok(out)
}

/// `count` random points of the rectangle around the shadow, told inside from outside. The same
/// seed, the same points.
pub fn sample(
    solid: &DistanceSolid,
    plane: &ProjectionPlane,
    count: usize,
    seed: u64,
    by: PointTest,
    job: &Job,
) -> Result<ProjectionSamples, Cancelled> {
    let (lo, hi) = rectangle(solid, plane).unwrap_or_default();
    let mut state = seed;
    let mut unit = || {
        // Splitmix64 (Steele, Lea and Flood 2014).
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    let points: Vec<DVec2> =
        (0..count).map(|_| lo + (hi - lo) * DVec2::new(unit(), unit())).collect();
    let inside = classify(solid, plane, &points, by, job)?;
    let whole = (hi - lo).x * (hi - lo).y;
    let n = count.max(1) as f64;
    let share = inside.iter().filter(|&&i| i).count() as f64 / n;
    let mut out = ProjectionSamples {
        lo,
        hi,
        inside: Vec::new(),
        outside: Vec::new(),
        area: whole * share,
        // A share of none or all is still known to one in n only.
        standard_error: whole * (share * (1.0 - share) / n).sqrt().max(1.0 / n),
        alpha: 2.5 * (whole / n).sqrt(),
    };
    for (&p, i) in points.iter().zip(inside) {
        if i { out.inside.push(p) } else { out.outside.push(p) }
    }
    Ok(out)
}

/// The exact area of the shadow along each direction, on all threads; zero for a direction of no
/// length.
pub fn shadow_areas(
    solid: &DistanceSolid,
    directions: &[DVec3],
    job: &Job,
) -> Result<Vec<f64>, Cancelled> {
    let positions = solid.positions();
    directions
        .par_iter()
        .map(|&d| {
            job.check()?;
            Ok(ProjectionPlane::along(d, 0.0).map_or(0.0, |plane| {
                area(&outline_of(&solid.topology, &positions, &plane).regions)
            }))
        })
        .collect()
}

/// `count` directions spread evenly over half the sphere (a shadow is the same from both sides), by
/// the golden angle.
pub fn spread_directions(count: usize) -> Vec<DVec3> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count)
        .map(|i| {
            let z = (i as f64 + 0.5) / count as f64;
            let r = (1.0 - z * z).sqrt();
            let (s, c) = (golden * i as f64).sin_cos();
            DVec3::new(r * c, r * s, z)
        })
        .collect()
}

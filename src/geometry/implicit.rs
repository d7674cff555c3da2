//! Surfaces of functions of space: dual marching cubes ([`crate::remesh::dual`]), then Newton steps
//! along the slope.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::grid::DistanceGrid;
use super::remesh::dual::extract;
use super::remesh::{MARGIN, RemeshError, middle};
use crate::TriMesh;
use crate::job::Job;

/// Step of the numerical slope and longest move of a vertex, shares of the spacing.
const SLOPE_STEP: f64 = 0.05;
/// See [`SLOPE_STEP`].
const ROOM: f64 = 0.5;

/// Moves vertices onto the zero of `field` along its slope, each by at most half of `spacing`.
/// Vertices at which the field is nearly flat stay.
pub(super) fn onto_zero(
    positions: &mut [Vec3],
    field: &(impl Fn(DVec3) -> f64 + Sync),
    spacing: f64,
    job: &Job,
) -> Result<(), RemeshError> {
    positions.par_iter_mut().try_for_each(|p| {
        job.check()?;
        let q = p.as_dvec3();
        let e = spacing * SLOPE_STEP;
        let slope =
            DVec3::from_array(DVec3::AXES.map(|x| field(q + x * e) - field(q - x * e))) / (2.0 * e);
        let steep = slope.length_squared();
        if steep > 0.25 {
            *p = (q - (slope * (field(q) / steep)).clamp_length_max(spacing * ROOM)).as_vec3();
        }
        Ok(())
    })
}

/// Returns the closed surface on which `field` is zero, negative inside, within the box `lo` to
/// `hi`, sampled at `side` places (8 to 1024) along the box's longest side. The solid must not
/// touch the box. Parts thinner than the spacing may be missing.
///
/// # Errors
/// [`RemeshError::Empty`] if the field is positive everywhere; [`RemeshError::Side`];
/// [`RemeshError::Cancelled`].
pub fn surface(
    field: impl Fn(DVec3) -> f64 + Sync,
    (lo, hi): (DVec3, DVec3),
    side: usize,
    job: &Job,
) -> Result<TriMesh, RemeshError> {
    if !(8..=1024).contains(&side) {
        return Err(RemeshError::Side(side));
    }
    let mut grid = DistanceGrid::layout((lo, hi), side, MARGIN);
    let [nx, ny, nz] = grid.size;
    let (origin, h) = (grid.origin, grid.spacing);
    grid.values = vec![0.0; nx * ny * nz];
    grid.values.par_chunks_mut(nx * ny).enumerate().try_for_each(|(k, slab)| {
        job.check()?;
        for (at, value) in slab.iter_mut().enumerate() {
            let place = DVec3::new((at % nx) as f64, (at / nx) as f64, k as f64);
            *value = field(origin + place * h) as f32;
        }
        Ok::<_, RemeshError>(())
    })?;
    let (mut positions, triangles) = extract(&grid, middle, job)?;
    if triangles.is_empty() {
        return Err(RemeshError::Empty);
    }
    onto_zero(&mut positions, &field, h, job)?;
    Ok(TriMesh { positions, triangles, colours: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measures;

    #[test]
    fn a_ball_of_a_function_has_its_volume_and_lies_on_it() {
        let field = |p: DVec3| p.length() - 10.0;
        let bounds = (DVec3::splat(-11.0), DVec3::splat(11.0));
        let ball = surface(field, bounds, 64, &Job::default()).expect("a ball");
        let furthest = ball.positions.iter().map(|p| field(p.as_dvec3()).abs()).fold(0.0, f64::max);
        assert!(furthest < 1e-3, "{furthest}");
        let volume = measures(&ball).volume;
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 1000.0;
        assert!((volume / exact - 1.0).abs() < 0.01, "{volume}");
        assert!(matches!(surface(|_| 1.0, bounds, 16, &Job::default()), Err(RemeshError::Empty)));
    }
}

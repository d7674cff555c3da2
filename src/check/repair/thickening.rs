//! Thin walls made thicker.
//!
//! The corners of faces over a thin wall move out of it, on both sides, by half of what is missing.
//! A corner stays in the planes of its other faces, so that a plate becomes thicker and no longer
//! or wider. The walls are measured again after each round. What faces without a movable corner
//! leave, and a wall that runs out to an edge, stays, and is named.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::thickness::{MeasuredSide, ThinFacets, walls_below};

use super::{RepairError, ReshapedPart};
use crate::part::PreparedPart;

/// Rounds of measuring and moving.
const ROUNDS: usize = 10;
/// Rounds after which a side moves by all that is missing: the other did not follow.
const HALVES: usize = 2;
/// Cosine of 40 degrees: sides that are turned more make an edge and no wall.
const OPPOSED: f64 = 0.766;
/// Cosine of 20 degrees: a face that is turned less from a moving one goes on in it and bends.
const ONE_FACE: f64 = 0.94;
/// The share of the trace that keeps a corner of nearly parallel faces from sliding along them.
const STIFF: f64 = 1e-3;
/// A corner is measured at this share of the way to its face's centre, or of the limit.
const BESIDE: f64 = 0.05;
/// A wall gets this share of the limit more: coordinates are rounded, and the rounds are few.
const SPARE: f64 = 2e-4;
/// Places that are named.
const NAMED: usize = 5;

/// A condition on the movement of a corner: how far along a face's normal, and the angle of the
/// face there.
type FaceCondition = (DVec3, f64, f64);

/// Thickens the walls of a part below `limit`, in the mesh's unit. Its faces stay, and its corners
/// move.
///
/// # Errors
/// Returns an error if the limit is not above 0, or if no wall is below it.
pub fn thicken(solid: &PolyMesh, limit: f64, job: &Job) -> Result<ReshapedPart, RepairError> {
    let limit = RepairError::expect_length("wall", limit)?;
    let mut mesh = solid.clone();
    let mut area = 0.0;
    for round in 0..=ROUNDS {
        let part = PreparedPart::with_surface(&mesh, 1.0, true, job)?;
        let found = thin(&part, limit, job)?;
        if round == 0 {
            area = found.facets.iter().map(|f| f.area).sum();
            if found.facets.is_empty() {
                return Err(RepairError::NoFinding("wall below this limit"));
            }
        }
        let left = found.regions(0.0, usize::MAX);
        if left.is_empty() || round == ROUNDS {
            let names = left.iter().take(NAMED).map(|r| {
                let [x, y, z] = part.to_file(DVec3::from(r.position.map(f64::from))).to_array();
                format!("the wall at ({x:.3}, {y:.3}, {z:.3}) stayed at {:.3}", r.thickness)
            });
            return Ok(ReshapedPart { area, kept: left.len(), notes: names.collect(), mesh });
        }
        let share = if round < HALVES { 0.5 } else { 1.0 };
        for (v, by) in moves(&part, &found, limit, share) {
            if let Some(p) = mesh.positions.get_mut(v as usize) {
                *p += by;
            }
        }
    }
    Ok(ReshapedPart { mesh, area, kept: 0, notes: Vec::new() })
}

/// Returns the number of connected regions of a part with walls below `limit`.
///
/// # Errors
/// Returns an error if the job was cancelled.
pub fn thin_regions(mesh: &PolyMesh, limit: f64, job: &Job) -> Result<usize, RepairError> {
    let part = PreparedPart::with_surface(mesh, 1.0, true, job)?;
    Ok(thin(&part, limit, job)?.regions(0.0, usize::MAX).len())
}

fn thin(part: &PreparedPart, limit: f64, job: &Job) -> Result<ThinFacets, Cancelled> {
    let grain = part.centred.grain;
    walls_below(part.surface(), part.tree(), MeasuredSide::Wall, limit, grain, job)
}

/// The movement of each corner of a thin face. `share` is how much of what is missing each side
/// adds.
fn moves(part: &PreparedPart, found: &ThinFacets, limit: f64, share: f64) -> BTreeMap<u32, DVec3> {
    let wanted = limit * (1.0 + SPARE) + 8.0 * (part.centred.grain + part.rounding());
    let mut is_thin = vec![false; part.triangles()];
    let mut at: BTreeMap<u32, Vec<FaceCondition>> = BTreeMap::new();
    let names = &part.centred.mesh.triangles;
    for facet in &found.facets {
        is_thin[facet.triangle as usize] = true;
        for v in names[facet.triangle as usize] {
            at.entry(v).or_default();
        }
    }
    for (t, corners) in names.iter().enumerate() {
        let Some(places) = part.corners(t as u32) else { continue };
        let normal = part.normals[t];
        let middle = part.middle(t as u32);
        for (k, v) in corners.iter().enumerate() {
            let Some(conditions) = at.get_mut(v) else { continue };
            let (p, a, b) = (places[k], places[(k + 1) % 3], places[(k + 2) % 3]);
            let by = if is_thin[t] {
                let beside = p + (middle - p).clamp_length_max(limit) * BESIDE;
                let wall = wall_at(part, beside, normal, &is_thin);
                wall.map_or(0.0, |w| (wanted - w).max(0.0) * share)
            } else {
                0.0
            };
            let angle = (a - p).normalize_or_zero().dot((b - p).normalize_or_zero());
            conditions.push((normal, by, angle.clamp(-1.0, 1.0).portable_acos()));
        }
    }
    at.into_iter().map(|(v, conditions)| (v, movement(&conditions))).collect()
}

/// The wall behind a point of a face: to the first side that is nearly parallel, or that belongs to
/// a thin wall itself.
fn wall_at(part: &PreparedPart, p: DVec3, normal: DVec3, is_thin: &[bool]) -> Option<f64> {
    let opposite = |t: u32| {
        part.normals[t as usize].dot(-normal) >= OPPOSED || is_thin.get(t as usize) == Some(&true)
    };
    part.exit_along(p, -normal, 16.0 * part.rounding(), opposite).map(|(d, _)| d)
}

/// The shortest movement that meets the conditions of a corner best (least squares).
fn movement(conditions: &[FaceCondition]) -> DVec3 {
    let moving = |n: &DVec3| conditions.iter().any(|(m, by, _)| *by > 0.0 && m.dot(*n) > ONE_FACE);
    let (mut squares, mut way) = (DMat3::ZERO, DVec3::ZERO);
    for (normal, by, weight) in conditions {
        if *by > 0.0 || !moving(normal) {
            let n = *normal;
            squares += DMat3::from_cols(n * n.x, n * n.y, n * n.z) * *weight;
            way += n * (by * weight);
        }
    }
    let trace = squares.x_axis.x + squares.y_axis.y + squares.z_axis.z;
    if way == DVec3::ZERO || !(trace > 0.0) {
        return DVec3::ZERO;
    }
    (squares + DMat3::from_diagonal(DVec3::splat(trace * STIFF))).inverse() * way
}

//! Computations on the face sets of the active object, in the caller's thread: finding the set at a
//! view position, and extracting a part of the surface as a new object.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::Vec2;

use crate::operations::{Computed, OperationError};
use crate::published::Published;
use sculptd_clay::face_sets::{self, FaceSetPart, Partition, SetsEdit};
use sculptd_clay::{Clay, Ray};
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{NewObject, ObjectSource, SceneCommand, SceneError};
use sculptd_geometry::job::Job;

/// The face set of the active object that is seen at a place of the view, (0, 0) top left to
/// (1, 1) bottom right; `None`: the object is not seen there.
pub fn set_seen(shown: &Published, at: Vec2) -> Option<u16> {
    let active = shown.scene.active()?;
    let inverse = active.settings.transform.inverse();
    let ray = shown.camera.ray(at);
    let (origin, dir) = (inverse.point(ray.origin), inverse.direction(ray.dir));
    let hit = shown.mesh.pick(Ray { origin, dir })?;
    Some(shown.mesh.set_at(&hit))
}

/// Computes face sets of the active object from its shape. Returns the number of sets.
///
/// # Errors
/// Returns an error if there are more parts than face set numbers.
pub fn parted(
    shown: &Published,
    by: Partition,
    job: &Job,
) -> Result<Computed<u64>, OperationError> {
    let edit = face_sets::partition(&shown.mesh, by, job)?;
    let SetsEdit::Assign { pages, .. } = &edit else {
        return Ok(Computed::of_scene(SceneCommand::Sets(edit), None, 0));
    };
    let all: BTreeSet<u16> = pages.iter().flat_map(|p| p.1.iter().copied()).collect();
    let made = all.len() as u64 - u64::from(all.contains(&0));
    Ok(Computed::of_scene(SceneCommand::Sets(edit), None, made))
}

/// Extracts a part of the active object as a new object at the same place. Returns its number of
/// vertices. `thickness` is in scene units.
///
/// # Errors
/// Returns an error if the part does not exist, or if the thickness produces no solid.
pub fn extract(
    shown: &Published,
    part: FaceSetPart,
    thickness: f64,
    name: &str,
    job: &Job,
) -> Result<Computed<usize>, OperationError> {
    let transform = shown.scene.active().ok_or(SceneError::Last)?.settings.transform;
    let own = (thickness / transform.scale) as f32;
    let shell = face_sets::extract(&shown.mesh, part, own)?;
    let clay = Clay::build(&shell, job).map_err(|e| OperationError::Build(e.to_string()))?;
    let new = NewObject::new(name, ObjectSource::Mesh(Arc::new(shell)), transform);
    let (vertices, payload) = (clay.vertex_count(), Payload::Clay(Box::new(clay)));
    Ok(Computed::of_scene(SceneCommand::Add(new), Some(payload), vertices))
}

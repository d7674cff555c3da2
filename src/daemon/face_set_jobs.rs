//! What is computed of the face sets of the active object on the thread of whoever asks: which set
//! is seen at a place, and a part of the surface as a new object.

use std::sync::Arc;

use glam::Vec2;

use crate::published::Published;
use sculptd_clay::face_sets::{self, ExtractError, FaceSetPart, Partition, SetsEdit, SetsError};
use sculptd_clay::{BuildError, Clay, Ray};
use sculptd_engine::scene::{NewObject, ObjectSource, SceneError};
use sculptd_geometry::job::Job;

/// Why no face sets were made, or no object extracted.
#[derive(Debug, thiserror::Error)]
pub enum ExtractionError {
    #[error(transparent)]
    Extract(#[from] ExtractError),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Sets(#[from] SetsError),
    #[error("the shell cannot be sculpted: {0}")]
    Build(#[from] BuildError),
}

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

/// The edit that gives the active object face sets by its shape.
///
/// # Errors
/// Where there are more parts than numbers of sets.
pub fn parted(shown: &Published, by: Partition) -> Result<SetsEdit, ExtractionError> {
    Ok(face_sets::partition(&shown.mesh, by)?)
}

/// A part of the active object as a new one that stands where it does. `thickness` is in the unit
/// of the scene.
///
/// # Errors
/// Where there is no such part, or the thickness makes no solid.
pub fn extract(
    shown: &Published,
    part: FaceSetPart,
    thickness: f64,
    name: &str,
    job: &Job,
) -> Result<(NewObject, Clay), ExtractionError> {
    let transform = shown.scene.active().ok_or(SceneError::Last)?.settings.transform;
    let own = (thickness / transform.scale) as f32;
    let shell = face_sets::extract(&shown.mesh, part, own)?;
    let clay = Clay::build(&shell, job)?;
    Ok((NewObject::new(name, ObjectSource::Mesh(Arc::new(shell)), transform), clay))
}

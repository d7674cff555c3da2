//! Masks that are measured on the thread of whoever asks.

use crate::operations::{Computed, OperationError};
use crate::published::Published;
use sculptd_clay::measured_mask::{MaskMeasure, MeasuredMask};
use sculptd_engine::scene::SceneCommand;
use sculptd_geometry::job::Job;

/// What is at most so thick, `below` in the unit of the scene.
pub fn thin(shown: &Published, below: f64) -> MaskMeasure {
    let scale = shown.scene.active().map_or(1.0, |o| o.settings.transform.scale);
    MaskMeasure::Thin((below / scale) as f32)
}

/// Computes the mask of the active object by a measure. The result is how many vertices it
/// protects.
///
/// # Errors
/// Where nothing would be masked, or the job was cancelled.
pub fn measured(
    shown: &Published,
    by: MaskMeasure,
    job: &Job,
) -> Result<Computed<u64>, OperationError> {
    let mask = MeasuredMask::new(&shown.mesh, by, job)?;
    let protected = mask.protected();
    Ok(Computed::of_scene(SceneCommand::MaskMeasured(mask), None, protected))
}

//! Masks that are measured on the thread of whoever asks.

use crate::operations::{Computed, OperationError};
use crate::published::Published;
use sculptd_clay::measured_mask::{MaskMeasure, MeasuredMask};
use sculptd_engine::scene::SceneCommand;
use sculptd_geometry::job::Job;

/// Returns the measure that masks everything at most `below` thick, in scene units.
pub fn thin(shown: &Published, below: f64) -> MaskMeasure {
    let scale = shown.scene.active().map_or(1.0, |o| o.settings.transform.scale);
    MaskMeasure::Thin((below / scale) as f32)
}

/// Computes a mask of the active object from a measure. Returns the number of protected vertices.
///
/// # Errors
/// Returns an error if nothing would be masked, or if the job was cancelled.
pub fn measured(
    shown: &Published,
    by: MaskMeasure,
    job: &Job,
) -> Result<Computed<u64>, OperationError> {
    let mask = MeasuredMask::new(&shown.mesh, by, job)?;
    let protected = mask.protected();
    Ok(Computed::of_scene(SceneCommand::MaskMeasured(mask), None, protected))
}

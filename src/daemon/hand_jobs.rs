//! Jobs that tracked hands request from workers: joining a held object with another, or laying it
//! flush on a nearby face. The result is a command, which the loop carries out only if nothing has
//! changed.

use sculptd_engine::hand::MenuItem;
use sculptd_engine::scene::{ObjectId, ObjectView, SceneError};
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;

use crate::operations::{Computed, OperationError};
use crate::published::Published;
use crate::scene_jobs::{self, CombineError, SceneBoolean};
use crate::snap_jobs::{NearFace, Placed, onto_what_is_near};

/// Distance within which a face is near, in mm of the hand: slightly more than a hand's tremor.
const NEAR_MM: f32 = 15.0;
/// Least cosine between faces that are laid on each other: 20 degrees.
const COSINE: f64 = 0.94;

/// Returns the Boolean operation of a menu choice, applied to an object and the held object.
pub fn operation(choice: MenuItem) -> Option<Operation> {
    match choice {
        MenuItem::Add => Some(Operation::Union),
        MenuItem::Carve => Some(Operation::Difference),
        MenuItem::Keep => Some(Operation::Intersection),
        _ => None,
    }
}

/// Returns the command that lays a put-down object on a nearby face; `None` if no face is near.
///
/// # Errors
/// Returns an error if the object does not exist or is locked.
pub fn lay_down(
    shown: &Published,
    id: ObjectId,
) -> Result<Option<Computed<Placed>>, OperationError> {
    let near = NearFace { distance: f64::from(NEAR_MM * shown.volume.scale), cosine: COSINE };
    let placed = onto_what_is_near(shown, id, near)?;
    Ok(placed.map(Computed::of_snap))
}

/// The object that a held one is joined with: the active one, or where that is held, of the visible
/// ones whose box it meets the largest.
fn partner(shown: &Published, held: ObjectId) -> Option<ObjectId> {
    let open = |o: &ObjectView| o.id != held && o.settings.visible && !o.settings.locked;
    if let Some(active) = shown.scene.active().filter(|o| open(o)) {
        return Some(active.id);
    }
    let boxes = || {
        let each = shown.scene.each(&shown.mesh);
        each.map(|(o, clay)| (o, o.settings.transform.bounds(clay.bounds())))
    };
    let (_, (lo, hi)) = boxes().find(|(o, _)| o.id == held)?;
    let meets = |(a, b): (glam::Vec3, glam::Vec3)| a.cmple(hi).all() && lo.cmple(b).all();
    let near = boxes().filter(|(o, b)| open(o) && meets(*b));
    let size = |(a, b): (glam::Vec3, glam::Vec3)| (b - a).element_product();
    near.max_by(|(_, a), (_, b)| size(*a).total_cmp(&size(*b))).map(|(o, _)| o.id)
}

/// The command that joins a held object of the scene with another one, as one step of undo.
///
/// # Errors
/// [`CombineError`]
pub fn join(
    shown: &Published,
    held: ObjectId,
    choice: MenuItem,
    job: &Job,
) -> Result<Computed<()>, OperationError> {
    let operation = operation(choice).ok_or(CombineError::Nothing)?;
    let other = partner(shown, held).ok_or(SceneError::Last)?;
    let done = scene_jobs::boolean(shown, [other, held], SceneBoolean::new(operation), job)?;
    Ok(Computed::of_combined(shown, done, ()))
}

#[cfg(test)]
mod tests;

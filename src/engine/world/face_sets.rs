//! What the world does with the face sets of its active object.

use super::{HistoryEvent, SceneResult, World};
use crate::scene::{ObjectId, SceneError, SceneEvent};
use sculptd_clay::face_sets::SetsEdit;

impl World {
    /// Carries out an edit of the active object's face sets: one step of undo. It looks at every
    /// vertex in this tick, as a change of the whole mask does. The result has the number of the
    /// set that was made or that it was about in the place of an object's, 0 for none.
    pub(super) fn edit_sets(&mut self, edit: &SetsEdit) -> SceneResult {
        let active = self.scene.active_mut();
        if active.settings.locked {
            return Err(SceneError::Locked(active.id));
        }
        active.clay.begin_step();
        let made = active.clay.edit_sets(edit);
        let World { timeline, scene, garbage, options, .. } = self;
        if timeline.end_step(scene, options.undo_bytes, garbage) {
            self.note(HistoryEvent::Scene(SceneEvent::Sets));
        }
        Ok(ObjectId(made?.into()))
    }
}

//! What the world does with the face sets of its active object.

use super::{HistoryEvent, SceneResult, World};
use crate::scene::{ObjectId, SceneError, SceneEvent};
use crate::view_region::{RegionSeen, SetsRegion};
use sculptd_clay::Clay;
use sculptd_clay::face_sets::{SetsEdit, SetsError};

impl World {
    /// Carries out an edit of the active object's face sets: one step of undo. It looks at every
    /// vertex in this tick, as a change of the whole mask does. The result has the number of the
    /// set that was made or that it was about in the place of an object's, 0 for none.
    pub(super) fn edit_sets(&mut self, edit: &SetsEdit) -> SceneResult {
        self.change_sets(|clay| clay.edit_sets(edit))
    }

    /// The same of what is seen in a region.
    pub(super) fn edit_sets_seen(&mut self, asked: &SetsRegion) -> SceneResult {
        let SetsRegion { region, edit, front_faces } = asked;
        if !region.is_sane() {
            return Err(SceneError::Region);
        }
        let (camera, transform) = (self.camera, self.scene.active().settings.transform);
        let seen = RegionSeen { region, camera: &camera, front_faces: *front_faces };
        self.change_sets(|clay| {
            clay.edit_part(*edit, |page, v| {
                seen.holds(transform.point(page.point(v)), transform.direction(page.normal(v)))
            })
        })
    }

    fn change_sets(
        &mut self,
        change: impl FnOnce(&mut Clay) -> Result<u16, SetsError>,
    ) -> SceneResult {
        let active = self.scene.active_mut();
        if active.settings.locked {
            return Err(SceneError::Locked(active.id));
        }
        active.clay.begin_step();
        let made = change(&mut active.clay);
        let World { timeline, scene, garbage, options, .. } = self;
        if timeline.end_step(scene, options.undo_bytes, garbage) {
            self.note(HistoryEvent::Scene(SceneEvent::Sets));
        }
        Ok(ObjectId(made?.into()))
    }
}

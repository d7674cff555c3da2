//! What the world does with the mask, the face sets and the triangles of its active object as a
//! whole.

use super::{HistoryEvent, SceneResult, World};
use crate::answer::{Answer, CommandResult};
use crate::command::Command;
use crate::local_remesh::LocalRemesh;
use crate::mask_region::MaskRegion;
use crate::region_seen::RegionSeen;
use crate::remesh_work::RemeshWork;
use crate::scene::{ObjectId, SceneError};
use crate::surface_edit::{Asked, SurfaceEdit};
use crate::view_region::{SetsRegion, ViewRegion};
use sculptd_clay::brush::MaskAction;
use sculptd_clay::brush::mask_all::MaskAll;
use sculptd_clay::face_sets::{SetsEdit, SetsError, SetsTask};
use sculptd_clay::measured_mask::MeasuredMask;

impl World {
    /// Returns true while an edit of a whole object's mask or face sets is under way. Its pages
    /// follow in this tick and, if there are many, in the next ones. A command that needs the
    /// surface finishes it within its tick; see [`crate::command::Command::needs_surface`].
    pub fn is_in_surface_edit(&self) -> bool {
        self.surface.is_under_way()
    }

    /// Returns what came of an edit of an earlier tick that was done in this one.
    pub fn late_answer(&self) -> Option<CommandResult> {
        self.late_answer
    }

    /// Returns whether the command that is being applied began an edit whose pages follow.
    pub(super) fn follows_later(&self) -> bool {
        self.surface.asked() == Asked::Now(self.answers.len())
    }

    /// Changes the mask of the whole active object: one step of undo.
    pub(super) fn mask(&mut self, action: MaskAction) -> CommandResult {
        self.lift_all();
        let extent = self.scene.active().extent;
        self.begin_mask(SurfaceEdit::Mask(MaskAll { action, extent }))?;
        Ok(Answer::UnderWay)
    }

    /// The same of what is seen in a region.
    pub(super) fn mask_seen(&mut self, asked: &MaskRegion) -> CommandResult {
        if !asked.is_sane() {
            return Err(SceneError::Region);
        }
        self.lift_all();
        let seen = self.seen(&asked.region, asked.front_faces);
        self.begin_mask(SurfaceEdit::MaskSeen(seen, asked.mask))?;
        Ok(Answer::UnderWay)
    }

    /// The same of what was measured of it, unless it has changed since.
    pub(super) fn mask_measured(&mut self, mask: &MeasuredMask) -> SceneResult {
        self.open_to_edits()?;
        if !mask.fits(&self.scene.active().clay) {
            return Err(SceneError::MaskChanged);
        }
        self.begin_mask(SurfaceEdit::MaskMeasured(mask.clone()))?;
        Ok(ObjectId(0))
    }

    /// Begins to resize triangles of the active object: one step of undo. Returns the number of
    /// changed edges as the object id.
    pub(super) fn remesh_locally(&mut self, asked: &LocalRemesh) -> SceneResult {
        self.open_to_edits()?;
        if asked.region.as_ref().is_some_and(|region| !region.is_sane()) {
            return Err(SceneError::Region);
        }
        let seen = asked.region.as_ref().map(|region| self.seen(region, false));
        let clay = &mut self.scene.active_mut().clay;
        let work = Box::new(RemeshWork::new(asked, seen, clay)?);
        clay.begin_step();
        self.surface.begin(SurfaceEdit::Remesh(work), Asked::Now(self.answers.len()));
        Ok(ObjectId(0))
    }

    /// Checks that the active object is neither locked nor hidden.
    fn open_to_edits(&self) -> Result<(), SceneError> {
        let active = self.scene.active();
        match (active.settings.locked, active.settings.visible) {
            (true, _) => Err(SceneError::Locked(active.id)),
            (false, false) => Err(SceneError::Hidden(active.id)),
            (false, true) => Ok(()),
        }
    }

    fn begin_mask(&mut self, edit: SurfaceEdit) -> Result<(), SceneError> {
        self.open_to_edits()?;
        self.scene.active_mut().clay.begin_step();
        self.surface.begin(edit, Asked::Now(self.answers.len()));
        Ok(())
    }

    /// A region as the active object sees it.
    fn seen(&self, region: &ViewRegion, front_faces: bool) -> RegionSeen {
        let transform = self.scene.active().settings.transform;
        RegionSeen::new(region, front_faces, &self.camera, transform)
    }

    /// Begins an edit of the active object's face sets: one step of undo. Returns the number of the
    /// set made or edited as the object id, 0 for none.
    pub(super) fn edit_sets(&mut self, edit: &SetsEdit) -> SceneResult {
        self.change_sets(SetsTask::Edit(edit.clone()), None)
    }

    /// The same of what is seen in a region.
    pub(super) fn edit_sets_seen(&mut self, asked: &SetsRegion) -> SceneResult {
        if !asked.region.is_sane() {
            return Err(SceneError::Region);
        }
        let seen = self.seen(&asked.region, asked.front_faces);
        self.change_sets(SetsTask::Part(asked.edit), Some(seen))
    }

    fn change_sets(&mut self, task: SetsTask, seen: Option<RegionSeen>) -> SceneResult {
        let active = self.scene.active_mut();
        if active.settings.locked {
            return Err(SceneError::Locked(active.id));
        }
        let work = active.clay.begin_sets(task)?;
        active.clay.begin_step();
        // Its index is the next one: the answer is pushed there after the command has been applied.
        let place = Asked::Now(self.answers.len());
        self.surface.begin(SurfaceEdit::Sets(work, seen), place);
        Ok(ObjectId(0))
    }

    /// An edit that is under way is finished, and its step closed.
    pub(super) fn end_surface_edit(&mut self) {
        if self.surface.is_under_way() {
            let done = self.surface.finish(&mut self.scene.active_mut().clay, &self.workers);
            self.close_surface_edit(done);
        }
    }

    /// Lets pages follow an edit. False: more are to follow, and strokes wait.
    pub(super) fn surface_may_wait(&mut self) -> bool {
        if !self.surface.is_under_way() {
            return true;
        }
        let done = self.surface.run(&mut self.scene.active_mut().clay, &self.workers);
        done.map(|done| self.close_surface_edit(done)).is_some()
    }

    /// Returns true if a command undoes the edit under way, and need not wait for its end.
    pub fn is_taken_back_by(&self, command: &Command) -> bool {
        matches!(command, Command::Undo) && self.surface.is_remesh()
    }

    /// Cancels a local remesh and restores the object. Returns false if none is under way.
    pub(super) fn take_back_remesh(&mut self) -> bool {
        // Somebody else's remesh is finished, and is a step of that person.
        let clay = &self.scene.active().clay;
        if !self.surface.is_remesh() || self.person().is_some_and(|p| !clay.is_step_of(p)) {
            return false;
        }
        self.tell_surface_edit(Err(SceneError::TakenBack));
        let event = HistoryEvent::Scene(self.surface.event());
        let World { surface, timeline, scene, garbage, options, .. } = self;
        surface.end(&scene.active().clay, garbage);
        if timeline.end_step(scene, options.undo_bytes, garbage) {
            if self.undo_step() {
                // Nobody would want to redo half of a remesh.
                let World { timeline, scene, garbage, .. } = self;
                timeline.forget_future(scene, garbage);
            } else {
                // It was too large for the bytes of undo, and stays.
                self.note(event);
            }
        }
        true
    }

    fn tell_surface_edit(&mut self, result: SceneResult) {
        let answer = result.map(Answer::Object);
        match self.surface.asked() {
            Asked::Untold => {}
            Asked::Earlier => self.late_answer = Some(answer),
            Asked::Now(place) => {
                self.answers.get_mut(place).into_iter().for_each(|a| *a = answer);
            }
        }
    }

    fn close_surface_edit(&mut self, done: Result<u32, SetsError>) {
        let event = HistoryEvent::Scene(self.surface.event());
        self.tell_surface_edit(done.map(ObjectId).map_err(SceneError::from));
        let World { surface, timeline, scene, garbage, options, .. } = self;
        surface.end(&scene.active().clay, garbage);
        // Nothing was moved, or there are no layers: nothing that they would have to take over.
        if timeline.end_step(scene, options.undo_bytes, garbage) {
            self.note(event);
        }
    }
}

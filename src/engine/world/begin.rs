//! Starts a new person with a new world.

use super::{HistoryEvent, World};
use crate::answer::{Answer, CommandResult};
use crate::command::Beginning;
use crate::scene::SceneError;
use sculptd_clay::Workers;

impl World {
    /// Nothing of what was before stays, but for what the loop gave the world.
    pub(super) fn begin_anew(&mut self, new: &Beginning) -> CommandResult {
        self.lift_all();
        if !new.camera.is_sane() {
            return Err(SceneError::Value("values that are finite"));
        }
        let mesh = self.built(&new.clay, &[]).ok_or(SceneError::Build)?;
        let workers = std::mem::replace(&mut self.workers, Workers::new(1));
        let fresh = World::new(mesh, new.camera, new.brush, workers, self.options);
        let mut old = std::mem::replace(self, fresh);
        self.lineages = old.lineages + 1;
        self.scene.active_mut().clay.set_object_id(self.lineages);
        self.moments = old.moments.take();
        self.desktop = old.desktop;
        self.people = std::mem::take(&mut old.people);
        self.tick = old.tick;
        self.report = old.report;
        std::mem::swap(&mut self.payloads, &mut old.payloads);
        std::mem::swap(&mut self.answers, &mut old.answers);
        self.late_answer = old.late_answer.take();
        self.set_garbage_sink(old.garbage.clone());
        self.set_page_supply(old.pages.clone());
        self.garbage.discard_owned(old);
        self.note(HistoryEvent::Begin);
        Ok(Answer::Done)
    }
}

//! What the world does with the layers of its active object: edits of them, and strokes on them.

use super::{HistoryEvent, SceneResult, World};
use crate::scene::{ObjectId, SceneError, SceneEvent, clean_name};
use sculptd_clay::LayerEdit;

impl World {
    /// Carries out an edit of the active object's layers. The pages follow in this tick and, if
    /// there are many, in the next ones. Returns the number of the layer made or edited as the
    /// object id, or `u32::MAX` for the base.
    pub(super) fn edit_layers(&mut self, edit: &LayerEdit) -> SceneResult {
        if !self.layers.goes_on_with(edit) {
            self.lift_all();
        }
        let cleaned = match edit {
            LayerEdit::Add(name) => Some(LayerEdit::Add(clean_name(name).ok_or(SceneError::Name)?)),
            LayerEdit::Rename(id, name) => {
                Some(LayerEdit::Rename(*id, clean_name(name).ok_or(SceneError::Name)?))
            }
            _ => None,
        };
        let edit = cleaned.as_ref().unwrap_or(edit);
        let workers = &self.workers;
        let active = self.scene.active_mut();
        if active.settings.locked {
            return Err(SceneError::Locked(active.id));
        }
        active.clay.begin_step();
        match active.clay.edit_layers(edit, workers) {
            Ok(job) => {
                let layer = job.layer.map_or(u32::MAX, |id| id.0);
                self.layers.edit(edit, job);
                Ok(ObjectId(layer))
            }
            Err(e) => {
                if !self.layers.is_edit() {
                    active.clay.end_step();
                }
                Err(e.into())
            }
        }
    }

    /// Returns whether pages are still to follow an edit of layers, or a stroke on one.
    pub fn is_in_layer_edit(&self) -> bool {
        self.layers.is_pending()
    }

    /// An edit that is under way is finished, and its step closed.
    pub(super) fn end_layer_edit(&mut self) {
        if self.layers.is_edit() {
            self.close();
        }
    }

    /// Does all that is still to be done to layers; what the open step is called.
    pub(super) fn finish_layers(&mut self) -> HistoryEvent {
        let clay = &mut self.scene.active_mut().clay;
        self.layers.capture(clay);
        self.layers.finish(clay, &self.workers);
        let edit = self.layers.is_edit();
        self.layers.clear();
        if edit { HistoryEvent::Scene(SceneEvent::Layers) } else { HistoryEvent::Step }
    }

    /// Lets pages follow an edit. False: more are to follow, and strokes wait.
    pub(super) fn layers_may_wait(&mut self) -> bool {
        if !self.layers.is_edit() {
            return true;
        }
        self.layers.run(&mut self.scene.active_mut().clay, &self.workers);
        if self.layers.is_pending() {
            return false;
        }
        let strokes = self.pens.iter().any(|s| s.track.is_open() || !s.track.is_idle());
        if self.layers.is_complete() || strokes || self.hands.is_touching() {
            self.close();
        }
        true
    }

    /// At the end of a tick: the step is closed where no stroke is under way, after what it did was
    /// taken over into layers.
    pub(super) fn settle_layers(&mut self, stroke: bool) {
        if stroke {
            self.layers.stroke_goes_on();
            return;
        }
        if self.layers.is_edit() {
            return;
        }
        let clay = &mut self.scene.active_mut().clay;
        self.layers.capture(clay);
        self.layers.run(clay, &self.workers);
        if self.layers.is_pending() {
            self.report.paused = true;
        } else {
            self.close();
        }
    }
}

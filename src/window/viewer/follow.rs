//! What follows the newest snapshot: requests to the workers, and the mesh that is drawn over the
//! clay (the held object, the hands' menu).

use super::distance_field;
use super::preview;
use super::state::WindowState;
use super::wiring::Wiring;
use crate::look::Map;
use crate::panels::hand_menu;
use crate::panels::state::{DistanceTarget, Tab, TrialStatus};
use sculptd_daemon::Published;
use sculptd_engine::hand::Similarity;

/// A preview that is not done after so long is given up for a newer one; before that it is shown
/// late rather than never.
const PATIENCE_US: u64 = 300_000;
/// Measuring waits until the object has not changed for so long.
const REST_US: u64 = 500_000;

impl WindowState {
    /// Asks the workers for what the newest state makes stale; `true` when that is to be seen.
    /// Once a poll.
    pub(super) fn follow(&mut self, state: &Published, wiring: &Wiring) -> bool {
        let now = wiring.clock.now_us();
        let revision = state.mesh.revision();
        let clay = (state.mesh.object_id(), revision);
        if self.rested.0 != revision {
            self.rested = (revision, now);
        }
        // Visitors of an installation compare nothing: old works are not kept.
        if wiring.kiosk.is_none() {
            // Another object is compared with itself, as it was when it became active.
            let active = state.scene.active().map(|o| o.id);
            if self.before.is_none() || self.before_of != active {
                (self.before, self.before_of) = (Some(state.mesh.clone()), active);
            }
        }
        let changed = self.follow_preview(state, now);
        if self.ui_state.look.map == Map::Distance {
            let to = self.goal_reference(wiring).or_else(|| self.earlier_form(state));
            let place = state
                .thing
                .as_ref()
                .filter(|_| self.ui_state.sizes.against == DistanceTarget::HeldObject);
            let base = self.before.as_ref().map_or((0, 0), |b| (b.object_id(), b.revision()));
            let transform = state.transform();
            let key = (clay, base, place.map(|t| t.place), transform);
            if let Some(to) = to.filter(|_| self.asked_distance != Some(key)) {
                self.asked_distance = Some(key);
                self.workers.distances(
                    distance_field::DistanceRequest { mesh: state.mesh.clone(), transform, to },
                    &self.tasks,
                );
            }
        }
        let section = self.ui_state.look.cut.map(|cut| (clay, state.transform(), cut));
        if section != self.asked_section {
            self.asked_section = section;
            if let Some((_, transform, cut)) = section {
                self.workers.section((state.mesh.clone(), transform, cut), &self.tasks);
            }
        }
        let direction = self.ui_state.sizes.direction;
        let rests = now.saturating_sub(self.rested.1) > REST_US;
        if self.ui_state.tab == Tab::Measure
            && !self.ui_state.hidden
            && self.asked_sizes != Some((clay, direction, state.transform()))
        {
            // Another direction of an unchanged object is measured at once.
            let turned = self.asked_sizes.is_some_and(|(c, ..)| c == clay);
            if rests || turned || self.ui_state.sizes.found.is_none() {
                let transform = state.transform();
                self.asked_sizes = Some((clay, direction, transform));
                self.workers.sizes((state.mesh.clone(), transform, direction), &self.tasks);
            }
        }
        changed
    }

    fn follow_preview(&mut self, state: &Published, now: u64) -> bool {
        let wanted = self.ui_state.trial.choice.zip(state.thing.as_ref());
        let Some((choice, thing)) = wanted else {
            if self.asked_preview.take().is_some() {
                self.workers.no_preview();
            }
            let shown = self.preview.take().is_some();
            let before = std::mem::take(&mut self.ui_state.trial.said);
            if state.thing.is_none() {
                self.ui_state.trial.choice = None;
            }
            return shown || before != TrialStatus::Nothing;
        };
        // The preview is of the clay, and drawn in the frame of its object.
        let mut thing = thing.clone();
        let own = state.transform().inverse();
        if !own.is_none() {
            let (shift, turn) = (own.shift.as_vec3(), own.turn.as_quat());
            thing.place = thing.place.then(&Similarity { shift, turn, scale: own.scale as f32 });
        }
        let key = (state.mesh.revision(), thing.place, choice);
        if self.asked_preview.as_ref().is_some_and(|(asked, _)| *asked == key) {
            return false;
        }
        let busy = self.ui_state.trial.said == TrialStatus::UnderWay;
        let begun = self.asked_preview.as_ref().map_or(0, |a| a.1);
        if busy && now.saturating_sub(begun) < PATIENCE_US {
            return false;
        }
        self.asked_preview = Some((key, now));
        self.ui_state.trial.said = TrialStatus::UnderWay;
        let wanted = preview::PreviewRequest { mesh: state.mesh.clone(), thing, choice };
        self.workers.preview(wanted, &self.tasks);
        true
    }

    /// A preview has come, or why there is none.
    pub(super) fn previewed(
        &mut self,
        done: Result<Option<std::sync::Arc<preview::Preview>>, String>,
    ) {
        match done {
            // It was dismissed while it was computed.
            _ if self.ui_state.trial.choice.is_none() => {}
            Ok(preview) => {
                self.ui_state.trial.said =
                    TrialStatus::Shown(preview.as_ref().map_or(0, |p| p.made));
                self.preview = preview;
            }
            Err(why) => {
                self.ui_state.trial.said = TrialStatus::Wrong(why);
                self.preview = None;
            }
        }
    }

    /// Updates the transparent meshes: the held object and the items of its menu.
    pub(super) fn update_overlay_mesh(&mut self, state: &Published) {
        let balls = hand_menu::menu_balls(state);
        let thing =
            state.thing.as_ref().map(|t| (std::sync::Arc::as_ptr(&t.plain) as usize, t.place));
        let trial = self.ui_state.trial.choice;
        let key = (thing, trial, balls.clone());
        if self.overlay_key == key {
            return;
        }
        self.overlay_mesh.clear();
        if let Some(thing) = &state.thing {
            // While its cut is previewed, the held object is fainter.
            let colour = if trial.is_some() { [255, 214, 140, 26] } else { [255, 214, 140, 90] };
            self.overlay_mesh.held_object(thing, colour);
        }
        for ball in &balls {
            let (colour, grown) = match ball.ring {
                Some(_) => ([255, 190, 70, 225], 1.12),
                None => ([120, 165, 225, 120], 1.0),
            };
            self.overlay_mesh.ball(ball.place, ball.radius * grown, colour);
        }
        self.overlay_key = key;
    }
}

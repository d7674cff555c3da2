//! The goal of an exhibit in the picture: as a ghost that shows through the clay, and as the
//! reference of the distance map.

use std::sync::Arc;

use super::distance_reference::DistanceReference;
use super::state::WindowState;
use super::wiring::Wiring;
use crate::look::Map;
use sculptd_daemon::kiosk::exhibit::ExhibitStep;
use sculptd_daemon::kiosk::exhibit::score::Goal;

/// The ends of the distance map's scale, in tolerances.
const SCALE: f32 = 4.0;

impl WindowState {
    /// The exhibit's step that is shown.
    fn exhibit_step<'a>(&self, wiring: &'a Wiring) -> Option<&'a ExhibitStep> {
        let (screen, now) = (wiring.kiosk.as_ref()?, self.drawn_kiosk?);
        screen.exhibits.get(now.exhibit?)?.steps.get(now.step)
    }

    /// Shows the step's goal as the visitor chose. Once a frame.
    pub(super) fn show_goal(&mut self, wiring: &Wiring) {
        if wiring.kiosk.is_none() {
            return;
        }
        let step = self.exhibit_step(wiring);
        let goal = step.and_then(|step| step.goal.as_ref());
        let pad = &self.ui_state.pad;
        let ghost = pad.ghost.unwrap_or(step.is_some_and(|step| step.ghost));
        self.ghost.show(goal.filter(|_| ghost && !pad.compares).map(|goal| &goal.mesh));
        let map = if goal.is_some() && pad.compares { Map::Distance } else { Map::None };
        let address = goal.map(Arc::as_ptr);
        if (self.ui_state.look.map, self.goal_address) != (map, address) {
            (self.ui_state.look.map, self.goal_address) = (map, address);
            (self.distances, self.asked_distance) = (None, None);
        }
    }

    /// The goal that the distance map measures from, if an exhibit is shown.
    pub(super) fn goal_reference(&self, wiring: &Wiring) -> Option<DistanceReference> {
        let goal = self.exhibit_step(wiring)?.goal.as_ref()?;
        Some(DistanceReference::Goal(goal.mesh.clone()))
    }

    /// The ends of the distance map's scale while it measures from a goal.
    pub(super) fn goal_scale(&self, wiring: &Wiring) -> Option<(f32, f32)> {
        let goal: &Arc<Goal> = self.exhibit_step(wiring)?.goal.as_ref()?;
        let most = goal.tolerance as f32 * SCALE;
        Some((-most, most))
    }
}

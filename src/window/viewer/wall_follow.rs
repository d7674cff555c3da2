//! Requests to the thread that measures walls and gaps, and the one under the pointer.

use super::distance_reference::DistanceReference;
use super::state::WindowState;
use super::thickness_task::{AskedWalls, ThicknessRequest};
use super::wall_probe::WallBall;
use crate::look::Map;
use crate::panels::state::DistanceTarget;
use sculptd_daemon::Published;

impl WindowState {
    /// The form that the clay is compared with: the held object, or the clay as it was before.
    pub(super) fn earlier_form(&self, state: &Published) -> Option<DistanceReference> {
        match (&state.thing, self.ui_state.sizes.against, &self.before) {
            (Some(thing), DistanceTarget::HeldObject, _) => {
                Some(DistanceReference::HeldObject(thing.clone()))
            }
            (_, _, before) => before.clone().map(DistanceReference::Before),
        }
    }

    /// Asks for the map of walls, the ball under the pointer and the change of walls where they are
    /// shown; `true` when something else is to be seen.
    pub(super) fn follow_walls(&mut self, state: &Published) -> bool {
        let wall = self.wall_here(state);
        let ball = self.ball.filter(|b: &WallBall| wall.is_some_and(|w| b.is_at(w.place)));
        let now = (wall.map(|w| w.thickness), ball.map(|b| b.diameter));
        let walls = &mut self.ui_state.walls;
        let changed = (walls.here, walls.ball) != now;
        (walls.here, walls.ball) = now;
        let map = self.ui_state.look.map;
        if !map.is_of_walls() {
            return changed;
        }
        let (side, transform) = (map.side(), state.transform());
        let limit = self.ui_state.walls.limit_of(side);
        if self.asked_map.is_some_and(|asked| asked.side != side) {
            // Values of the other side are not shown as this one's.
            let walls = &mut self.ui_state.walls;
            (walls.found, walls.scale, self.values) = (None, None, None);
        }
        let earlier = (map == Map::WallChange).then(|| self.earlier_form(state)).flatten();
        let of_earlier = |to: &DistanceReference| match to {
            DistanceReference::Before(b) => ((b.object_id(), b.revision()), to.place()),
            _ => ((0, 0), to.place()),
        };
        let asked = AskedWalls {
            clay: (state.mesh.object_id(), state.mesh.revision()),
            side,
            limit,
            transform,
            probe: wall.map(|w| w.place),
            earlier: earlier.as_ref().map(of_earlier),
        };
        if self.asked_map != Some(asked) || self.values.is_none() && self.asked_map.is_none() {
            self.asked_map = Some(asked);
            self.tasks.thickness(ThicknessRequest {
                mesh: state.mesh.clone(),
                transform,
                near: transform.inverse().point(self.camera.target),
                side,
                limit,
                probe: wall.map(|w| (w.place, w.normal)),
                earlier,
            });
        }
        changed
    }
}

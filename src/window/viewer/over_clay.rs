//! Lines drawn over the clay: rings of pens, the gizmo, hands, the held object.

use glam::Vec2;

use super::clay_frame::OverClay;
use super::mirrors::mirrors;
use super::overlay;
use super::pointer::Drag;
use super::renderer::LineEnd;
use super::state::WindowState;
use super::wall_probe::{ProbedWall, wall_on};
use super::wiring::Wiring;
use sculptd_daemon::Published;
use sculptd_daemon::kiosk::Stage;
use sculptd_daemon::people::colour_of;
use sculptd_engine::camera::Camera;

impl WindowState {
    /// In the view in which is worked: the ring under the pointer and under every other pen (where
    /// that will be when the frame is seen), and their mirror images.
    pub(super) fn over_view(&self, state: &Published, wiring: &Wiring) -> OverClay {
        let mut lines = Vec::new();
        let mut brush = None;
        self.grid(&mut lines, state);
        let mut ring_at = |view: Vec2, pressure: f32, tilt: Option<Vec2>, down: bool| {
            let ray = self.camera.ray(view);
            let radius = state.brush_radius * state.brush.pressure_radius.factor(pressure);
            let carve = state.brush.negative;
            let ring = overlay::Ring { radius, carve, mirrored: false, down, of: None };
            if let Some(hit) = state.pick(ray) {
                overlay::ring(&mut lines, state, hit.position, hit.normal, &ring);
                if let Some(tilt) = tilt {
                    overlay::barrel(&mut lines, &self.camera, hit.position, tilt, radius);
                }
                brush.get_or_insert((hit.position, radius));
            }
            // Mirrors are in the object's frame.
            let to_world = state.transform();
            let own = to_world.inverse();
            let (middle, ray) = (own.point(state.middle), own.ray(ray));
            for m in mirrors(state.brush.symmetry) {
                let origin = middle + (ray.origin - middle) * m;
                let mirrored = sculptd_clay::Ray { origin, dir: ray.dir * m };
                if let Some(hit) = state.pick(to_world.ray(mirrored)) {
                    let ring = overlay::Ring { mirrored: true, ..ring };
                    overlay::ring(&mut lines, state, hit.position, hit.normal, &ring);
                }
            }
        };
        // While nobody is there the recording plays by itself: no tool is seen.
        // And none on a form that is cut.
        let nobody = self.drawn_kiosk.is_some_and(|k| k.stage == Stage::Attract)
            || self.ui_state.look.cut.is_some();
        let p = &self.pointer;
        let scale = self.egui.egui_ctx().pixels_per_point();
        let over_panel = self.over_panel(self.pointer.at);
        let follows = self.pointer_is_a_pen(wiring);
        if let Some(modal) = &self.ui_state.modal {
            let at = Vec2::new(modal.from.x, modal.from.y) * scale;
            ring_at(self.view_point(at), 1.0, None, false);
        } else if p.inside
            && !nobody
            && self.is_in_view(p.at)
            && (p.drag == Drag::Sculpt || (p.drag == Drag::None && !over_panel && !follows))
        {
            let felt = state
                .pens
                .iter()
                .flatten()
                .find(|(id, _)| *id == sculptd_daemon::adaptors::POINTER_ID);
            let down = p.drag == Drag::Sculpt;
            let pressure = if down { felt.map_or(1.0, |f| f.1.pressure) } else { 1.0 };
            ring_at(self.view_point(p.at), pressure, None, down);
        }
        for (id, pen) in state.pens.iter().flatten().filter(|_| !nobody) {
            if *id != sculptd_daemon::adaptors::POINTER_ID {
                let down = pen.pressure > 0.0;
                let view = self.predicted(*id, wiring).unwrap_or(pen.view);
                ring_at(view, if down { pen.pressure } else { 1.0 }, pen.tilt, down);
            }
        }
        self.objects_in_hand(&mut lines, state, &self.camera);
        self.check_lines(&mut lines, &self.camera);
        if let Some(wall) = self.wall_here(state) {
            overlay::wall(&mut lines, &wall);
            if let Some(ball) = self.ball.filter(|b| b.is_at(wall.place)) {
                overlay::ball(&mut lines, &self.camera, &ball);
            }
        }
        OverClay { lines, brush, led: self.led(state, wiring) }
    }

    /// In another view: what is in the scene, without rings.
    pub(super) fn over_other_view(&self, state: &Published, camera: &Camera) -> OverClay {
        let mut lines = Vec::new();
        self.grid(&mut lines, state);
        self.objects_in_hand(&mut lines, state, camera);
        self.check_lines(&mut lines, camera);
        OverClay { lines, ..OverClay::default() }
    }

    fn grid(&self, lines: &mut Vec<LineEnd>, state: &Published) {
        if self.ui_state.look.grid {
            let floor = state.world_bounds().0.y;
            overlay::grid(lines, state.middle, floor, state.extent, self.ui_state.look.pale);
        }
    }

    /// The rings of others who share the sculpture, the gizmo, as large as it is in a view, the
    /// held object, the tracked hands.
    fn objects_in_hand(&self, lines: &mut Vec<LineEnd>, state: &Published, camera: &Camera) {
        overlay::others(lines, state);
        self.gizmo_lines(lines, state, camera);
        if let Some(thing) = &state.thing {
            overlay::held_object(lines, thing);
        }
        if let Some(hands) = &state.hands {
            let of = state.others_hands().map(colour_of);
            overlay::hands(lines, hands, &state.volume, of);
        }
    }

    /// The wall or the gap under the pointer while a map of them is shown.
    pub(super) fn wall_here(&self, state: &Published) -> Option<ProbedWall> {
        let at = self.pointer.at;
        let on_clay = self.pointer.inside && self.is_in_view(at) && !self.over_panel(at);
        let shown = on_clay && self.ui_state.look.map.is_of_walls();
        let ray = shown.then(|| self.camera.ray(self.view_point(at)))?;
        let seen = self.ui_state.look.cut.map_or(Some(ray), |cut| cut.seen(ray))?;
        wall_on(state, seen, self.ui_state.look.map.side())
    }
}

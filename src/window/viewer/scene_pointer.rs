//! What the pointer does to objects as a whole: it drags the gizmo of the active one, and picks the
//! faces that are laid on each other.

use glam::Vec2;

use super::gizmo::{Gizmo, GizmoDrag, GizmoHandle, GizmoSteps};
use super::objects;
use super::pointer::Drag;
use super::renderer::LineEnd;
use super::state::WindowState;
use super::wiring::Wiring;
use sculptd_clay::Ray;
use sculptd_daemon::Published;
use sculptd_daemon::snap_jobs::PickedFace;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::scene::{ObjectTransform, ObjectView, SceneCommand};

const BOX: [u8; 4] = [255, 220, 120, 160];

/// The active object, where a gizmo may move it: a hidden one too, as an operand that a result
/// follows.
fn movable(state: &Published) -> Option<&ObjectView> {
    state.scene.active().filter(|o| !o.settings.locked)
}

impl WindowState {
    /// The gizmo of the active object as it stands, or as it is dragged, in a view.
    fn gizmo(&self, state: &Published, camera: &Camera) -> Option<Gizmo> {
        let object = movable(state).filter(|_| self.ui_state.outliner.gizmo)?;
        let at = self.pointer.gizmo.map_or(object.settings.transform, |drag| drag.now);
        Some(Gizmo::of(object, &at, camera))
    }

    /// A press that is of objects and not of clay. False: it is neither on the gizmo nor a pick.
    pub(super) fn press_on_objects(
        &mut self,
        state: &Published,
        ray: Ray,
        wiring: &Wiring,
    ) -> bool {
        if let Some(picks) = &mut self.ui_state.outliner.snapping {
            if let Some((id, at)) = objects::hit_under(state, ray)
                && let Some(both) = picks.pick(id, at)
            {
                self.ui_state.outliner.snapping = None;
                let faces = both.map(|(id, at)| PickedFace { id, at });
                let to = (wiring.published.clone(), wiring.commands.clone());
                self.tasks.snap(faces, to);
            }
            return true;
        }
        let view = self.view_point(self.pointer.at);
        let Some(gizmo) = self.gizmo(state, &self.camera) else { return false };
        let Some(handle) = gizmo.handle_at(&self.camera, view) else { return false };
        let Some(object) = movable(state) else { return false };
        let before = object.settings.transform;
        self.pointer.gizmo = Some(GizmoDrag { handle, from: ray, before, now: before });
        self.pointer.drag = Drag::Gizmo;
        true
    }

    /// The pointer moves with a handle of the gizmo; with Ctrl in steps.
    pub(super) fn drag_gizmo(&mut self, wiring: &Wiring) {
        let state = wiring.published.load();
        let view = self.view_point(self.pointer.at);
        let Some((object, drag)) = movable(&state).zip(self.pointer.gizmo.as_mut()) else { return };
        // The gizmo stands where it was pressed.
        let gizmo = Gizmo::of(object, &drag.before, &self.camera);
        let steps = GizmoSteps::of(f64::from(state.extent));
        let steps = self.mods.control_key().then_some(steps);
        let to = self.camera.ray(view);
        if let Some(now) = gizmo.drag(drag.handle, &drag.before, drag.from, to, steps)
            && now != drag.now
        {
            drag.now = now;
            // The object goes with the pointer, and what follows it does; one step in the end.
            let _ = wiring.commands.try_send(Command::Scene(SceneCommand::Drag(object.id, now)));
        }
    }

    /// The button is released: the object stands where it was dragged to, in one step of undo.
    pub(super) fn release_gizmo(&mut self, wiring: &Wiring) {
        let Some(drag) = self.pointer.gizmo.take() else { return };
        let state = wiring.published.load();
        if let Some(object) = movable(&state).filter(|_| drag.now != drag.before) {
            let command = SceneCommand::Transform(object.id, drag.now);
            let _ = wiring.commands.try_send(Command::Scene(command));
        }
    }

    /// The lines of the gizmo, and the object's box where it is dragged to.
    pub(super) fn gizmo_lines(&self, lines: &mut Vec<LineEnd>, state: &Published, camera: &Camera) {
        let Some(gizmo) = self.gizmo(state, camera) else { return };
        let hot = match self.pointer.gizmo {
            Some(drag) => Some(drag.handle),
            None if *camera == self.camera => self.hot_handle(&gizmo),
            None => None,
        };
        gizmo.lines(lines, hot);
        if let Some(drag) = self.pointer.gizmo {
            outline(lines, state, &drag.now);
        } else if let Some(hidden) = movable(state).filter(|o| !o.settings.visible) {
            outline(lines, state, &hidden.settings.transform);
        }
    }

    fn hot_handle(&self, gizmo: &Gizmo) -> Option<GizmoHandle> {
        let at: Vec2 = self.pointer.at;
        let free = self.pointer.inside && !self.over_panel(at);
        gizmo.handle_at(&self.camera, self.view_point(at)).filter(|_| free)
    }
}

/// The box of the active object, where it would stand.
fn outline(lines: &mut Vec<LineEnd>, state: &Published, at: &ObjectTransform) {
    let (lo, hi) = state.mesh.bounds();
    let corner = |i: u32| {
        let pick = |bit: u32, a: f32, b: f32| if i >> bit & 1 == 0 { a } else { b };
        let own = glam::Vec3::new(pick(0, lo.x, hi.x), pick(1, lo.y, hi.y), pick(2, lo.z, hi.z));
        at.point(own)
    };
    for i in 0..8u32 {
        for bit in (0..3).filter(|bit| i >> bit & 1 == 0) {
            let ends = [corner(i), corner(i | 1 << bit)];
            lines.extend(ends.map(|p| LineEnd::new(p, BOX)));
        }
    }
}

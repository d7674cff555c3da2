//! The pointer as a device: on the clay it sculpts, beside the clay it turns the view. A press is
//! decided by where it happens: [`WindowState::over_panel`].

use std::sync::atomic::Ordering::Relaxed;

use glam::Vec2;
use winit::event::{MouseButton, Touch, TouchPhase};

use super::fingers::{Contact, FingerAction, TouchStep};
use super::objects;
use super::pointer::{Drag, PLAIN, give_back, lent};
use super::state::WindowState;
use super::wiring::Wiring;
use crate::panels::region;
use sculptd_daemon::adaptors::TABLET_IDS;
use sculptd_devices::{Body, Pen, Sample, Tool};
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneCommand;
use sculptd_engine::stroke::CurveAction;

/// Returns true if a layer of egui takes presses that would otherwise go to the clay.
pub(super) fn takes_presses(layer: egui::LayerId) -> bool {
    layer.order != egui::Order::Background || layer == region::layer()
}

impl WindowState {
    /// The pointer as a pen: it says all that a pen says.
    fn sample(&mut self, tip: bool, wiring: &mut Wiring) {
        let t_us = self.pointer.t_us.unwrap_or_else(|| wiring.events.now_us());
        let by_speed = self.pointer.speed.pressure(t_us, self.pointer.at / self.view_rect().1.y);
        let felt = self.pen_at_pointer(wiring);
        let pressure = match self.pointer.force.or(felt.map(|pen| pen.pressure)) {
            Some(force) => force,
            None if self.ui_state.prefs.speed_is_pressure => by_speed,
            None => PLAIN,
        };
        let (corner, size) = self.view_rect();
        let pen = Pen {
            tool: Tool::Touch,
            // Over a panel it is as far from the clay as a pen beside its tablet.
            // And where it is a tablet's own pen, that pen is in range.
            in_range: self.pointer.inside
                && (tip || !self.over_panel(self.pointer.at) && !self.pointer_is_a_pen(wiring)),
            tip,
            pos_mm: self.pointer.at - corner,
            area_mm: size,
            raw: self.pointer.at.as_ivec2().to_array(),
            pressure: Some(if tip { pressure.clamp(0.01, 1.0) } else { 0.0 }),
            tilt: felt.and_then(|pen| pen.tilt),
            ..Default::default()
        };
        let sample =
            Sample { device: wiring.pointer_id, t_us, device_t_us: None, body: Body::Pen(pen) };
        wiring.pointer.push(sample);
        wiring.pointer.flush();
        self.figures.sent += 1;
    }

    pub(super) fn moved(&mut self, to: Vec2, wiring: &mut Wiring) {
        let by = (to - self.pointer.at) / self.view_rect().1;
        self.pointer.at = to;
        self.pointer.inside = true;
        self.work_at(to, wiring);
        self.take_trail(wiring);
        match self.pointer.drag {
            Drag::Sculpt => self.sample(true, wiring),
            Drag::Orbit => {
                self.camera.orbit(by);
                self.ui_state.prefs.hints.turned = true;
                self.moved_view(wiring);
            }
            Drag::Pan => {
                self.camera.pan(by);
                self.moved_view(wiring);
            }
            Drag::Gizmo => self.drag_gizmo(wiring),
            Drag::None => self.sample(false, wiring),
        }
        self.pacing.want();
    }

    /// The pointer is gone: a pen that left the tablet's range.
    pub(super) fn left(&mut self, wiring: &mut Wiring) {
        if self.pointer.drag == Drag::None {
            self.pointer.inside = false;
            self.sample(false, wiring);
            self.pacing.want();
        }
    }

    /// Returns true if a place in the window, in pixels, is on a panel or on another surface of
    /// egui that takes presses. The panels are as the last frame laid them out, and they do not
    /// move under a pointer.
    pub(super) fn over_panel(&self, at: Vec2) -> bool {
        let context = self.egui.egui_ctx();
        let at = at / context.pixels_per_point();
        let at = egui::pos2(at.x, at.y);
        self.free.is_some_and(|free| !free.contains(at))
            || context.layer_id_at(at).is_some_and(takes_presses)
    }

    /// Returns true if a place in the window, in pixels, is where the pointer draws a region. Only
    /// the left button draws.
    pub(super) fn over_region(&self, at: Vec2) -> bool {
        let context = self.egui.egui_ctx();
        let at = at / context.pixels_per_point();
        let over = context.layer_id_at(egui::pos2(at.x, at.y)) == Some(region::layer());
        over && self.ui_state.region.drawing.is_some()
    }

    /// A press belongs to what is under the pointer at the time of the press, whatever the last
    /// frame was; what follows until the release belongs there too.
    pub(super) fn mouse_button(&mut self, button: MouseButton, down: bool, wiring: &mut Wiring) {
        let bit = match button {
            MouseButton::Left => 1,
            MouseButton::Right => 2,
            MouseButton::Middle => 4,
            _ => 8,
        };
        if down && self.pointer.drag == Drag::None {
            let dragged = self.held_on_panels != 0;
            let at = self.pointer.at;
            self.work_at(at, wiring);
            let turns = button != MouseButton::Left && self.over_region(at);
            if dragged || self.over_panel(at) && !turns {
                self.held_on_panels |= bit;
                return;
            }
        }
        if !down && self.held_on_panels & bit != 0 {
            self.held_on_panels &= !bit;
            return;
        }
        if let Some(kiosk) = wiring.kiosk.as_ref().filter(|_| down) {
            // However short the press is: the loop may not have felt it when it is looked at.
            kiosk.desk.touched.store(true, Relaxed);
        }
        self.button(button, down, wiring);
    }

    pub(super) fn button(&mut self, button: MouseButton, down: bool, wiring: &mut Wiring) {
        if !down {
            if self.pointer.drag == Drag::Sculpt {
                self.sample(false, wiring);
                if let Some(brush) = self.pointer.lent.take() {
                    wiring.link.claim_lent(None);
                    let state = wiring.published.load();
                    let (lent, kept) = (state.brush.key(), &state.kept_brushes);
                    for brush in give_back(lent, brush, &wiring.presets, kept) {
                        let _ = wiring.commands.try_send(Command::Brush(brush));
                    }
                }
            }
            if self.pointer.drag == Drag::Gizmo {
                self.release_gizmo(wiring);
            }
            self.pointer.drag = Drag::None;
            return;
        }
        let busy = self.ui_state.modal.is_some() || self.ui_state.radial.is_some();
        if busy || self.pointer.drag != Drag::None {
            return;
        }
        self.camera_animation = None;
        self.pointer.inside = true;
        self.work_at(self.pointer.at, wiring);
        self.take_trail(wiring);
        if self.press_is_a_keys() {
            return;
        }
        let state = wiring.published.load();
        let view = self.view_point(self.pointer.at);
        let ray = self.camera.ray(view);
        // The handle of a curve may be beside the clay.
        let draft = &state.draft;
        let handle = draft.handle_at(view, self.camera.aspect);
        // Alt and a press on another object make it active: that is no stroke.
        if button == MouseButton::Left
            && self.mods.alt_key()
            && let Some(id) = objects::under(&state, ray)
            && state.scene.active().is_some_and(|o| o.id != id)
        {
            let _ = wiring.commands.try_send(Command::Scene(SceneCommand::Activate(id)));
            return;
        }
        if button == MouseButton::Left && self.press_on_objects(&state, ray, wiring) {
            return;
        }
        let on_clay = || handle.is_some() || state.pick(ray).is_some();
        if let (MouseButton::Right, Some(handle)) = (button, handle) {
            let _ = wiring.commands.try_send(Command::CurveStroke(CurveAction::Delete(handle)));
            return;
        }
        self.pointer.drag = match button {
            // The pen's own samples sculpt, and its buttons have actions of their own.
            MouseButton::Left if on_clay() && self.press_is_a_pens(wiring) => Drag::None,
            MouseButton::Right | MouseButton::Middle if self.pointer_is_a_pen(wiring) => Drag::None,
            // The clay that a press would meet may be cut off: the form is only looked at.
            MouseButton::Left if on_clay() && self.ui_state.look.cut.is_none() => Drag::Sculpt,
            MouseButton::Left => Drag::Orbit,
            MouseButton::Right if self.mods.shift_key() => Drag::Pan,
            MouseButton::Right => Drag::Orbit,
            MouseButton::Middle if self.mods.shift_key() => Drag::Orbit,
            MouseButton::Middle => Drag::Pan,
            _ => Drag::None,
        };
        let turns = button == MouseButton::Left && self.pointer.drag == Drag::Orbit;
        if turns && self.is_double_press(wiring) {
            self.pointer.drag = Drag::None;
            self.show_view(self.views.active(), wiring);
        }
        self.pointer.drag = self.held_drag(self.pointer.drag);
        if self.pointer.drag == Drag::Sculpt {
            self.ui_state.prefs.hints.touched = true;
            let brush = state.brush;
            let mut now = brush;
            if draft.is_empty() {
                now = lent(brush, self.mods, &wiring.presets, &state.kept_brushes);
            }
            if now != brush {
                self.pointer.lent = Some(brush);
                wiring.link.claim_lent(self.pointer.lent);
                let _ = wiring.commands.try_send(Command::Brush(now));
            }
            self.sample(true, wiring);
        }
    }

    /// A touch of the screen. One that begins on a panel stays with that.
    pub(super) fn touched(&mut self, touch: &Touch, wiring: &mut Wiring) {
        let at = Vec2::new(touch.location.x as f32, touch.location.y as f32);
        if touch.phase == TouchPhase::Started {
            self.work_at(at, wiring);
        }
        let step = match touch.phase {
            TouchPhase::Started if self.over_panel(at) => return,
            TouchPhase::Started => TouchStep::Down,
            TouchPhase::Moved => TouchStep::Moved,
            TouchPhase::Ended => TouchStep::Up,
            TouchPhase::Cancelled => TouchStep::Cancelled,
        };
        self.set_up_fingers(wiring);
        let force = touch.force.map(|f| f.normalized() as f32);
        let contact = Contact { id: touch.id, t_us: wiring.events.now_us(), at, force };
        self.fingers.touch(step, contact);
        self.follow_fingers(wiring);
    }

    /// All events that waited were told: a finger that has waited long enough sculpts.
    pub(super) fn tick_fingers(&mut self, wiring: &mut Wiring) {
        self.set_up_fingers(wiring);
        self.fingers.tick(wiring.clock.now_us());
        self.follow_fingers(wiring);
    }

    fn set_up_fingers(&mut self, wiring: &Wiring) {
        let state = wiring.published.load();
        let pen_is_near = state.tablets.iter().flatten().any(|t| TABLET_IDS.contains(&t.0.0));
        let scale = self.window.scale_factor() as f32;
        self.fingers.set_up(scale, self.ui_state.prefs.two_fingers);
        self.fingers.pen(wiring.clock.now_us(), pen_is_near);
    }

    /// Does what the fingers ask for.
    fn follow_fingers(&mut self, wiring: &mut Wiring) {
        for action in self.fingers.take_actions() {
            self.finger(action, wiring);
        }
    }

    fn finger(&mut self, action: FingerAction, wiring: &mut Wiring) {
        let height = self.view_rect().1.y;
        match action {
            FingerAction::Press(c) | FingerAction::Drag(c) | FingerAction::Lift(c) => {
                (self.pointer.t_us, self.pointer.force) = (Some(c.t_us), c.force);
                match action {
                    FingerAction::Press(_) => {
                        (self.pointer.at, self.pointer.inside) = (c.at, true);
                        self.button(MouseButton::Left, true, wiring);
                    }
                    FingerAction::Drag(_) => self.moved(c.at, wiring),
                    // It is in range only while it touches.
                    _ => {
                        self.button(MouseButton::Left, false, wiring);
                        self.left(wiring);
                        self.pointer.force = None;
                    }
                }
                self.pointer.t_us = None;
                return;
            }
            FingerAction::Turn(by) if self.views.is_held() => self.camera.pan(by / height),
            FingerAction::Turn(by) => {
                self.camera.orbit(by / height);
                self.ui_state.prefs.hints.turned = true;
            }
            FingerAction::Slide(by) => self.camera.pan(by / height),
            FingerAction::Zoom { factor, about } => {
                self.camera.zoom_at(factor, self.view_point(about));
            }
            FingerAction::Undo | FingerAction::Redo => {
                let undo = action == FingerAction::Undo;
                let command = if undo { Command::Undo } else { Command::Redo };
                self.ui_state.prefs.hints.undone = true;
                let _ = wiring.commands.try_send(command);
                return;
            }
        }
        self.moved_view(wiring);
    }

    /// Comes nearer to, or goes away from, what is under the pointer.
    pub(super) fn zoom_to_pointer(&mut self, factor: f32, wiring: &Wiring) {
        let view = self.view_point(self.pointer.at);
        self.camera.zoom_at(factor, view);
        self.moved_view(wiring);
    }

    /// A person has moved the camera: in an installation that is a visitor who is at work.
    fn moved_view(&mut self, wiring: &Wiring) {
        if let Some(kiosk) = &wiring.kiosk {
            kiosk.desk.touched.store(true, Relaxed);
        }
        self.camera_animation = None;
        self.send_camera(wiring);
    }
}

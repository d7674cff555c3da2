//! Which of the views is worked in: the one under the pointer, or under a pen that is no pointer.
//!
//! The world's camera is that of this view, so rings, strokes, regions and objects are where they
//! are seen, whatever made them. Nothing changes while something is drawn or dragged.

use glam::Vec2;

use super::pointer::Drag;
use super::state::WindowState;
use super::wiring::Wiring;
use crate::language::tr;
use crate::panels::state::ViewKind;
use sculptd_daemon::Published;
use sculptd_daemon::adaptors::POINTER_ID;
use sculptd_engine::camera::Camera;

/// Two presses beside the clay so soon after each other, microseconds, and so near, points, show
/// the view alone.
const DOUBLE: (u64, f32) = (400_000, 6.0);

impl WindowState {
    /// The part of the window in which one of the views lies, pixels: top left corner, size.
    pub(super) fn part_of(&self, kind: ViewKind) -> (Vec2, Vec2) {
        self.views.part(kind, self.clay_rect())
    }

    /// The part of the window of the view in which is worked.
    pub(super) fn view_rect(&self) -> (Vec2, Vec2) {
        self.part_of(self.views.active())
    }

    /// Returns true if a place in the window, in pixels, is in the active view.
    pub(super) fn is_in_view(&self, at: Vec2) -> bool {
        let (corner, size) = self.view_rect();
        at.cmpge(corner).all() && at.cmplt(corner + size).all()
    }

    /// Works in the view at a place in the window, pixels, where nothing is under way in another.
    pub(super) fn work_at(&mut self, at: Vec2, wiring: &Wiring) {
        let (corner, size) = self.clay_rect();
        let beside = !(at.cmpge(corner).all() && at.cmplt(corner + size).all());
        if !self.views.are_four() || beside {
            return;
        }
        let kind = self.views.at(at, (corner, size));
        if kind == self.views.active() || self.is_at_work(&wiring.published.load()) {
            return;
        }
        self.leave_animation();
        self.camera = self.views.work_in(kind, &self.camera);
        self.send_camera(wiring);
    }

    /// Returns true while an action that belongs to one view is under way.
    fn is_at_work(&self, state: &Published) -> bool {
        let ui = &self.ui_state;
        let drawing = ui.region.drawing.as_ref().is_some_and(|d| !d.points.is_empty());
        let pressed = self.pointer.drag != Drag::None || self.held_on_panels != 0;
        pressed
            || drawing
            || ui.modal.is_some()
            || ui.radial.is_some()
            || !state.draft.is_empty()
            || state.pens.iter().flatten().any(|(_, pen)| pen.pressure > 0.0)
    }

    /// A pen that moves no pointer covers all views with its tablet: it is worked in the one that
    /// it is over.
    pub(super) fn follow_pens(&mut self, state: &Published, wiring: &Wiring) {
        let (corner, size) = self.view_rect();
        let sent = &self.tablets.sent;
        let spread = |(id, _): &&(sculptd_devices::DeviceId, _)| {
            *id != POINTER_ID && !self.tablets.moves_pointer(*id) && sent.place(*id).is_some()
        };
        let over = state.pens.iter().flatten().find(spread).map(|(_, pen)| pen.view);
        if let Some(view) = over.filter(|_| self.views.are_four()) {
            let (first, all) = self.clay_rect();
            let inside = (corner + view * size).clamp(first, first + all - Vec2::ONE);
            self.work_at(inside, wiring);
        }
    }

    /// One view becomes four, and four the one in which is worked.
    pub(super) fn turn_views(&mut self, wiring: &Wiring) {
        if self.views.are_four() {
            self.show_view(self.views.active(), wiring);
        } else if !self.takes_copies() {
            self.ui_state.say(tr!("views-no-copies"), true);
        } else {
            self.leave_animation();
            let (lo, hi) = wiring.published.load().world_bounds();
            self.views.show_four(&self.camera, lo, hi);
            let at = self.pointer.at;
            if self.pointer.inside {
                self.work_at(at, wiring);
            }
            self.fit_camera(wiring);
        }
    }

    /// Shows one of the views alone.
    pub(super) fn show_view(&mut self, kind: ViewKind, wiring: &Wiring) {
        self.leave_animation();
        self.camera = self.views.show_one(kind, &self.camera);
        self.send_camera(wiring);
        self.fit_camera(wiring);
    }

    /// A press beside the clay: whether it is the second one, which shows the view alone.
    pub(super) fn is_double_press(&mut self, wiring: &Wiring) -> bool {
        let (now, at) = (wiring.events.now_us(), self.pointer.at);
        let near = DOUBLE.1 * self.egui.egui_ctx().pixels_per_point();
        let before = self.pointer.beside.replace((now, at));
        let double = before.is_some_and(|(us, place)| {
            now.saturating_sub(us) < DOUBLE.0 && place.distance(at) < near
        });
        let shows = double && self.views.are_four();
        if shows {
            self.pointer.beside = None;
        }
        shows
    }

    /// Returns the effect of a drag with this button in the active view: a view along an axis pans
    /// instead of orbiting.
    pub(super) fn held_drag(&self, drag: Drag) -> Drag {
        if drag == Drag::Orbit && self.views.is_held() { Drag::Pan } else { drag }
    }

    /// Takes a camera that was asked for.
    pub(super) fn take_camera(&mut self, asked: Camera) {
        self.camera = self.views.take(asked, &self.camera);
    }

    /// Switches to the free view before the camera is turned.
    pub(super) fn turn_freely(&mut self) {
        self.leave_animation();
        if self.views.is_held() {
            self.camera = self.views.work_in(ViewKind::Free, &self.camera);
        }
    }

    /// An animation under way ends at once: another view begins where it would have ended.
    fn leave_animation(&mut self) {
        if let Some(animation) = self.camera_animation.take() {
            self.camera = Camera { aspect: self.camera.aspect, ..animation.end() };
        }
    }
}

//! The window's own pointer as an adaptor: on the clay it sculpts, beside it it turns the view.

use glam::Vec2;
use winit::event::MouseButton;
use winit::keyboard::ModifiersState;

use super::overlay;
use super::window::{WindowState, Wiring};
use sculptd_clay::brush::{BrushKind, BrushSettings, Presets};
use sculptd_devices::{Body, Pen, Sample, Tool};
use sculptd_engine::command::Command;
use sculptd_engine::stroke::CurveAction;

/// What a pressed button drags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Drag {
    #[default]
    None,
    Sculpt,
    Orbit,
    Pan,
}

#[derive(Debug, Default)]
pub struct Pointer {
    /// Pixels from the top left.
    pub at: Vec2,
    pub inside: bool,
    pub drag: Drag,
    /// How hard, where the window system tells.
    pub force: Option<f32>,
    pub finger: Option<u64>,
    /// The brush as it was before Shift or Ctrl changed it for one stroke.
    lent: Option<BrushSettings>,
    speed: Speed,
}

/// The speed of a pointer as a stand-in for its pressure: slow strokes press harder than quick
/// ones, as hands do.
#[derive(Debug, Default)]
pub struct Speed {
    last: Option<(u64, Vec2)>,
    /// Views a second, smoothed.
    speed: f32,
}

/// Pressure of a pointer at rest, and how much of it is lost to speed.
const RESTING: f32 = 0.8;
const LOST: f32 = 0.45;
/// Views a second at which half of that is lost.
const BRISK: f32 = 1.2;
/// Seconds over which the speed is smoothed.
const SMOOTH_S: f32 = 0.05;
/// Of a pointer whose speed does not count: two thirds, so that a pen can press harder and softer
/// than it.
const PLAIN: f32 = 0.66;

impl Speed {
    /// Takes a place in views at a time in microseconds; the pressure, 0 to 1.
    pub fn pressure(&mut self, t_us: u64, at: Vec2) -> f32 {
        if let Some((last_us, last)) = self.last {
            let dt = (t_us.saturating_sub(last_us) as f32 * 1e-6).max(1e-4);
            let now = (at - last).length() / dt;
            self.speed += (now - self.speed) * (1.0 - (-dt / SMOOTH_S).exp());
        }
        self.last = Some((t_us, at));
        RESTING - LOST * self.speed / (self.speed + BRISK)
    }
}

impl WindowState {
    /// The pointer as a pen: it says all that a pen says.
    fn sample(&mut self, tip: bool, wiring: &mut Wiring) {
        let t_us = wiring.clock.now_us();
        let by_speed = self.pointer.speed.pressure(t_us, self.pointer.at / self.size().y);
        let pressure = match self.pointer.force {
            Some(force) => force,
            None if self.desk.prefs.speed_is_pressure => by_speed,
            None => PLAIN,
        };
        let pen = Pen {
            tool: Tool::Touch,
            in_range: self.pointer.inside,
            tip,
            pos_mm: self.pointer.at,
            area_mm: self.size(),
            raw: self.pointer.at.as_ivec2().to_array(),
            pressure: Some(if tip { pressure.clamp(0.01, 1.0) } else { 0.0 }),
            ..Default::default()
        };
        let sample =
            Sample { device: wiring.pointer_id, t_us, device_t_us: None, body: Body::Pen(pen) };
        wiring.pointer.push(sample);
        wiring.pointer.flush();
        self.figures.sent += 1;
    }

    pub(super) fn moved(&mut self, to: Vec2, wiring: &mut Wiring) {
        let by = (to - self.pointer.at) / self.size();
        self.pointer.at = to;
        self.pointer.inside = true;
        match self.pointer.drag {
            Drag::Sculpt => self.sample(true, wiring),
            Drag::Orbit => {
                self.camera.orbit(by);
                self.desk.prefs.done.turned = true;
                self.send_camera(wiring);
            }
            Drag::Pan => {
                self.camera.pan(by);
                self.send_camera(wiring);
            }
            Drag::None => self.sample(false, wiring),
        }
        self.window.request_redraw();
    }

    /// The pointer is gone: a pen that left the tablet's range.
    pub(super) fn left(&mut self, wiring: &mut Wiring) {
        if self.pointer.drag == Drag::None {
            self.pointer.inside = false;
            self.sample(false, wiring);
            self.window.request_redraw();
        }
    }

    pub(super) fn button(&mut self, button: MouseButton, down: bool, wiring: &mut Wiring) {
        if !down {
            if self.pointer.drag == Drag::Sculpt {
                self.sample(false, wiring);
                if let Some(brush) = self.pointer.lent.take() {
                    let _ = wiring.commands.try_send(Command::Brush(brush));
                }
            }
            self.pointer.drag = Drag::None;
            return;
        }
        let busy = self.desk.modal.is_some() || self.desk.radial.is_some();
        if busy || self.pointer.drag != Drag::None {
            return;
        }
        self.flight = None;
        self.pointer.inside = true;
        let state = wiring.published.load();
        let ray = self.camera.ray(overlay::view_point(self.pointer.at, self.size()));
        // The handle of a curve may lie beside the clay.
        let (draft, view) = (&state.draft, overlay::view_point(self.pointer.at, self.size()));
        let handle = draft.handle_at(view, self.camera.aspect);
        let on_clay = || handle.is_some() || state.mesh.pick(ray).is_some();
        if let (MouseButton::Right, Some(handle)) = (button, handle) {
            let _ = wiring.commands.try_send(Command::CurveStroke(CurveAction::Delete(handle)));
            return;
        }
        self.pointer.drag = match button {
            MouseButton::Left if on_clay() => Drag::Sculpt,
            MouseButton::Left => Drag::Orbit,
            MouseButton::Right if self.mods.shift_key() => Drag::Pan,
            MouseButton::Right => Drag::Orbit,
            MouseButton::Middle if self.mods.shift_key() => Drag::Orbit,
            MouseButton::Middle => Drag::Pan,
            _ => Drag::None,
        };
        if self.pointer.drag == Drag::Sculpt {
            self.desk.prefs.done.touched = true;
            let brush = state.brush;
            let mut now = brush;
            if draft.is_empty() {
                now = lent(brush, self.mods, &wiring.presets);
            }
            if now != brush {
                self.pointer.lent = Some(brush);
                let _ = wiring.commands.try_send(Command::Brush(now));
            }
            self.sample(true, wiring);
        }
    }
}

/// The brush for one stroke with these keys down: Shift evens, Ctrl and Alt turn it round.
/// Slide-relax evens by itself.
fn lent(brush: BrushSettings, mods: ModifiersState, presets: &Presets) -> BrushSettings {
    let mut now = match (mods.shift_key(), brush.kind) {
        (true, BrushKind::SlideRelax) => BrushSettings { negative: !brush.negative, ..brush },
        (true, _) => presets.switched(&brush, BrushKind::Smooth),
        (false, _) => brush,
    };
    now.negative ^= mods.control_key() || mods.alt_key();
    now
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shift_evens_and_slide_relax_relaxes() {
        let presets = Presets::default();
        let of = |kind| presets.of(kind);
        let lent = |brush, mods| super::lent(brush, mods, &presets);
        assert_eq!(lent(of(BrushKind::Draw), ModifiersState::SHIFT).kind, BrushKind::Smooth);
        let relaxing = lent(of(BrushKind::SlideRelax), ModifiersState::SHIFT);
        assert!(relaxing.kind == BrushKind::SlideRelax && relaxing.negative);
        assert!(lent(of(BrushKind::Draw), ModifiersState::CONTROL).negative);
        assert_eq!(lent(of(BrushKind::Draw), ModifiersState::empty()), of(BrushKind::Draw));
    }

    #[test]
    fn a_slow_pointer_presses_harder_than_a_quick_one() {
        let run = |views_a_second: f32| {
            let mut speed = Speed::default();
            (0..60u64)
                .map(|i| {
                    speed.pressure(i * 8000, Vec2::new(i as f32 * 0.008 * views_a_second, 0.0))
                })
                .last()
                .unwrap_or(0.0)
        };
        let (still, slow, quick) = (run(0.0), run(0.2), run(3.0));
        assert!((still - RESTING).abs() < 1e-6);
        assert!(still > slow && slow > quick && quick > RESTING - LOST);
    }
}

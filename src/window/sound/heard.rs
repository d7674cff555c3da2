//! Derives contacts with the clay from the published state: pens by pressure, hands by their dabs.

use glam::Vec2;

use super::contact::Touch;
use sculptd_daemon::Published;
use sculptd_devices::DeviceId;

/// Pressure assumed for a touching hand, which reports none.
const HAND_PRESSURE: f32 = 0.5;
/// Millimetres of the room that count as one height of the view, for hands.
const HAND_VIEW_MM: f32 = 300.0;
/// Time without a dab after which a hand no longer touches, in microseconds.
const HAND_LASTS_US: u64 = 80_000;
/// Speed is smoothed over this time, microseconds.
const SMOOTH_US: f32 = 60_000.0;
/// So long after the last movement of a pen or a hand the device may stop, microseconds.
const RESTS_US: u64 = 2_000_000;

/// A pen or a hand, and where it is: shares of the view's height, or a hand's room in those.
type Toucher = (DeviceId, Vec2);

/// State of the last published update.
#[derive(Debug, Clone, Default)]
pub struct Heard {
    /// Time of the last update, in microseconds.
    t_us: u64,
    at: Option<Toucher>,
    speed: f32,
    dabs: u64,
    /// Time of a hand's last dab.
    dab_us: u64,
    /// Toucher that was near at the last movement, and its time.
    near: (Option<Toucher>, u64),
}

impl Heard {
    /// Returns the contact at `now_us`, in microseconds on any monotonic clock. The flag is true if
    /// a sound may follow soon, so that a device must run.
    pub fn touch(&mut self, state: &Published, now_us: u64) -> (Touch, bool) {
        let flat = |view: Vec2| view * Vec2::new(state.camera.aspect, 1.0);
        let pens = || state.pens.iter().flatten();
        let pressed = pens().filter(|p| p.1.pressure > 0.0);
        let pen = pressed.max_by(|a, b| a.1.pressure.total_cmp(&b.1.pressure));
        let hand = state.hands.as_ref().and_then(|h| h.as_slice().first()).map(|hand| {
            let id = state.hand_devices[0].unwrap_or(DeviceId(0));
            (id, hand.palm.truncate() / HAND_VIEW_MM)
        });
        let dabbed = self.t_us != 0 && state.figures.dabs != self.dabs;
        if dabbed && pen.is_none() && hand.is_some() {
            self.dab_us = now_us;
        }
        let held =
            hand.filter(|_| self.dab_us != 0 && now_us.saturating_sub(self.dab_us) < HAND_LASTS_US);
        let (at, pressure) = match (pen, held) {
            (Some((id, pen)), _) => (Some((*id, flat(pen.view))), pen.pressure),
            (None, Some(hand)) => (Some(hand), HAND_PRESSURE),
            (None, None) => (None, 0.0),
        };
        let passed = now_us.saturating_sub(self.t_us).max(1) as f32;
        let step = self.at.zip(at).filter(|(a, b)| a.0 == b.0).map(|(a, b)| a.1.distance(b.1));
        let speed = step.map_or(0.0, |way| way / (passed * 1e-6));
        self.speed = match step {
            Some(_) => self.speed + (speed - self.speed) * (1.0 - (-passed / SMOOTH_US).exp()),
            None => 0.0,
        };
        (self.t_us, self.at, self.dabs) = (now_us, at, state.figures.dabs);
        let near = hand.or_else(|| pens().next().map(|(id, pen)| (*id, flat(pen.view))));
        if near != self.near.0 || pressure > 0.0 {
            self.near = (near, now_us);
        }
        let runs = self.near.1 != 0 && now_us.saturating_sub(self.near.1) < RESTS_US;
        let inverted = pen.is_some_and(|p| p.1.inverted);
        let touch = Touch {
            brush: state.brush.kind,
            carves: state.brush.negative != inverted,
            pressure,
            speed: self.speed,
            // Counted round and round.
            dabs: state.figures.dabs as u32,
        };
        (touch, runs)
    }
}

//! A menu for hands that hold no button: balls in the air at the left, out of the work's way. A
//! pointing fingertip that stays in one for a while sees a ring; when the ring has closed, the ball
//! is chosen.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::settings::HandSettings;

/// Choices in the menu.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MenuItem {
    /// The thing in the hands becomes one with the work.
    Add,
    /// It is cut out of the work.
    Carve,
    /// Only what both have in common stays.
    Keep,
    /// The thing is gone, the work as it was.
    PutAway,
    /// Take up a ball, a box, a cylinder.
    Ball,
    /// Takes up a cuboid.
    Box,
    /// Takes up a cylinder.
    Cylinder,
    /// Takes back the last step.
    Undo,
    /// Redoes the step that was undone last.
    Redo,
    /// From now on pinches pick up objects of the scene.
    PickUp,
}

impl MenuItem {
    /// With empty hands.
    pub const EMPTY: [MenuItem; 6] = [
        MenuItem::Undo,
        MenuItem::Redo,
        MenuItem::Ball,
        MenuItem::Box,
        MenuItem::Cylinder,
        MenuItem::PickUp,
    ];
    /// With a thing in the hands.
    pub const HOLDING: [MenuItem; 4] =
        [MenuItem::Add, MenuItem::Carve, MenuItem::Keep, MenuItem::PutAway];

    /// Returns its English name, for logs and widget ids.
    pub fn label(self) -> &'static str {
        match self {
            MenuItem::Add => "add",
            MenuItem::Carve => "carve",
            MenuItem::Keep => "keep common",
            MenuItem::PutAway => "put away",
            MenuItem::Ball => "ball",
            MenuItem::Box => "box",
            MenuItem::Cylinder => "cylinder",
            MenuItem::Undo => "undo",
            MenuItem::Redo => "redo",
            MenuItem::PickUp => "pick up",
        }
    }
}

/// Position of the lowest ball, in mm from the tracker: left of the work, within good Leap range.
const FIRST_MM: Vec3 = Vec3::new(-165.0, 110.0, 0.0);
/// From ball to ball, and a ball's radius, mm: a fingertip drifts by up to 15 mm while it dwells.
const STEP_MM: f32 = 48.0;
/// The radius of a ball, mm.
pub const RADIUS_MM: f32 = 20.0;

/// Returns the centre of the `i`th ball, in the tracker's mm.
pub fn ball_mm(i: usize) -> Vec3 {
    FIRST_MM + Vec3::Y * (STEP_MM * i as f32)
}

/// Ball that a fingertip is in, and how far its ring has closed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Menu {
    over: Option<(usize, u64)>,
    /// A choice was just made: the finger must leave before it can choose again.
    spent: bool,
    ring: f32,
}

impl Menu {
    /// Returns the choices for a hand that holds an object, or for an empty one.
    pub fn choices(holding: bool) -> &'static [MenuItem] {
        if holding { &MenuItem::HOLDING } else { &MenuItem::EMPTY }
    }

    /// The ball that a fingertip is in, and 0 to 1 how far its ring has closed.
    pub fn showing(&self) -> Option<(usize, f32)> {
        self.over.map(|(i, _)| (i, self.ring))
    }

    /// Takes where a pointing fingertip is, if there is one.
    pub fn take(
        &mut self,
        tip_mm: Option<Vec3>,
        t_us: u64,
        holding: bool,
        s: &HandSettings,
    ) -> Option<MenuItem> {
        let choices = Menu::choices(holding);
        let inside = |i: &usize, slack: f32| {
            tip_mm.is_some_and(|p| p.distance(ball_mm(*i)) < RADIUS_MM + slack)
        };
        let kept = self.over.map(|(i, _)| i).filter(|i| *i < choices.len() && inside(i, 4.0));
        let now = kept.or_else(|| (0..choices.len()).find(|i| inside(i, 0.0)));
        let Some(i) = now else {
            *self = Menu::default();
            return None;
        };
        let since = match self.over {
            Some((before, since)) if before == i => since,
            _ => t_us,
        };
        self.over = Some((i, since));
        let ms = t_us.saturating_sub(since) as f32 * 1e-3;
        self.ring = ((ms - s.dwell_ms) / s.ring_ms.max(1.0)).clamp(0.0, 1.0);
        if self.ring >= 1.0 && !self.spent {
            (self.spent, self.ring) = (true, 0.0);
            return Some(choices[i]);
        }
        if self.spent {
            self.ring = 0.0;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten milliseconds a frame; what was chosen, and when.
    fn watch(path: impl Fn(u64) -> Option<Vec3>, ms: u64) -> Vec<(u64, MenuItem)> {
        let (mut menu, s) = (Menu::default(), HandSettings::default());
        (0..ms / 10)
            .filter_map(|i| menu.take(path(i * 10), i * 10_000, false, &s).map(|c| (i * 10, c)))
            .collect()
    }

    #[test]
    fn a_finger_that_dwells_chooses_once_and_one_that_passes_never() {
        let dwelling = watch(|_| Some(ball_mm(1) + Vec3::new(5.0, -6.0, 3.0)), 4000);
        assert_eq!(dwelling, [(1100, MenuItem::Redo)]);
        let passing = watch(|ms| Some(ball_mm(0) + Vec3::Y * (ms as f32 * 0.1 - 100.0)), 4000);
        assert_eq!(passing, []);
        let away_and_back = watch(|ms| (!(1500..1600).contains(&ms)).then(|| ball_mm(2)), 3000);
        assert_eq!(away_and_back, [(1100, MenuItem::Ball), (2700, MenuItem::Ball)]);
    }
}

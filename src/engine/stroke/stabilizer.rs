//! The stabilizer between the pen and the brush: a lazy rope, and a moving average of reports.

use glam::Vec2;
use serde::{Deserialize, Serialize};

use super::surface::PenPoint;
use sculptd_clay::brush::PathSettings;

/// Pen reports that can be averaged, at most.
const MOST: usize = 64;

/// Smoothing between the pen and the brush.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Stabilizer {
    /// The newest reports, in a ring.
    #[serde(with = "sculptd_devices::long_array")]
    seen: [PenPoint; MOST],
    count: usize,
    next: usize,
    /// Current position of the brush.
    brush: PenPoint,
    newest: PenPoint,
}

impl Default for Stabilizer {
    fn default() -> Self {
        let none = PenPoint::default();
        Stabilizer { seen: [none; MOST], count: 0, next: 0, brush: none, newest: none }
    }
}

impl Stabilizer {
    /// The pen comes down: the brush is where the pen is.
    pub fn begin(&mut self, at: &PenPoint) {
        (self.count, self.next) = (0, 0);
        (self.brush, self.newest) = (*at, *at);
        self.remember(at);
    }

    fn remember(&mut self, at: &PenPoint) {
        self.seen[self.next] = *at;
        self.next = (self.next + 1) % MOST;
        self.count = (self.count + 1).min(MOST);
    }

    /// Returns the position to which a pen at `at` pulls the brush. While the rope is slack, this
    /// is its old position with the pen's pressure. `aspect`: width over height of the view; the
    /// rope is measured in heights.
    pub fn follow(&mut self, at: &PenPoint, path: &PathSettings, aspect: f32) -> PenPoint {
        self.newest = *at;
        self.remember(at);
        let mut goal = *at;
        let n = usize::from(path.average).min(self.count).min(MOST);
        if n > 1 {
            let newest = |k: usize| &self.seen[(self.next + MOST - 1 - k) % MOST];
            let share = 1.0 / n as f32;
            goal.view = (0..n).map(|k| newest(k).view).sum::<Vec2>() * share;
            goal.pressure = (0..n).map(|k| newest(k).pressure).sum::<f32>() * share;
        }
        if path.rope > 0.0 {
            let d = (goal.view - self.brush.view) * Vec2::new(aspect, 1.0);
            let length = d.length();
            goal.view = if length <= path.rope {
                self.brush.view
            } else {
                self.brush.view + (goal.view - self.brush.view) * (1.0 - path.rope / length)
            };
        }
        self.brush = goal;
        goal
    }

    /// Ends the stroke at the lifted pen's last position. Returns `None` if the brush is already at
    /// it.
    pub fn catch_up(&mut self) -> Option<PenPoint> {
        (self.newest.view != self.brush.view).then_some(self.newest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32, y: f32) -> PenPoint {
        PenPoint { view: Vec2::new(x, y), pressure: 0.5, tilt: None, inverted: false }
    }

    #[test]
    fn a_rope_keeps_its_length_moves_nothing_while_loose_and_ends_at_the_pen() {
        let path = PathSettings { rope: 0.1, ..PathSettings::default() };
        let mut steady = Stabilizer::default();
        steady.begin(&at(0.2, 0.5));
        assert_eq!(steady.follow(&at(0.25, 0.5), &path, 1.0).view, at(0.2, 0.5).view);
        let mut last = at(0.2, 0.5);
        for i in 0..50 {
            let pen = at(0.3 + 0.01 * i as f32, 0.5 + 0.05 * (i as f32 * 0.5).sin());
            let b = steady.follow(&pen, &path, 1.0);
            let length = (b.view - pen.view).length();
            assert!(length < 0.1 + 1e-6 && (length > 0.1 - 1e-6 || b.view == last.view));
            last = b;
        }
        assert!(last.view.x > 0.65);
        assert!((steady.catch_up().expect("it lags").view.x - 0.79).abs() < 1e-6);
    }

    #[test]
    fn an_average_lies_amid_what_it_averages_and_ends_where_the_pen_did() {
        let path = PathSettings { average: 8, ..PathSettings::default() };
        let mut steady = Stabilizer::default();
        steady.begin(&at(0.0, 0.5));
        for i in 1..=40 {
            // A tremble about a straight line, from report to report: the average of eight has none
            // of it.
            let wobble = if i % 2 == 0 { 0.01 } else { -0.01 };
            let b = steady.follow(&at(i as f32 * 0.01, 0.5 + wobble), &path, 1.6);
            if i >= 8 {
                assert!(
                    (b.view.y - 0.5).abs() < 1e-6
                        && (b.view.x - (i as f32 - 3.5) * 0.01).abs() < 1e-5
                );
            }
        }
        assert!((steady.catch_up().expect("it lags").view.x - 0.4).abs() < 1e-6);
    }
}

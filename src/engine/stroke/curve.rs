//! A fair curve through a hand's path: one cubic Bezier from where the pen came down to where it
//! lifts, as near as least squares bring it to all that was drawn between (Schneider 1990, "An
//! algorithm for automatically fitting digitized curves", without its corners: one piece, ends
//! held, parameters mended by Newton's step).

use glam::{DVec2, Vec2};
use serde::{Deserialize, Serialize};

use super::surface::PenPoint;

/// Points of a path that are kept; beyond them every second one is let go.
const MOST: usize = 256;
/// Rounds of fitting and of mending parameters.
const ROUNDS: usize = 6;
/// A path while it is drawn, and the curve afterwards.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Curve {
    path: Vec<PenPoint>,
    /// Position of each point on the curve, 0 to 1.
    at: Vec<f64>,
    control: [DVec2; 4],
    /// One in so many reports is kept.
    every: u32,
    skipped: u32,
    newest: PenPoint,
}

impl Default for Curve {
    fn default() -> Self {
        Curve {
            path: Vec::with_capacity(MOST),
            at: Vec::with_capacity(MOST),
            control: [DVec2::ZERO; 4],
            every: 1,
            skipped: 0,
            newest: PenPoint::default(),
        }
    }
}

impl Curve {
    /// The pen comes down.
    pub fn begin(&mut self, at: &PenPoint) {
        self.path.clear();
        (self.every, self.skipped, self.newest) = (1, 0, *at);
        self.path.push(*at);
    }

    /// And moves.
    pub fn take(&mut self, at: &PenPoint) {
        self.newest = *at;
        self.skipped += 1;
        if self.skipped < self.every {
            return;
        }
        self.skipped = 0;
        // One place is kept free for the end.
        if self.path.len() + 1 >= MOST {
            let mut keep = false;
            self.path.retain(|_| {
                keep = !keep;
                keep
            });
            self.every = self.every.saturating_mul(2);
        }
        self.path.push(*at);
    }

    /// The pen lifts: the curve is laid. `aspect`: width over height of the view.
    pub fn end(&mut self, aspect: f32) {
        if self.path.last() != Some(&self.newest) {
            self.path.push(self.newest);
        }
        let place = |p: &PenPoint| (p.view * Vec2::new(aspect, 1.0)).as_dvec2();
        // By the length of the path so far.
        self.at.clear();
        let mut length = 0.0;
        for (i, p) in self.path.iter().enumerate() {
            length += if i > 0 { place(p).distance(place(&self.path[i - 1])) } else { 0.0 };
            self.at.push(length);
        }
        if length > 0.0 {
            self.at.iter_mut().for_each(|t| *t /= length);
        }
        let (first, last) = (place(&self.path[0]), place(&self.newest));
        self.control = [first, first.lerp(last, 1.0 / 3.0), first.lerp(last, 2.0 / 3.0), last];
        for _ in 0..ROUNDS {
            self.fit(place);
            self.close_gaps(place);
        }
        self.control.iter_mut().for_each(|p| p.x /= f64::from(aspect));
    }

    /// The inner control points that bring the curve nearest to the path, its parameters given.
    fn fit(&mut self, place: impl Fn(&PenPoint) -> DVec2) {
        let [a, _, _, d] = self.control;
        let (mut m11, mut m12, mut m22) = (0.0, 0.0, 0.0);
        let (mut r1, mut r2) = (DVec2::ZERO, DVec2::ZERO);
        for (p, &t) in self.path.iter().zip(&self.at) {
            let s = 1.0 - t;
            let (b1, b2) = (3.0 * s * s * t, 3.0 * s * t * t);
            let rest = place(p) - a * (s * s * s) - d * (t * t * t);
            m11 += b1 * b1;
            m12 += b1 * b2;
            m22 += b2 * b2;
            r1 += rest * b1;
            r2 += rest * b2;
        }
        let det = m11 * m22 - m12 * m12;
        if det > 1e-9 * m11 * m22 {
            self.control[1] = (r1 * m22 - r2 * m12) / det;
            self.control[2] = (r2 * m11 - r1 * m12) / det;
        }
    }

    /// Each point's parameter a Newton step nearer to the foot of its perpendicular; never out of
    /// order.
    fn close_gaps(&mut self, place: impl Fn(&PenPoint) -> DVec2) {
        let [a, b, c, d] = self.control;
        let mut before = 0.0;
        for (p, t) in self.path.iter().zip(&mut self.at) {
            let s = 1.0 - *t;
            let off = bezier(&self.control, *t) - place(p);
            let slope = ((b - a) * (s * s) + (c - b) * (2.0 * s * *t) + (d - c) * (*t * *t)) * 3.0;
            let bend = ((c - b * 2.0 + a) * s + (d - c * 2.0 + b) * *t) * 6.0;
            let down = slope.length_squared() + off.dot(bend);
            if down > 1e-12 {
                *t = (*t - off.dot(slope) / down).clamp(before, 1.0);
            }
            before = *t;
        }
    }

    /// The pen at a share of the curve, 0 to 1: pressure and tilt as where the path was nearest.
    pub fn point(&self, t: f32) -> PenPoint {
        let (last, t) = (self.path.len() - 1, f64::from(t));
        let k = self.at.partition_point(|&a| a < t).clamp(1.min(last), last);
        let from = k.saturating_sub(1);
        let (lo, hi) = (self.at[from], self.at[k]);
        let share = if hi > lo { ((t - lo) / (hi - lo)).clamp(0.0, 1.0) as f32 } else { 1.0 };
        let pen = self.path[from].lerp(&self.path[k], share);
        PenPoint { view: bezier(&self.control, t).as_vec2(), ..pen }
    }
}

fn bezier([a, b, c, d]: &[DVec2; 4], t: f64) -> DVec2 {
    let s = 1.0 - t;
    *a * (s * s * s) + *b * (3.0 * s * s * t) + *c * (3.0 * s * t * t) + *d * (t * t * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32, y: f32) -> PenPoint {
        PenPoint { view: Vec2::new(x, y), pressure: x, tilt: None, inverted: false }
    }

    #[test]
    fn a_trembling_arc_becomes_a_fair_one_with_its_ends_held() {
        let mut curve = Curve::default();
        let arc = |i: usize| {
            let a = i as f32 / 999.0 * 1.4;
            Vec2::new(0.2 + 0.5 * a.sin(), 0.2 + 0.5 * (1.0 - a.cos()))
        };
        curve.begin(&at(arc(0).x, arc(0).y));
        for i in 1..1000 {
            let tremble = if i == 999 { 0.0 } else { 0.01 * ((i * 7919 % 13) as f32 / 6.0 - 1.0) };
            curve.take(&at(arc(i).x + tremble, arc(i).y - tremble));
        }
        curve.end(1.6);
        assert!((curve.point(0.0).view - arc(0)).length() < 1e-6);
        assert!((curve.point(1.0).view - arc(999)).length() < 1e-6);
        for k in 0..=64 {
            let p = curve.point(k as f32 / 64.0);
            let off = ((p.view - Vec2::new(0.2, 0.7)).length() - 0.5).abs();
            assert!(off < 0.004, "{off} off the arc at {k}");
            assert!((p.pressure - p.view.x).abs() < 0.05, "pressure goes along");
        }
    }

    #[test]
    fn a_point_and_a_line_are_curves_too() {
        let mut curve = Curve::default();
        curve.begin(&at(0.3, 0.4));
        curve.end(1.6);
        assert!((curve.point(0.5).view - Vec2::new(0.3, 0.4)).length() < 1e-6);
        curve.begin(&at(0.0, 0.0));
        curve.take(&at(1.0, 0.5));
        curve.end(1.6);
        assert!((curve.point(0.5).view - Vec2::new(0.5, 0.25)).length() < 1e-6);
    }
}

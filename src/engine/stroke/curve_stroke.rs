//! A curve that is laid by its points before it is drawn: handles over the view, to be dragged,
//! added to and taken away, until the curve is applied or put away.
//!
//! The curve passes through every handle (Catmull and Rom 1974, centripetal as Barry and Goldman
//! 1988 have it: it has no loops or cusps between handles, however unevenly they are laid).
//! Pressure and tilt go from handle to handle in a straight line.

use glam::Vec2;
use serde::{Deserialize, Serialize};

use super::curve::Curve;
use super::surface::PenPoint;
use sculptd_geometry::portable::PortableMath;

/// Handles of one curve at most.
pub const MOST: usize = 64;
/// Straight pieces from handle to handle that the curve is walked in.
pub const PIECES: usize = 16;
/// A pen this near to a handle takes hold of it, and nearly this near to the curve puts a new one
/// on it; heights of the view.
pub const REACH: f32 = 0.018;
/// Handles made of what was drawn freely, its ends counted.
const FREE: usize = 5;
/// A pen that moved less between coming down and lifting, in heights of the view, only set a point.
const SLIP: f32 = 0.01;

/// Actions on a curve that is being edited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CurveAction {
    /// Draws the active brush along it, as one stroke.
    Apply,
    /// It is put away.
    Cancel,
    /// The handle of this number is taken away.
    Delete(usize),
}

/// A curve by its handles, in their order.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CurveStroke {
    points: Vec<PenPoint>,
    held: Option<usize>,
}

impl CurveStroke {
    /// The handles, in the order in which they were laid.
    pub fn points(&self) -> &[PenPoint] {
        &self.points
    }

    /// Returns true if the curve has no handles.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Returns the index of the handle that the pen holds.
    pub fn held(&self) -> Option<usize> {
        self.held
    }

    /// Takes all handles away.
    pub fn clear(&mut self) {
        self.points.clear();
        self.held = None;
    }

    /// The handle within reach of a place, the nearest. `aspect`: width over height of the view.
    pub fn handle_at(&self, view: Vec2, aspect: f32) -> Option<usize> {
        let off = |p: &PenPoint| length(p.view - view, aspect);
        let near = (0..self.points.len())
            .min_by(|a, b| off(&self.points[*a]).total_cmp(&off(&self.points[*b])));
        near.filter(|i| off(&self.points[*i]) <= REACH)
    }

    /// The pen comes down: it takes hold of a handle, or puts one on the curve, or one more at the
    /// end that is nearer, and holds that. Where there are as many as there may be, it takes hold
    /// of the nearest.
    pub fn grab(&mut self, at: &PenPoint, aspect: f32) {
        self.held = self.handle_at(at.view, aspect).or_else(|| {
            if self.points.len() >= MOST {
                let off = |p: &PenPoint| length(p.view - at.view, aspect);
                let all = 0..self.points.len();
                return all.min_by(|a, b| off(&self.points[*a]).total_cmp(&off(&self.points[*b])));
            }
            let place =
                match (self.span_at(at.view, aspect), self.points.first(), self.points.last()) {
                    (Some(span), ..) => span + 1,
                    (None, Some(first), Some(last))
                        if self.points.len() > 1
                            && length(first.view - at.view, aspect)
                                < length(last.view - at.view, aspect) =>
                    {
                        0
                    }
                    _ => self.points.len(),
                };
            self.points.insert(place, *at);
            Some(place)
        });
    }

    /// The pen moves: the handle goes along.
    pub fn drag(&mut self, to: &PenPoint) {
        if let Some(point) = self.held.and_then(|i| self.points.get_mut(i)) {
            point.view = to.view;
        }
    }

    /// The pen lifts.
    pub fn release(&mut self) {
        self.held = None;
    }

    /// A handle is taken away; one that is not there is no matter.
    pub fn delete(&mut self, index: usize) {
        if index < self.points.len() {
            self.points.remove(index);
            self.held = None;
        }
    }

    /// Handles on what was drawn freely: a few, or one where the pen hardly moved.
    pub fn fit_handles(&mut self, drawn: &Curve, aspect: f32) {
        self.clear();
        let (start, end) = (drawn.point(0.0), drawn.point(1.0));
        let way: f32 = (1..=8)
            .map(|k| drawn.point(k as f32 / 8.0).view - drawn.point((k - 1) as f32 / 8.0).view)
            .map(|d| length(d, aspect))
            .sum();
        if way < SLIP {
            self.points.push(start);
            return;
        }
        self.points.extend((0..FREE - 1).map(|k| drawn.point(k as f32 / (FREE - 1) as f32)));
        self.points.push(end);
    }

    /// The span of the curve that passes within reach of a place.
    fn span_at(&self, view: Vec2, aspect: f32) -> Option<usize> {
        let pieces = (0..self.pieces()).map(|k| {
            let (a, b) = (self.at(k, aspect).view - view, self.at(k + 1, aspect).view - view);
            let (a, b) = (a * Vec2::new(aspect, 1.0), b * Vec2::new(aspect, 1.0));
            let t = (-a.dot(b - a) / (b - a).length_squared().max(1e-20)).clamp(0.0, 1.0);
            (a.lerp(b, t).length(), k / PIECES)
        });
        pieces
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(off, _)| *off <= REACH * 0.8)
            .map(|(_, span)| span)
    }

    /// Straight pieces of the whole curve; none of a single point.
    pub fn pieces(&self) -> usize {
        self.points.len().saturating_sub(1) * PIECES
    }

    /// The pen after `k` pieces of the curve; at its end for what is beyond, and as it is by
    /// default on a curve of no handles.
    pub fn at(&self, k: usize, aspect: f32) -> PenPoint {
        let Some(last) = self.points.last() else { return PenPoint::default() };
        let (span, t) = (k / PIECES, (k % PIECES) as f32 / PIECES as f32);
        let (Some(b), Some(c)) = (self.points.get(span), self.points.get(span + 1)) else {
            return *last;
        };
        if t == 0.0 {
            return *b;
        }
        // Beyond the ends the curve would go on as it came.
        let before = span.checked_sub(1).map_or(b.view * 2.0 - c.view, |i| self.points[i].view);
        let after = self.points.get(span + 2).map_or(c.view * 2.0 - b.view, |p| p.view);
        PenPoint { view: through([before, b.view, c.view, after], t, aspect), ..b.lerp(c, t) }
    }
}

fn length(d: Vec2, aspect: f32) -> f32 {
    (d.x * aspect).portable_hypot(d.y)
}

/// Between the middle two of four points, by Barry and Goldman's pyramid with knots a square root
/// of the distance apart.
fn through(p: [Vec2; 4], t: f32, aspect: f32) -> Vec2 {
    let knot = |a: Vec2, b: Vec2| length(b - a, aspect).sqrt().max(1e-4);
    let t0 = 0.0;
    let t1 = t0 + knot(p[0], p[1]);
    let t2 = t1 + knot(p[1], p[2]);
    let t3 = t2 + knot(p[2], p[3]);
    let t = t1 + (t2 - t1) * t;
    let mix = |a: Vec2, b: Vec2, from: f32, to: f32| a.lerp(b, (t - from) / (to - from));
    let (a, b, c) = (mix(p[0], p[1], t0, t1), mix(p[1], p[2], t1, t2), mix(p[2], p[3], t2, t3));
    mix(mix(a, b, t0, t2), mix(b, c, t1, t3), t1, t2)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASPECT: f32 = 1.6;

    fn at(x: f32, y: f32) -> PenPoint {
        PenPoint { view: Vec2::new(x, y), pressure: x, tilt: None, inverted: false }
    }

    fn laid(points: &[(f32, f32)]) -> CurveStroke {
        let mut draft = CurveStroke::default();
        for &(x, y) in points {
            draft.grab(&at(x, y), ASPECT);
            draft.release();
        }
        draft
    }

    #[test]
    fn points_laid_one_after_the_other_are_passed_through_in_order() {
        let draft = laid(&[(0.2, 0.5), (0.4, 0.3), (0.6, 0.6), (0.8, 0.5)]);
        assert_eq!(draft.pieces(), 3 * PIECES);
        for (i, p) in draft.points().iter().enumerate() {
            assert_eq!(draft.at(i * PIECES, ASPECT).view, p.view);
        }
        // Fair: no corner of more than a few degrees between pieces.
        for k in 1..draft.pieces() {
            let (a, b, c) = (
                draft.at(k - 1, ASPECT).view,
                draft.at(k, ASPECT).view,
                draft.at(k + 1, ASPECT).view,
            );
            assert!((b - a).angle_to(c - b).abs() < 0.45, "a corner at {k}");
        }
        assert!((draft.at(PIECES / 2, ASPECT).pressure - 0.3).abs() < 1e-6);
    }

    #[test]
    fn a_handle_is_dragged_one_is_put_on_the_curve_and_one_taken_away() {
        let mut draft = laid(&[(0.2, 0.5), (0.5, 0.5), (0.8, 0.5)]);
        draft.grab(&at(0.503, 0.51), ASPECT);
        assert_eq!((draft.held(), draft.points().len()), (Some(1), 3));
        draft.drag(&at(0.5, 0.3));
        draft.release();
        assert_eq!(draft.points()[1].view, Vec2::new(0.5, 0.3));
        // On the curve, off any handle: between its neighbours.
        let on = draft.at(PIECES + PIECES / 2, ASPECT);
        draft.grab(&on, ASPECT);
        assert_eq!((draft.held(), draft.points().len()), (Some(2), 4));
        draft.release();
        // Off the curve: at the nearer end.
        draft.grab(&at(0.1, 0.7), ASPECT);
        assert_eq!((draft.held(), draft.points().len()), (Some(0), 5));
        draft.delete(0);
        draft.delete(99);
        assert_eq!((draft.held(), draft.points().len(), draft.points()[0].view.x), (None, 4, 0.2));
        draft.clear();
        assert_eq!((draft.pieces(), draft.at(0, ASPECT)), (0, PenPoint::default()));
    }

    #[test]
    fn there_are_never_too_many() {
        let mut draft = CurveStroke::default();
        for i in 0..200 {
            draft.grab(&at((i * 37 % 200) as f32 / 200.0, (i * 61 % 200) as f32 / 200.0), ASPECT);
            draft.release();
        }
        assert!(draft.points().len() <= MOST && draft.points().len() > 30);
    }

    #[test]
    fn what_is_drawn_freely_becomes_a_few_handles_and_a_touch_becomes_one() {
        let mut drawn = Curve::default();
        drawn.begin(&at(0.2, 0.5));
        for i in 1..=40 {
            let t = i as f32 / 40.0;
            drawn.take(&at(0.2 + 0.6 * t, 0.5 - 0.2 * (t * 3.0).sin()));
        }
        drawn.end(ASPECT);
        let mut draft = CurveStroke::default();
        draft.fit_handles(&drawn, ASPECT);
        assert_eq!(draft.points().len(), FREE);
        for k in 0..=draft.pieces() {
            let p = draft.at(k, ASPECT).view;
            let off = (p.y - (0.5 - 0.2 * ((p.x - 0.2) / 0.6 * 3.0).sin())).abs();
            assert!(off < 0.01, "{off} off what was drawn");
        }
        drawn.begin(&at(0.3, 0.3));
        drawn.take(&at(0.301, 0.3));
        drawn.end(ASPECT);
        draft.fit_handles(&drawn, ASPECT);
        assert_eq!(draft.points().len(), 1);
    }
}

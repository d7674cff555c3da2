//! One pen's visit to the surface, as a bounded queue of path points that the world walks within
//! its budget.

use std::collections::VecDeque;

use glam::Vec2;
use serde::{Deserialize, Serialize};

use super::curve::Curve;
use super::spacer::Spacer;
use super::surface::{Flow, PenPoint, StrokeMethod, Surface};
use crate::desktop_layout::{DesktopLayout, PenPlace};
use crate::stroke::curve_stroke::CurveStroke;
use crate::stroke::stabilizer::Stabilizer;
use sculptd_clay::brush::{BrushSettings, Method};
use sculptd_devices::{Pen, Tool};
use sculptd_geometry::portable::PortableMath;

/// Path points waiting to be walked, a pen. At 1,000 reports a second two seconds of arrears;
/// beyond that the newest motion replaces the one before it (the path is cut short between two
/// points, never broken).
const MAX_WAITING: usize = 2048;

/// Meaning of a pen sample for a stroke.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum PenEvent {
    /// The tip touches.
    Down(PenPoint),
    /// The tip moves while it touches.
    Move(PenPoint),
    /// The tip is lifted.
    Up,
    /// The curve that is being laid is drawn.
    Draw,
}

/// A pen's stroke between its samples and its dabs.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PenTrack {
    waiting: VecDeque<PenEvent>,
    steady: Stabilizer,
    /// Point at which the pen came down: start of a straight line.
    start: PenPoint,
    /// The line from there, or the curve, is being drawn; so many pieces of it are done.
    drawing: bool,
    pieces: usize,
    /// The freehand path, and the curve fitted to it.
    curve: Curve,
    draft: CurveStroke,
    laying: Laying,
    spacer: Spacer,
    /// State of the walk: the point reached, and the share of the segment to the first waiting
    /// point.
    from: PenPoint,
    share: f32,
    /// The pen is down as its samples tell.
    down: bool,
    /// A stroke is open as its dabs tell: it lags behind `down` by what is waiting.
    open: bool,
    /// The last hover or contact, for the cursor.
    pub seen: Option<PenPoint>,
    /// Motion merged because the queue was full.
    pub merged: u64,
    /// Length of the string by which the brush follows the pen, in heights of the view.
    #[serde(default)]
    string: f32,
    /// Position of the pen while the brush follows it by the string.
    #[serde(default)]
    pen: Option<PenPoint>,
    /// Position of the pen on its tablet while in range: shares of the tablet's area.
    #[serde(default)]
    pub on_tablet: Option<Vec2>,
    /// The pen came down where no stroke may begin: it does nothing until it is lifted.
    #[serde(default)]
    refused: bool,
    /// Point of the stroke with the greatest pressure.
    #[serde(default)]
    firmest: PenPoint,
    /// Brushes of the contacts that are not walked to their end yet, oldest first: a stroke keeps
    /// the brush that it began with. Empty when a world is saved, which has no open stroke.
    #[serde(skip)]
    brushes: VecDeque<BrushSettings>,
}

/// Contacts whose brushes fit without an allocation.
const CONTACTS: usize = 8;

impl Default for PenTrack {
    fn default() -> Self {
        PenTrack {
            waiting: VecDeque::with_capacity(MAX_WAITING),
            steady: Stabilizer::default(),
            start: PenPoint::default(),
            drawing: false,
            pieces: 0,
            curve: Curve::default(),
            draft: CurveStroke::default(),
            laying: Laying::No,
            spacer: Spacer::default(),
            from: PenPoint::default(),
            share: 0.0,
            down: false,
            open: false,
            seen: None,
            merged: 0,
            string: 0.0,
            pen: None,
            on_tablet: None,
            refused: false,
            firmest: PenPoint::default(),
            brushes: VecDeque::with_capacity(CONTACTS),
        }
    }
}

/// Effect of a pressed pen on a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Laying {
    No,
    /// It draws freely, and handles are fitted to the path.
    Free,
    /// It holds a handle.
    Handle,
}

/// Changes to the stroke made by walking.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Walked {
    /// A stroke began.
    pub began: bool,
    /// The stroke ended.
    pub ended: bool,
    /// The budget of this tick is spent; the rest is walked in the next one.
    pub paused: bool,
}

impl PenTrack {
    /// Takes one pen sample of a tablet whose place on the desktop is `place`.
    pub fn take(
        &mut self,
        pen: &Pen,
        brush: &BrushSettings,
        aspect: f32,
        (desktop, place): (&DesktopLayout, Option<PenPlace>),
    ) {
        let share = pen.pos_mm / pen.area_mm.max(Vec2::splat(1e-3));
        let at = PenPoint {
            view: place.unwrap_or_default().view(share),
            pressure: pen.pressure.unwrap_or(1.0),
            tilt: pen.tilt,
            inverted: pen.tool == Tool::Eraser,
        };
        let mut touches = pen.tip && pen.in_range;
        let free = desktop.is_free(place, at.view);
        self.refused = touches && !self.down && (self.refused || !free);
        touches &= !self.refused;
        self.on_tablet = pen.in_range.then_some(share);
        // A pen that can do nothing is the desktop's pointer and has no ring.
        self.seen = (pen.in_range && (touches || free && !self.refused)).then_some(at);
        match (self.down, touches) {
            (false, true) => {
                self.steady.begin(&at);
                self.brushes.push_back(*brush);
                self.push(PenEvent::Down(at));
            }
            (true, true) => {
                let path = self.brushes.back().unwrap_or(brush).path;
                let at = self.steady.follow(&at, &path, aspect);
                self.push(PenEvent::Move(at));
            }
            (true, false) => self.up(),
            (false, false) => {}
        }
        self.down = touches;
    }

    fn up(&mut self) {
        if let Some(end) = self.steady.catch_up() {
            self.push(PenEvent::Move(end));
        }
        self.push(PenEvent::Up);
    }

    /// The pen is gone, without a word: the stroke ends as a lifted pen.
    pub fn lift(&mut self) {
        if self.down {
            self.up();
            self.down = false;
        }
        (self.seen, self.on_tablet) = (None, None);
    }

    fn push(&mut self, event: PenEvent) {
        if self.waiting.len() >= MAX_WAITING {
            if let (Some(PenEvent::Move(last)), PenEvent::Move(at)) =
                (self.waiting.back_mut(), event)
            {
                *last = at;
                self.merged += 1;
                return;
            }
            // A full queue that ends in a transition: room is made by dropping the oldest motion.
            if let Some(i) = self.waiting.iter().position(|e| matches!(e, PenEvent::Move(_))) {
                self.waiting.remove(i);
                self.merged += 1;
            }
        }
        self.waiting.push_back(event);
    }

    /// Returns true while a stroke is under way.
    pub fn is_open(&self) -> bool {
        self.open
    }

    /// Returns true if the next waiting event begins a stroke.
    pub fn begins(&self) -> bool {
        match self.waiting.front() {
            Some(PenEvent::Down(_)) => true,
            Some(PenEvent::Draw) => !self.drawing,
            _ => false,
        }
    }

    /// Returns the brush of what is walked next: the one that its stroke began with, or `now` for
    /// a curve, which follows the settings until it is drawn.
    pub fn brush<'a>(&'a self, now: &'a BrushSettings) -> &'a BrushSettings {
        let draws = self.waiting.front() == Some(&PenEvent::Draw);
        let kept = self.brushes.front().filter(|b| !draws && b.path.method != Method::Curve);
        kept.unwrap_or(now)
    }

    /// The curve that is being laid; empty: none is.
    pub fn curve_stroke(&self) -> &CurveStroke {
        &self.draft
    }

    /// The curve is drawn, once all that waits is done.
    pub fn apply(&mut self) {
        if !self.draft.is_empty() && self.waiting.back() != Some(&PenEvent::Draw) {
            self.push(PenEvent::Draw);
        }
    }

    /// The curve is put away, if it is not being drawn already. False: there is none.
    pub fn cancel(&mut self) -> bool {
        let there = !self.draft.is_empty() && !self.is_drawn();
        if there {
            self.draft.clear();
        }
        self.laying = Laying::No;
        there
    }

    /// A handle of the curve is taken away. False: there is none.
    pub fn delete(&mut self, handle: usize) -> bool {
        let there = handle < self.draft.points().len() && !self.is_drawn();
        if there {
            self.draft.delete(handle);
        }
        there
    }

    fn is_drawn(&self) -> bool {
        self.waiting.contains(&PenEvent::Draw)
    }

    /// Returns true if no event waits to be walked.
    pub fn is_idle(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Returns true if the pen is out of range and nothing of its strokes is left to do.
    pub fn is_away(&self) -> bool {
        let quiet = !self.open && self.waiting.is_empty() && self.draft.is_empty();
        quiet && self.seen.is_none() && self.on_tablet.is_none()
    }

    /// Walks one waiting event over the surface; returns `None` if there is none.
    pub fn walk_one(&mut self, aspect: f32, on: &mut dyn Surface) -> Option<Walked> {
        let event = *self.waiting.front()?;
        let mut walked = Walked::default();
        let flow = match event {
            PenEvent::Down(at) if on.way() == StrokeMethod::Curve => {
                self.from = at;
                if self.draft.is_empty() {
                    self.curve.begin(&at);
                    self.laying = Laying::Free;
                } else {
                    self.draft.grab(&at, aspect);
                    self.laying = Laying::Handle;
                }
                Flow::Go
            }
            PenEvent::Move(to) if self.laying != Laying::No => {
                match self.laying {
                    Laying::Free => self.curve.take(&to),
                    _ => self.draft.drag(&to),
                }
                self.from = to;
                Flow::Go
            }
            PenEvent::Up if self.laying != Laying::No => {
                if self.laying == Laying::Free {
                    self.curve.end(aspect);
                    self.draft.fit_handles(&self.curve, aspect);
                }
                self.draft.release();
                self.laying = Laying::No;
                Flow::Go
            }
            PenEvent::Draw => {
                walked.began = !self.open;
                self.open = true;
                if !self.draw_curve(aspect, on) {
                    walked.paused = true;
                    return Some(walked);
                }
                self.draft.clear();
                (walked.ended, self.open, self.drawing) = (true, false, false);
                Flow::Go
            }
            PenEvent::Down(at) => {
                walked.began = !self.open;
                self.open = true;
                self.spacer = Spacer::new(aspect);
                (self.from, self.start, self.drawing) = (at, at, false);
                self.string = on.string(&at);
                (self.pen, self.firmest) = (None, at);
                match on.way() {
                    StrokeMethod::Spaced | StrokeMethod::Each => self.spacer.begin(&at, on),
                    StrokeMethod::Held => on.hold(&at, true),
                    StrokeMethod::Line | StrokeMethod::Curve => Flow::Go,
                }
            }
            // Its curve was put away while it was down.
            PenEvent::Move(to) if !self.open => {
                self.from = to;
                Flow::Go
            }
            PenEvent::Move(to) => {
                if to.pressure > self.firmest.pressure {
                    self.firmest = to;
                }
                let pen = to;
                let to = match on.way() {
                    StrokeMethod::Spaced => self.pull(&pen, aspect),
                    _ => to,
                };
                let flow = match on.way() {
                    StrokeMethod::Spaced => {
                        self.share = self.spacer.advance(&self.from, &to, self.share, on);
                        if self.share < 1.0 {
                            walked.paused = true;
                            return Some(walked);
                        }
                        self.pen = (self.string > 0.0).then_some(pen);
                        Flow::Go
                    }
                    StrokeMethod::Each => self.spacer.begin(&to, on),
                    // Only where it is now matters: what came between is passed over.
                    StrokeMethod::Held
                        if matches!(self.waiting.get(1), Some(PenEvent::Move(_))) =>
                    {
                        Flow::Go
                    }
                    StrokeMethod::Held => on.hold(&to, false),
                    StrokeMethod::Line | StrokeMethod::Curve => Flow::Go,
                };
                self.from = to;
                flow
            }
            PenEvent::Up => {
                let flow = match on.way() {
                    StrokeMethod::Spaced if self.open => {
                        // The string is drawn in: the brush comes to where the pen was lifted.
                        let end = self.pen.unwrap_or(self.from);
                        self.share = self.spacer.advance(&self.from, &end, self.share, on);
                        if self.share < 1.0 {
                            walked.paused = true;
                            return Some(walked);
                        }
                        (self.pen, self.from) = (None, end);
                        self.spacer.finish(&end, &self.firmest, on)
                    }
                    StrokeMethod::Line if self.open => {
                        if !self.draw_line(on) {
                            walked.paused = true;
                            return Some(walked);
                        }
                        self.spacer.finish(&self.from, &self.firmest, on)
                    }
                    _ => Flow::Go,
                };
                walked.ended = self.open;
                (self.open, self.drawing) = (false, false);
                flow
            }
        };
        walked.paused = flow == Flow::Pause;
        self.share = 0.0;
        if self.waiting.pop_front() == Some(PenEvent::Up) {
            self.brushes.pop_front();
        }
        Some(walked)
    }

    /// Returns the position to which a pen at `to` pulls the brush by its string.
    fn pull(&self, to: &PenPoint, aspect: f32) -> PenPoint {
        if self.string <= 0.0 {
            return *to;
        }
        let scale = Vec2::new(aspect, 1.0);
        let (pen, brush) = (self.pen.unwrap_or(self.from).view * scale, self.from.view * scale);
        let place = towed(brush, pen, to.view * scale, self.string);
        PenPoint { view: if place == brush { self.from.view } else { place / scale }, ..*to }
    }

    /// Draws the line that waited for the pen to lift, as firmly as the pen was pressed at most: a
    /// pen touches down and lifts at nearly no pressure. False: there is more of it, for the next
    /// tick.
    fn draw_line(&mut self, on: &mut dyn Surface) -> bool {
        if !self.drawing {
            let pressure = self.firmest.pressure;
            (self.start.pressure, self.from.pressure) = (pressure, pressure);
            (self.drawing, self.share) = (true, 0.0);
            self.spacer.begin(&self.start, on);
        }
        self.share = self.spacer.advance(&self.start, &self.from, self.share, on);
        self.share >= 1.0
    }

    /// Draws the curve that was laid. False: there is more of it, for the next tick.
    fn draw_curve(&mut self, aspect: f32, on: &mut dyn Surface) -> bool {
        if !self.drawing {
            (self.drawing, self.pieces, self.share) = (true, 0, 0.0);
            self.spacer = Spacer::new(aspect);
            self.from = self.draft.at(0, aspect);
            self.spacer.begin(&self.from, on);
        }
        while self.pieces < self.draft.pieces() {
            let (from, to) =
                (self.draft.at(self.pieces, aspect), self.draft.at(self.pieces + 1, aspect));
            self.share = self.spacer.advance(&from, &to, self.share, on);
            if self.share < 1.0 {
                return false;
            }
            (self.share, self.from) = (0.0, to);
            self.pieces += 1;
        }
        self.spacer.finish(&self.from, &self.from, on);
        true
    }

    /// One more dab where the pen rests. The stroke goes on from it as from any other.
    pub fn rest(&mut self, on: &mut dyn Surface) {
        let at = self.from;
        self.spacer.rest(&at, on);
    }
}

/// Returns the position to which a string of this length pulls the brush while the pen goes
/// straight from `pen` to `to`. A slack string moves nothing. A taut one draws the brush along a
/// tractrix, so that the number of reports along a path does not matter: with the angle `a` between
/// string and path, `tan(a / 2)` falls by `e` over the string's length. The path of a trembling
/// hand is drawn straight.
fn towed(brush: Vec2, pen: Vec2, to: Vec2, string: f32) -> Vec2 {
    let length = pen.distance(to);
    let hangs = pen - brush;
    if !(length > 0.0) {
        return brush;
    }
    let way = (to - pen) / length;
    let ahead = hangs.dot(way);
    let loose = (ahead * ahead + string * string - hangs.length_squared()).max(0.0).sqrt() - ahead;
    let drawn = length - loose.max(0.0);
    if drawn <= 0.0 {
        return brush;
    }
    let taut = hangs + way * loose.max(0.0);
    let (along, aside) = (taut.dot(way).max(0.0), way.perp_dot(taut));
    let half = aside / (string + along) * (-drawn / string).portable_exp();
    let (cosine, sine) = (1.0 - half * half, 2.0 * half);
    to - (way * cosine + way.perp() * sine) * (string / (1.0 + half * half))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_string_draws_the_brush_alike_in_many_reports_and_in_few() {
        let string = 0.1;
        let corners = [Vec2::ZERO, Vec2::new(0.05, 0.0), Vec2::new(0.3, 0.1), Vec2::new(0.2, 0.4)];
        let walk = |cut: usize| -> Vec<Vec2> {
            let mut brush = Vec2::ZERO;
            corners
                .windows(2)
                .map(|leg| {
                    for i in 0..cut {
                        let at = |k: usize| leg[0].lerp(leg[1], k as f32 / cut as f32);
                        brush = towed(brush, at(i), at(i + 1), string);
                    }
                    brush
                })
                .collect()
        };
        let few = walk(1);
        for cut in [2, 7, 100] {
            for (a, b) in few.iter().zip(walk(cut)) {
                assert!(a.distance(b) < 1e-5, "{a} in one report, {b} in {cut}");
            }
        }
        // Loose at first, then as far behind the pen as the string is long.
        assert_eq!(few[0], Vec2::ZERO);
        assert!((few[2].distance(corners[3]) - string).abs() < 1e-5);
        // Drawn out all but straight: `atan` of the half angle has fallen to a twentieth.
        let straight = corners[3] - (corners[3] - corners[2]).normalize() * string;
        assert!(few[2].distance(straight) < 0.01, "{} from {straight}", few[2]);
    }
}

//! Pictures that explain how to sculpt: with a pen, a finger, one hand, two hands.

use egui::{Align2, Color32, Painter, Pos2, Rect, RichText, Sense, Stroke, vec2};

use super::parts::place;
use crate::panels::theme;
use sculptd_daemon::kiosk::{Hint, Language};

/// Side of a picture, points.
const SIDE: f32 = 72.0;
/// Width of the text beside it at most, points.
const TEXT: f32 = 190.0;
/// Points of an arc.
const ARC: usize = 16;

/// Shows the pictures below each other, at the left.
pub(super) fn column(ctx: &egui::Context, free: Rect, words: &Language, hints: &[Hint]) {
    if hints.is_empty() {
        return;
    }
    place(ctx, "hints", free, Align2::LEFT_CENTER, |ui| {
        for hint in hints {
            one(ui, words, *hint);
        }
    });
}

/// Shows the pictures beside each other, in as many rows as they need.
pub(super) fn rows(ui: &mut egui::Ui, words: &Language, hints: &[Hint]) {
    let each = SIDE + TEXT + 3.0 * ui.spacing().item_spacing.x;
    let fits = ((ui.available_width() / each).floor() as usize).max(1);
    for row in hints.chunks(fits) {
        ui.horizontal_top(|ui| row.iter().for_each(|hint| one(ui, words, *hint)));
    }
}

/// Returns the width that all pictures need beside each other, at most `most`.
pub(super) fn width(hints: &[Hint], most: f32) -> f32 {
    let each = SIDE + TEXT + 24.0;
    let fits = (most / each).floor().max(1.0);
    (hints.len() as f32).min(fits) * each
}

fn one(ui: &mut egui::Ui, words: &Language, hint: Hint) {
    let text = match hint {
        Hint::Pen => &words.hint_pen,
        Hint::Touch => &words.hint_touch,
        Hint::OneHand => &words.hint_hand,
        Hint::TwoHands => &words.hint_hands,
    };
    ui.horizontal_top(|ui| {
        let (picture, _) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::hover());
        let canvas = Canvas {
            painter: ui.painter(),
            place: picture,
            line: Stroke::new(3.0, ui.visuals().widgets.noninteractive.fg_stroke.color),
            accent: theme::accent(ui),
        };
        match hint {
            Hint::Pen => canvas.pen(),
            Hint::Touch => canvas.touch(),
            Hint::OneHand => canvas.one_hand(),
            Hint::TwoHands => canvas.two_hands(),
        }
        let font = egui::FontId::proportional(16.0);
        let size = ui.painter().layout(text.clone(), font, Color32::WHITE, TEXT).size();
        ui.vertical(|ui| {
            ui.set_width(TEXT);
            ui.add_space(((SIDE - size.y) / 2.0).max(0.0));
            ui.label(RichText::new(text).size(16.0));
        });
    });
}

/// A square of 100 x 100 units.
struct Canvas<'a> {
    painter: &'a Painter,
    place: Rect,
    line: Stroke,
    accent: Color32,
}

impl Canvas<'_> {
    fn at(&self, x: f32, y: f32) -> Pos2 {
        self.place.min + vec2(x, y) * (self.place.width() / 100.0)
    }

    fn path(&self, points: &[(f32, f32)], colour: Color32) {
        let points: Vec<Pos2> = points.iter().map(|(x, y)| self.at(*x, *y)).collect();
        let stroke = Stroke::new(self.line.width, colour);
        for end in points.first().into_iter().chain(points.last()) {
            self.painter.circle_filled(*end, stroke.width / 2.0, colour);
        }
        self.painter.line(points, stroke);
    }

    /// An arc about a point, from and to an angle in radians.
    fn arc(&self, (x, y, radius): (f32, f32, f32), (from, to): (f32, f32), colour: Color32) {
        let point = |i: usize| {
            let angle = from + (to - from) * i as f32 / ARC as f32;
            (x + radius * angle.cos(), y + radius * angle.sin())
        };
        let points: Vec<(f32, f32)> = (0..=ARC).map(point).collect();
        self.path(&points, colour);
    }

    /// The clay, from below.
    fn clay(&self) {
        self.arc((50.0, 150.0, 75.0), (-2.3, -0.84), self.accent);
    }

    fn pen(&self) {
        self.clay();
        let line = self.line.color;
        self.path(&[(48.0, 74.0), (52.0, 58.0), (84.0, 12.0), (94.0, 19.0), (62.0, 66.0)], line);
        self.path(&[(62.0, 66.0), (48.0, 74.0)], line);
        self.path(&[(52.0, 58.0), (62.0, 66.0)], line);
    }

    fn touch(&self) {
        self.clay();
        self.arc((50.0, 74.0, 20.0), (-2.9, -0.24), self.accent);
        self.finger((50.0, 70.0), (62.0, 14.0), 18.0);
        self.path(&[(14.0, 40.0), (34.0, 40.0)], self.line.color);
        self.path(&[(22.0, 33.0), (14.0, 40.0), (22.0, 47.0)], self.line.color);
        self.path(&[(78.0, 40.0), (96.0, 40.0)], self.line.color);
        self.path(&[(88.0, 33.0), (96.0, 40.0), (88.0, 47.0)], self.line.color);
    }

    /// A finger from its tip to its root.
    fn finger(&self, tip: (f32, f32), root: (f32, f32), width: f32) {
        let stroke = |width: f32, colour| {
            let width = width * self.place.width() / 100.0;
            let ends = [self.at(tip.0, tip.1), self.at(root.0, root.1)];
            self.painter.line_segment(ends, Stroke::new(width, colour));
            ends.into_iter().for_each(|end| {
                self.painter.circle_filled(end, width / 2.0, colour);
            });
        };
        stroke(width, self.line.color);
    }

    /// A hand whose thumb and index finger meet at a point. `side`: 1 for a right hand, -1 for a
    /// left one.
    fn pinch(&self, (x, y): (f32, f32), side: f32, scale: f32) {
        let at = |dx: f32, dy: f32| (x + side * dx * scale, y + dy * scale);
        let width = 9.0 * scale;
        let (palm, knuckle) = (at(48.0, 28.0), at(34.0, -2.0));
        self.finger(at(2.0, -2.0), knuckle, width);
        self.finger(at(2.0, 6.0), at(28.0, 26.0), width);
        for (tip, root) in [
            (at(40.0, -24.0), at(46.0, 4.0)),
            (at(54.0, -22.0), at(54.0, 8.0)),
            (at(66.0, -12.0), at(60.0, 14.0)),
        ] {
            self.finger(tip, root, width);
        }
        self.finger(palm, at(44.0, 12.0), 30.0 * scale);
    }

    fn one_hand(&self) {
        self.arc((8.0, 62.0, 30.0), (-1.5, 1.2), self.accent);
        self.pinch((32.0, 46.0), 1.0, 0.9);
    }

    fn two_hands(&self) {
        self.arc((50.0, 50.0, 14.0), (0.0, std::f32::consts::TAU), self.accent);
        self.pinch((66.0, 60.0), 1.0, 0.5);
        self.pinch((34.0, 60.0), -1.0, 0.5);
        self.arc((50.0, 40.0, 32.0), (-2.5, -0.64), self.line.color);
        self.path(&[(68.0, 8.0), (76.0, 21.0), (62.0, 24.0)], self.line.color);
    }
}

//! The first lesson: six hints, each with a ghost hand over the clay that shows it once. A hint
//! disappears once it was followed, and with the last one the lesson is over.
//!
//! Law kept here: nothing moves for long. The hand shows a hint once and is gone, so that a window
//! that nobody answers rests.

use std::f32::consts::TAU;

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, pos2, vec2};
use sculptd_clay::brush::BrushKind;

use super::state::{Action, Hint, HintsFollowed, UiState, View};
use super::{start, theme};
use crate::language::tr;

/// So long the hand shows one hint, seconds.
const SHOWN_S: f64 = 4.0;
/// Between two of its pictures, seconds.
const FRAME_S: f32 = 1.0 / 30.0;

/// Follows what the person does, and shows the hint low in the middle of the view.
pub fn ui(ctx: &egui::Context, view: &View<'_>, ui_state: &mut UiState, free: Rect) {
    follow(view, &mut ui_state.prefs.hints);
    // Who works with bare hands is not told about keys, and who is offered earlier sculptures
    // answers that first.
    if view.state.hands.is_some() || start::offers(view, ui_state) {
        return;
    }
    let next = ui_state.prefs.hints.hint();
    let demo = view.demo_runs && !ui_state.prefs.hints.touched;
    let text = match next {
        _ if demo => tr!("lesson-demo"),
        Some((hint, at, all)) => {
            tr!("lesson-line", hint = hint_text(hint, view), at = at, all = all)
        }
        None => return,
    };
    if !ui_state.hidden {
        let place = egui::Area::new(egui::Id::unique("hint"))
            .fixed_pos(free.center_bottom() - vec2(0.0, 18.0))
            .pivot(Align2::CENTER_BOTTOM)
            .constrain_to(free)
            .interactable(false);
        place.show(ctx, |ui| {
            ui.set_max_width((free.width() - 60.0).clamp(60.0, 460.0));
            egui::Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
                ui.label(egui::RichText::new(text).size(15.0));
            });
        });
    }
    if let Some((hint, ..)) = next.filter(|_| !demo) {
        show(ctx, view, ui_state, hint, free);
    }
}

/// Follows a stroke under way, because the window's keys have changed its brush by then.
fn follow(view: &View<'_>, hints: &mut HintsFollowed) {
    let presses = view.state.pens.iter().flatten().any(|(_, p)| p.pressure > 0.0);
    if !presses || view.demo_runs {
        return;
    }
    let brush = &view.state.brush;
    // A tablet's pen has touched the clay as well as a pointer has.
    hints.touched |= view.state.undo_steps > 0;
    hints.smoothed |= brush.kind == BrushKind::Smooth;
    hints.carved |= brush.negative;
    hints.mirrored |= brush.symmetry.contains(&true);
}

fn hint_text(hint: Hint, view: &View<'_>) -> String {
    match hint {
        Hint::Sculpt => tr!("lesson-sculpt"),
        Hint::Turn => tr!("lesson-turn"),
        Hint::Smooth => tr!("lesson-smooth"),
        Hint::Carve => tr!("lesson-carve"),
        Hint::Undo => tr!("lesson-undo", keys = view.keys.text(Action::Undo)),
        Hint::Mirror => match view.keys.of(Action::MirrorX) {
            Some(keys) => tr!("lesson-mirror", keys = keys.shown()),
            None => tr!("lesson-mirror.no-keys"),
        },
    }
}

/// The hand over the clay, in time.
fn show(ctx: &egui::Context, view: &View<'_>, ui_state: &mut UiState, hint: Hint, free: Rect) {
    let now = ctx.input(|i| i.time);
    let shows = &mut ui_state.lesson.shows;
    if shows.is_none_or(|s| s.0 != hint) {
        *shows = Some((hint, now));
    }
    let t = now - shows.map_or(now, |s| s.1);
    // A hand that is at work itself is not shown how.
    let works = ctx.input(|i| i.pointer.any_down());
    if t >= SHOWN_S || works || free.width() < 160.0 || free.height() < 160.0 {
        return;
    }
    ctx.request_repaint_after_secs(FRAME_S);
    let layer = egui::LayerId::new(egui::Order::Middle, egui::Id::unique("ghost hand"));
    let painter = ctx.layer_painter(layer).with_clip_rect(free);
    let size = free.width().min(free.height());
    let part = (t / SHOWN_S) as f32;
    // It comes, goes its way, and leaves.
    let way = ((part - 0.15) / 0.65).clamp(0.0, 1.0);
    let seen = (part / 0.1).min((1.0 - part) / 0.1).clamp(0.0, 1.0);
    let pressed = way > 0.0 && way < 1.0;
    let at = |x: f32, y: f32| free.center() + vec2(x, y) * size;
    let keys = match hint {
        Hint::Smooth => tr!("key-shift"),
        Hint::Carve => tr!("key-ctrl"),
        Hint::Undo => view.keys.text(Action::Undo),
        _ => String::new(),
    };
    let wave = |x: f32| at(-0.2 + 0.4 * x, 0.05 * (x * TAU).sin());
    let path = |x: f32| match hint {
        Hint::Turn => at(-0.16 + 0.32 * x, 0.42),
        Hint::Mirror => at(0.06 + 0.16 * x, 0.1 - 0.2 * x),
        Hint::Smooth => at(0.2 * (x * 2.0 * TAU).cos(), 0.05 * (x * 4.0 * TAU).sin()),
        _ => wave(x),
    };
    let hand =
        Hand { painter: &painter, seen, pressed, accent: theme::accent_of(!ui_state.prefs.light) };
    match hint {
        // The drawn path disappears again.
        Hint::Undo => {
            hand.trace(&path, 1.0 - way);
            hand.chip(at(0.0, -0.12), &keys);
        }
        Hint::Mirror => {
            let other = |x: f32| {
                let p = path(x);
                pos2(2.0 * free.center().x - p.x, p.y)
            };
            hand.trace(&path, way);
            hand.trace(&other, way);
            hand.tip(path(way), "");
        }
        _ => {
            hand.trace(&path, way);
            hand.tip(path(way), &keys);
        }
    }
}

struct Hand<'a> {
    painter: &'a Painter,
    /// 0 to 1.
    seen: f32,
    pressed: bool,
    accent: Color32,
}

impl Hand<'_> {
    /// The way so far.
    fn trace(&self, path: &dyn Fn(f32) -> Pos2, to: f32) {
        let line: Vec<Pos2> = (0..=32).map(|i| path(to * i as f32 / 32.0)).collect();
        let colour = self.accent.gamma_multiply(0.7 * self.seen);
        self.painter.add(egui::Shape::line(line, Stroke::new(4.0, colour)));
    }

    /// The tip of a pen, filled while it presses, with the key that is held.
    fn tip(&self, at: Pos2, keys: &str) {
        let pale = Color32::WHITE.gamma_multiply(self.seen);
        let fill = if self.pressed { self.accent } else { Color32::from_black_alpha(90) };
        self.painter.circle(at, 9.0, fill.gamma_multiply(self.seen), Stroke::new(2.5, pale));
        let end = at + vec2(26.0, -38.0);
        self.painter.line_segment([at + vec2(5.0, -7.5), end], Stroke::new(6.0, pale));
        if !keys.is_empty() {
            self.chip(at + vec2(-34.0, -30.0), keys);
        }
    }

    /// A key.
    fn chip(&self, at: Pos2, text: &str) {
        let pale = Color32::WHITE.gamma_multiply(self.seen);
        let font = FontId::proportional(15.0);
        let words = self.painter.layout_no_wrap(text.to_owned(), font, pale);
        let rect = Rect::from_center_size(at, words.size() + vec2(16.0, 8.0));
        let ground = Color32::from_black_alpha(200).gamma_multiply(self.seen);
        let edge = Stroke::new(1.5, pale);
        self.painter.rect(rect, 5.0, ground, edge, egui::StrokeKind::Inside);
        self.painter.galley(rect.center() - words.size() * 0.5, words, pale);
    }
}

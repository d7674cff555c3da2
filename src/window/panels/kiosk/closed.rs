//! The screen while the installation is closed.

use egui::{Align2, Color32, LayerId, RichText, vec2};

use super::parts::{place, text_size};
use sculptd_daemon::kiosk::{Language, View};

/// Time after which the text moves elsewhere, so that it does not burn into the screen, in seconds.
const STAYS_S: f64 = 60.0;
/// Distance by which everything drifts while nobody is here, points; and the time of a turn.
const DRIFT: f32 = 24.0;
/// See [`DRIFT`], seconds.
const DRIFT_S: f64 = 600.0;

/// Darkens the ground of the texts, as the hours say.
pub(super) fn darken(ctx: &egui::Context, now: &View) {
    if now.dim_percent > 0 {
        let alpha = u32::from(now.dim_percent.min(100)) * 255 / 100;
        let dark = Color32::from_black_alpha(alpha as u8);
        ctx.layer_painter(LayerId::background()).rect_filled(ctx.content_rect(), 0.0, dark);
    }
}

/// Returns the part of the screen for the texts of the attract loop. It moves slowly, so that they
/// do not burn into the screen.
pub(super) fn drifting(ctx: &egui::Context, whole: egui::Rect) -> egui::Rect {
    let turn = (ctx.input(|i| i.time) / DRIFT_S * std::f64::consts::TAU) as f32;
    // A point of way takes four seconds.
    ctx.request_repaint_after(std::time::Duration::from_secs(4));
    // Two turns of different length: the way covers an area.
    whole.shrink(DRIFT).translate(vec2(turn.sin(), (turn * 1.618).cos()) * DRIFT)
}

/// Shows why nobody can sculpt now, and when it opens.
pub(super) fn ui(ctx: &egui::Context, free: egui::Rect, words: &Language, now: &View) {
    let turn = (ctx.input(|i| i.time) / STAYS_S).floor() as f32;
    ctx.request_repaint_after(std::time::Duration::from_secs_f64(STAYS_S));
    // Two incommensurable turns: no place comes again for days.
    let shift = vec2((turn * 2.4).sin(), (turn * 1.7).cos()) * free.size() * 0.25;
    let place_of = egui::Rect::from_center_size(free.center() + shift, free.size() * 0.5);
    let text = if now.cleaning { &words.cleaning } else { &words.closed };
    let opens = now.opens_next.filter(|_| !now.cleaning);
    let opens = opens.map(|next| words.opens_text(next));
    place(ctx, "closed", place_of, Align2::CENTER_CENTER, |ui| {
        let widest = text_size(ui, text, 40.0).x.ceil();
        ui.set_width(widest.min(free.width() * 0.45));
        ui.vertical_centered(|ui| {
            ui.label(RichText::new(text).size(40.0));
            if let Some(opens) = opens {
                ui.label(RichText::new(opens).size(24.0));
            }
        });
    });
}

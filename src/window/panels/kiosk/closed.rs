//! The screen while the installation is closed.

use egui::{Align2, Color32, LayerId, RichText, vec2};

use super::parts::{place, text_size};
use sculptd_daemon::kiosk::desk::Screen;
use sculptd_daemon::kiosk::{Language, View};

/// Time after which the text moves elsewhere, so that it does not burn into the screen, in seconds.
const STAYS_S: f64 = 60.0;

/// Shows why nobody can sculpt now, and when it opens.
pub(super) fn ui(
    ctx: &egui::Context,
    free: egui::Rect,
    words: &Language,
    screen: &Screen,
    now: &View,
) {
    let dark = Color32::from_black_alpha((screen.dim.clamp(0.0, 1.0) * 255.0) as u8);
    ctx.layer_painter(LayerId::background()).rect_filled(ctx.content_rect(), 0.0, dark);
    let turn = (ctx.input(|i| i.time) / STAYS_S).floor() as f32;
    ctx.request_repaint_after(std::time::Duration::from_secs_f64(STAYS_S));
    // Two incommensurable turns: no place comes again for days.
    let shift = vec2((turn * 2.4).sin(), (turn * 1.7).cos()) * free.size() * 0.25;
    let place_of = egui::Rect::from_center_size(free.center() + shift, free.size() * 0.5);
    let text = if now.cleaning { &words.cleaning } else { &words.closed };
    let opens = now.opens_at.filter(|_| !now.cleaning);
    let opens = opens.map(|minute| {
        let time = format!("{}:{:02}", minute / 60, minute % 60);
        words.opens.replace("{time}", &time)
    });
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

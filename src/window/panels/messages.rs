//! The messages of background tasks: the last one for some seconds over the clay, all of them in a
//! list.

use std::time::Duration;

use egui::vec2;

use super::state::UiState;
use super::theme;
use crate::language::tr;

/// Seconds that a message stays over the clay; a failure stays longer.
const STAYS: [f64; 2] = [5.0, 12.0];

pub fn ui(ui: &mut egui::Ui, ui_state: &UiState) {
    ui.strong(tr!("messages-heading"));
    if ui_state.messages.is_empty() {
        ui.colored_label(theme::quiet(ui), tr!("none"));
    }
    for m in ui_state.messages.iter().rev().take(12) {
        if m.wrong {
            ui.colored_label(theme::alarm(ui), &m.text);
        } else {
            ui.label(&m.text);
        }
    }
}

/// Shows the file being loaded, and its progress.
pub fn loading(ctx: &egui::Context, ui_state: &UiState, free: egui::Rect) {
    let Some((name, done)) = &ui_state.loading else { return };
    let place = egui::Area::new(egui::Id::unique("loading"))
        .fixed_pos(free.center())
        .pivot(egui::Align2::CENTER_CENTER)
        .interactable(false);
    place.show(ctx, |ui| {
        let width = (free.width() - 60.0).clamp(120.0, 360.0);
        ui.set_max_width(width);
        egui::Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
            ui.label(tr!("messages-loading", name = name.as_str()));
            let percent = tr!("percent", value = format!("{:.0}", done * 100.0));
            ui.add(egui::ProgressBar::new(*done).desired_width(width - 20.0).text(percent));
        });
    });
}

pub fn toast(ctx: &egui::Context, ui_state: &mut UiState, free: egui::Rect) {
    let now = ctx.input(|i| i.time);
    let Some(last) = ui_state.messages.last_mut() else { return };
    let since = *last.since.get_or_insert(now);
    let left = STAYS[usize::from(last.wrong)] - (now - since);
    if left < 0.0 {
        return;
    }
    // The frame that takes it away.
    ctx.request_repaint_after(Duration::from_secs_f64(left + 0.05));
    let place = egui::Area::new(egui::Id::unique("toast"))
        // Above the hint, and away from the bars and scales at the top.
        .fixed_pos(free.center_bottom() - vec2(0.0, 70.0))
        .pivot(egui::Align2::CENTER_BOTTOM)
        .interactable(false);
    place.show(ctx, |ui| {
        ui.set_max_width((free.width() - 120.0).clamp(120.0, 560.0));
        egui::Frame::popup(ui.style()).inner_margin(8.0).show(ui, |ui| {
            if last.wrong {
                ui.colored_label(theme::alarm(ui), &last.text);
            } else {
                ui.label(&last.text);
            }
        });
    });
}

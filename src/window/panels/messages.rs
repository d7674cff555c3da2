//! What slow work said: the last line for a while over the clay, all of them in a list.

use egui::vec2;

use super::{UiState, theme};

#[derive(Debug, Clone)]
pub struct Message {
    pub text: String,
    pub wrong: bool,
    /// Seconds on egui's clock when it was first shown; set by the panel.
    pub since: Option<f64>,
}

/// Kept at most.
const MOST: usize = 50;
/// A line stays over the clay so long, seconds; bad news longer.
const STAYS: [f64; 2] = [5.0, 12.0];

impl UiState {
    pub fn say(&mut self, text: impl Into<String>, wrong: bool) {
        self.messages.push(Message { text: text.into(), wrong, since: None });
        if self.messages.len() > MOST {
            self.messages.remove(0);
        }
    }
}

pub fn ui(ui: &mut egui::Ui, desk: &UiState) {
    ui.strong("Messages");
    if desk.messages.is_empty() {
        ui.colored_label(theme::quiet(ui), "none");
    }
    for m in desk.messages.iter().rev().take(12) {
        if m.wrong {
            ui.colored_label(theme::alarm(ui), &m.text);
        } else {
            ui.label(&m.text);
        }
    }
}

pub fn toast(ctx: &egui::Context, desk: &mut UiState, free: egui::Rect) {
    let now = ctx.input(|i| i.time);
    let Some(last) = desk.messages.last_mut() else { return };
    let since = *last.since.get_or_insert(now);
    if now - since > STAYS[usize::from(last.wrong)] {
        return;
    }
    let place = egui::Area::new(egui::Id::unique("toast"))
        .fixed_pos(free.center_top() + vec2(0.0, 14.0))
        .pivot(egui::Align2::CENTER_TOP)
        .interactable(false);
    place.show(ctx, |ui| {
        ui.set_max_width((free.width() - 260.0).clamp(120.0, 560.0));
        egui::Frame::popup(ui.style()).inner_margin(8.0).show(ui, |ui| {
            if last.wrong {
                ui.colored_label(theme::alarm(ui), &last.text);
            } else {
                ui.label(&last.text);
            }
        });
    });
}

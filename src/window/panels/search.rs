//! Every action by name: Ctrl+K, a few letters, Enter.

use egui::Key;

use super::state::action;
use super::state::{Action, UiState, View};
use super::theme;
use crate::language::tr;

/// Shown at a time.
const MOST: usize = 9;

pub fn ui(ctx: &egui::Context, view: &View<'_>, ui_state: &mut UiState) -> Option<Action> {
    let search = ui_state.search.as_mut()?;
    let (up, down, enter, escape) = ctx.input(|i| {
        let p = |k| i.key_pressed(k);
        (p(Key::ArrowUp), p(Key::ArrowDown), p(Key::Enter), p(Key::Escape))
    });
    let mut chosen = None;
    let screen = ctx.content_rect();
    let area = egui::Area::new(egui::Id::unique("search"))
        .fixed_pos(screen.center_top() + egui::vec2(0.0, screen.height() * 0.12))
        .pivot(egui::Align2::CENTER_TOP)
        .order(egui::Order::Foreground);
    area.show(ctx, |ui| {
        egui::Frame::window(ui.style()).show(ui, |ui| {
            ui.set_width(320.0f32.min(screen.width() - 40.0));
            let label = ui.label(tr!("search-heading"));
            let edit = egui::TextEdit::singleline(&mut search.text).desired_width(f32::INFINITY);
            let response = ui.add(edit).labelled_by(label.id);
            let ready = search.begun;
            if !search.begun || !response.has_focus() {
                response.request_focus();
                search.begun = true;
            }
            let found = action::search(&search.text);
            if response.changed() {
                search.at = 0;
            }
            search.at = (search.at + usize::from(down)).saturating_sub(usize::from(up));
            search.at = search.at.min(found.len().min(MOST).saturating_sub(1));
            if enter && ready {
                chosen = found.get(search.at).map(|e| e.action);
            }
            for (i, entry) in found.iter().take(MOST).enumerate() {
                let keys = view.keys.text(entry.action);
                ui.horizontal(|ui| {
                    if ui.selectable_label(i == search.at, entry.action.title()).clicked() {
                        chosen = Some(entry.action);
                    }
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        ui.colored_label(theme::quiet(ui), keys);
                    });
                });
            }
            if found.is_empty() {
                ui.colored_label(theme::quiet(ui), tr!("search-nothing"));
            }
        });
    });
    if escape || chosen.is_some() {
        ui_state.search = None;
    }
    chosen
}

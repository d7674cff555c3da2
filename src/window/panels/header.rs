//! The row above the clay: the file, undo and redo, what is changed most of the brush, the mirrors,
//! and the way to everything else.

use egui::{Align, Layout};

use super::icons::{self, Icon};
use super::state::{Action, UiRequest, UiState, View};
use super::{act, brush, history, symmetry};

/// Height of the row, points.
pub const HEIGHT: f32 = 40.0;

/// Each with its icon.
const FILES: [(Icon, Action); 3] = [
    (Icon::FilePlus, Action::New),
    (Icon::FolderOpen, Action::OpenMesh),
    (Icon::Save, Action::Export),
];

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let ctx = ui.ctx().clone();
    let mut chosen = None;
    let wide = ctx.content_rect().width() >= brush::ROOM_IN_HEADER;
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (icon, action) in FILES {
            button(ui, view, icon, action, &mut chosen);
        }
        gap(ui);
        let (back, ahead) = history::ways(view, ui_state);
        ui.add_enabled_ui(back, |ui| button(ui, view, Icon::Undo2, Action::Undo, &mut chosen));
        ui.add_enabled_ui(ahead, |ui| button(ui, view, Icon::Redo2, Action::Redo, &mut chosen));
        gap(ui);
        if wide {
            ui.scope(|ui| brush::in_a_row(ui, view, ui_state, out));
            gap(ui);
        }
        symmetry::ui(ui, view, out);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            button(ui, view, Icon::CircleQuestionMark, Action::Help, &mut chosen);
            let theme = if ui_state.prefs.light { Icon::Moon } else { Icon::Sun };
            button(ui, view, theme, Action::LightOrDark, &mut chosen);
            button(ui, view, Icon::Search, Action::Search, &mut chosen);
        });
    });
    if let Some(action) = chosen {
        act(action, &ctx, view, ui_state, out);
    }
}

fn gap(ui: &mut egui::Ui) {
    ui.add_space(4.0);
    let (rect, _) = ui.allocate_exact_size(egui::vec2(1.0, 20.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 0.0, ui.visuals().widgets.noninteractive.bg_stroke.color);
    ui.add_space(4.0);
}

fn button(
    ui: &mut egui::Ui,
    view: &View<'_>,
    icon: Icon,
    action: Action,
    chosen: &mut Option<Action>,
) {
    let button = icons::button(ui, icon, &action.title());
    if button.on_hover_text(view.tip(action)).clicked() {
        *chosen = Some(action);
    }
}

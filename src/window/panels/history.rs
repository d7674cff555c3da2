//! The history: a slider through the steps, a click on the picture of a step.

use egui::{Sense, Stroke, vec2};

use super::rows;
use super::state::{StepPicture, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use crate::panels::history_tree;
use sculptd_engine::command::Command;

/// Steps sent at once: the loop's inbox holds a thousand commands.
const AT_ONCE: usize = 200;
/// Pictures shown: those nearest to the present step.
const SHOWN: usize = 9;

/// Returns whether a step can be undone, and whether one can be redone. A session's file holds
/// steps that memory no longer holds.
pub fn ways(view: &View<'_>, ui_state: &UiState) -> (bool, bool) {
    let (first, last) = ui_state.versions.ends();
    (view.state.undo_steps > 0 || first, view.state.redo_steps > 0 || last)
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let (back, ahead) = (view.state.undo_steps, view.state.redo_steps);
    rows::heading(ui, &tr!("history-heading"));
    let text = match ui_state.versions.rows.len() {
        0 => tr!("history-steps", at = back, all = back + ahead),
        n => tr!("history-versions", count = n),
    };
    ui.colored_label(theme::quiet(ui), text);
    if !ui_state.versions.rows.is_empty() {
        history_tree::ui(ui, &mut ui_state.versions, out);
        return;
    }
    if back + ahead == 0 {
        return;
    }
    let mut at = back;
    let slider = egui::Slider::new(&mut at, 0..=back + ahead).show_value(false);
    rows::slider(ui, slider, &tr!("history-step")).on_hover_text(tr!("history-step.tip"));
    if let Some(step) = pictures(ui, ui_state, back, back + ahead) {
        at = step;
    }
    let (times, command) =
        if at < back { (back - at, Command::Undo) } else { (at - back, Command::Redo) };
    out.extend((0..times.min(AT_ONCE)).map(|_| UiRequest::World(command.clone())));
}

/// The pictures around the present step; the step of the one that was clicked.
fn pictures(ui: &mut egui::Ui, ui_state: &UiState, back: usize, all: usize) -> Option<usize> {
    let mut near: Vec<&StepPicture> = ui_state.history.iter().filter(|t| t.step <= all).collect();
    near.sort_by_key(|t| t.step.abs_diff(back));
    near.truncate(SHOWN);
    near.sort_by_key(|t| t.step);
    let mut chosen = None;
    ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
    for row in near.chunks(3) {
        ui.horizontal(|ui| {
            for thumb in row {
                let (rect, response) = ui.allocate_exact_size(vec2(64.0, 40.0), Sense::click());
                let name = tr!("history-after", step = thumb.step);
                let here = thumb.step == back;
                response.widget_info(|| {
                    egui::WidgetInfo::selected(egui::Role::Button, true, here, &name)
                });
                let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                ui.painter().image(thumb.texture.id(), rect, whole, egui::Color32::WHITE);
                if here || response.hovered() || response.has_focus() {
                    let colour = if here { theme::accent(ui) } else { ui.visuals().text_color() };
                    let stroke = Stroke::new(2.0, colour);
                    ui.painter().rect_stroke(rect, 2.0, stroke, egui::StrokeKind::Inside);
                }
                if response.on_hover_text(name).clicked() {
                    chosen = Some(thumb.step);
                }
            }
        });
    }
    chosen
}

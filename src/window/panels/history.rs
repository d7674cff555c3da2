//! What was done: one step back, one forward, scrubbing through all of it, or a click on the
//! picture of a step.

use egui::{Sense, Stroke, vec2};

use super::action::Action;
use super::{UiRequest, UiState, View, theme};
use crate::panels::history_tree;
use sculptd_engine::command::Command;

/// Steps sent at once: the loop's inbox holds a thousand commands.
const AT_ONCE: usize = 200;
/// Pictures kept.
pub const KEPT: usize = 24;
/// Of these, so many are shown, those nearest to where the work is.
const SHOWN: usize = 9;

/// The work after a step.
#[derive(Clone)]
pub struct Thumb {
    pub step: usize,
    /// Tells this state from another that came after as many steps.
    pub mark: u64,
    pub texture: egui::TextureHandle,
}

impl std::fmt::Debug for Thumb {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Thumb").field("step", &self.step).finish_non_exhaustive()
    }
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, desk: &mut UiState, out: &mut Vec<UiRequest>) {
    // Beyond what memory holds, a session's file does.
    let (first, last) = desk.places.ends();
    let (back, ahead) = (view.state.undo_steps, view.state.redo_steps);
    ui.strong("History");
    ui.horizontal(|ui| {
        let undo = ui
            .add_enabled(back > 0 || first, egui::Button::new("Undo"))
            .on_hover_text(Action::Undo.tip());
        let redo = ui
            .add_enabled(ahead > 0 || last, egui::Button::new("Redo"))
            .on_hover_text(Action::Redo.tip());
        if undo.clicked() {
            out.push(UiRequest::World(Command::Undo));
        }
        if redo.clicked() {
            out.push(UiRequest::World(Command::Redo));
        }
        let text = match desk.places.rows.len() {
            0 => format!("{back} of {}", back + ahead),
            1 => "1 place".to_owned(),
            n => format!("{n} places"),
        };
        ui.colored_label(theme::quiet(ui), text);
    });
    if !desk.places.rows.is_empty() {
        history_tree::ui(ui, &mut desk.places, out);
        return;
    }
    if back + ahead == 0 {
        return;
    }
    let mut at = back;
    let slider = egui::Slider::new(&mut at, 0..=back + ahead).show_value(false).text("Step");
    ui.add(slider).on_hover_text("Drag to go through the steps");
    if let Some(step) = pictures(ui, desk, back, back + ahead) {
        at = step;
    }
    let (times, command) =
        if at < back { (back - at, Command::Undo) } else { (at - back, Command::Redo) };
    out.extend((0..times.min(AT_ONCE)).map(|_| UiRequest::World(command.clone())));
}

/// The pictures around the present step; the step of the one that was clicked.
fn pictures(ui: &mut egui::Ui, desk: &UiState, back: usize, all: usize) -> Option<usize> {
    let mut near: Vec<&Thumb> = desk.history.iter().filter(|t| t.step <= all).collect();
    near.sort_by_key(|t| t.step.abs_diff(back));
    near.truncate(SHOWN);
    near.sort_by_key(|t| t.step);
    let mut chosen = None;
    ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
    for row in near.chunks(3) {
        ui.horizontal(|ui| {
            for thumb in row {
                let (rect, response) = ui.allocate_exact_size(vec2(64.0, 40.0), Sense::click());
                let name = format!("After step {}", thumb.step);
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

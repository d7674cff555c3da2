//! What was done: one step back, one forward, or scrubbing through all of it.

use super::action::Action;
use super::{Ask, View, theme};
use crate::command::Command;

/// Steps sent a frame while scrubbing: the loop takes 64 commands a tick.
const AT_ONCE: usize = 32;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<Ask>) {
    let (back, ahead) = (view.state.undo_steps, view.state.redo_steps);
    ui.strong("History");
    ui.horizontal(|ui| {
        let undo = ui.add_enabled(back > 0, egui::Button::new("Undo")).on_hover_text(Action::Undo.tip());
        let redo = ui.add_enabled(ahead > 0, egui::Button::new("Redo")).on_hover_text(Action::Redo.tip());
        if undo.clicked() {
            out.push(Ask::World(Command::Undo));
        }
        if redo.clicked() {
            out.push(Ask::World(Command::Redo));
        }
        ui.colored_label(theme::quiet(ui), format!("{back} of {}", back + ahead));
    });
    if back + ahead > 0 {
        let mut at = back;
        let slider = egui::Slider::new(&mut at, 0..=back + ahead).show_value(false).text("Step");
        ui.add(slider).on_hover_text("Drag to go through the steps");
        let (times, command) =
            if at < back { (back - at, Command::Undo) } else { (at - back, Command::Redo) };
        out.extend((0..times.min(AT_ONCE)).map(|_| Ask::World(command.clone())));
    }
}

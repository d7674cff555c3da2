//! Mirrors.

use super::state::{Action, UiRequest, View};
use crate::language::tr;
use sculptd_engine::command::Command;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<UiRequest>) {
    let mut brush = view.state.brush;
    ui.horizontal(|ui| {
        ui.strong(tr!("mirror-heading"));
        let names = [("x", Action::MirrorX), ("y", Action::MirrorY), ("z", Action::MirrorZ)];
        for (axis, (name, action)) in brush.symmetry.iter_mut().zip(names) {
            let button = egui::Button::selectable(*axis, name).min_size([30.0, 20.0].into());
            if ui.add(button).on_hover_text(view.tip(action)).clicked() {
                *axis = !*axis;
            }
        }
    });
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush)));
    }
}

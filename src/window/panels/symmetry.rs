//! Mirrors: three letters behind their icon.

use super::icons::{self, Icon};
use super::state::{Action, UiRequest, View};
use crate::language::tr;
use sculptd_engine::command::Command;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<UiRequest>) {
    let mut brush = view.state.brush;
    let (rect, icon) = ui.allocate_exact_size([20.0, 20.0].into(), egui::Sense::hover());
    let colour = ui.visuals().text_color();
    icons::paint(ui.painter(), rect, Icon::FlipHorizontal2, 15.0, colour);
    icon.on_hover_text(tr!("mirror-heading"));
    let names = [("x", Action::MirrorX), ("y", Action::MirrorY), ("z", Action::MirrorZ)];
    for (axis, (name, action)) in brush.symmetry.iter_mut().zip(names) {
        let button = egui::Button::selectable(*axis, name).min_size([22.0, 22.0].into());
        if ui.add(button).on_hover_text(view.tip(action)).clicked() {
            *axis = !*axis;
        }
    }
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush)));
    }
}

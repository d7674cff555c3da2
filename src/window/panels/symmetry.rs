//! Mirrors: three letters behind their icon, and the copies about the vertical axis.

use super::icons::{self, Icon};
use super::rows;
use super::state::{Action, UiRequest, View};
use crate::language::tr;
use sculptd_clay::brush::BrushSettings;
use sculptd_engine::command::Command;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Room for the button of the copies and for the end of the header, points.
const ROOM: f32 = 150.0;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<UiRequest>) {
    let mut brush = view.state.brush;
    let (rect, icon) = ui.allocate_exact_size([20.0, 20.0].into(), egui::Sense::hover());
    let colour = ui.visuals().text_color();
    icons::paint(ui.painter(), rect, Icon::FlipHorizontal2, 15.0, colour);
    icon.on_hover_text(tr!("mirror-heading"));
    let actions = [Action::MirrorX, Action::MirrorY, Action::MirrorZ];
    for ((axis, name), action) in brush.symmetry.iter_mut().zip(AXES).zip(actions) {
        let button = egui::Button::selectable(*axis, name).min_size([22.0, 22.0].into());
        if ui.add(button).on_hover_text(view.tip(action)).clicked() {
            *axis = !*axis;
        }
    }
    // Where there is room for the buttons that follow, too.
    if ui.available_width() >= ROOM {
        copies(ui, &mut brush);
    }
    // A mirror more leaves room for fewer copies.
    brush.mirror.radial = brush.mirror.radial.min(brush.most_copies());
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush)));
    }
}

/// The button of the copies about the axis of the settings, at first the vertical one. It shows
/// their number.
fn copies(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    let on = brush.mirror.radial > 1;
    let name = tr!("mirror-radial");
    let icon = icons::tab(ui, Icon::Snowflake, &name, on, 22.0);
    if on {
        let count = format!("{}", brush.mirror.radial);
        let at = icon.rect.right_bottom();
        let font = egui::TextStyle::Small.resolve(ui.style());
        let colour = ui.visuals().strong_text_color();
        ui.painter().text(at, egui::Align2::RIGHT_BOTTOM, count, font, colour);
    }
    let icon = icon.on_hover_text(tr!("mirror-radial.tip"));
    let menu =
        egui::Popup::menu(&icon).close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
    menu.show(|ui| {
        ui.set_min_width(220.0);
        let most = brush.most_copies();
        let slider = egui::Slider::new(&mut brush.mirror.radial, 1..=most);
        rows::slider(ui, slider, &tr!("mirror-copies"));
    });
}

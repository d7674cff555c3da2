//! Rows of a panel that hold in every language: names in one column at the left, values in one at
//! the right. A name that is too long for its column stands above its value.

use crate::language::tr;
use egui::{ComboBox, Response, Slider, TextStyle, Ui, WidgetText};

/// Width of the column of names, points.
const NAMES: f32 = 84.0;
/// Points beside the bar of a slider: its number and the gap before it.
const NUMBER: f32 = 66.0;
/// The shortest bar, points.
const SHORTEST: f32 = 48.0;

fn width(ui: &Ui, text: &str) -> f32 {
    let font = TextStyle::Body.resolve(ui.style());
    let colour = ui.visuals().text_color();
    ui.painter().layout_no_wrap(text.to_owned(), font, colour).size().x
}

/// A widget behind its name; it is given the width that is left for it. In a row of several, it is
/// as wide as it is by itself.
pub fn named(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui, f32) -> Response) -> Response {
    if ui.layout().is_horizontal() {
        let label = ui.label(name);
        let usual = ui.spacing().slider_width + NUMBER;
        return ui.scope(|ui| add(ui, usual)).inner.labelled_by(label.id);
    }
    let gap = NAMES - width(ui, name);
    if gap < 0.0 {
        let label = ui.label(name);
        let left = ui.available_width();
        return ui.scope(|ui| add(ui, left)).inner.labelled_by(label.id);
    }
    let row = ui.horizontal(|ui| {
        let label = ui.label(name);
        ui.add_space(NAMES - label.rect.width());
        let left = ui.available_width();
        add(ui, left).labelled_by(label.id)
    });
    row.inner
}

/// A slider with its name.
pub fn slider(ui: &mut Ui, slider: Slider<'_>, name: &str) -> Response {
    slider_beside(ui, slider, name, NUMBER)
}

/// A slider with its name, whose number and the gap take so many points beside the bar.
pub fn slider_beside(ui: &mut Ui, slider: Slider<'_>, name: &str, number: f32) -> Response {
    named(ui, name, |ui, left| {
        ui.spacing_mut().slider_width = (left - number).max(SHORTEST);
        ui.add(slider)
    })
}

/// A number that is dragged or typed, with its name.
pub fn value(ui: &mut Ui, name: &str, value: egui::DragValue<'_>) -> Response {
    named(ui, name, |ui, left| ui.add_sized([left, ui.spacing().interact_size.y], value))
}

/// A list that unfolds, with its name. `now` is what is chosen.
pub fn list(
    ui: &mut Ui,
    name: &str,
    now: impl Into<WidgetText>,
    all: impl FnOnce(&mut Ui),
) -> Response {
    let now = now.into();
    named(ui, name, |ui, left| {
        let list = ComboBox::from_id_salt(name).selected_text(now).width(left);
        list.truncate().show_ui(ui, all).response
    })
}

/// The title of a part of a page.
pub fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.strong(text);
}

/// Widgets in a row that goes on in the next line, each whole.
pub fn flow(ui: &mut Ui, what: impl FnOnce(&mut Ui)) {
    ui.horizontal_wrapped(|ui| {
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        what(ui);
    });
}

/// A part that is folded at first, by the message of its title.
pub fn folded(title: &'static str) -> egui::CollapsingHeader {
    egui::CollapsingHeader::new(tr!(title)).id_salt(title).default_open(false)
}

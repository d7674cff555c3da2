//! Rows of a panel that hold in every language: a label that does not fit beside its widget stands
//! above it.

use crate::language::tr;
use egui::{ComboBox, Response, Slider, TextStyle, Ui, WidgetText};

/// Points beside the bar of a slider: its number and the gaps.
const NUMBER: f32 = 62.0;
/// A bar beside its name is at least so long, as a part of the usual length.
const SHORTEST: f32 = 0.75;
/// Width of a list that unfolds, points.
const LIST: f32 = 100.0;

fn width(ui: &Ui, text: &str) -> f32 {
    let font = TextStyle::Body.resolve(ui.style());
    let colour = ui.visuals().text_color();
    ui.painter().layout_no_wrap(text.to_owned(), font, colour).size().x
}

/// A slider with its name.
pub fn slider(ui: &mut Ui, slider: Slider<'_>, name: &str) -> Response {
    slider_beside(ui, slider, name, NUMBER)
}

/// A slider with its name, whose number and the gaps take so many points beside the bar.
pub fn slider_beside(ui: &mut Ui, slider: Slider<'_>, name: &str, number: f32) -> Response {
    let usual = ui.spacing().slider_width;
    let bar = (ui.available_width() - number - width(ui, name)).min(usual);
    // A bar that is a little shorter is better than two kinds of rows on one page.
    if bar >= SHORTEST * usual {
        let add = |ui: &mut Ui| {
            ui.spacing_mut().slider_width = bar;
            ui.add(slider.text(name))
        };
        return ui.scope(add).inner;
    }
    let label = ui.label(name);
    ui.add(slider).labelled_by(label.id)
}

/// A list that unfolds, with its name. `now` is what is chosen.
pub fn list(
    ui: &mut Ui,
    name: &str,
    now: impl Into<WidgetText>,
    all: impl FnOnce(&mut Ui),
) -> Response {
    let (now, spacing) = (now.into(), ui.spacing());
    let gap = spacing.item_spacing.x;
    // A list grows with what is chosen, and would press its name into two lines.
    let frame = 2.0 * spacing.button_padding.x + spacing.icon_spacing + spacing.icon_width;
    let list = LIST.max(width(ui, now.text()) + frame);
    if list + gap + width(ui, name) <= ui.available_width() {
        let list = ComboBox::from_label(name).selected_text(now).width(LIST).truncate();
        return list.show_ui(ui, all).response;
    }
    let label = ui.label(name);
    let list = ComboBox::from_id_salt(name).selected_text(now).width(ui.available_width() - 8.0);
    list.truncate().show_ui(ui, all).response.labelled_by(label.id)
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

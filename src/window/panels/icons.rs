//! Icons: letters of the Lucide font, and the buttons that show one. Who reads with the ears, and
//! who points at one, is told its name.

use egui::{Color32, FontData, FontDefinitions, FontFamily, FontId, Rect, Response, Sense};

pub use lucide_icons::Icon;

/// Points along a side of an icon's button.
pub const BUTTON: f32 = 28.0;
/// Points that an icon is high in it.
const SIZE: f32 = 16.0;
/// Name of the font among the fonts of the window.
const FONT: &str = "icons";

/// The fonts of the window in every language: egui's own, and the icons behind the first of them.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let data = FontData::from_static(lucide_icons::LUCIDE_FONT_BYTES);
    fonts.font_data.insert(FONT.into(), data.into());
    // Before the fonts of pictograms, some of which have other signs at the same places.
    let family = fonts.families.entry(FontFamily::Proportional).or_default();
    family.insert(family.len().min(1), FONT.into());
    fonts
}

/// Draws an icon in the middle of a place.
pub fn paint(painter: &egui::Painter, place: Rect, icon: Icon, size: f32, colour: Color32) {
    let letter = char::from(icon).to_string();
    let drawn = painter.layout_no_wrap(letter, FontId::proportional(size), colour);
    // By what is seen of it: the line that it stands in is higher than the icon.
    let at = place.center() - drawn.mesh_bounds.center().to_vec2();
    painter.galley(at, drawn, colour);
}

/// A text that begins with an icon.
pub fn text(icon: Icon, text: &str) -> String {
    format!("{}  {text}", char::from(icon))
}

/// A button that does something.
pub fn button(ui: &mut egui::Ui, icon: Icon, name: &str) -> Response {
    shown(ui, icon, name, None, BUTTON)
}

/// The name of something in a list, as wide as the list.
pub fn row(ui: &egui::Ui, chosen: bool, name: &str) -> egui::Button<'static> {
    let wide = [ui.available_width(), 22.0].into();
    egui::Button::selectable(chosen, (name.to_owned(), egui::Atom::grow()))
        .truncate()
        .min_size(wide)
}

/// One of several of which one is chosen.
pub fn tab(ui: &mut egui::Ui, icon: Icon, name: &str, chosen: bool, side: f32) -> Response {
    shown(ui, icon, name, Some(chosen), side)
}

/// A small switch in a row of a list: full while it is on, faint while it is off.
pub fn switch(ui: &mut egui::Ui, icons: [Icon; 2], name: &str, on: bool) -> Response {
    let (rect, response) = ui.allocate_exact_size(egui::Vec2::splat(20.0), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::CheckBox, ui.is_enabled(), on, name)
    });
    let colour = if on || response.hovered() || response.has_focus() {
        ui.visuals().text_color()
    } else {
        super::theme::quiet(ui)
    };
    paint(ui.painter(), rect, icons[usize::from(!on)], 14.0, colour);
    response
}

fn shown(ui: &mut egui::Ui, icon: Icon, name: &str, on: Option<bool>, side: f32) -> Response {
    let (rect, response) = ui.allocate_exact_size(egui::Vec2::splat(side), Sense::click());
    response.widget_info(|| match on {
        Some(on) => egui::WidgetInfo::selected(egui::Role::Button, ui.is_enabled(), on, name),
        None => egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), name),
    });
    let chosen = on == Some(true);
    let style = ui.style().interact_selectable(&response, chosen);
    if chosen || response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, style.corner_radius, style.weak_bg_fill);
    }
    let colour = if ui.is_enabled() { style.text_color() } else { super::theme::faint(ui) };
    paint(ui.painter(), rect, icon, SIZE, colour);
    response
}

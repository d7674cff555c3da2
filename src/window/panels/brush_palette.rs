//! The brushes to choose from: a person's favourites, those of the program, those of their own; and
//! how the one in hand becomes another of their own.

use egui::{Rect, Sense, Stroke, TextureHandle, vec2};

use super::brush_picture;
use super::icons::{self, Icon};
use super::rows::folded;
use super::state::action::brush_title;
use super::state::{Action, UiRequest, UiState, View};
use super::theme;
use crate::language::{text_of, tr};
use sculptd_clay::brush::own_brush::check_name;
use sculptd_clay::brush::{BrushKind, BrushSettings, OwnBrush};
use sculptd_engine::command::Command;

/// Brushes that are shown first; the others are under "more".
const FIRST: [BrushKind; 12] = [
    BrushKind::Draw,
    BrushKind::Clay,
    BrushKind::ClayStrips,
    BrushKind::Smooth,
    BrushKind::Crease,
    BrushKind::Inflate,
    BrushKind::Grab,
    BrushKind::Pinch,
    BrushKind::Flatten,
    BrushKind::Layer,
    BrushKind::Mask,
    BrushKind::Gaussian,
];

/// Shows the active brush, its favourite mark, and all other brushes: a click activates one.
pub fn ui(
    ui: &mut egui::Ui,
    view: &View<'_>,
    ui_state: &mut UiState,
    brush: &mut BrushSettings,
    out: &mut Vec<UiRequest>,
) {
    let (name, title) = in_hand(view);
    ui.horizontal(|ui| {
        let likes = &mut ui_state.prefs.brushes;
        let marked = likes.is_favourite(&name);
        let label = tr!("brush-favourite");
        let star = icons::switch(ui, [Icon::Star, Icon::StarOff], &label, marked);
        if star.on_hover_text(tr!("brush-favourite.tip")).clicked() {
            likes.mark(&name);
        }
        let name = egui::RichText::new(tr!("brush-now", name = title)).heading();
        ui.add(egui::Label::new(name).truncate());
    });
    let pictures = &mut ui_state.brush_panel.pictures;
    let pictures = pictures.get_or_insert_with(|| brush_picture::load(ui.ctx())).clone();
    let palette = |ui: &mut egui::Ui, brush: &mut BrushSettings, kinds: &[BrushKind]| {
        palette(ui, view, &pictures, brush, kinds);
    };
    favourites(ui, view, &palette, &ui_state.prefs.brushes.favourites, brush, out);
    palette(ui, brush, &FIRST);
    let more: Vec<BrushKind> =
        BrushKind::ALL.iter().filter(|k| !FIRST.contains(k)).copied().collect();
    folded("brush-more").show(ui, |ui| palette(ui, brush, &more));
    own_brushes(ui, view, brush, out);
}

/// The brush in hand: the name by which it is a favourite, and what people read.
fn in_hand(view: &View<'_>) -> (String, String) {
    let brush = &view.state.brush;
    let own = view.presets.own();
    match own.iter().find(|own| own.settings.key() == brush.key()) {
        Some(own) => (own.name.clone(), own.name.clone()),
        None => (brush.kind.name().to_owned(), brush_title(brush.kind)),
    }
}

/// Brushes of the program as buttons.
fn palette(
    ui: &mut egui::Ui,
    view: &View<'_>,
    pictures: &TextureHandle,
    brush: &mut BrushSettings,
    kinds: &[BrushKind],
) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(GAP, GAP);
        kinds.iter().for_each(|kind| button(ui, view, pictures, brush, *kind));
    });
}

/// One brush of the program as a button.
fn button(
    ui: &mut egui::Ui,
    view: &View<'_>,
    pictures: &TextureHandle,
    brush: &mut BrushSettings,
    kind: BrushKind,
) {
    let chosen = brush.key() == (kind, 0);
    let response = picture(ui, pictures, kind, chosen);
    let about = view.presets.get(kind).about();
    let about = text_of(&format!("kind-{}.about", kind.name()), about);
    let tip = format!("{}\n{about}", view.tip(Action::Brush(kind)));
    if response.on_hover_text(tip).clicked() && !chosen {
        *brush = view.presets.recalled(brush, &view.state.kept_brushes, kind);
    }
}

/// Shows the favourites, the built-in brushes first.
fn favourites(
    ui: &mut egui::Ui,
    view: &View<'_>,
    palette: &dyn Fn(&mut egui::Ui, &mut BrushSettings, &[BrushKind]),
    names: &[String],
    brush: &mut BrushSettings,
    out: &mut Vec<UiRequest>,
) {
    let kinds: Vec<BrushKind> = names.iter().filter_map(|name| name.parse().ok()).collect();
    let own = view.presets.own();
    let own: Vec<&OwnBrush> =
        names.iter().filter_map(|name| own.iter().find(|own| own.name == *name)).collect();
    if kinds.is_empty() && own.is_empty() {
        return;
    }
    ui.label(tr!("brush-favourites"));
    ui.push_id(egui::Id::unique("favourites"), |ui| {
        palette(ui, brush, &kinds);
        if !own.is_empty() {
            ui.horizontal_wrapped(|ui| {
                own.iter().for_each(|one| own_brush(ui, view, brush, one, out));
            });
        }
    });
    ui.separator();
}

/// Saves the brush in hand as one of the person's own.
pub fn save(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let panel = &mut ui_state.brush_panel;
    if !panel.saves {
        return;
    }
    folded("brush-save").show(ui, |ui| {
        let label = ui.label(tr!("brush-save-name"));
        let edit = egui::TextEdit::singleline(&mut panel.name).desired_width(f32::INFINITY);
        ui.add(edit).labelled_by(label.id);
        let name = panel.name.trim().to_owned();
        let wrong = check_name(&name).err();
        let there = view.presets.own_of(&name).is_some();
        let text = if there { tr!("brush-save-replace") } else { tr!("brush-save-new") };
        let button = ui.add_enabled(wrong.is_none(), egui::Button::new(text));
        if button.on_hover_text(tr!("brush-save.tip")).clicked() {
            out.push(UiRequest::SaveBrush { name: name.clone(), replace: there });
            panel.name.clear();
        }
        if !name.is_empty() && wrong.is_some() {
            ui.colored_label(theme::alarm(ui), tr!("brush-save-wrong"));
        }
    });
}

/// A person's own brushes: choosing one takes its picture of heights along.
fn own_brushes(
    ui: &mut egui::Ui,
    view: &View<'_>,
    brush: &mut BrushSettings,
    out: &mut Vec<UiRequest>,
) {
    let own = view.presets.own();
    if own.is_empty() {
        return;
    }
    ui.label(tr!("brush-own"));
    ui.horizontal_wrapped(|ui| own.iter().for_each(|one| own_brush(ui, view, brush, one, out)));
}

/// One of a person's own brushes as a button.
fn own_brush(
    ui: &mut egui::Ui,
    view: &View<'_>,
    brush: &mut BrushSettings,
    one: &OwnBrush,
    out: &mut Vec<UiRequest>,
) {
    let chosen = view.state.brush.key() == one.settings.key();
    if ui.selectable_label(chosen, &one.name).on_hover_text(own_hint(one)).clicked() {
        *brush = view.presets.taken(brush, &view.state.kept_brushes, one);
        if let Some(picture) = &one.picture {
            out.push(UiRequest::World(Command::Picture(picture.clone())));
        }
    }
}

fn own_hint(own: &OwnBrush) -> String {
    let kind = brush_title(own.settings.kind);
    let what = match own.about.is_empty() {
        true => kind,
        false => tr!("brush-own-about", kind = kind, about = own.about.as_str()),
    };
    tr!("brush-own.tip", what = what)
}

/// Height of a brush's button, points: its picture, and its name below.
const BUTTON: f32 = 64.0;
/// Height of the picture in it.
const PICTURE: f32 = 48.0;
/// Buttons beside each other, and points between them.
const COLUMNS: f32 = 3.0;
const GAP: f32 = 4.0;

/// A button with the stroke of the brush.
fn picture(
    ui: &mut egui::Ui,
    pictures: &TextureHandle,
    kind: BrushKind,
    chosen: bool,
) -> egui::Response {
    let name = brush_title(kind);
    let wide = ((ui.max_rect().width() - GAP * (COLUMNS - 1.0)) / COLUMNS).floor();
    let (rect, response) = ui.allocate_exact_size(vec2(wide, BUTTON), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::RadioButton, ui.is_enabled(), chosen, name.clone())
    });
    let style = ui.style().interact_selectable(&response, chosen);
    let fill = if chosen { ui.visuals().selection.bg_fill } else { style.weak_bg_fill };
    ui.painter().rect_filled(rect, 4.0, fill);
    let shown = Rect::from_min_size(rect.min, vec2(rect.width(), PICTURE)).shrink(2.0);
    brush_picture::paint(ui, pictures, kind, shown, 3);
    if response.hovered() || response.has_focus() {
        let line = Stroke::new(1.5, theme::accent(ui));
        ui.painter().rect_stroke(rect, 4.0, line, egui::StrokeKind::Inside);
    }
    let text = if chosen { ui.visuals().selection.stroke.color } else { ui.visuals().text_color() };
    let font = egui::FontId::proportional(11.0);
    let at = rect.center_bottom() - vec2(0.0, 1.0);
    // A long name is written smaller: the button keeps its size.
    let wide = ui.painter().layout_no_wrap(name.clone(), font.clone(), text).size().x;
    let share = ((rect.width() - 4.0) / wide.max(1.0)).min(1.0);
    let font = egui::FontId::proportional(font.size * share);
    ui.painter().text(at, egui::Align2::CENTER_BOTTOM, name, font, text);
    response
}

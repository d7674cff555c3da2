//! The brushes to choose from: a person's favourites, those of the program, those of their own; and
//! how the one in hand becomes another of their own.

use egui::{Pos2, Sense, Stroke, vec2};

use super::rows::folded;
use super::state::action::brush_title;
use super::state::{UiRequest, UiState, View};
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
        let star = star(ui, marked).on_hover_text(tr!("brush-favourite.tip"));
        if star.clicked() {
            likes.mark(&name);
        }
        let name = egui::RichText::new(tr!("brush-now", name = title)).strong();
        ui.add(egui::Label::new(name).truncate());
    });
    favourites(ui, view, &ui_state.prefs.brushes.favourites, brush, out);
    palette(ui, view, brush, &FIRST);
    let more: Vec<BrushKind> =
        BrushKind::ALL.iter().filter(|k| !FIRST.contains(k)).copied().collect();
    folded("brush-more").show(ui, |ui| palette(ui, view, brush, &more));
    own_brushes(ui, view, brush, out);
}

/// A star as a button, full while it is `marked`: drawn, for fonts may have none.
fn star(ui: &mut egui::Ui, marked: bool) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(20.0, 20.0), Sense::click());
    response.widget_info(|| {
        let label = tr!("brush-favourite");
        egui::WidgetInfo::selected(egui::Role::CheckBox, ui.is_enabled(), marked, label)
    });
    let ink = match response.hovered() || response.has_focus() {
        true => ui.visuals().strong_text_color(),
        false => theme::accent(ui),
    };
    let corner = |k: usize| {
        let radius = if k.is_multiple_of(2) { 8.0 } else { 3.4 };
        let turn = std::f32::consts::TAU * (k as f32 / 10.0 - 0.25);
        rect.center() + radius * egui::Vec2::angled(turn)
    };
    let corners: Vec<Pos2> = (0..10).map(corner).collect();
    if marked {
        let inner = corners.iter().skip(1).step_by(2).copied().collect();
        ui.painter().add(egui::Shape::convex_polygon(inner, ink, Stroke::NONE));
        for k in (0..10).step_by(2) {
            let point = vec![corner(k + 9), corner(k), corner(k + 1)];
            ui.painter().add(egui::Shape::convex_polygon(point, ink, Stroke::NONE));
        }
    }
    ui.painter().add(egui::Shape::closed_line(corners, Stroke::new(1.2, ink)));
    response
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
fn palette(ui: &mut egui::Ui, view: &View<'_>, brush: &mut BrushSettings, kinds: &[BrushKind]) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        kinds.iter().for_each(|kind| button(ui, view, brush, *kind));
    });
}

/// One brush of the program as a button.
fn button(ui: &mut egui::Ui, view: &View<'_>, brush: &mut BrushSettings, kind: BrushKind) {
    let chosen = brush.key() == (kind, 0);
    let response = picture(ui, kind, chosen);
    let about = view.presets.get(kind).about();
    let about = text_of(&format!("kind-{}.about", kind.name()), about);
    if response.on_hover_text(about).clicked() && !chosen {
        *brush = view.presets.recalled(brush, &view.state.kept_brushes, kind);
    }
}

/// Shows the favourites, the built-in brushes first.
fn favourites(
    ui: &mut egui::Ui,
    view: &View<'_>,
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
        palette(ui, view, brush, &kinds);
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

/// The profile that a brush leaves on flat clay, `d` from -1 to 1 across it: drawn, not computed.
/// A brush that is not named here is drawn as a bell.
fn profile(kind: BrushKind, d: f32) -> f32 {
    let bell = (-d * d * 9.0).exp();
    let step = |edge: f32| 1.0 / (1.0 + ((d.abs() - edge) * 24.0).exp());
    match kind {
        BrushKind::Smooth | BrushKind::Relax | BrushKind::SlideRelax => {
            0.25 * (-d * d * 3.0).exp() + 0.08 * (d * 22.0).sin() * d * d
        }
        BrushKind::Clay | BrushKind::Layer => 0.6 * step(0.55),
        BrushKind::ClayStrips | BrushKind::Trim => 0.7 * step(0.42),
        BrushKind::Crease => 0.35 * bell - 0.9 * (-d * d * 120.0).exp() + 0.3,
        BrushKind::Inflate | BrushKind::Blob => (1.0 - d * d).max(0.0).sqrt() * 0.8,
        BrushKind::Flatten | BrushKind::Scrape => (0.4 + 0.1 * (d * 9.0).sin()).min(0.36),
        BrushKind::Fill => (0.4 + 0.25 * (d * 9.0).sin()).max(0.3),
        BrushKind::Pinch => 0.9 * (-d.abs() * 7.0).exp(),
        BrushKind::Grab
        | BrushKind::Elastic
        | BrushKind::SnakeHook
        | BrushKind::Thumb
        | BrushKind::Nudge => bell * 0.9 * (1.0 + 0.8 * d),
        BrushKind::Mask | BrushKind::MaskBlur | BrushKind::Paint | BrushKind::DrawFaceSets => 0.25,
        BrushKind::Twist => 0.4 + 0.35 * (d * 6.0).sin() * (1.0 - d * d),
        BrushKind::Texture => 0.3 + 0.2 * (d * 31.0).sin() * step(0.7),
        BrushKind::Topological => 0.5 * bell + 0.3 * (d * 12.0).cos().max(0.0) * step(0.6),
        _ => bell * 0.85,
    }
}

/// A button with the profile that the brush leaves.
fn picture(ui: &mut egui::Ui, kind: BrushKind, chosen: bool) -> egui::Response {
    let name = brush_title(kind);
    let (rect, response) = ui.allocate_exact_size(vec2(66.0, 40.0), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::RadioButton, ui.is_enabled(), chosen, name.clone())
    });
    let style = ui.style().interact_selectable(&response, chosen);
    let fill = if chosen { ui.visuals().selection.bg_fill } else { style.weak_bg_fill };
    ui.painter().rect(rect, 5.0, fill, style.bg_stroke, egui::StrokeKind::Inside);
    let line: Vec<Pos2> = (0..=40)
        .map(|i| {
            let x = i as f32 / 40.0;
            let y = profile(kind, (x - 0.5) * 2.0);
            Pos2::new(rect.left() + 8.0 + x * (rect.width() - 16.0), rect.top() + 22.0 - y * 17.0)
        })
        .collect();
    let text = if chosen { ui.visuals().selection.stroke.color } else { ui.visuals().text_color() };
    let ink = if chosen { text } else { theme::accent(ui) };
    ui.painter().add(egui::Shape::line(line, Stroke::new(1.8, ink)));
    let font = egui::FontId::proportional(11.0);
    let at = rect.center_bottom() - vec2(0.0, 2.0);
    // A long name is written smaller: the button keeps its size.
    let wide = ui.painter().layout_no_wrap(name.clone(), font.clone(), text).size().x;
    let share = ((rect.width() - 4.0) / wide.max(1.0)).min(1.0);
    let font = egui::FontId::proportional(font.size * share);
    ui.painter().text(at, egui::Align2::CENTER_BOTTOM, name, font, text);
    response
}

//! Wall thickness: the live map's figures, limits of processes, the worst spots.

use super::rows;
use super::state::{Action, ThicknessSummary, UiRequest, UiState, View};
use super::theme;
use crate::language::text_of;
use crate::language::tr;
use crate::look::Map;
use sculptd_geometry::thickness::preset::Preset;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    ui.strong(tr!("walls-heading"));
    let mut on = ui_state.look.map == Map::Thickness;
    if ui.checkbox(&mut on, tr!("walls-live")).on_hover_text(view.tip(Action::Thickness)).changed()
    {
        super::act::act(Action::Thickness, &ui.ctx().clone(), view, ui_state, out);
    }
    let walls = &mut ui_state.walls;
    let own = tr!("walls-own-limit");
    let preset = walls.preset.and_then(|i| walls.presets.get(i));
    let title = preset.map_or(own.clone(), |p| p.name.clone());
    let mut chosen = walls.preset;
    rows::list(ui, &tr!("walls-process"), title, |ui| {
        ui.selectable_value(&mut chosen, None, own);
        for (i, p) in walls.presets.iter().enumerate() {
            ui.selectable_value(&mut chosen, Some(i), process(p)).on_hover_text(&p.source);
        }
    });
    if chosen != walls.preset {
        walls.preset = chosen;
        if let Some(p) = chosen.and_then(|i| walls.presets.get(i)) {
            walls.limit = p.fail_below;
        }
    }
    rows::flow(ui, |ui| {
        let drag =
            egui::DragValue::new(&mut walls.limit).range(0.0..=1e6).speed(0.01).suffix(" mm");
        let label = ui.label(tr!("walls-too-thin-below"));
        if ui.add(drag).labelled_by(label.id).changed() {
            walls.preset = None;
        }
    });
    let Some(found) = walls.found.as_ref().filter(|_| on) else {
        ui.colored_label(quiet, tr!("walls-note", keys = view.keys.text(Action::Thickness)));
        return;
    };
    ui.add_space(6.0);
    histogram(ui, found, walls.limit);
    let row = |ui: &mut egui::Ui, name: &str, value: String| {
        ui.colored_label(quiet, tr!(name));
        ui.monospace(value);
        ui.end_row();
    };
    egui::Grid::new("walls").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        row(ui, "walls-thinnest", tr!("length-mm", value = format!("{:.3}", found.min)));
        row(ui, "walls-median", tr!("length-mm", value = format!("{:.3}", found.median)));
        row(ui, "walls-thickest", tr!("length-mm", value = format!("{:.3}", found.max)));
        let below = format!("{:.1}", found.below * 100.0);
        row(ui, "walls-too-thin", tr!("percent", value = below));
        let share = found.measured as f32 / found.vertices.max(1) as f32;
        let share = format!("{:.0}", share * 100.0);
        row(ui, "walls-measured", tr!("percent", value = share));
    });
    ui.add_space(6.0);
    ui.strong(tr!("walls-spots"));
    if found.spots.is_empty() {
        ui.colored_label(quiet, tr!("walls-none"));
    }
    for (i, spot) in found.spots.iter().enumerate() {
        let value = format!("{:.3}", spot.thickness);
        let name = tr!("walls-spot", number = i + 1, value = value);
        if ui.button(name).on_hover_text(tr!("walls-spot.tip")).clicked() {
            out.push(UiRequest::FlyTo(spot.place));
        }
    }
}

/// Returns the name of a process.
fn process(preset: &Preset) -> String {
    text_of(&format!("process-{}", preset.name), &preset.title)
}

fn histogram(ui: &mut egui::Ui, found: &ThicknessSummary, limit: f32) {
    let (rect, response) = ui.allocate_exact_size(egui::vec2(196.0, 64.0), egui::Sense::hover());
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, tr!("walls-histogram")));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let most = found.histogram.iter().copied().max().unwrap_or(0).max(1) as f32;
    let width = rect.width() / found.histogram.len().max(1) as f32;
    let span = found.high - found.min;
    for (i, n) in found.histogram.iter().enumerate() {
        let x = rect.left() + i as f32 * width;
        let height = (*n as f32 / most).sqrt() * (rect.height() - 4.0);
        let value = found.min + (i as f32 + 0.5) / found.histogram.len() as f32 * span;
        let [r, g, b] = Map::Thickness.colour(value, found.min, found.high);
        let bar = egui::Rect::from_min_max(
            egui::pos2(x, rect.bottom() - height),
            egui::pos2(x + width - 0.5, rect.bottom()),
        );
        painter.rect_filled(bar, 0.0, egui::Color32::from_rgb(r, g, b));
    }
    let at = (limit - found.min) / span.max(1e-12);
    if (0.0..=1.0).contains(&at) {
        let x = rect.left() + at * rect.width();
        painter.vline(x, rect.y_range(), egui::Stroke::new(1.5, ui.visuals().text_color()));
    }
    let (min, max) = (format!("{:.3}", found.min), format!("{:.3}", found.high));
    response.on_hover_text(tr!("walls-histogram.tip", min = min, max = max));
}

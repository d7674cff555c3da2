//! Wall thickness: the live map's figures, limits of processes, the worst spots.

use super::state::{Action, ThicknessSummary, UiRequest, UiState, View};
use super::theme;
use crate::look::Map;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    ui.strong("Wall thickness");
    let mut on = ui_state.look.map == Map::Thickness;
    if ui.checkbox(&mut on, "Live map").on_hover_text(view.tip(Action::Thickness)).changed() {
        super::act::act(Action::Thickness, &ui.ctx().clone(), view, ui_state, out);
    }
    let walls = &mut ui_state.walls;
    let title =
        walls.preset.and_then(|i| walls.presets.get(i)).map_or("own limit", |p| p.name.as_str());
    let mut chosen = walls.preset;
    egui::ComboBox::from_label("Process").selected_text(title).width(120.0).show_ui(ui, |ui| {
        ui.selectable_value(&mut chosen, None, "own limit");
        for (i, p) in walls.presets.iter().enumerate() {
            ui.selectable_value(&mut chosen, Some(i), &p.title).on_hover_text(&p.source);
        }
    });
    if chosen != walls.preset {
        walls.preset = chosen;
        if let Some(p) = chosen.and_then(|i| walls.presets.get(i)) {
            walls.limit = p.fail_below;
        }
    }
    ui.horizontal(|ui| {
        let drag =
            egui::DragValue::new(&mut walls.limit).range(0.0..=1e6).speed(0.01).suffix(" mm");
        let label = ui.label("Too thin below");
        if ui.add(drag).labelled_by(label.id).changed() {
            walls.preset = None;
        }
    });
    let Some(found) = walls.found.as_ref().filter(|_| on) else {
        ui.colored_label(quiet, "Press T: the map follows the clay while you sculpt.");
        return;
    };
    ui.add_space(6.0);
    histogram(ui, found, walls.limit);
    let row = |ui: &mut egui::Ui, name: &str, value: String| {
        ui.colored_label(quiet, name);
        ui.monospace(value);
        ui.end_row();
    };
    egui::Grid::new("walls").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        row(ui, "thinnest", format!("{:.3} mm", found.min));
        row(ui, "median", format!("{:.3} mm", found.median));
        row(ui, "thickest", format!("{:.3} mm", found.max));
        row(ui, "too thin", format!("{:.1} %", found.below * 100.0));
        let share = found.measured as f32 / found.vertices.max(1) as f32;
        row(ui, "measured", format!("{:.0} %", share * 100.0));
    });
    ui.add_space(6.0);
    ui.strong("Thin spots");
    if found.spots.is_empty() {
        ui.colored_label(quiet, "None below the limit.");
    }
    for (i, spot) in found.spots.iter().enumerate() {
        let name = format!("{}: {:.3} mm", i + 1, spot.thickness);
        if ui.button(name).on_hover_text("The camera flies there").clicked() {
            out.push(UiRequest::FlyTo(spot.place));
        }
    }
}

fn histogram(ui: &mut egui::Ui, found: &ThicknessSummary, limit: f32) {
    let (rect, response) = ui.allocate_exact_size(egui::vec2(196.0, 64.0), egui::Sense::hover());
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Thickness histogram"));
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
    response
        .on_hover_text(format!("{:.3} to {:.3} mm; the line is the limit", found.min, found.high));
}

//! Wall thickness: the live map's figures, limits of processes, the worst spots.

use super::cut;
use super::rows;
use super::state::{Action, ThicknessSummary, ThinSpot, UiRequest, UiState, View, WallsPage};
use super::theme;
use crate::language::text_of;
use crate::language::tr;
use crate::look::{Look, Map};
use sculptd_geometry::thickness::MeasuredSide;
use sculptd_geometry::thickness::preset::Preset;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    walls(ui, view, ui_state, out);
    cut::ui(ui, ui_state, view);
}

fn walls(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    let side = ui_state.look.map.side();
    let name = |wall: &'static str, gap: &'static str| match side {
        MeasuredSide::Wall => tr!(wall),
        MeasuredSide::Gap => tr!(gap),
    };
    ui.strong(name("walls-heading", "map-gap"));
    let mut on = ui_state.look.map.is_of_walls();
    if ui.checkbox(&mut on, tr!("walls-live")).on_hover_text(view.tip(Action::Thickness)).changed()
    {
        // From gaps and from the change of walls the map is closed too.
        ui_state.look.map = if on { ui_state.look.map } else { Map::Thickness };
        super::act::act(Action::Thickness, &ui.ctx().clone(), view, ui_state, out);
    }
    if on {
        let mut gaps = side == MeasuredSide::Gap;
        let checkbox = ui.checkbox(&mut gaps, tr!("map-gap"));
        if checkbox.on_hover_text(view.tip(Action::Gap)).changed() {
            ui_state.look.map = if gaps { Map::Gap } else { Map::Thickness };
        }
    }
    if on && side == MeasuredSide::Wall && changes(ui, ui_state, out) {
        return;
    }
    let walls = &mut ui_state.walls;
    let own = tr!("walls-own-limit");
    let preset = walls.preset.and_then(|i| walls.presets.get(i));
    let title = preset.map_or(own.clone(), |p| p.name.clone());
    let mut chosen = walls.preset;
    if side == MeasuredSide::Wall {
        rows::list(ui, &tr!("walls-process"), title, |ui| {
            ui.selectable_value(&mut chosen, None, own);
            for (i, p) in walls.presets.iter().enumerate() {
                ui.selectable_value(&mut chosen, Some(i), process(p)).on_hover_text(&p.source);
            }
        });
    }
    if chosen != walls.preset {
        walls.preset = chosen;
        if let Some(p) = chosen.and_then(|i| walls.presets.get(i)) {
            walls.limit = p.fail_below;
        }
    }
    let mut limit = walls.limit_of(side);
    rows::flow(ui, |ui| {
        let drag = egui::DragValue::new(&mut limit).range(0.0..=1e6).speed(0.01).suffix(" mm");
        let label = ui.label(name("walls-too-thin-below", "gaps-too-narrow-below"));
        ui.add(drag).labelled_by(label.id);
    });
    set_limit(walls, side, limit);
    let Some(found) = walls.found.as_ref().filter(|_| on) else {
        ui.colored_label(quiet, tr!("walls-note", keys = view.keys.text(Action::Thickness)));
        return;
    };
    ui.add_space(6.0);
    let auto = (found.min, found.high);
    let shown = walls.scale.unwrap_or(auto);
    let mut marks = [limit, shown.0, shown.1];
    if histogram(ui, found, &ui_state.look, &mut marks) {
        limit = marks[0].max(0.0);
        if (marks[1], marks[2]) != shown {
            walls.scale = Some((marks[1], marks[2].max(marks[1] + LEAST_SPAN)));
        }
    }
    scale(ui, &mut walls.scale, auto, limit);
    ui.checkbox(&mut ui_state.look.bands, tr!("walls-bands")).on_hover_text(tr!("walls-bands.tip"));
    let row = |ui: &mut egui::Ui, name: String, value: String| {
        ui.colored_label(quiet, name);
        ui.monospace(value);
        ui.end_row();
    };
    let narrowest = name("walls-thinnest", "gaps-narrowest");
    let (widest, narrow) =
        (name("walls-thickest", "gaps-widest"), name("walls-too-thin", "gaps-too-narrow"));
    egui::Grid::new("walls").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        row(ui, narrowest, tr!("length-mm", value = format!("{:.3}", found.min)));
        row(ui, tr!("walls-usual"), tr!("length-mm", value = format!("{:.3}", found.usual())));
        row(ui, tr!("walls-median"), tr!("length-mm", value = format!("{:.3}", found.median)));
        row(ui, widest, tr!("length-mm", value = format!("{:.3}", found.max)));
        let below = format!("{:.1}", found.below * 100.0);
        row(ui, narrow, tr!("percent", value = below));
        let share = found.measured as f32 / found.vertices.max(1) as f32;
        let share = format!("{:.0}", share * 100.0);
        row(ui, tr!("walls-measured"), tr!("percent", value = share));
    });
    ui.add_space(6.0);
    ui.strong(name("walls-spots", "gaps-spots"));
    if found.spots.is_empty() {
        ui.colored_label(quiet, tr!("walls-none"));
    }
    spots(ui, &found.spots, out);
    set_limit(walls, side, limit);
}

/// Sets the limit of a side. A limit of walls that differs from the process's is the person's own.
fn set_limit(walls: &mut WallsPage, side: MeasuredSide, limit: f32) {
    match side {
        MeasuredSide::Gap => walls.gap_limit = limit,
        MeasuredSide::Wall if limit != walls.limit => (walls.limit, walls.preset) = (limit, None),
        MeasuredSide::Wall => {}
    }
}

/// The comparison with an earlier form; returns true if its map is shown.
fn changes(ui: &mut egui::Ui, ui_state: &mut UiState, out: &mut Vec<UiRequest>) -> bool {
    let mut shown = ui_state.look.map == Map::WallChange;
    let checkbox = ui.checkbox(&mut shown, tr!("walls-change"));
    if checkbox.on_hover_text(tr!("walls-change.tip")).changed() {
        ui_state.look.map = if shown { Map::WallChange } else { Map::Thickness };
    }
    if !shown {
        return false;
    }
    if ui.button(tr!("distance-now")).on_hover_text(tr!("distance-now.tip")).clicked() {
        out.push(UiRequest::Reference);
    }
    let quiet = theme::quiet(ui);
    let Some(found) = &ui_state.walls.changes else {
        ui.colored_label(quiet, tr!("legend-measuring"));
        return true;
    };
    egui::Grid::new("wall-changes").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        for (name, value) in [
            ("walls-thinned", tr!("length-mm", value = format!("{:+.3}", found.thinned))),
            ("walls-thickened", tr!("length-mm", value = format!("{:+.3}", found.thickened))),
            ("walls-compared", tr!("percent", value = format!("{:.0}", found.compared * 100.0))),
        ] {
            ui.colored_label(quiet, tr!(name));
            ui.monospace(value);
            ui.end_row();
        }
    });
    spots(ui, &found.spots, out);
    true
}

fn spots(ui: &mut egui::Ui, spots: &[ThinSpot], out: &mut Vec<UiRequest>) {
    for (i, spot) in spots.iter().enumerate() {
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

/// The narrowest scale, millimetres.
const LEAST_SPAN: f32 = 1e-4;

/// The ends of the colours' scale: those of the map, or set by hand.
fn scale(ui: &mut egui::Ui, chosen: &mut Option<(f32, f32)>, auto: (f32, f32), limit: f32) {
    let (mut low, mut high) = chosen.unwrap_or(auto);
    let drag = |value| egui::DragValue::new(value).range(0.0..=1e6).speed(0.01).suffix(" mm");
    let from = rows::value(ui, &tr!("walls-scale-from"), drag(&mut low));
    let to = rows::value(ui, &tr!("walls-scale-to"), drag(&mut high));
    if from.changed() || to.changed() {
        *chosen = Some((low.min(high - LEAST_SPAN), high.max(low + LEAST_SPAN)));
    }
    rows::flow(ui, |ui| {
        let follow = ui.add_enabled(chosen.is_some(), egui::Button::new(tr!("walls-scale-auto")));
        if follow.on_hover_text(tr!("walls-scale-auto.tip")).clicked() {
            *chosen = None;
        }
        let about = ui.add_enabled(limit > 0.0, egui::Button::new(tr!("walls-scale-limit")));
        if about.on_hover_text(tr!("walls-scale-limit.tip")).clicked() {
            *chosen = Some((0.0, 2.0 * limit));
        }
    });
}

/// Draws the histogram. `marks` are the limit and the two ends of the scale, which are dragged;
/// returns true while one is.
fn histogram(
    ui: &mut egui::Ui,
    found: &ThicknessSummary,
    look: &Look,
    marks: &mut [f32; 3],
) -> bool {
    let size = egui::vec2(196.0, 64.0);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::click_and_drag());
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, tr!("walls-histogram")));
    let span = (found.high - found.min).max(1e-12);
    let place = |value: f32| rect.left() + (value - found.min) / span * rect.width();
    // The mark that is nearest where the drag begins; of those beside each other the limit. A limit
    // beyond the histogram is not drawn and not dragged; the ends of the scale wait at its edges.
    let key = response.id.with("mark");
    if response.drag_started()
        && let Some(at) = response.interact_pointer_pos()
    {
        let away = |i: &usize| {
            let x = place(marks[*i]);
            let unseen = *i == 0 && !rect.x_range().contains(x);
            let x = x.clamp(rect.left(), rect.right());
            if unseen { f32::INFINITY } else { (x - at.x).abs() }
        };
        let nearest = (0..marks.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
        ui.data_mut(|d| d.insert_temp(key, nearest.unwrap_or_default()));
    }
    let mut moved = false;
    if response.dragged()
        && let Some(at) = response.interact_pointer_pos()
        && let Some(mark) = ui.data(|d| d.get_temp::<usize>(key))
    {
        let x = (at.x - rect.left()) / rect.width();
        let value = found.min + x.clamp(0.0, 1.0) * span;
        marks[mark] = match mark {
            1 => value.min(marks[2] - LEAST_SPAN),
            2 => value.max(marks[1] + LEAST_SPAN),
            _ => value,
        };
        moved = true;
    }
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let most = found.histogram.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let width = rect.width() / found.histogram.len().max(1) as f32;
    for (i, n) in found.histogram.iter().enumerate() {
        let x = rect.left() + i as f32 * width;
        let height = (n / most).sqrt() * (rect.height() - 8.0);
        let value = found.min + (i as f32 + 0.5) / found.histogram.len() as f32 * span;
        let share = (value - marks[1]) / (marks[2] - marks[1]).max(1e-12);
        let [r, g, b] = look.scale_colour(share.clamp(0.0, 1.0));
        let bar = egui::Rect::from_min_max(
            egui::pos2(x, rect.bottom() - height),
            egui::pos2(x + width - 0.5, rect.bottom()),
        );
        painter.rect_filled(bar, 0.0, egui::Color32::from_rgb(r, g, b));
    }
    let colour = ui.visuals().text_color();
    if rect.x_range().contains(place(marks[0])) {
        painter.vline(place(marks[0]), rect.y_range(), egui::Stroke::new(1.5, colour));
    }
    for end in [marks[1], marks[2]] {
        // Beyond the histogram a handle waits at its edge.
        let x = place(end).clamp(rect.left() + 4.0, rect.right() - 4.0);
        let corners = [(-4.0, 0.0), (4.0, 0.0), (0.0, 7.0)];
        let corners = corners.map(|(dx, dy)| egui::pos2(x + dx, rect.top() + dy)).to_vec();
        painter.add(egui::Shape::convex_polygon(corners, colour, egui::Stroke::NONE));
    }
    let (min, max) = (format!("{:.3}", found.min), format!("{:.3}", found.high));
    response.on_hover_text(tr!("walls-histogram.tip", min = min, max = max));
    moved
}

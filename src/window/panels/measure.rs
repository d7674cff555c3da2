//! Sizes of the object: measures, the shadow along a direction, the distance to another form.

use egui::{Color32, Mesh, Stroke, pos2, vec2};
use glam::{DVec2, DVec3};

use super::rows;
use super::state::{Action, DistanceTarget, Measured, SizesPage, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use crate::look::Map;
use sculptd_geometry::projection::PlaneRegion;

/// Corners of the drawn outline at most: it is a picture as large as a thumb.
const CORNERS: usize = 1500;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    measures(ui, view, &ui_state.sizes);
    ui.add_space(8.0);
    shadow(ui, view, &mut ui_state.sizes, out);
    ui.add_space(8.0);
    distance(ui, view, ui_state, out);
}

fn measures(ui: &mut egui::Ui, view: &View<'_>, sizes: &SizesPage) {
    let quiet = theme::quiet(ui);
    ui.strong(tr!("measure-heading"));
    let Some(m) = &sizes.found else {
        ui.colored_label(quiet, tr!("measure-waits"));
        return;
    };
    let row = |ui: &mut egui::Ui, name: &str, value: String| {
        ui.colored_label(quiet, name);
        ui.monospace(value);
        ui.end_row();
    };
    egui::Grid::new("measures").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        row(ui, &tr!("measure-volume"), tr!("volume-mm3", value = short(m.volume)));
        row(ui, &tr!("measure-area"), tr!("area-mm2", value = short(m.area)));
        for (axis, size) in ["x", "y", "z"].into_iter().zip(m.dimensions) {
            let name = tr!("measure-size", axis = axis);
            row(ui, &name, tr!("length-mm", value = short(size)));
        }
        for (axis, area) in ["x", "y", "z"].into_iter().zip(m.projected) {
            let name = tr!("measure-shadow", axis = axis);
            row(ui, &name, tr!("area-mm2", value = short(area)));
        }
    });
    if m.revision != view.state.mesh.revision() {
        ui.colored_label(quiet, tr!("measure-stale"));
    }
}

/// Six figures, as many before the point as there are.
pub fn short(x: f64) -> String {
    let whole = x.abs().max(1.0).log10().floor() as usize;
    format!("{x:.*}", 5usize.saturating_sub(whole).min(4))
}

fn shadow(ui: &mut egui::Ui, view: &View<'_>, sizes: &mut SizesPage, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    ui.strong(tr!("shadow-heading"));
    rows::flow(ui, |ui| {
        for (name, direction) in [("x", DVec3::NEG_X), ("y", DVec3::NEG_Y), ("z", DVec3::NEG_Z)] {
            let button = egui::Button::selectable(sizes.direction == direction, name);
            let button = ui.add(button).on_hover_text(tr!("shadow-along.tip", axis = name));
            button.widget_info(|| {
                egui::WidgetInfo::selected(
                    egui::Role::RadioButton,
                    true,
                    sizes.direction == direction,
                    tr!("shadow-along", axis = name),
                )
            });
            if button.clicked() {
                sizes.direction = direction;
            }
        }
        if ui.button(tr!("shadow-here")).on_hover_text(tr!("shadow-here.tip")).clicked() {
            sizes.direction = -view.camera.backward().as_dvec3();
        }
    });
    let Some(m) = &sizes.found else { return };
    ui.monospace(tr!("area-mm2", value = short(m.shadow)));
    let (lo, hi) = picture(ui, m);
    let size = (hi - lo).max(DVec2::ZERO);
    let holes: usize = m.outline.iter().map(|p| p.holes.len()).sum();
    let (x, y) = (short(size.x), short(size.y));
    ui.colored_label(quiet, tr!("shadow-size", x = x, y = y, holes = holes));
    ui.horizontal(|ui| {
        let text = egui::TextEdit::singleline(&mut sizes.file).desired_width(126.0);
        let field = ui.add(text).on_hover_text(tr!("shadow-file.tip"));
        field.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::TextInput, true, tr!("shadow-file"))
        });
        let named = !sizes.file.trim().is_empty();
        let tip = tr!("shadow-write.tip");
        if ui
            .add_enabled(named, egui::Button::new(tr!("shadow-write")))
            .on_hover_text(tip)
            .clicked()
        {
            out.push(UiRequest::Outline(sizes.file.trim().into()));
        }
    });
}

/// The outline, and the box around it.
fn picture(ui: &mut egui::Ui, m: &Measured) -> (DVec2, DVec2) {
    let (rect, response) = ui.allocate_exact_size(vec2(196.0, 120.0), egui::Sense::hover());
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, tr!("shadow-outline")));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let points = m.outline.iter().flat_map(|p| &p.outer);
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (lo, hi) = points.fold(none, |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    if !lo.cmple(hi).all() {
        return (DVec2::ZERO, DVec2::ZERO);
    }
    let inner = rect.shrink(6.0);
    let size = (hi - lo).max(DVec2::splat(1e-12));
    let scale = (f64::from(inner.width()) / size.x).min(f64::from(inner.height()) / size.y);
    let at = |p: &DVec2| {
        let d = (*p - (lo + hi) * 0.5) * scale;
        pos2(inner.center().x + d.x as f32, inner.center().y - d.y as f32)
    };
    let all: usize = m.outline.iter().flat_map(PlaneRegion::rings).map(Vec::len).sum();
    let step = all.div_ceil(CORNERS).max(1);
    let stroke = Stroke::new(1.5, theme::accent(ui));
    for ring in m.outline.iter().flat_map(PlaneRegion::rings) {
        let mut line: Vec<_> = ring.iter().step_by(step).map(at).collect();
        line.extend(ring.last().map(at));
        painter.add(egui::Shape::line(line, stroke));
    }
    (lo, hi)
}

fn distance(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    ui.strong(tr!("distance-heading"));
    let mut on = ui_state.look.map == Map::Distance;
    if ui
        .checkbox(&mut on, tr!("distance-live"))
        .on_hover_text(view.tip(Action::Distance))
        .changed()
    {
        super::act::act(Action::Distance, &ui.ctx().clone(), view, ui_state, out);
    }
    let sizes = &mut ui_state.sizes;
    let held = view.state.thing.is_some();
    rows::flow(ui, |ui| {
        ui.radio_value(&mut sizes.against, DistanceTarget::Before, tr!("distance-before"))
            .on_hover_text(tr!("distance-before.tip"));
        let to_held = sizes.against == DistanceTarget::HeldObject;
        let radio = egui::RadioButton::new(to_held, tr!("distance-held"));
        if ui.add_enabled(held, radio).clicked() {
            sizes.against = DistanceTarget::HeldObject;
        }
    });
    if !held && sizes.against == DistanceTarget::HeldObject {
        sizes.against = DistanceTarget::Before;
    }
    if ui.button(tr!("distance-now")).on_hover_text(tr!("distance-now.tip")).clicked() {
        out.push(UiRequest::Reference);
    }
    let Some(d) = sizes.distances.filter(|_| on) else {
        ui.colored_label(quiet, tr!("distance-note"));
        return;
    };
    egui::Grid::new("distances").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        let share = d.known.0 as f64 / d.known.1.max(1) as f64 * 100.0;
        for (name, value) in [
            ("distance-deepest", tr!("length-mm", value = format!("{:+.4}", d.min))),
            ("distance-highest", tr!("length-mm", value = format!("{:+.4}", d.max))),
            ("distance-rms", tr!("length-mm", value = format!("{:.4}", d.rms))),
            ("distance-known", tr!("percent", value = format!("{share:.0}"))),
        ] {
            ui.colored_label(quiet, tr!(name));
            ui.monospace(value);
            ui.end_row();
        }
    });
}

/// A scale's bar, upright, its low end below: for legends.
pub fn bar(painter: &egui::Painter, rect: egui::Rect, colour: impl Fn(f32) -> [u8; 3]) {
    // A multiple of the number of bands, so that none is blurred.
    const STEPS: u32 = 64;
    let mut mesh = Mesh::default();
    for i in 0..STEPS {
        let [low, high] =
            [i, i + 1].map(|i| rect.bottom() - i as f32 / STEPS as f32 * rect.height());
        let [r, g, b] = colour((i as f32 + 0.5) / STEPS as f32);
        for (x, y) in
            [(rect.left(), low), (rect.right(), low), (rect.left(), high), (rect.right(), high)]
        {
            mesh.colored_vertex(pos2(x, y), Color32::from_rgb(r, g, b));
        }
        let k = i * 4;
        mesh.add_triangle(k, k + 1, k + 2);
        mesh.add_triangle(k + 1, k + 2, k + 3);
    }
    painter.add(mesh);
}

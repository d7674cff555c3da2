//! The brush: which one, of the program's and of a person's own, and all its settings.

use super::state::{Action, UiRequest, UiState, View};
use super::{alphas, brush_palette, brush_size, colours, rows};
use crate::language::tr;
use crate::language::{text_of, text_or};
use sculptd_clay::brush::{BrushKind, BrushSettings, Falloff, Measure, Method, StampBy};
use sculptd_engine::command::Command;

const METHODS: [(Method, &str); 7] = [
    (Method::Space, "method-space"),
    (Method::Dots, "method-dots"),
    (Method::Airbrush, "method-airbrush"),
    (Method::Anchored, "method-anchored"),
    (Method::DragDot, "method-drag-dot"),
    (Method::Line, "method-line"),
    (Method::Curve, "method-curve"),
];

const STAMPS: [(StampBy, &str); 4] = [
    (StampBy::Off, "stamp-off"),
    (StampBy::Dab, "stamp-dab"),
    (StampBy::View, "stamp-view"),
    (StampBy::Stencil, "stamp-stencil"),
];

const FALLOFFS: [(Falloff, &str); 8] = [
    (Falloff::Gaussian, "falloff-gaussian"),
    (Falloff::Smooth, "falloff-smooth"),
    (Falloff::Sphere, "falloff-sphere"),
    (Falloff::Root, "falloff-root"),
    (Falloff::Sharp, "falloff-sharp"),
    (Falloff::Linear, "falloff-linear"),
    (Falloff::Constant, "falloff-constant"),
    (Falloff::Custom, "falloff-custom"),
];

const MEASURES: [(Measure, &str); 4] = [
    (Measure::Off, "topology-off"),
    (Measure::Brush, "topology-brush"),
    (Measure::Work, "topology-object"),
    (Measure::View, "topology-view"),
];

/// Narrower windows, points, have radius and strength in the left panel, not in the header.
pub const ROOM_IN_HEADER: f32 = 900.0;
/// Narrower windows, points, have the stroke and the falloff there.
const ROOM_FOR_STROKE: f32 = 1240.0;

/// One of several, in a list that unfolds; `title` and the names are messages.
fn choice<T: Copy + PartialEq>(ui: &mut egui::Ui, title: &str, value: &mut T, all: &[(T, &str)]) {
    let now = all.iter().find(|(v, _)| v == value).map_or_else(String::new, |(_, name)| tr!(name));
    rows::list(ui, &tr!(title), now, |ui| {
        for (v, name) in all {
            ui.selectable_value(value, *v, tr!(name));
        }
    });
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let mut brush: BrushSettings = view.state.brush;
    brush_palette::ui(ui, view, ui_state, &mut brush, out);
    let wide = ui.ctx().content_rect().width();
    if wide < ROOM_IN_HEADER {
        first_settings(ui, view, ui_state, &mut brush);
    }
    let paints = view.state.brush.kind == BrushKind::Paint;
    if paints {
        colours::ui(ui, view, ui_state, &mut brush);
    }
    if wide < ROOM_FOR_STROKE {
        choice(ui, "dab-falloff", &mut brush.falloff, &FALLOFFS);
        rows::folded("brush-stroke").show(ui, |ui| path(ui, &mut brush));
    }
    rows::folded("brush-settings").show(ui, |ui| {
        check(ui, &mut ui_state.prefs.brushes.radius_in_pixels, "brush-radius-pixels");
        rows::folded("brush-dab").show(ui, |ui| {
            dab(ui, &mut brush);
            if !paints {
                colours::ui(ui, view, ui_state, &mut brush);
            }
        });
        rows::folded("brush-stamp").show(ui, |ui| {
            alphas::ui(ui, view, &mut brush, out);
            stamp(ui, &mut brush);
        });
        rows::folded("brush-automasks").show(ui, |ui| automasks(ui, &mut brush));
        rows::folded("brush-topology").show(ui, |ui| topology(ui, &mut brush));
        brush_palette::save(ui, view, ui_state, out);
    });
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush.clamped())));
    }
}

/// The settings that are changed most, in a row.
pub fn in_a_row(
    ui: &mut egui::Ui,
    view: &View<'_>,
    ui_state: &mut UiState,
    out: &mut Vec<UiRequest>,
) {
    let mut brush = view.state.brush;
    ui.spacing_mut().slider_width = 80.0;
    first_settings(ui, view, ui_state, &mut brush);
    ui.add_space(8.0);
    if ui.ctx().content_rect().width() >= ROOM_FOR_STROKE {
        ui.spacing_mut().slider_width = 48.0;
        choice(ui, "dab-falloff", &mut brush.falloff, &FALLOFFS);
        let stroke = egui::containers::menu::MenuButton::new(tr!("brush-stroke"));
        let stay = egui::PopupCloseBehavior::CloseOnClickOutside;
        stroke.config(egui::containers::menu::MenuConfig::new().close_behavior(stay)).ui(
            ui,
            |ui| {
                ui.set_width(240.0);
                path(ui, &mut brush);
            },
        );
    }
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush.clamped())));
    }
}

/// Radius, strength, and whether it carves.
fn first_settings(
    ui: &mut egui::Ui,
    view: &View<'_>,
    ui_state: &mut UiState,
    brush: &mut BrushSettings,
) {
    brush_size::radius(ui, view, ui_state, brush);
    let strength = egui::Slider::new(&mut brush.strength, 0.0..=1.0);
    let keys = view.both(Action::Weaker, Action::Stronger);
    let drag = view.keys.text(Action::DragStrength);
    let tip = tr!("brush-strength.tip", keys = keys, drag = drag);
    rows::slider(ui, strength, &tr!("brush-strength")).on_hover_text(tip);
    let carves = ui.checkbox(&mut brush.negative, tr!("brush-carve"));
    carves.on_hover_text(tr!("brush-carve.tip", action = view.tip(Action::Carve)));
}

/// A slider by the message of its name, whose attribute `tip` says what it means.
fn slider(
    ui: &mut egui::Ui,
    value: &mut f32,
    range: std::ops::RangeInclusive<f32>,
    name: &str,
) -> egui::Response {
    let tip = tr!(&format!("{name}.tip"));
    rows::slider(ui, egui::Slider::new(value, range), &tr!(name)).on_hover_text(tip)
}

/// A check box in the same way.
fn check(ui: &mut egui::Ui, value: &mut bool, name: &str) -> egui::Response {
    let tip = tr!(&format!("{name}.tip"));
    ui.checkbox(value, tr!(name)).on_hover_text(tip)
}

fn path(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    let path = &mut brush.path;
    slider(ui, &mut brush.spacing, 0.02..=1.0, "stroke-spacing");
    slider(ui, &mut path.rope, 0.0..=0.5, "stroke-stabilizer");
    slider(ui, &mut brush.steady, 0.0..=1.0, "stroke-steadiness");
    let average = egui::Slider::new(&mut path.average, 0..=64);
    rows::slider(ui, average, &tr!("stroke-average")).on_hover_text(tr!("stroke-average.tip"));
    slider(ui, &mut path.jitter, 0.0..=2.0, "stroke-jitter");
    if path.jitter > 0.0 {
        let seed = tr!("stroke-seed") + " ";
        ui.add(egui::DragValue::new(&mut path.seed).prefix(seed));
    }
    choice(ui, "stroke-method", &mut path.method, &METHODS);
    ui.checkbox(&mut path.continuous, tr!("stroke-continuous"));
    if path.continuous || path.method == Method::Airbrush {
        let ticks = egui::Slider::new(&mut path.every_ticks, 1.0..=1000.0).logarithmic(true);
        rows::slider(ui, ticks, &tr!("stroke-ticks"));
    }
    check(ui, &mut path.compensate, "stroke-compensate");
    check(ui, &mut brush.accumulate, "stroke-accumulate");
    slider(ui, &mut brush.saturation, 0.0..=20.0, "stroke-limit");
}

fn dab(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    if brush.falloff == Falloff::Custom {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (i, value) in brush.curve.iter_mut().enumerate() {
                let slider = egui::Slider::new(value, 0.0..=1.0).vertical().show_value(false);
                ui.add(slider).on_hover_text(tr!("dab-curve-tip", eighths = i));
            }
        });
    }
    slider(ui, &mut brush.hardness, 0.0..=0.95, "dab-hardness");
    slider(ui, &mut brush.auto_smooth, 0.0..=1.0, "dab-smoothing");
    slider(ui, &mut brush.normal_radius, 0.05..=2.0, "dab-averaging");
    slider(ui, &mut brush.plane_trim, 0.0..=2.0, "dab-plane-trim");
    slider(ui, &mut brush.tilt, 0.0..=1.0, "dab-tilt");
    let kind = brush.kind.name();
    for (value, extra) in brush.extra.iter_mut().zip(brush.kind.own_numbers()) {
        let id = format!("number-{}", extra.name);
        let (of_kind, of_all) = (format!("{id}.{kind}"), format!("{id}.about"));
        let about = text_of(&of_kind, &text_of(&of_all, extra.about));
        let number = egui::Slider::new(value, extra.min..=extra.max);
        rows::slider(ui, number, &text_or(&id, extra.name)).on_hover_text(about);
    }
}

fn stamp(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    let stamp = &mut brush.stamp;
    choice(ui, "stamp-stamp", &mut stamp.by, &STAMPS);
    if stamp.by == StampBy::Off {
        return;
    }
    let size = egui::Slider::new(&mut stamp.size, 0.05..=10.0).logarithmic(true);
    rows::slider(ui, size, &tr!("stamp-size"));
    let angle = egui::Slider::new(&mut stamp.turn_degrees, -180.0..=180.0);
    rows::slider(ui, angle, &tr!("stamp-angle"));
    ui.checkbox(&mut stamp.repeat, tr!("stamp-repeat"));
    if stamp.by == StampBy::Stencil {
        for (value, name) in stamp.at.iter_mut().zip(["stamp-right", "stamp-up"]) {
            rows::slider(ui, egui::Slider::new(value, -4.0..=4.0), &tr!(name))
                .on_hover_text(tr!("stamp-at-tip"));
        }
    }
}

fn automasks(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    let auto = &mut brush.auto;
    ui.checkbox(&mut auto.front_faces, tr!("automask-front"));
    ui.checkbox(&mut auto.topology, tr!("automask-topology"));
    ui.checkbox(&mut auto.face_sets, tr!("automask-sets"));
    check(ui, &mut auto.boundary, "automask-boundary");
    slider(ui, &mut auto.normal_degrees, 0.0..=180.0, "automask-normal");
    slider(ui, &mut auto.cavity, -1.0..=1.0, "automask-cavity");
}

fn topology(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    let topology = &mut brush.topology;
    choice(ui, "topology-by", &mut topology.by, &MEASURES);
    if topology.by == Measure::Off {
        return;
    }
    let length = egui::Slider::new(&mut topology.edge, 0.002..=1.0).logarithmic(true);
    rows::slider(ui, length, &tr!("topology-length"));
    ui.checkbox(&mut topology.split, tr!("topology-split"));
    ui.checkbox(&mut topology.collapse, tr!("topology-collapse"));
}

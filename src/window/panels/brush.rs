//! The brush: which one, of the program's and of a person's own, and all its settings.

use egui::{Pos2, Sense, Stroke, vec2};

use super::state::action::brush_title;
use super::state::{Action, UiRequest, View};
use super::theme;
use sculptd_clay::brush::{
    Alpha, BrushKind, BrushSettings, Falloff, Measure, Method, OwnBrush, StampBy,
};
use sculptd_engine::command::Command;

/// Those that are shown first; the others stand under "more".
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

const METHODS: [(Method, &str); 7] = [
    (Method::Space, "Evenly spaced"),
    (Method::Dots, "Dots"),
    (Method::Airbrush, "Airbrush"),
    (Method::Anchored, "Anchored"),
    (Method::DragDot, "Dragged dot"),
    (Method::Line, "Line"),
    (Method::Curve, "Curve by points"),
];

const STAMPS: [(StampBy, &str); 4] = [
    (StampBy::Off, "None"),
    (StampBy::Dab, "Under each dab"),
    (StampBy::View, "Along the view"),
    (StampBy::Stencil, "Stencil"),
];

const FALLOFFS: [(Falloff, &str); 8] = [
    (Falloff::Gaussian, "Gaussian"),
    (Falloff::Smooth, "Smooth"),
    (Falloff::Sphere, "Sphere"),
    (Falloff::Root, "Root"),
    (Falloff::Sharp, "Sharp"),
    (Falloff::Linear, "Linear"),
    (Falloff::Constant, "Constant"),
    (Falloff::Custom, "Custom"),
];

const MEASURES: [(Measure, &str); 4] = [
    (Measure::Off, "Off"),
    (Measure::Brush, "Share of the brush"),
    (Measure::Work, "Share of the object"),
    (Measure::View, "Share of the view"),
];

const ALPHAS: [(Alpha, &str); 9] = [
    (Alpha::Studs, "Studs"),
    (Alpha::Scales, "Scales"),
    (Alpha::Rope, "Rope"),
    (Alpha::Stitches, "Stitches"),
    (Alpha::Waves, "Waves"),
    (Alpha::Bricks, "Bricks"),
    (Alpha::Stone, "Stone"),
    (Alpha::Cracks, "Cracks"),
    (Alpha::Picture, "Loaded picture"),
];

/// One of several, in a list that unfolds.
fn choice<T: Copy + PartialEq>(ui: &mut egui::Ui, title: &str, value: &mut T, all: &[(T, &str)]) {
    let now = all.iter().find(|(v, _)| v == value).map_or("", |(_, name)| name);
    egui::ComboBox::from_label(title).selected_text(now).show_ui(ui, |ui| {
        for (v, name) in all {
            ui.selectable_value(value, *v, *name);
        }
    });
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<UiRequest>) {
    let mut brush: BrushSettings = view.state.brush;
    ui.strong("Brush");
    let first = |k: &&BrushKind| FIRST.contains(k);
    let mut palette = |ui: &mut egui::Ui, kinds: &mut dyn Iterator<Item = BrushKind>| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
            for kind in kinds {
                let chosen = brush.key() == (kind, 0);
                let response = picture(ui, kind, chosen);
                if response.on_hover_text(view.presets.get(kind).about()).clicked() && !chosen {
                    brush = view.presets.recalled(&brush, &view.state.kept_brushes, kind);
                }
            }
        });
    };
    palette(ui, &mut FIRST.into_iter());
    let chosen_below = !FIRST.contains(&view.state.brush.kind);
    let more = egui::CollapsingHeader::new("More brushes").default_open(false);
    more.show(ui, |ui| palette(ui, &mut BrushKind::ALL.iter().filter(|k| !first(k)).copied()));
    own_brushes(ui, view, &mut brush, out);
    if chosen_below {
        ui.label(format!("Brush: {}", brush_title(view.state.brush.kind)));
    }
    let keys = |a: Action, b: Action| format!("{} and {}", view.keys.text(a), view.keys.text(b));
    let radius = egui::Slider::new(&mut brush.radius, 0.005..=1.0).logarithmic(true).text("Radius");
    ui.add(radius).on_hover_text(format!(
        "Share of the object's size ({}, or {} and drag)",
        keys(Action::Smaller, Action::Larger),
        view.keys.text(Action::DragRadius)
    ));
    let strength = egui::Slider::new(&mut brush.strength, 0.0..=1.0).text("Strength");
    ui.add(strength).on_hover_text(format!(
        "How much one dab does ({}, or {} and drag)",
        keys(Action::Weaker, Action::Stronger),
        view.keys.text(Action::DragStrength)
    ));
    ui.checkbox(&mut brush.negative, "Carve")
        .on_hover_text(format!("{}; hold Ctrl for one stroke", view.tip(Action::Carve)));
    egui::CollapsingHeader::new("Stroke").default_open(false).show(ui, |ui| path(ui, &mut brush));
    egui::CollapsingHeader::new("More settings").default_open(false).show(ui, |ui| {
        egui::CollapsingHeader::new("Shape of a dab").show(ui, |ui| dab(ui, &mut brush));
        egui::CollapsingHeader::new("Alpha and stamp").show(ui, |ui| stamp(ui, &mut brush));
        egui::CollapsingHeader::new("Automatic masks").show(ui, |ui| automasks(ui, &mut brush));
        egui::CollapsingHeader::new("Dynamic topology").show(ui, |ui| topology(ui, &mut brush));
    });
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush.clamped())));
    }
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
    ui.label("Your own");
    ui.horizontal_wrapped(|ui| {
        for one in own.iter() {
            let chosen = view.state.brush.key() == one.settings.key();
            let button = ui.selectable_label(chosen, &one.name);
            if button.on_hover_text(own_hint(one)).clicked() {
                *brush = view.presets.taken(brush, &view.state.kept_brushes, one);
                if let Some(picture) = &one.picture {
                    out.push(UiRequest::World(Command::Picture(picture.clone())));
                }
            }
        }
    });
}

fn own_hint(own: &OwnBrush) -> String {
    let kind = brush_title(own.settings.kind);
    let what = if own.about.is_empty() { kind } else { format!("{kind}: {}", own.about) };
    format!("{what} (once more: as it was saved)")
}

/// A slider with what it means.
fn slider(
    ui: &mut egui::Ui,
    value: &mut f32,
    range: std::ops::RangeInclusive<f32>,
    name: &str,
    about: &str,
) {
    ui.add(egui::Slider::new(value, range).text(name)).on_hover_text(about);
}

fn path(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    let path = &mut brush.path;
    slider(
        ui,
        &mut brush.spacing,
        0.02..=1.0,
        "Spacing",
        "Distance between dabs as a share of the radius",
    );
    slider(
        ui,
        &mut path.rope,
        0.0..=0.5,
        "Stabilizer",
        "The brush follows the pen at this distance: a share of the view's height",
    );
    slider(
        ui,
        &mut brush.steady,
        0.0..=1.0,
        "Steadiness",
        "Length of the string by which the brush follows the pen, in radii",
    );
    let average = egui::Slider::new(&mut path.average, 0..=64).text("Averaged reports");
    ui.add(average).on_hover_text("The brush goes to the mean of so many reports of the pen");
    slider(
        ui,
        &mut path.jitter,
        0.0..=2.0,
        "Jitter",
        "How far dabs are scattered about the path, in radii",
    );
    if path.jitter > 0.0 {
        ui.add(egui::DragValue::new(&mut path.seed).prefix("Seed of the jitter: "));
    }
    choice(ui, "Method", &mut path.method, &METHODS);
    ui.checkbox(&mut path.continuous, "Go on while the pen rests");
    if path.continuous || path.method == Method::Airbrush {
        let ticks = egui::Slider::new(&mut path.every_ticks, 1.0..=1000.0).logarithmic(true);
        ui.add(ticks.text("Ticks between dabs at rest"));
    }
    ui.checkbox(&mut path.compensate, "Same strength at any spacing")
        .on_hover_text("Strength counts over the way of the pen; off: each dab has all of it");
    ui.checkbox(&mut brush.accumulate, "Accumulate")
        .on_hover_text("A stroke builds upon what it has raised itself");
    slider(
        ui,
        &mut brush.saturation,
        0.0..=20.0,
        "Limit of a stroke",
        "How far a stroke may move a point, in heights of one full dab; 0: no limit",
    );
}

fn dab(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    choice(ui, "Falloff", &mut brush.falloff, &FALLOFFS);
    if brush.falloff == Falloff::Custom {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (i, value) in brush.curve.iter_mut().enumerate() {
                let slider = egui::Slider::new(value, 0.0..=1.0).vertical().show_value(false);
                ui.add(slider).on_hover_text(format!("At {i} eighths of the radius"));
            }
        });
    }
    slider(
        ui,
        &mut brush.hardness,
        0.0..=0.95,
        "Hardness",
        "Share of the radius within which the brush works in full",
    );
    slider(
        ui,
        &mut brush.auto_smooth,
        0.0..=1.0,
        "Smoothing",
        "Each dab is smoothed at this strength",
    );
    slider(
        ui,
        &mut brush.normal_radius,
        0.05..=2.0,
        "Averaging",
        "Share of the radius over which the plane of the surface is averaged",
    );
    slider(
        ui,
        &mut brush.plane_trim,
        0.0..=2.0,
        "Plane trim",
        "What is further from the plane stays, in radii; 0: nothing",
    );
    slider(ui, &mut brush.tilt, 0.0..=1.0, "Tilt", "How much a dab leans as the pen does");
    for (value, extra) in brush.extra.iter_mut().zip(brush.kind.own_numbers()) {
        slider(ui, value, extra.min..=extra.max, extra.name, extra.about);
    }
    ui.horizontal(|ui| {
        ui.color_edit_button_srgba_unmultiplied(&mut brush.colour);
        ui.label("Colour");
    });
}

fn stamp(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    choice(ui, "Alpha", &mut brush.alpha, &ALPHAS);
    let stamp = &mut brush.stamp;
    choice(ui, "Stamp", &mut stamp.by, &STAMPS);
    if stamp.by == StampBy::Off {
        return;
    }
    ui.add(egui::Slider::new(&mut stamp.size, 0.05..=10.0).logarithmic(true).text("Stamp size"));
    ui.add(egui::Slider::new(&mut stamp.turn_degrees, -180.0..=180.0).text("Stamp angle"));
    ui.checkbox(&mut stamp.repeat, "Repeat the stamp");
    if stamp.by == StampBy::Stencil {
        for (value, name) in stamp.at.iter_mut().zip(["Stencil right", "Stencil up"]) {
            slider(ui, value, -4.0..=4.0, name, "From the middle of the view, in its heights");
        }
    }
}

fn automasks(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    let auto = &mut brush.auto;
    ui.checkbox(&mut auto.front_faces, "Front faces only");
    ui.checkbox(&mut auto.topology, "Only connected parts");
    ui.checkbox(&mut auto.boundary, "Borders stay")
        .on_hover_text("The border of an open surface does not move");
    slider(
        ui,
        &mut auto.normal_degrees,
        0.0..=180.0,
        "Normal limit",
        "Only what turns from the dab's normal by at most so many degrees; 0: everything",
    );
    slider(
        ui,
        &mut auto.cavity,
        -1.0..=1.0,
        "Cavity",
        "Above 0 only hollows are touched, below 0 only ridges",
    );
}

fn topology(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    let topology = &mut brush.topology;
    choice(ui, "Length of edges", &mut topology.by, &MEASURES);
    if topology.by == Measure::Off {
        return;
    }
    ui.add(egui::Slider::new(&mut topology.edge, 0.002..=1.0).logarithmic(true).text("Length"));
    ui.checkbox(&mut topology.split, "Split longer edges");
    ui.checkbox(&mut topology.collapse, "Collapse shorter edges");
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
        BrushKind::Mask | BrushKind::MaskBlur | BrushKind::Paint => 0.25,
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
    ui.painter().text(at, egui::Align2::CENTER_BOTTOM, name, font, text);
    response
}

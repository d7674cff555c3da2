//! The brush: which one, radius, strength, its own numbers.

use egui::{Pos2, Sense, Stroke, vec2};

use super::state::{Action, UiRequest, View};
use super::theme;
use sculptd_clay::brush::{BrushKind, BrushSettings, Method, StampBy};
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

/// One of several, in a list that unfolds.
fn choice<T: Copy + PartialEq>(ui: &mut egui::Ui, title: &str, value: &mut T, all: &[(T, &str)]) {
    let now = all.iter().find(|(v, _)| v == value).map_or("", |(_, name)| name);
    egui::ComboBox::from_label(title).selected_text(now).show_ui(ui, |ui| {
        for (v, name) in all {
            ui.selectable_value(value, *v, *name);
        }
    });
}

/// What a button says: `clay-strips` becomes `Clay strips`.
fn title(kind: BrushKind) -> String {
    let name = kind.name().replace('-', " ");
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |c| c.to_uppercase().chain(letters).collect())
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<UiRequest>) {
    let mut brush: BrushSettings = view.state.brush;
    ui.strong("Brush");
    let first = |k: &&BrushKind| FIRST.contains(k);
    let mut palette = |ui: &mut egui::Ui, kinds: &mut dyn Iterator<Item = BrushKind>| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
            for kind in kinds {
                let response = picture(ui, kind, brush.kind == kind);
                if response.on_hover_text(view.presets.get(kind).about()).clicked()
                    && brush.kind != kind
                {
                    brush = view.presets.recalled(&brush, &view.state.kept_brushes, kind);
                }
            }
        });
    };
    palette(ui, &mut FIRST.into_iter());
    let chosen_below = !FIRST.contains(&view.state.brush.kind);
    let more = egui::CollapsingHeader::new("More brushes").default_open(false);
    more.show(ui, |ui| palette(ui, &mut BrushKind::ALL.iter().filter(|k| !first(k)).copied()));
    if chosen_below {
        ui.label(format!("Brush: {}", title(view.state.brush.kind)));
    }
    let keys = |a: Action, b: Action| {
        let of = |a: Action| a.entry().keys.map_or(String::new(), |k| k.to_string());
        format!("{} and {}", of(a), of(b))
    };
    let radius = egui::Slider::new(&mut brush.radius, 0.005..=1.0).logarithmic(true).text("Radius");
    ui.add(radius).on_hover_text(format!(
        "Share of the object's size ({}, or F and drag)",
        keys(Action::Smaller, Action::Larger)
    ));
    let strength = egui::Slider::new(&mut brush.strength, 0.0..=1.0).text("Strength");
    ui.add(strength).on_hover_text(format!(
        "How much one dab does ({}, or Shift+F and drag)",
        keys(Action::Weaker, Action::Stronger)
    ));
    ui.checkbox(&mut brush.negative, "Carve")
        .on_hover_text(format!("{}; hold Ctrl for one stroke", Action::Carve.tip()));
    egui::CollapsingHeader::new("Stroke").default_open(false).show(ui, |ui| {
        ui.add(egui::Slider::new(&mut brush.spacing, 0.02..=1.0).text("Spacing"))
            .on_hover_text("Distance between dabs as a share of the radius");
        ui.add(egui::Slider::new(&mut brush.path.rope, 0.0..=0.5).text("Stabilizer"))
            .on_hover_text(
                "The brush follows the pen at this distance: a share of the view's height",
            );
        ui.add(egui::Slider::new(&mut brush.path.jitter, 0.0..=2.0).text("Jitter"))
            .on_hover_text("How far dabs are scattered about the path, in radii");
        choice(ui, "Method", &mut brush.path.method, &METHODS);
        choice(ui, "Stamp", &mut brush.stamp.by, &STAMPS);
        if brush.stamp.by != StampBy::Off {
            ui.add(
                egui::Slider::new(&mut brush.stamp.size, 0.05..=10.0)
                    .logarithmic(true)
                    .text("Stamp size"),
            );
            ui.add(
                egui::Slider::new(&mut brush.stamp.turn_degrees, -180.0..=180.0)
                    .text("Stamp angle"),
            );
            ui.checkbox(&mut brush.stamp.repeat, "Repeat the stamp");
        }
        ui.checkbox(&mut brush.auto.front_faces, "Front faces only");
        ui.checkbox(&mut brush.auto.topology, "Only connected parts");
        for (value, extra) in brush.extra.iter_mut().zip(brush.kind.own_numbers()) {
            ui.add(egui::Slider::new(value, extra.min..=extra.max).text(extra.name))
                .on_hover_text(extra.about);
        }
    });
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush.clamped())));
    }
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
    let name = title(kind);
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

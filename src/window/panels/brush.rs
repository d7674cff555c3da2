//! The brush: which one, of the program's and of a person's own, and all its settings.

use egui::{Pos2, Sense, Stroke, vec2};

use super::rows;
use super::state::action::brush_title;
use super::state::{Action, UiRequest, View};
use super::theme;
use crate::language::tr;
use crate::language::{text_of, text_or};
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

const ALPHAS: [(Alpha, &str); 9] = [
    (Alpha::Studs, "alpha-studs"),
    (Alpha::Scales, "alpha-scales"),
    (Alpha::Rope, "alpha-rope"),
    (Alpha::Stitches, "alpha-stitches"),
    (Alpha::Waves, "alpha-waves"),
    (Alpha::Bricks, "alpha-bricks"),
    (Alpha::Stone, "alpha-stone"),
    (Alpha::Cracks, "alpha-cracks"),
    (Alpha::Picture, "alpha-picture"),
];

/// One of several, in a list that unfolds; `title` and the names are messages.
fn choice<T: Copy + PartialEq>(ui: &mut egui::Ui, title: &str, value: &mut T, all: &[(T, &str)]) {
    let now = all.iter().find(|(v, _)| v == value).map_or_else(String::new, |(_, name)| tr!(name));
    rows::list(ui, &tr!(title), now, |ui| {
        for (v, name) in all {
            ui.selectable_value(value, *v, tr!(name));
        }
    });
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<UiRequest>) {
    let mut brush: BrushSettings = view.state.brush;
    ui.strong(tr!("brush-heading"));
    let first = |k: &&BrushKind| FIRST.contains(k);
    let mut palette = |ui: &mut egui::Ui, kinds: &mut dyn Iterator<Item = BrushKind>| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
            for kind in kinds {
                let chosen = brush.key() == (kind, 0);
                let response = picture(ui, kind, chosen);
                let about = view.presets.get(kind).about();
                let about = text_of(&format!("kind-{}.about", kind.name()), about);
                if response.on_hover_text(about).clicked() && !chosen {
                    brush = view.presets.recalled(&brush, &view.state.kept_brushes, kind);
                }
            }
        });
    };
    palette(ui, &mut FIRST.into_iter());
    let chosen_below = !FIRST.contains(&view.state.brush.kind);
    let more = folded("brush-more");
    more.show(ui, |ui| palette(ui, &mut BrushKind::ALL.iter().filter(|k| !first(k)).copied()));
    own_brushes(ui, view, &mut brush, out);
    if chosen_below {
        ui.label(tr!("brush-now", name = brush_title(view.state.brush.kind)));
    }
    let keys = |a: Action, b: Action| {
        tr!("both-keys", first = view.keys.text(a), second = view.keys.text(b))
    };
    let radius = egui::Slider::new(&mut brush.radius, 0.005..=1.0).logarithmic(true);
    let (both, drag) = (keys(Action::Smaller, Action::Larger), view.keys.text(Action::DragRadius));
    rows::slider(ui, radius, &tr!("brush-radius")).on_hover_text(tr!(
        "brush-radius.tip",
        keys = both,
        drag = drag
    ));
    let strength = egui::Slider::new(&mut brush.strength, 0.0..=1.0);
    let both = keys(Action::Weaker, Action::Stronger);
    let drag = view.keys.text(Action::DragStrength);
    rows::slider(ui, strength, &tr!("brush-strength")).on_hover_text(tr!(
        "brush-strength.tip",
        keys = both,
        drag = drag
    ));
    ui.checkbox(&mut brush.negative, tr!("brush-carve"))
        .on_hover_text(tr!("brush-carve.tip", action = view.tip(Action::Carve)));
    folded("brush-stroke").show(ui, |ui| path(ui, &mut brush));
    folded("brush-settings").show(ui, |ui| {
        folded("brush-dab").show(ui, |ui| dab(ui, &mut brush));
        folded("brush-stamp").show(ui, |ui| stamp(ui, &mut brush));
        folded("brush-automasks").show(ui, |ui| automasks(ui, &mut brush));
        folded("brush-topology").show(ui, |ui| topology(ui, &mut brush));
    });
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush.clamped())));
    }
}

/// A part that is folded at first, by the message of its title.
fn folded(title: &'static str) -> egui::CollapsingHeader {
    egui::CollapsingHeader::new(tr!(title)).id_salt(title).default_open(false)
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
    let what = match own.about.is_empty() {
        true => kind,
        false => tr!("brush-own-about", kind = kind, about = own.about.as_str()),
    };
    tr!("brush-own.tip", what = what)
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
    choice(ui, "dab-falloff", &mut brush.falloff, &FALLOFFS);
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
    ui.horizontal(|ui| {
        ui.color_edit_button_srgba_unmultiplied(&mut brush.colour);
        ui.label(tr!("dab-colour"));
    });
}

fn stamp(ui: &mut egui::Ui, brush: &mut BrushSettings) {
    choice(ui, "stamp-alpha", &mut brush.alpha, &ALPHAS);
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

//! The numbers of the active object: where it stands, and what it was made of. They are sent when a
//! person lets go of them, so that a drag is one step of undo.

use std::cell::Cell;

use glam::{DQuat, DVec3, EulerRot};

use super::state::{Outliner, UiRequest, View};
use super::{rows, theme};
use crate::language::tr;
use sculptd_engine::command::Command;
use sculptd_engine::scene::{ObjectTransform, ObjectView, Primitive, PrimitiveShape, SceneCommand};

/// Asks the scene for a change.
pub fn ask(out: &mut Vec<UiRequest>, command: SceneCommand) {
    out.push(UiRequest::World(Command::Scene(command)));
}

/// Shows where the active object stands, and what it was made of.
pub fn ui(
    ui: &mut egui::Ui,
    view: &View<'_>,
    active: &ObjectView,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    if active.settings.locked {
        ui.colored_label(theme::quiet(ui), tr!("objects-locked"));
        return;
    }
    place(ui, active, view.state.extent, outliner, out);
    let untouched = view.state.mesh.revision() == 0;
    if let Some(primitive) = active.settings.primitive.filter(|_| untouched) {
        numbers(ui, active, primitive, outliner, out);
    }
}

/// A number as a drag shows it; what rounds to zero has no sign.
fn plain_number(value: f64, decimals: std::ops::RangeInclusive<usize>) -> String {
    let text = egui::emath::format_with_decimals_in_range(value, decimals);
    let zero = text.chars().all(|c| !c.is_ascii_digit() || c == '0');
    if zero { text.trim_start_matches(['-', '\u{2212}']).into() } else { text }
}

/// Shows the transform of the active object.
fn place(
    ui: &mut egui::Ui,
    object: &ObjectView,
    extent: f32,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    let now = object.settings.transform;
    let mut shown = outliner.place.filter(|p| p.0 == object.id).map_or(now, |p| p.1);
    let before = shown;
    let done = Cell::new(false);
    let drag = |ui: &mut egui::Ui, value: &mut f64, (speed, unit): (f64, &str), name: &str| {
        let value = egui::DragValue::new(value).speed(speed).custom_formatter(plain_number);
        let response = rows::value(ui, name, value.suffix(unit));
        done.set(done.get() || response.drag_stopped() || response.lost_focus());
    };
    let (step, unit) = (f64::from(extent) * 0.01, format!(" {}", tr!("unit-mm")));
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let name = tr!("objects-position", axis = name);
        drag(ui, &mut shown.shift[axis], (step, &unit), &name);
    }
    let (yaw, pitch, roll) = shown.turn.to_euler(EulerRot::YXZ);
    let mut degrees = [yaw, pitch, roll].map(f64::to_degrees);
    let turned = degrees;
    for (angle, name) in degrees.iter_mut().zip(["scene-yaw", "scene-pitch", "scene-roll"]) {
        drag(ui, angle, (1.0, "°"), &tr!(name));
    }
    if degrees != turned {
        let [yaw, pitch, roll] = degrees.map(f64::to_radians);
        shown.turn = DQuat::from_euler(EulerRot::YXZ, yaw, pitch, roll).normalize();
    }
    drag(ui, &mut shown.scale, (0.01, ""), &tr!("scene-scale"));
    if shown != ObjectTransform::NONE {
        let reset = ui.button(tr!("objects-reset-place"));
        if reset.on_hover_text(tr!("objects-reset-place.tip")).clicked() {
            shown = ObjectTransform { shift: DVec3::ZERO, ..ObjectTransform::NONE };
            done.set(true);
        }
    }
    shown.scale = shown.scale.clamp(1e-6, 1e6);
    if shown != before {
        outliner.place = Some((object.id, shown));
    }
    if done.get() {
        outliner.place = None;
        if shown != now && shown.is_sane() {
            ask(out, SceneCommand::Transform(object.id, shown));
        }
    }
}

/// Returns the name of a shape.
fn shape_title(shape: &PrimitiveShape) -> String {
    tr!(match shape {
        PrimitiveShape::Box(_) => "shape-box",
        PrimitiveShape::Ball(_) => "shape-ball",
        PrimitiveShape::Cylinder(_) => "shape-cylinder",
        PrimitiveShape::Cone(_) => "shape-cone",
        PrimitiveShape::Torus(_) => "shape-torus",
        PrimitiveShape::Tube(_) => "shape-tube",
        PrimitiveShape::Plane(_) => "shape-plane",
    })
}

/// The numbers that the active object was made of.
fn numbers(
    ui: &mut egui::Ui,
    object: &ObjectView,
    now: Primitive,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    let mut shown = outliner.primitive.filter(|p| p.0 == object.id).map_or(now, |p| p.1);
    let before = shown;
    let mut done = false;
    rows::flow(ui, |ui| {
        ui.colored_label(theme::quiet(ui), shape_title(&now.shape));
        let all: &mut [f64] = match &mut shown.shape {
            PrimitiveShape::Box(n) | PrimitiveShape::Tube(n) => n,
            PrimitiveShape::Ball(n) => std::slice::from_mut(n),
            PrimitiveShape::Cylinder(n)
            | PrimitiveShape::Cone(n)
            | PrimitiveShape::Torus(n)
            | PrimitiveShape::Plane(n) => n,
        };
        for n in all {
            let speed = n.abs() * 0.01;
            let response = ui.add(egui::DragValue::new(n).speed(speed).range(1e-6..=1e6));
            done |= response.drag_stopped() || response.lost_focus();
        }
    });
    if shown != before {
        outliner.primitive = Some((object.id, shown));
    }
    if done {
        outliner.primitive = None;
        if shown.shape != now.shape {
            shown.edge = shown.shape.usual_edge();
            out.push(UiRequest::Reshape(object.id, shown));
        }
    }
}

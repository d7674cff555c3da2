//! The outliner: every object of the scene with its name, its eye and its lock; what can be done to
//! the active one; the numbers of where it stands and of what it was made of.
//!
//! Numbers are sent when a person lets go of them, so that a drag is one step of undo.

use std::cell::Cell;

use glam::{DQuat, DVec3, EulerRot};

use super::state::{Outliner, Pairing, SnapPicks, UiRequest, UiState, View};
use super::theme;
use sculptd_engine::command::Command;
use sculptd_engine::scene::{ObjectTransform, ObjectView, Primitive, PrimitiveShape, SceneCommand};
use sculptd_geometry::boolean::Operation;

/// A name, and the primitive of a size.
type SizedPrimitive = (&'static str, fn(f64) -> PrimitiveShape);

/// Primitives at the size of a scene: lengths are multiples of the active object's bounding radius.
const PRIMITIVES: [SizedPrimitive; 7] = [
    ("Box", |r| PrimitiveShape::Box([r; 3])),
    ("Ball", |r| PrimitiveShape::Ball(r * 0.5)),
    ("Cylinder", |r| PrimitiveShape::Cylinder([r * 0.5, r])),
    ("Cone", |r| PrimitiveShape::Cone([r * 0.5, r])),
    ("Torus", |r| PrimitiveShape::Torus([r * 0.5, r * 0.2])),
    ("Tube", |r| PrimitiveShape::Tube([r * 0.5, r * 0.35, r])),
    ("Plane", |r| PrimitiveShape::Plane([r; 2])),
];

const PAIRINGS: [(Operation, &str, &str); 4] = [
    (Operation::Union, "Union", "The active object and this one become one"),
    (Operation::Intersection, "Intersection", "Only what lies in both stays"),
    (Operation::Difference, "Difference", "This object is cut out of the active one"),
    (Operation::ReverseDifference, "Reverse difference", "The active one is cut out of this one"),
];

fn ask(out: &mut Vec<UiRequest>, command: SceneCommand) {
    out.push(UiRequest::World(Command::Scene(command)));
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let scene = &view.state.scene;
    ui.horizontal(|ui| {
        ui.strong("Objects");
        ui.menu_button("Add object", |ui| {
            for (name, shape) in PRIMITIVES {
                if ui.button(name).clicked() {
                    let shape = shape(f64::from(view.state.extent.max(1e-6)));
                    let edge = shape.usual_edge();
                    out.push(UiRequest::AddPrimitive(Primitive { shape, edge }));
                    ui.close();
                }
            }
        });
    });
    let busy = ui_state.joining;
    for (i, object) in scene.objects.iter().enumerate() {
        row(ui, object, i == scene.active, busy, &mut ui_state.outliner, out);
    }
    let Some(active) = scene.active() else { return };
    let id = active.id;
    ui.horizontal(|ui| {
        if ui.button("Duplicate").clicked() {
            ask(out, SceneCommand::Duplicate(id));
        }
        if ui.button("Rename").clicked() {
            ui_state.outliner.renaming = Some((id, active.settings.name.clone()));
        }
        let more = scene.objects.len() > 1 && !active.settings.locked;
        if more && ui.button("Remove").clicked() {
            ask(out, SceneCommand::Remove(id));
        }
    });
    ui.horizontal(|ui| {
        let gizmo = ui.selectable_label(ui_state.outliner.gizmo, "Gizmo");
        if gizmo.on_hover_text("Move, turn and scale it by the pointer; Ctrl: in steps").clicked() {
            ui_state.outliner.gizmo = !ui_state.outliner.gizmo;
        }
        let picking = ui_state.outliner.snapping;
        let label = match picking {
            None => "Snap face to face",
            Some(SnapPicks { moved: None }) => "Press on the face to move",
            Some(_) => "Press on the face to lay it on",
        };
        let button = ui.add_enabled(
            scene.objects.len() > 1,
            egui::Button::selectable(picking.is_some(), label),
        );
        if button.on_hover_text("Lays a flat face of one object flush on one of another").clicked()
        {
            ui_state.outliner.snapping = picking.is_none().then(SnapPicks::default);
        }
    });
    if active.settings.locked {
        ui.colored_label(theme::quiet(ui), "Locked: no stroke, no move, no removal");
    } else {
        place(ui, active, view.state.extent, &mut ui_state.outliner, out);
        let untouched = view.state.mesh.revision() == 0;
        if let Some(primitive) = active.settings.primitive.filter(|_| untouched) {
            numbers(ui, active, primitive, &mut ui_state.outliner, out);
        }
    }
    ui.separator();
}

fn row(
    ui: &mut egui::Ui,
    object: &ObjectView,
    active: bool,
    busy: bool,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    let (id, settings) = (object.id, &object.settings);
    ui.horizontal(|ui| {
        let eye = ui.selectable_label(settings.visible, "eye").on_hover_text("Drawn");
        if eye.clicked() {
            ask(out, SceneCommand::Show(id, !settings.visible));
        }
        let lock = ui.selectable_label(settings.locked, "lock");
        if lock.on_hover_text("Protected from strokes, moves and removal").clicked() {
            ask(out, SceneCommand::Lock(id, !settings.locked));
        }
        if let Some((renamed, text)) = outliner.renaming.as_mut().filter(|r| r.0 == id) {
            let field = ui.text_edit_singleline(text);
            if field.lost_focus() {
                ask(out, SceneCommand::Rename(*renamed, text.clone()));
                outliner.renaming = None;
            } else {
                field.request_focus();
            }
            return;
        }
        let name = egui::Button::selectable(active, &settings.name).truncate();
        let name = ui.add(name);
        if name.double_clicked() {
            outliner.renaming = Some((id, settings.name.clone()));
        } else if name.clicked() && !active {
            ask(out, SceneCommand::Activate(id));
        }
        if !active {
            name.context_menu(|ui| {
                for (operation, label, tip) in PAIRINGS {
                    let button = ui.add_enabled(!busy, egui::Button::new(label));
                    if button.on_hover_text(tip).clicked() {
                        let pairing = Pairing { operation, with: id };
                        out.push(UiRequest::BooleanWith(pairing));
                        ui.close();
                    }
                }
            });
        }
    });
}

/// A number as a drag shows it; what rounds to zero has no sign.
fn plain_number(value: f64, decimals: std::ops::RangeInclusive<usize>) -> String {
    let text = egui::emath::format_with_decimals_in_range(value, decimals);
    let zero = text.chars().all(|c| !c.is_ascii_digit() || c == '0');
    if zero { text.trim_start_matches(['-', '\u{2212}']).into() } else { text }
}

/// Where the active object stands.
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
    let drag = |ui: &mut egui::Ui, value: &mut f64, speed: f64, name: &str| {
        let value = egui::DragValue::new(value).speed(speed).custom_formatter(plain_number);
        let response = ui.add(value.prefix(format!("{name} ")));
        done.set(done.get() || response.drag_stopped() || response.lost_focus());
    };
    let step = f64::from(extent) * 0.01;
    ui.horizontal(|ui| {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            drag(ui, &mut shown.shift[axis], step, name);
        }
    });
    let (yaw, pitch, roll) = shown.turn.to_euler(EulerRot::YXZ);
    let mut degrees = [yaw, pitch, roll].map(f64::to_degrees);
    let turned = degrees;
    ui.horizontal(|ui| {
        for (angle, name) in degrees.iter_mut().zip(["yaw", "pitch", "roll"]) {
            drag(ui, angle, 1.0, name);
        }
    });
    if degrees != turned {
        let [yaw, pitch, roll] = degrees.map(f64::to_radians);
        shown.turn = DQuat::from_euler(EulerRot::YXZ, yaw, pitch, roll).normalize();
    }
    ui.horizontal(|ui| {
        drag(ui, &mut shown.scale, 0.01, "scale");
        if ui.button("Reset place").on_hover_text("Back to where it was made").clicked() {
            shown = ObjectTransform { shift: DVec3::ZERO, ..ObjectTransform::NONE };
            done.set(true);
        }
    });
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
    ui.horizontal(|ui| {
        ui.colored_label(theme::quiet(ui), now.shape.name());
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

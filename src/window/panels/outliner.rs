//! The outliner: every object of the scene with its name, its eye and its lock; what can be done to
//! the active one; the numbers of where it stands and of what it was made of.
//!
//! Numbers are sent when a person lets go of them, so that a drag is one step of undo.

use std::cell::Cell;

use glam::{DQuat, DVec3, EulerRot};

use super::rows;
use super::state::{Outliner, Pairing, SnapPicks, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use sculptd_engine::command::Command;
use sculptd_engine::scene::{ObjectTransform, ObjectView, Primitive, PrimitiveShape, SceneCommand};
use sculptd_geometry::boolean::Operation;

/// The message of a name, and the primitive of a size.
type SizedPrimitive = (&'static str, fn(f64) -> PrimitiveShape);

/// Primitives at the size of a scene: lengths are multiples of the active object's bounding radius.
const PRIMITIVES: [SizedPrimitive; 7] = [
    ("shape-box", |r| PrimitiveShape::Box([r; 3])),
    ("shape-ball", |r| PrimitiveShape::Ball(r * 0.5)),
    ("shape-cylinder", |r| PrimitiveShape::Cylinder([r * 0.5, r])),
    ("shape-cone", |r| PrimitiveShape::Cone([r * 0.5, r])),
    ("shape-torus", |r| PrimitiveShape::Torus([r * 0.5, r * 0.2])),
    ("shape-tube", |r| PrimitiveShape::Tube([r * 0.5, r * 0.35, r])),
    ("shape-plane", |r| PrimitiveShape::Plane([r; 2])),
];

/// Each with the message of its name.
const PAIRINGS: [(Operation, &str); 4] = [
    (Operation::Union, "operation-union"),
    (Operation::Intersection, "operation-intersection"),
    (Operation::Difference, "operation-difference"),
    (Operation::ReverseDifference, "operation-reverse-difference"),
];

fn ask(out: &mut Vec<UiRequest>, command: SceneCommand) {
    out.push(UiRequest::World(Command::Scene(command)));
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let scene = &view.state.scene;
    ui.horizontal(|ui| {
        ui.strong(tr!("objects-heading"));
        ui.menu_button(tr!("objects-add"), |ui| {
            for (name, shape) in PRIMITIVES {
                if ui.button(tr!(name)).clicked() {
                    let shape = shape(f64::from(view.state.extent.max(1e-6)));
                    let edge = shape.usual_edge();
                    out.push(UiRequest::AddPrimitive(Primitive { shape, edge }));
                    ui.close();
                }
            }
        });
    });
    let busy = ui_state.joining;
    let mut group = "";
    for (i, object) in scene.objects.iter().enumerate() {
        // Consecutive objects of one group have its name above them.
        if object.settings.group != group {
            group = &object.settings.group;
            if !group.is_empty() {
                ui.colored_label(theme::quiet(ui), group);
            }
        }
        row(ui, object, i == scene.active, busy, &mut ui_state.outliner, out);
    }
    let Some(active) = scene.active() else { return };
    let id = active.id;
    rows::flow(ui, |ui| {
        if ui.button(tr!("objects-duplicate")).clicked() {
            ask(out, SceneCommand::Duplicate(id));
        }
        if ui.button(tr!("objects-rename")).clicked() {
            ui_state.outliner.renaming = Some((id, active.settings.name.clone()));
        }
        let more = scene.objects.len() > 1 && !active.settings.locked;
        if more && ui.button(tr!("objects-remove")).clicked() {
            ask(out, SceneCommand::Remove(id));
        }
    });
    arrange(ui, view, active, &mut ui_state.outliner, out);
    rows::flow(ui, |ui| {
        let gizmo = ui.selectable_label(ui_state.outliner.gizmo, tr!("objects-gizmo"));
        if gizmo.on_hover_text(tr!("objects-gizmo.tip")).clicked() {
            ui_state.outliner.gizmo = !ui_state.outliner.gizmo;
        }
        let picking = ui_state.outliner.snapping;
        let label = match picking {
            None => "objects-snap",
            Some(SnapPicks { moved: None }) => "objects-snap-first",
            Some(_) => "objects-snap-second",
        };
        let button = ui.add_enabled(
            scene.objects.len() > 1,
            egui::Button::selectable(picking.is_some(), tr!(label)),
        );
        if button.on_hover_text(tr!("objects-snap.tip")).clicked() {
            ui_state.outliner.snapping = picking.is_none().then(SnapPicks::default);
        }
    });
    if active.settings.locked {
        ui.colored_label(theme::quiet(ui), tr!("objects-locked"));
    } else {
        place(ui, active, view.state.extent, &mut ui_state.outliner, out);
        let untouched = view.state.mesh.revision() == 0;
        if let Some(primitive) = active.settings.primitive.filter(|_| untouched) {
            numbers(ui, active, primitive, &mut ui_state.outliner, out);
        }
    }
    ui.separator();
}

/// Arranges the active object: its place in the list, its mirrored duplicate, and its live Boolean.
fn arrange(
    ui: &mut egui::Ui,
    view: &View<'_>,
    active: &ObjectView,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    let scene = &view.state.scene;
    let (id, place) = (active.id, scene.active);
    rows::flow(ui, |ui| {
        let mut to = |ui: &mut egui::Ui, can: bool, name: &str, place: usize| {
            if ui.add_enabled(can, egui::Button::new(tr!(name))).clicked() {
                ask(out, SceneCommand::Move(id, place as u32));
            }
        };
        to(ui, place > 0, "layers-up", place.saturating_sub(1));
        to(ui, place + 1 < scene.objects.len(), "layers-down", place + 1);
        let group = ui.button(tr!("objects-group"));
        if group.on_hover_text(tr!("objects-group.tip")).clicked() {
            outliner.grouping = Some((id, active.settings.group.clone()));
        }
        ui.menu_button(tr!("objects-mirror"), |ui| {
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                if ui.button(name).clicked() {
                    out.push(UiRequest::Mirror(id, axis));
                    ui.close();
                }
            }
        });
    });
    if let Some((grouped, text)) = outliner.grouping.as_mut().filter(|g| g.0 == id) {
        let field = ui.text_edit_singleline(text);
        if field.lost_focus() {
            ask(out, SceneCommand::Group(vec![*grouped], text.trim().into()));
            outliner.grouping = None;
        } else {
            field.request_focus();
        }
    }
    if scene.objects.len() > 1 {
        let live = ui.checkbox(&mut outliner.live, tr!("objects-live"));
        live.on_hover_text(tr!("objects-live.tip"));
    }
    if active.live(&view.state.mesh).is_some() {
        rows::flow(ui, |ui| {
            ui.colored_label(theme::quiet(ui), tr!("objects-follows"));
            let apply = ui.button(tr!("objects-apply"));
            if apply.on_hover_text(tr!("objects-apply.tip")).clicked() {
                ask(out, SceneCommand::ApplyLive(id));
            }
        });
    }
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
        let eye = ui.selectable_label(settings.visible, tr!("objects-eye"));
        let eye = eye.on_hover_text(tr!("objects-eye.tip"));
        if eye.clicked() {
            ask(out, SceneCommand::Show(id, !settings.visible));
        }
        let lock = ui.selectable_label(settings.locked, tr!("objects-lock"));
        if lock.on_hover_text(tr!("objects-lock.tip")).clicked() {
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
                for (operation, name) in PAIRINGS {
                    let button = ui.add_enabled(!busy, egui::Button::new(tr!(name)));
                    if button.on_hover_text(tr!(&format!("{name}.tip"))).clicked() {
                        let (with, live) = (id, outliner.live);
                        let pairing = Pairing { operation, with, live, all: false };
                        out.push(UiRequest::BooleanWith(pairing));
                        ui.close();
                    }
                }
                let all = ui.add_enabled(!busy, egui::Button::new(tr!("operation-all")));
                if all.on_hover_text(tr!("operation-all.tip")).clicked() {
                    let operation = Operation::Union;
                    let pairing = Pairing { operation, with: id, live: false, all: true };
                    out.push(UiRequest::BooleanWith(pairing));
                    ui.close();
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
    let drag = |ui: &mut egui::Ui, value: &mut f64, speed: f64, name: &str| {
        let value = egui::DragValue::new(value).speed(speed).custom_formatter(plain_number);
        let response = ui.add(value.prefix(format!("{name} ")));
        done.set(done.get() || response.drag_stopped() || response.lost_focus());
    };
    let step = f64::from(extent) * 0.01;
    rows::flow(ui, |ui| {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            drag(ui, &mut shown.shift[axis], step, name);
        }
    });
    let (yaw, pitch, roll) = shown.turn.to_euler(EulerRot::YXZ);
    let mut degrees = [yaw, pitch, roll].map(f64::to_degrees);
    let turned = degrees;
    rows::flow(ui, |ui| {
        for (angle, name) in degrees.iter_mut().zip(["scene-yaw", "scene-pitch", "scene-roll"]) {
            drag(ui, angle, 1.0, &tr!(name));
        }
    });
    if degrees != turned {
        let [yaw, pitch, roll] = degrees.map(f64::to_radians);
        shown.turn = DQuat::from_euler(EulerRot::YXZ, yaw, pitch, roll).normalize();
    }
    rows::flow(ui, |ui| {
        drag(ui, &mut shown.scale, 0.01, &tr!("scene-scale"));
        let reset = ui.button(tr!("objects-reset-place"));
        if reset.on_hover_text(tr!("objects-reset-place.tip")).clicked() {
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

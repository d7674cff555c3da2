//! The outliner: every object of the scene in a tree of groups, with its eye and its lock, and what
//! can be done to the chosen ones. A press chooses one, with Ctrl or Shift several; they are
//! dragged onto a group, and the right button shows all that can be done.

use super::icons::{self, Icon};
use super::inspector::ask;
use super::state::{Outliner, Pairing, SnapPicks, UiRequest, UiState, View};
use super::{inspector, rows, theme};
use crate::language::tr;
use sculptd_engine::scene::{
    ObjectId, ObjectView, Primitive, PrimitiveShape, SceneCommand, SceneView,
};
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

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let scene = &view.state.scene;
    let Some(active) = scene.active() else { return };
    ui_state.outliner.keep_to(scene);
    ui.horizontal(|ui| {
        ui.strong(tr!("objects-heading"));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.menu_button(tr!("objects-add"), |ui| add(ui, view, out));
        });
    });
    let busy = ui_state.joining;
    let mut group = "";
    let mut open = true;
    for object in &scene.objects {
        // Consecutive objects of one group have its name above them.
        if object.settings.group != group {
            group = &object.settings.group;
            open = group.is_empty() || group_row(ui, group, &mut ui_state.outliner, out);
        }
        if open {
            row(ui, object, scene, busy, &mut ui_state.outliner, out);
        }
    }
    // Who drags a member here takes it out of its group.
    if let Some(dropped) = ui.separator().dnd_release_payload::<Vec<ObjectId>>() {
        ask(out, SceneCommand::Group(dropped.to_vec(), String::new()));
    }
    buttons(ui, scene, active, &mut ui_state.outliner, out);
    grouping(ui, &mut ui_state.outliner, out);
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
    following(ui, view, active, &mut ui_state.outliner, out);
    inspector::ui(ui, view, active, &mut ui_state.outliner, out);
    ui.separator();
}

/// Things that can be added.
fn add(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<UiRequest>) {
    for (name, shape) in PRIMITIVES {
        if ui.button(tr!(name)).clicked() {
            let shape = shape(f64::from(view.state.extent.max(1e-6)));
            let edge = shape.usual_edge();
            out.push(UiRequest::AddPrimitive(Primitive { shape, edge }));
            ui.close();
        }
    }
}

/// A group's name, which takes what is dropped on it; false: its members are folded away.
fn group_row(
    ui: &mut egui::Ui,
    group: &str,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) -> bool {
    let folded = outliner.folded.iter().position(|name| name == group);
    let icons = [Icon::ChevronDown, Icon::ChevronRight];
    let shown = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let fold = icons::switch(ui, icons, &tr!("objects-fold", group = group), folded.is_none());
        let name = egui::Button::selectable(false, icons::text(Icon::Folder, group)).truncate();
        (fold, ui.add(name))
    });
    let (fold, name) = shown.inner;
    if fold.clicked() || name.clicked() {
        match folded {
            Some(place) => drop(outliner.folded.remove(place)),
            None => outliner.folded.push(group.to_owned()),
        }
    }
    if let Some(dropped) = name.dnd_release_payload::<Vec<ObjectId>>() {
        ask(out, SceneCommand::Group(dropped.to_vec(), group.to_owned()));
    }
    folded.is_none()
}

fn row(
    ui: &mut egui::Ui,
    object: &ObjectView,
    scene: &SceneView,
    busy: bool,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    let (id, settings) = (object.id, &object.settings);
    let active = scene.active().is_some_and(|a| a.id == id);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        if !settings.group.is_empty() {
            ui.add_space(16.0);
        }
        let eyes = [Icon::Eye, Icon::EyeOff];
        let eye = icons::switch(ui, eyes, &tr!("objects-eye"), settings.visible);
        if eye.on_hover_text(tr!("objects-eye.tip")).clicked() {
            ask(out, SceneCommand::Show(id, !settings.visible));
        }
        let locks = [Icon::Lock, Icon::LockOpen];
        let lock = icons::switch(ui, locks, &tr!("objects-lock"), settings.locked);
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
        let chosen = active || outliner.chosen.contains(&id);
        let name = icons::row(ui, chosen, &settings.name);
        let name = ui.add(name.sense(egui::Sense::click_and_drag()));
        name.dnd_set_drag_payload(outliner.with(id));
        if name.double_clicked() {
            outliner.renaming = Some((id, settings.name.clone()));
        } else if name.clicked() {
            let keys = ui.input(|i| i.modifiers);
            if outliner.choose(id, scene, keys.command, keys.shift) && !active {
                ask(out, SceneCommand::Activate(id));
            }
        }
        name.context_menu(|ui| menu(ui, object, scene, busy, outliner, out));
    });
}

/// All that can be done to an object, and to those that are chosen with it.
fn menu(
    ui: &mut egui::Ui,
    object: &ObjectView,
    scene: &SceneView,
    busy: bool,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    let id = object.id;
    let all = outliner.with(id);
    let active = scene.active().is_some_and(|a| a.id == id);
    let item = |ui: &mut egui::Ui, icon: Icon, name: &str| {
        let pressed = ui.button(icons::text(icon, &tr!(name))).clicked();
        if pressed {
            ui.close();
        }
        pressed
    };
    if item(ui, Icon::Pencil, "objects-rename") {
        outliner.renaming = Some((id, object.settings.name.clone()));
    }
    if item(ui, Icon::Copy, "objects-duplicate") {
        all.iter().for_each(|id| ask(out, SceneCommand::Duplicate(*id)));
    }
    if item(ui, Icon::Folder, "objects-group") {
        outliner.grouping = Some((all.clone(), object.settings.group.clone()));
    }
    if item(ui, Icon::Eye, "objects-show") {
        let seen = object.settings.visible;
        all.iter().for_each(|id| ask(out, SceneCommand::Show(*id, !seen)));
    }
    if item(ui, Icon::Lock, "objects-lock-or-not") {
        let locked = object.settings.locked;
        all.iter().for_each(|id| ask(out, SceneCommand::Lock(*id, !locked)));
    }
    if scene.objects.len() > all.len() && item(ui, Icon::Trash2, "objects-remove") {
        all.iter().for_each(|id| ask(out, SceneCommand::Remove(*id)));
    }
    if active {
        return;
    }
    ui.separator();
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
}

/// A row of the most frequent actions on the active object.
fn buttons(
    ui: &mut egui::Ui,
    scene: &SceneView,
    active: &ObjectView,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    let (id, place) = (active.id, scene.active);
    let all = outliner.with(id);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let button = |ui: &mut egui::Ui, can: bool, icon: Icon, name: &str| {
            let name = tr!(name);
            let add = |ui: &mut egui::Ui| icons::button(ui, icon, &name).on_hover_text(&name);
            ui.add_enabled_ui(can, add).inner.clicked()
        };
        if button(ui, true, Icon::Copy, "objects-duplicate") {
            all.iter().for_each(|id| ask(out, SceneCommand::Duplicate(*id)));
        }
        if button(ui, true, Icon::Pencil, "objects-rename") {
            outliner.renaming = Some((id, active.settings.name.clone()));
        }
        if button(ui, true, Icon::Folder, "objects-group") {
            outliner.grouping = Some((all.clone(), active.settings.group.clone()));
        }
        if button(ui, place > 0, Icon::ArrowUp, "layers-up") {
            ask(out, SceneCommand::Move(id, place.saturating_sub(1) as u32));
        }
        if button(ui, place + 1 < scene.objects.len(), Icon::ArrowDown, "layers-down") {
            ask(out, SceneCommand::Move(id, place as u32 + 1));
        }
        let more = scene.objects.len() > all.len() && !active.settings.locked;
        if button(ui, more, Icon::Trash2, "objects-remove") {
            all.iter().for_each(|id| ask(out, SceneCommand::Remove(*id)));
        }
        let name = tr!("objects-mirror");
        let mirror = icons::button(ui, Icon::FlipHorizontal2, &name).on_hover_text(name);
        egui::Popup::menu(&mirror).show(|ui| {
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                if ui.button(name).clicked() {
                    out.push(UiRequest::Mirror(id, axis));
                    ui.close();
                }
            }
        });
    });
}

/// The name of a group, while it is typed.
fn grouping(ui: &mut egui::Ui, outliner: &mut Outliner, out: &mut Vec<UiRequest>) {
    let Some((grouped, text)) = &mut outliner.grouping else { return };
    let label = ui.label(tr!("objects-group")).on_hover_text(tr!("objects-group.tip"));
    let field = ui.text_edit_singleline(text).labelled_by(label.id);
    if field.lost_focus() {
        ask(out, SceneCommand::Group(std::mem::take(grouped), text.trim().into()));
        outliner.grouping = None;
    } else {
        field.request_focus();
    }
}

/// Whether Booleans follow their operands, and the end of it for the active object.
fn following(
    ui: &mut egui::Ui,
    view: &View<'_>,
    active: &ObjectView,
    outliner: &mut Outliner,
    out: &mut Vec<UiRequest>,
) {
    if view.state.scene.objects.len() > 1 {
        let live = ui.checkbox(&mut outliner.live, tr!("objects-live"));
        live.on_hover_text(tr!("objects-live.tip"));
    }
    if active.live(&view.state.mesh).is_some() {
        rows::flow(ui, |ui| {
            ui.colored_label(theme::quiet(ui), tr!("objects-follows"));
            let apply = ui.button(tr!("objects-apply"));
            if apply.on_hover_text(tr!("objects-apply.tip")).clicked() {
                ask(out, SceneCommand::ApplyLive(active.id));
            }
        });
    }
}

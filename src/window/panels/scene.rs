//! The object, a second one that is held beside it, and Booleans of the two.

use std::sync::Arc;

use glam::{DVec3, EulerRot, Quat};

use super::rows;
use super::state::{TrialStatus, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use sculptd_engine::command::Command;
use sculptd_engine::hand::MenuItem;
use sculptd_geometry::{PolyMesh, shapes};

type Solid = (&'static str, fn() -> PolyMesh);

/// Shapes that can be taken up without a file, each with the message of its name.
const SOLIDS: [Solid; 3] = [
    ("shape-ball", || shapes::uv_sphere(1.0, 24, 48)),
    ("shape-box", || shapes::cuboid(DVec3::NEG_ONE, DVec3::ONE)),
    ("shape-cylinder", || shapes::cylinder(1.0, 2.0, 48)),
];

/// Each with the message of its name.
const JOINS: [(MenuItem, &str); 3] =
    [(MenuItem::Add, "scene-add"), (MenuItem::Carve, "scene-cut"), (MenuItem::Keep, "scene-keep")];

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let busy = ui_state.joining;
    let quiet = theme::quiet(ui);
    let s = view.state;
    ui.strong(tr!("scene-object"));
    let (lo, hi) = s.transform().bounds(s.mesh.bounds());
    let size = (hi - lo).max(glam::Vec3::ZERO);
    ui.colored_label(quiet, tr!("triangles", count = s.mesh.triangle_count()));
    let [x, y, z] = size.to_array().map(|n| format!("{n:.2}"));
    ui.colored_label(quiet, tr!("scene-size", x = x, y = y, z = z, unit = tr!("unit-mm")));
    ui.add_space(8.0);
    ui.strong(tr!("scene-held"));
    rows::flow(ui, |ui| {
        for (name, make) in SOLIDS {
            if ui.button(tr!(name)).on_hover_text(tr!("scene-held.tip")).clicked() {
                out.push(UiRequest::World(Command::TakeUp(Arc::new(make().triangulate().0))));
            }
        }
    });
    let Some(thing) = &s.thing else {
        ui.colored_label(quiet, tr!("scene-held-note"));
        return;
    };
    let mut place = thing.place;
    let reach = s.extent * 3.0;
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let range = s.middle[i] - reach..=s.middle[i] + reach;
        ui.add(egui::Slider::new(&mut place.shift[i], range).text(axis));
    }
    let (mut yaw, mut pitch, mut roll) = place.turn.to_euler(EulerRot::YXZ);
    let before = (yaw, pitch, roll);
    for (angle, name, most) in [
        (&mut yaw, "scene-yaw", 180.0),
        (&mut pitch, "scene-pitch", 89.0),
        (&mut roll, "scene-roll", 180.0),
    ] {
        let mut degrees = angle.to_degrees();
        let slider = egui::Slider::new(&mut degrees, -most..=most);
        if rows::slider(ui, slider, &tr!(name)).changed() {
            *angle = degrees.to_radians();
        }
    }
    if (yaw, pitch, roll) != before {
        place.turn = Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll);
    }
    let sizes = s.extent * 0.02..=s.extent * 3.0;
    let scale = egui::Slider::new(&mut place.scale, sizes).logarithmic(true);
    rows::slider(ui, scale, &tr!("scene-held-size"));
    if place != thing.place {
        out.push(UiRequest::World(Command::Place(place)));
    }
    ui.add_space(4.0);
    preview(ui, ui_state, out);
    ui.add_space(4.0);
    rows::flow(ui, |ui| {
        for (choice, name) in JOINS {
            let button = ui.add_enabled(!busy, egui::Button::new(tr!(name)));
            if button.on_hover_text(tr!(&format!("{name}.tip"))).clicked() {
                out.push(UiRequest::Join(choice));
            }
        }
    });
    rows::flow(ui, |ui| {
        let down = ui.button(tr!("scene-put-down"));
        if down.on_hover_text(tr!("scene-put-down.tip")).clicked() {
            out.push(UiRequest::AddHeld);
        }
        if ui.button(tr!("scene-put-away")).clicked() {
            out.push(UiRequest::World(Command::PutDown));
        }
    });
    if busy {
        ui.colored_label(quiet, tr!("scene-busy"));
    }
}

fn preview(ui: &mut egui::Ui, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let busy = ui_state.joining;
    let trial = &mut ui_state.trial;
    let title = JOINS.iter().find(|j| trial.choice == Some(j.0)).map_or("off", |j| j.1);
    rows::list(ui, &tr!("scene-preview"), tr!(title), |ui| {
        ui.selectable_value(&mut trial.choice, None, tr!("off"));
        for (choice, name) in JOINS {
            ui.selectable_value(&mut trial.choice, Some(choice), tr!(name))
                .on_hover_text(tr!(&format!("{name}.tip")));
        }
    });
    let Some(choice) = trial.choice else { return };
    let (text, wrong) = match &trial.said {
        TrialStatus::Nothing | TrialStatus::UnderWay => (tr!("scene-computing"), false),
        TrialStatus::Shown(n) => (tr!("scene-shown", count = *n), false),
        TrialStatus::Wrong(why) => (why.clone(), true),
    };
    let colour = if wrong { theme::alarm(ui) } else { theme::quiet(ui) };
    ui.colored_label(colour, text);
    rows::flow(ui, |ui| {
        let apply = ui.add_enabled(!busy, egui::Button::new(tr!("scene-apply")));
        if apply.on_hover_text(tr!("scene-apply.tip")).clicked() {
            out.push(UiRequest::Join(choice));
            trial.choice = None;
        }
        let dismiss = ui.button(tr!("scene-dismiss"));
        if dismiss.on_hover_text(tr!("scene-dismiss.tip")).clicked() {
            trial.choice = None;
        }
    });
}

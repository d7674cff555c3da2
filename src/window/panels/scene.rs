//! The object, a second one that is held beside it, and Booleans of the two.

use std::sync::Arc;

use glam::{DVec3, EulerRot, Quat};

use super::state::{TrialStatus, UiRequest, UiState, View};
use super::theme;
use sculptd_engine::command::Command;
use sculptd_engine::hand::MenuItem;
use sculptd_geometry::{PolyMesh, shapes};

type Solid = (&'static str, fn() -> PolyMesh);

/// Shapes that can be taken up without a file.
const SOLIDS: [Solid; 3] = [
    ("Ball", || shapes::uv_sphere(1.0, 24, 48)),
    ("Box", || shapes::cuboid(DVec3::NEG_ONE, DVec3::ONE)),
    ("Cylinder", || shapes::cylinder(1.0, 2.0, 48)),
];

const JOINS: [(MenuItem, &str, &str); 3] = [
    (MenuItem::Add, "Add", "The two become one"),
    (MenuItem::Carve, "Cut", "What is held is cut out of the object"),
    (MenuItem::Keep, "Keep", "Only what lies in both stays"),
];

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let busy = ui_state.joining;
    let quiet = theme::quiet(ui);
    let s = view.state;
    ui.strong("Object");
    let (lo, hi) = s.transform().bounds(s.mesh.bounds());
    let size = (hi - lo).max(glam::Vec3::ZERO);
    ui.colored_label(quiet, format!("{} triangles", s.mesh.triangle_count()));
    ui.colored_label(quiet, format!("{:.2} x {:.2} x {:.2} mm", size.x, size.y, size.z));
    ui.add_space(8.0);
    ui.strong("Held object");
    ui.horizontal(|ui| {
        for (name, make) in SOLIDS {
            if ui
                .button(name)
                .on_hover_text("Appears beside the object, to be moved into it")
                .clicked()
            {
                out.push(UiRequest::World(Command::TakeUp(Arc::new(make().triangulate().0))));
            }
        }
    });
    let Some(thing) = &s.thing else {
        ui.colored_label(quiet, "Take up a shape, move it into place, then add, cut or keep.");
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
    for (angle, name) in [(&mut yaw, "yaw"), (&mut pitch, "pitch"), (&mut roll, "roll")] {
        let most = if name == "pitch" { 89.0 } else { 180.0 };
        let mut degrees = angle.to_degrees();
        if ui.add(egui::Slider::new(&mut degrees, -most..=most).text(name)).changed() {
            *angle = degrees.to_radians();
        }
    }
    if (yaw, pitch, roll) != before {
        place.turn = Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll);
    }
    let sizes = s.extent * 0.02..=s.extent * 3.0;
    ui.add(egui::Slider::new(&mut place.scale, sizes).logarithmic(true).text("size"));
    if place != thing.place {
        out.push(UiRequest::World(Command::Place(place)));
    }
    ui.add_space(4.0);
    preview(ui, ui_state, out);
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        for (choice, name, tip) in JOINS {
            if ui.add_enabled(!busy, egui::Button::new(name)).on_hover_text(tip).clicked() {
                out.push(UiRequest::Join(choice));
            }
        }
    });
    ui.horizontal(|ui| {
        if ui.button("Put down").on_hover_text("It becomes an object where it is").clicked() {
            out.push(UiRequest::AddHeld);
        }
        if ui.button("Put away").clicked() {
            out.push(UiRequest::World(Command::PutDown));
        }
    });
    if busy {
        ui.colored_label(quiet, "computing in the background: go on sculpting");
    }
}

fn preview(ui: &mut egui::Ui, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let busy = ui_state.joining;
    let trial = &mut ui_state.trial;
    let title = trial.choice.map_or("off", |c| JOINS.iter().find(|j| j.0 == c).map_or("", |j| j.1));
    egui::ComboBox::from_label("Preview").selected_text(title).width(110.0).show_ui(ui, |ui| {
        ui.selectable_value(&mut trial.choice, None, "off");
        for (choice, name, tip) in JOINS {
            ui.selectable_value(&mut trial.choice, Some(choice), name).on_hover_text(tip);
        }
    });
    let Some(choice) = trial.choice else { return };
    let (text, wrong) = match &trial.said {
        TrialStatus::Nothing | TrialStatus::UnderWay => ("computing ...".to_owned(), false),
        TrialStatus::Shown(n) => (format!("{n} triangles of the held object"), false),
        TrialStatus::Wrong(why) => (why.clone(), true),
    };
    let colour = if wrong { theme::alarm(ui) } else { theme::quiet(ui) };
    ui.colored_label(colour, text);
    ui.horizontal(|ui| {
        if ui
            .add_enabled(!busy, egui::Button::new("Apply"))
            .on_hover_text("Do what is shown")
            .clicked()
        {
            out.push(UiRequest::Join(choice));
            trial.choice = None;
        }
        if ui
            .button("Dismiss")
            .on_hover_text("The object stays as it is; the held one too")
            .clicked()
        {
            trial.choice = None;
        }
    });
}

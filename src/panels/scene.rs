//! The work, a second thing beside it, and joining the two.

use std::sync::Arc;

use glam::{DVec3, EulerRot, Quat};

use super::{Ask, View, theme};
use crate::command::Command;
use crate::hand::Choice;
use crate::mesh::{PolyMesh, shapes};

type Solid = (&'static str, fn() -> PolyMesh);

/// What can be taken up without a file.
const SOLIDS: [Solid; 3] = [
    ("Ball", || shapes::uv_sphere(1.0, 24, 48)),
    ("Box", || shapes::cuboid(DVec3::NEG_ONE, DVec3::ONE)),
    ("Cylinder", || shapes::cylinder(1.0, 2.0, 48)),
];

const JOINS: [(Choice, &str, &str); 3] = [
    (Choice::Add, "Add", "Work and thing become one"),
    (Choice::Carve, "Cut", "The thing is taken out of the work"),
    (Choice::Keep, "Keep", "Only what lies in both stays"),
];

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, busy: bool, out: &mut Vec<Ask>) {
    let quiet = theme::quiet(ui);
    let s = view.state;
    ui.strong("Work");
    let (lo, hi) = s.mesh.bounds();
    let size = (hi - lo).max(glam::Vec3::ZERO);
    ui.colored_label(quiet, format!("{} triangles", s.mesh.triangle_count()));
    ui.colored_label(quiet, format!("{:.2} x {:.2} x {:.2} mm", size.x, size.y, size.z));
    ui.add_space(8.0);
    ui.strong("Thing");
    ui.horizontal(|ui| {
        for (name, make) in SOLIDS {
            if ui.button(name).on_hover_text("Appears beside the work, to be carried into it").clicked() {
                out.push(Ask::World(Command::TakeUp(Arc::new(make().triangulate().0))));
            }
        }
    });
    let Some(thing) = &s.thing else {
        ui.colored_label(quiet, "Take something up, put it in its place, then add, cut or keep.");
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
        out.push(Ask::World(Command::Place(place)));
    }
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        for (choice, name, tip) in JOINS {
            if ui.add_enabled(!busy, egui::Button::new(name)).on_hover_text(tip).clicked() {
                out.push(Ask::Join(choice));
            }
        }
        if ui.button("Put away").clicked() {
            out.push(Ask::World(Command::PutDown));
        }
    });
    if busy {
        ui.colored_label(quiet, "joining in the background: go on sculpting");
    }
}

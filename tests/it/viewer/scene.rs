//! Several objects in the window: each is drawn where it stands, and the outliner asks for what can
//! be done to them.

use egui::Role;
use egui_kittest::kittest::Queryable;
use glam::{DQuat, DVec3, Vec3};

use super::panels::harness;
use super::pictures::painter;
use sculptd_daemon::Published;
use sculptd_daemon::snap_jobs::{self, PickedFace};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::scene::{
    FaceAlignment, NewObject, ObjectId, ObjectSource, ObjectTransform, Primitive, PrimitiveShape,
    SceneCommand,
};
use sculptd_engine::world::World;
use sculptd_window::look::Look;
use sculptd_window::panels::{SnapPicks, Tab, UiRequest};
use sculptd_window::viewer::gizmo::Gizmo;
use sculptd_window::viewer::objects::{Stance, hit_under, others, under};
use sculptd_window::viewer::renderer::{Beside, Scene};

fn ask(world: &mut World, command: SceneCommand) {
    let tick = world.tick() + 1;
    world.step(tick, &[], &[Command::Scene(command)]);
    assert!(world.answers()[0].is_ok());
}

/// A ball at the origin and a box to its right, turned and small; the box is active.
fn world() -> World {
    let mut world = super::world(2_000);
    let source =
        ObjectSource::Primitive(Primitive { shape: PrimitiveShape::Box([8.0; 3]), edge: 0.5 });
    let transform = ObjectTransform {
        shift: DVec3::new(4.0, 0.0, 0.0),
        turn: DQuat::from_rotation_y(0.6),
        scale: 0.25,
    };
    ask(&mut world, SceneCommand::Add(NewObject::new("box", source, transform)));
    world
}

fn camera() -> Camera {
    let target = Vec3::new(2.0, 0.0, 0.0);
    Camera { yaw: 0.0, pitch: 0.0, distance: 10.0, aspect: 1.0, target, ..Camera::default() }
}

#[test]
fn every_visible_object_is_drawn_where_it_stands_whichever_is_active() {
    let Some(mut painter) = painter() else { return };
    let mut world = world();
    let mut covered = |state: &Published| {
        let (camera, others) = (camera(), others(state));
        let beside = Beside { stance: Stance::of(state), others: &others, ..Beside::default() };
        let look = Look::default();
        let scene = Scene {
            mesh: &state.mesh,
            camera: &camera,
            brush: None,
            lines: &[],
            look,
            values: None,
            beside,
        };
        let picture = painter.paint(&scene, 200, 200).expect("a picture");
        // The ground is dark, clay is light.
        let lit = |p: Vec3| {
            let at = camera.project(p).expect("before the eye") * 200.0;
            let light: u32 = picture.get_pixel(at.x as u32, at.y as u32).0[..3]
                .iter()
                .map(|c| u32::from(*c))
                .sum();
            light > 250
        };
        [Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0)].map(lit)
    };
    for active in [1, 0, 1] {
        ask(&mut world, SceneCommand::Activate(ObjectId(active)));
        let state = super::published(&mut world);
        assert_eq!(covered(&state), [true, true, false], "object {active} is active");
        let ray = |p| camera().ray(camera().project(p).expect("before the eye"));
        assert_eq!(under(&state, ray(Vec3::ZERO)), Some(ObjectId(0)));
        assert_eq!(under(&state, ray(Vec3::new(4.0, 0.0, 0.0))), Some(ObjectId(1)));
        assert_eq!(under(&state, ray(Vec3::new(2.0, 0.0, 0.0))), None);
    }
    for (hidden, seen) in [(0, [false, true, false]), (1, [false, false, false])] {
        ask(&mut world, SceneCommand::Show(ObjectId(hidden), false));
        assert_eq!(covered(&super::published(&mut world)), seen);
    }
}

#[test]
fn the_outliner_lists_objects_and_asks_for_what_is_clicked() {
    let mut h = harness(Tab::Scene);
    h.state_mut().published = super::published(&mut world());
    h.run_steps(3);
    h.get_by_role_and_label(Role::Button, "object").click();
    h.run_steps(3);
    h.get_by_role_and_label(Role::Button, "Duplicate").click();
    h.run_steps(3);
    h.get_by_role_and_label(Role::Button, "Remove").click();
    h.run_steps(3);
    let asked: Vec<String> = h
        .state()
        .asked
        .iter()
        .filter_map(|a| match a {
            UiRequest::World(Command::Scene(command)) => Some(format!("{command:?}")),
            _ => None,
        })
        .collect();
    let expected = ["Activate(ObjectId(0))", "Duplicate(ObjectId(1))", "Remove(ObjectId(1))"];
    assert_eq!(asked, expected);
    h.get_by_role_and_label(Role::Button, "Add object").click();
    h.run_steps(3);
    h.get_by_role_and_label(Role::Button, "Torus").click();
    h.run_steps(3);
    let added = h.state().asked.iter().any(|a| match a {
        UiRequest::AddPrimitive(p) => p.shape.name() == "torus" && p.triangles().is_ok(),
        _ => false,
    });
    assert!(added, "{:?}", h.state().asked);
}

#[test]
fn the_gizmo_and_the_picking_of_faces_are_turned_on_in_the_outliner() {
    let mut h = harness(Tab::Scene);
    h.state_mut().published = super::published(&mut world());
    h.run_steps(3);
    h.get_by_label("Gizmo").click();
    h.run_steps(3);
    assert!(h.state().ui_state.outliner.gizmo);
    h.get_by_label("Snap face to face").click();
    h.run_steps(3);
    assert!(h.state().ui_state.outliner.snapping.is_some());
    h.get_by_label("Press on the face to move").click();
    h.run_steps(3);
    assert!(h.state().ui_state.outliner.snapping.is_none());
}

#[test]
fn two_picked_faces_are_laid_on_each_other() {
    let mut world = super::world(500);
    for x in [-3.0, 3.0] {
        let source =
            ObjectSource::Primitive(Primitive { shape: PrimitiveShape::Box([2.0; 3]), edge: 0.5 });
        let shift = DVec3::new(x, 0.0, 0.0);
        let transform = ObjectTransform { shift, ..ObjectTransform::NONE };
        ask(&mut world, SceneCommand::Add(NewObject::new("box", source, transform)));
    }
    let state = super::published(&mut world);
    let camera = Camera { yaw: 0.0, pitch: 0.0, distance: 20.0, ..Camera::default() };
    // The faces toward the eye.
    let hit = |x: f32| {
        let ray = camera.ray(camera.project(Vec3::new(x, 0.1, 1.0)).expect("before the eye"));
        hit_under(&state, ray).expect("a box")
    };
    let (left, right) = (hit(-3.0), hit(3.0));
    let mut picks = SnapPicks::default();
    assert_eq!(picks.pick(left.0, left.1), None);
    let both = picks.pick(right.0, right.1).expect("two objects");
    let [moved, target] = both.map(|(id, at)| PickedFace { id, at });
    let placed = snap_jobs::face_to_face(&state, moved, target, FaceAlignment::Nearest, 0.0);
    ask(&mut world, SceneCommand::Snap(Box::new(placed.expect("faces").placing)));
    let object = world.scene().object(left.0).expect("there");
    let (lo, hi) = object.settings.transform.bounds(object.clay.bounds());
    assert!((lo.z - 1.0).abs() < 1e-5 && (hi.z - 3.0).abs() < 1e-5, "{lo} {hi}");
    let mut gizmo_lines = Vec::new();
    let state = super::published(&mut world);
    let active = state.scene.active().expect("one");
    let gizmo = Gizmo::of(active, &active.settings.transform, &camera);
    gizmo.lines(&mut gizmo_lines, None);
    assert!(gizmo_lines.len() > 300 && gizmo.centre.distance(DVec3::new(3.0, 0.0, 0.0)) < 1e-6);
}

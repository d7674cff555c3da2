//! A plane that cuts the form: what is seen, what the pointer finds there, and the section's
//! figures.

use egui_kittest::kittest::Queryable;
use glam::{DQuat, DVec3, Vec3};
use sculptd_clay::brush::GaussianBrush;
use sculptd_clay::{Clay, Ray, Reach, Workers};
use sculptd_engine::camera::Camera;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::MeasuredSide;
use sculptd_geometry::{TriMesh, shapes};
use sculptd_window::look::{CutPlane, Look};
use sculptd_window::panels::state::Tab;
use sculptd_window::viewer::objects::Stance;
use sculptd_window::viewer::renderer::{Beside, Scene};
use sculptd_window::viewer::section_figures::SectionWork;
use sculptd_window::viewer::wall_probe::wall_on;

use super::check::world_of;
use super::panels::harness;
use super::pictures::painter;

/// A box of 40 x 30 x 20 about the origin with walls of 2 mm around a room.
fn hollow() -> TriMesh {
    let half = DVec3::new(20.0, 15.0, 10.0);
    let mut mesh = shapes::cuboid(-half, half).triangulate().0;
    let room = shapes::cuboid(-half + 2.0, half - 2.0).triangulate().0;
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&room.positions);
    mesh.triangles
        .extend(room.triangles.iter().map(|t| [t[0] + first, t[2] + first, t[1] + first]));
    mesh
}

const MIDDLE: CutPlane = CutPlane { axis: 1, at: 0.0, below: false };

#[test]
fn a_cut_shows_walls_as_solid_and_the_room_within() {
    let Some(mut painter) = painter() else { return };
    let mut clay = Clay::build(&hollow(), &Job::default()).expect("builds");
    let snapshot = clay.snapshot();
    let turn = DQuat::from_rotation_y(0.5);
    let transforms = [
        ObjectTransform::NONE,
        ObjectTransform { shift: DVec3::new(9.0, -4.0, 2.0), turn, scale: 0.5 },
    ];
    for transform in transforms {
        let (lo, hi) = transform.bounds(clay.bounds());
        // From above: in the middle the room's floor, beside it the wall.
        let mut camera = Camera { pitch: 1.5, yaw: 0.0, orthographic: true, ..Camera::default() };
        camera.frame(lo, hi);
        let at = (0.5 * (lo + hi)).y;
        let mut paint = |cut: Option<CutPlane>| {
            let beside =
                Beside { stance: Stance { id: 0, transform, visible: true }, ..Default::default() };
            let look = Look { cut, shade: 0.0, cavity: 0.0, ..Look::default() };
            let scene = Scene {
                mesh: &snapshot,
                camera: &camera,
                brush: None,
                lines: &[],
                look,
                values: None,
                beside,
            };
            painter.paint(&scene, 300, 300).expect("a picture")
        };
        let (whole, cut) = (paint(None), paint(Some(CutPlane { at, ..MIDDLE })));
        let pixel = |picture: &image::RgbaImage, p: Vec3| {
            let world = transform.point(p);
            let on = camera.view_projection(100.0).project_point3(world);
            let x = ((on.x * 0.5 + 0.5) * 300.0) as u32;
            let y = ((0.5 - on.y * 0.5) * 300.0) as u32;
            picture.get_pixel(x, y).0
        };
        // Twice as much red as blue: the colour of what is cut through.
        let solid = |p: [u8; 4]| u32::from(p[0]) > 2 * u32::from(p[2]);
        let (wall, floor) = (Vec3::new(19.0, 0.0, 0.0), Vec3::new(5.0, -13.0, 1.0));
        assert!(solid(pixel(&cut, wall)), "{:?}", pixel(&cut, wall));
        assert!(!solid(pixel(&cut, floor)), "{:?}", pixel(&cut, floor));
        assert!(!solid(pixel(&whole, Vec3::new(19.0, 15.0, 0.0))));
        assert_ne!(pixel(&whole, Vec3::new(5.0, 15.0, 1.0)), pixel(&cut, floor));
    }
}

#[test]
fn a_section_has_the_area_and_the_perimeter_of_its_walls_wherever_the_object_stands() {
    let mut clay = Clay::build(&hollow(), &Job::default()).expect("builds");
    let turn = DQuat::from_rotation_y(0.7);
    let transforms = [
        ObjectTransform::NONE,
        ObjectTransform { shift: DVec3::new(70.0, -20.0, 5.0), turn, scale: 2.5 },
    ];
    let mut work = SectionWork::default();
    for transform in transforms {
        let at = transform.shift.y as f32;
        let found = work.section(&(clay.snapshot(), transform, CutPlane { at, ..MIDDLE }));
        let found = found.expect("a section");
        let scale = transform.scale;
        let (area, perimeter) = (40.0 * 20.0 - 36.0 * 16.0, 2.0 * (60.0 + 52.0));
        assert!((found.area / (area * scale * scale) - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found.perimeter / (perimeter * scale) - 1.0).abs() < 1e-6, "{found:?}");
        assert_eq!((found.contours, found.open), (2, 0));
    }
    let lid = CutPlane { at: 14.0, ..MIDDLE };
    let found = work.section(&(clay.snapshot(), ObjectTransform::NONE, lid)).expect("a section");
    assert!((found.area - 800.0).abs() < 1e-6 && found.contours == 1, "{found:?}");
    // The clay changes: what was cut before is not cut again.
    let (centre, radius) = (Vec3::new(20.0, 15.0, 10.0), 5.0);
    clay.begin_step();
    let dab = GaussianBrush::new(centre, radius, Vec3::X, 1.0);
    clay.dab(&Reach::Sphere { centre, radius }, &dab, &Workers::new(1));
    clay.end_step();
    let found = work.section(&(clay.snapshot(), ObjectTransform::NONE, lid)).expect("a section");
    assert!(found.area > 801.0, "{found:?}");
}

#[test]
fn the_wall_under_the_pointer_is_that_which_the_cut_shows() {
    let mut world = world_of(&hollow());
    let state = super::published(&mut world);
    let down = |x: f32| Ray { origin: Vec3::new(x, 60.0, 1.0), dir: Vec3::NEG_Y };
    let wall = |ray: Ray| wall_on(&state, ray, MeasuredSide::Wall);
    // The lid from outside, and the floor through the cut.
    let lid = wall(down(5.0)).expect("a wall");
    assert!((lid.thickness - 2.0).abs() < 1e-4 && lid.place.y > 14.9);
    let floor = wall(MIDDLE.seen(down(5.0)).expect("seen")).expect("a wall");
    assert!((floor.thickness - 2.0).abs() < 1e-4 && floor.place.y < -12.9, "{floor:?}");
    // On the cut itself there is no surface.
    assert!(wall(MIDDLE.seen(down(19.0)).expect("seen")).is_none());
    // From below nothing is cut off; away from the plane nothing is seen.
    let up = Ray { origin: Vec3::new(5.0, -60.0, 1.0), dir: Vec3::Y };
    assert_eq!(MIDDLE.seen(up).map(|r| r.origin), Some(up.origin));
    assert!(MIDDLE.seen(Ray { dir: Vec3::Y, ..down(5.0) }).is_none());
    let below = CutPlane { below: true, ..MIDDLE };
    let seen = below.seen(up).expect("seen").origin.y;
    assert!(seen.abs() < 1e-4, "{seen}");
}

#[test]
fn a_cut_is_chosen_and_moved_on_the_page_of_walls() {
    let mut h = harness(Tab::Walls);
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.cut, None);
    h.get_by_label("Cut y").click();
    h.run_steps(2);
    let cut = h.state().ui_state.look.cut.expect("a cut");
    assert!(cut.axis == 1 && !cut.below);
    // Why presses do not sculpt is said on every page.
    h.get_by_label("Form cut: presses turn it");
    h.get_by_label("cut off what is below").click();
    h.run_steps(2);
    assert!(h.state().ui_state.look.cut.expect("a cut").below);
    h.get_by_label("none").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.cut, None);
    assert!(h.query_by_label("Form cut: presses turn it").is_none());
}

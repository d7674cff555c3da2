//! The page of walls and its map: thin spots, the scale set by hand, steps of colour, the wall
//! under the pointer.

use egui::{Pos2, Role, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::{DQuat, DVec3, Vec3};
use sculptd_clay::Ray;
use sculptd_engine::command::Command;
use sculptd_engine::scene::{ObjectTransform, SceneCommand};
use sculptd_geometry::shapes;
use sculptd_geometry::thickness::MeasuredSide;
use sculptd_window::look::{Look, Map};
use sculptd_window::panels::state::{
    Tab, ThicknessSummary, ThinSpot, UiRequest, WallChangeSummary,
};
use sculptd_window::viewer::wall_probe::wall_on;

use super::check::world_of;
use super::panels::{State, harness};
use super::pictures::{painted_by_height, painter};
use crate::clay::sphere;

const SPOT: Vec3 = Vec3::new(0.1, 0.9, 0.0);

/// The page of walls with a map from 0.4 to 2.4 mm.
fn page() -> Harness<'static, State> {
    let mut h = harness(Tab::Walls);
    h.state_mut().ui_state.look.map = Map::Thickness;
    let mut histogram = vec![3.0; 48];
    histogram[12] = 9.0;
    h.state_mut().ui_state.walls.found = Some(Box::new(ThicknessSummary {
        min: 0.4,
        max: 3.0,
        median: 1.5,
        high: 2.4,
        measured: 90,
        vertices: 100,
        below: 0.07,
        histogram,
        spots: vec![ThinSpot { place: SPOT, thickness: 0.4 }],
    }));
    h.run_steps(2);
    h
}

#[test]
fn walls_tell_their_thin_spots_and_the_camera_is_asked_to_fly() {
    let mut h = page();
    // The class with the largest area.
    h.get_by_label("0.921 mm");
    h.get_by_label("1: 0.400 mm").click();
    h.run_steps(2);
    assert!(
        matches!(h.state().asked[..], [UiRequest::FlyTo(p)] if p == SPOT),
        "{:?}",
        h.state().asked
    );
}

#[test]
fn the_change_of_walls_is_chosen_and_its_worst_place_flown_to() {
    let mut h = page();
    h.get_by_role_and_label(Role::CheckBox, "Change of walls").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.map, Map::WallChange);
    h.state_mut().ui_state.walls.changes = Some(WallChangeSummary {
        thinned: -1.25,
        thickened: 0.5,
        compared: 0.93,
        spots: vec![ThinSpot { place: SPOT, thickness: -1.25 }],
    });
    h.run_steps(2);
    h.get_by_label("+0.500 mm");
    h.get_by_label("93 %");
    h.get_by_label("1: -1.250 mm").click();
    h.run_steps(2);
    h.get_by_label("Compare with now").click();
    h.run_steps(2);
    assert!(
        matches!(h.state().asked[..], [UiRequest::FlyTo(p), UiRequest::Reference] if p == SPOT),
        "{:?}",
        h.state().asked
    );
    h.get_by_role_and_label(Role::CheckBox, "Change of walls").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.map, Map::Thickness);
}

#[test]
fn gaps_have_their_own_limit_and_words() {
    let mut h = page();
    h.get_by_role_and_label(Role::CheckBox, "Gaps").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.map, Map::Gap);
    h.get_by_label("narrowest");
    h.get_by_label("Narrow gaps");
    let walls = &h.state().ui_state.walls;
    assert_eq!((walls.limit, walls.limit_of(MeasuredSide::Gap)), (1.0, 0.4));
    h.get_by_label("About the limit").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.walls.scale, Some((0.0, 0.8)));
    h.get_by_role_and_label(Role::CheckBox, "Gaps").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.look.map, Map::Thickness);
    h.get_by_label("thinnest");
}

#[test]
fn the_gap_under_the_pointer_is_in_front_of_the_surface() {
    let mut two = shapes::cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 4.0));
    let over = shapes::cuboid(DVec3::new(0.0, 0.0, 6.5), DVec3::new(40.0, 30.0, 9.0));
    let base = two.positions.len() as u32;
    two.positions.extend(&over.positions);
    over.faces().for_each(|f| two.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>()));
    let state = super::published(&mut world_of(&two.triangulate().0));
    // From between the two, onto the lower one.
    let ray = Ray { origin: Vec3::new(11.0, 9.0, 5.0), dir: Vec3::NEG_Z };
    let gap = wall_on(&state, ray, MeasuredSide::Gap).expect("a gap");
    assert!((gap.thickness - 2.5).abs() < 1e-4 && (gap.place.z - 4.0).abs() < 1e-4, "{gap:?}");
    assert_eq!((gap.normal, gap.opposite), (Vec3::NEG_Z, Vec3::NEG_Z), "away from the gap");
    let wall = wall_on(&state, ray, MeasuredSide::Wall).expect("a wall");
    assert!((wall.thickness - 4.0).abs() < 1e-4 && wall.normal == Vec3::Z, "{wall:?}");
    let above = Ray { origin: Vec3::new(11.0, 9.0, 30.0), dir: Vec3::NEG_Z };
    assert!(wall_on(&state, above, MeasuredSide::Gap).is_none(), "nothing is above");
}

/// Drags within the histogram, from and to shares of its width.
fn drag(h: &mut Harness<'static, State>, from: f32, to: f32) {
    let rect = h.get_by_label("Thickness histogram").rect();
    let at = |x: f32| -> Pos2 { pos2(rect.left() + x * rect.width(), rect.center().y) };
    h.drag_at(at(from));
    h.run_steps(2);
    h.hover_at(at(0.5 * (from + to)));
    h.run_steps(2);
    h.hover_at(at(to));
    h.run_steps(2);
    h.drop_at(at(to));
    h.run_steps(2);
}

#[test]
fn the_ends_of_the_scale_and_the_limit_are_dragged_in_the_histogram() {
    let mut h = page();
    h.state_mut().ui_state.walls.limit = 1.4;
    h.run_steps(2);
    let near = |a: f32, b: f32| (a - b).abs() < 0.05;
    // A limit beyond the histogram is not seen, and not what is dragged at its edge.
    h.state_mut().ui_state.walls.limit = 50.0;
    drag(&mut h, 0.99, 0.8);
    let walls = &mut h.state_mut().ui_state.walls;
    assert!(walls.limit == 50.0 && walls.scale.take().is_some_and(|s| near(s.1, 2.0)));
    walls.limit = 1.4;
    h.run_steps(2);
    // The limit is in the middle.
    drag(&mut h, 0.5, 0.3);
    let walls = &h.state().ui_state.walls;
    assert!(near(walls.limit, 1.0) && walls.scale.is_none(), "{walls:?}");
    // The upper end of the scale.
    drag(&mut h, 0.99, 0.6);
    let (low, high) = h.state().ui_state.walls.scale.expect("set by hand");
    assert!(near(low, 0.4) && near(high, 1.6), "{low} {high}");
    assert!(near(h.state().ui_state.walls.limit, 1.0));
    h.get_by_label("About the limit").click();
    h.run_steps(2);
    let limit = h.state().ui_state.walls.limit;
    assert_eq!(h.state().ui_state.walls.scale, Some((0.0, 2.0 * limit)));
    h.get_by_label("Follow the map").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.walls.scale, None);
}

#[test]
fn steps_of_colour_show_equal_walls_as_equal() {
    let Some(mut painter) = painter() else { return };
    let mut mesh = sphere(40_000);
    let mut tones = |bands: bool| {
        // Without shading each pixel has its step's colour, but for where two meet.
        let look = Look { shade: 0.0, material: 3, bands, ..Look::default() };
        let picture = painted_by_height(&mut painter, &mut mesh, look, 240);
        // The ratio of green to red along the middle, which the light hardly changes.
        let ratio = |y: u32| {
            let p = picture.get_pixel(120, y).0;
            f32::from(p[1]) / f32::from(p[0]).max(1.0)
        };
        let column: Vec<f32> = (50..190).map(ratio).collect();
        column.windows(2).filter(|two| (two[0] - two[1]).abs() < 0.004).count()
    };
    let (smooth, banded) = (tones(false), tones(true));
    assert!(banded > smooth + 20, "{banded} equal neighbours with steps, {smooth} without");
}

#[test]
fn the_wall_under_the_pointer_is_that_of_the_part_wherever_it_stands() {
    // Walls of 3, 8 and 40 mm, whose corners' normals are no face's.
    let slab = shapes::cuboid(DVec3::ZERO, DVec3::new(40.0, 3.0, 8.0)).triangulate().0;
    let mut world = world_of(&slab);
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 0.6));
    let shift = DVec3::new(70.0, -20.0, 5.0);
    let transforms = [ObjectTransform::NONE, ObjectTransform { shift, turn, scale: 2.5 }];
    for transform in transforms {
        let id = super::published(&mut world).scene.active().expect("an object").id;
        let tick = world.tick() + 1;
        world.step(tick, &[], &[Command::Scene(SceneCommand::Transform(id, transform))]);
        let state = super::published(&mut world);
        let scale = transform.scale as f32;
        let cases = [
            (Vec3::new(11.0, 30.0, 3.5), Vec3::NEG_Y, 3.0),
            (Vec3::new(31.0, 1.2, 30.0), Vec3::NEG_Z, 8.0),
            (Vec3::new(60.0, 1.7, 2.0), Vec3::NEG_X, 40.0),
            // Aslant, the wall is still along the normal.
            (Vec3::new(8.0, 10.0, 4.0), Vec3::new(0.3, -1.0, 0.1).normalize(), 3.0),
        ];
        for (origin, dir, wall) in cases {
            let ray = Ray { origin: transform.point(origin), dir: transform.direction(dir) };
            let found = wall_on(&state, ray, MeasuredSide::Wall).expect("a wall");
            let off = (found.thickness - wall * scale).abs();
            assert!(off < 1e-3 * scale, "{} for {}", found.thickness, wall * scale);
            let outward = found.normal.dot(found.opposite);
            assert!((outward + 1.0).abs() < 1e-5, "the sides face away from each other");
        }
        let beside = Ray { origin: transform.point(Vec3::splat(500.0)), dir: Vec3::X };
        assert!(wall_on(&state, beside, MeasuredSide::Wall).is_none());
    }
}

//! Regions drawn over the view: by the panel, by a key, by the search; what they ask for.

use egui::{Event, Key, Modifiers, Pos2, Role, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::Vec2;
use sculptd_clay::brush::{BrushKind, draw_face_sets};
use sculptd_clay::face_sets::PartEdit;
use sculptd_engine::command::Command;
use sculptd_engine::local_remesh::{LocalRemesh, WantedEdge};
use sculptd_engine::mask_region::MaskRegion;
use sculptd_engine::scene::SceneCommand;
use sculptd_engine::view_region::{MOST_CORNERS, SetsRegion, ViewRegion};
use sculptd_window::panels::state::region::{RegionPurpose, RegionShape};
use sculptd_window::panels::{Tab, UiRequest};

use super::panels::{State, harness, view_of};

/// A place of the window as shares of the view.
fn share(h: &Harness<'_, State>, at: Pos2) -> Vec2 {
    let view = view_of(h);
    let at = (at - view.min) / view.size();
    Vec2::new(at.x, at.y)
}

fn drag(h: &mut Harness<'_, State>, way: &[Pos2]) {
    h.hover_at(way[0]);
    h.run_steps(1);
    h.drag_at(way[0]);
    h.run_steps(1);
    for at in way {
        h.hover_at(*at);
        h.run_steps(1);
    }
    h.drop_at(way[way.len() - 1]);
    h.run_steps(2);
}

fn press(h: &mut Harness<'_, State>, at: Pos2) {
    drag(h, &[at]);
}

/// Returns the requests since the last call.
fn asked(h: &mut Harness<'_, State>) -> Vec<UiRequest> {
    std::mem::take(&mut h.state_mut().asked)
}

/// A way around the middle of the view.
fn around() -> Vec<Pos2> {
    (0..=24)
        .map(|i| {
            let angle = i as f32 * 0.25;
            pos2(640.0 + 90.0 * angle.cos(), 400.0 + 70.0 * angle.sin())
        })
        .collect()
}

#[test]
fn a_lasso_masks_and_frees_until_escape_ends_it() {
    let mut h = harness(Tab::Look);
    h.get_by_role_and_label(Role::DisclosureTriangle, "Mask").click();
    h.run_steps(8);
    h.get_by_label("Lasso").scroll_to_me();
    h.run_steps(3);
    h.get_by_label("Lasso").click();
    h.run_steps(3);
    let now = h.state().ui_state.region.now();
    assert_eq!(now, Some((RegionShape::Lasso, RegionPurpose::Mask)));
    drag(&mut h, &around());
    let all = asked(&mut h);
    let [UiRequest::World(Command::MaskRegion(MaskRegion { region, mask, front_faces }))] =
        &all[..]
    else {
        panic!("{all:?}")
    };
    assert_eq!((*mask, *front_faces), (1.0, false));
    let ViewRegion::Polygon(corners) = region else { panic!("{region:?}") };
    assert!(corners.len() > 20, "{}", corners.len());
    assert!((corners[0] - share(&h, around()[0])).length() < 1e-2, "{:?}", corners[0]);
    // It goes on: front faces only, and freeing, which the bar over the view offers.
    h.get_by_label("Front faces only").click();
    h.get_by_label("Unmask").click();
    h.run_steps(3);
    drag(&mut h, &around());
    let all = asked(&mut h);
    let [UiRequest::World(Command::MaskRegion(free))] = &all[..] else { panic!("{all:?}") };
    assert!(free.mask == 0.0 && free.front_faces);
    // Escape in the middle of a drag takes it back, and the next one ends drawing.
    h.drag_at(pos2(600.0, 400.0));
    h.run_steps(1);
    h.hover_at(pos2(700.0, 480.0));
    h.run_steps(1);
    h.key_press(Key::Escape);
    h.run_steps(2);
    h.drop_at(pos2(720.0, 420.0));
    h.run_steps(2);
    assert!(asked(&mut h).is_empty());
    assert!(h.state().ui_state.region.drawing.is_some());
    h.key_press(Key::Escape);
    h.run_steps(2);
    assert!(h.state().ui_state.region.drawing.is_none());
    // A path that is far too long keeps its form with fewer corners.
    h.key_press(Key::L);
    h.run_steps(2);
    let long: Vec<Pos2> =
        (0..2600).map(|i| pos2(400.0 + (i % 97) as f32 * 4.0, 200.0 + (i / 8) as f32)).collect();
    drag(&mut h, &long);
    let all = asked(&mut h);
    let [UiRequest::World(Command::MaskRegion(long))] = &all[..] else { panic!("{all:?}") };
    let ViewRegion::Polygon(corners) = &long.region else { panic!("a lasso") };
    assert!(corners.len() > MOST_CORNERS / 3 && long.is_sane(), "{}", corners.len());
}

#[test]
fn triangles_of_a_region_or_of_what_was_stretched_get_one_size() {
    let mut h = harness(Tab::Scene);
    h.state_mut().ui_state.region.edge = 0.5;
    h.get_by_label("Refine what was stretched").scroll_to_me();
    h.run_steps(3);
    h.get_by_label("Refine what was stretched").click();
    h.run_steps(3);
    let edge = WantedEdge::OfUsual(0.5);
    let all = asked(&mut h);
    let [UiRequest::RemeshLocal(stretched)] = &all[..] else { panic!("{all:?}") };
    assert_eq!(*stretched, LocalRemesh { edge, stretched_only: true, region: None });
    h.get_by_label("Lasso").scroll_to_me();
    h.run_steps(3);
    h.get_by_label("Lasso").click();
    h.run_steps(3);
    assert_eq!(h.state().ui_state.region.now(), Some((RegionShape::Lasso, RegionPurpose::Remesh)));
    drag(&mut h, &around());
    let all = asked(&mut h);
    let [UiRequest::RemeshLocal(part)] = &all[..] else { panic!("{all:?}") };
    assert!(part.edge == edge && !part.stretched_only);
    assert!(matches!(part.region, Some(ViewRegion::Polygon(_))), "{part:?}");
}

#[test]
fn a_box_hides_ctrl_turns_it_round_and_a_polyline_makes_a_face_set() {
    let mut h = harness(Tab::Look);
    h.state_mut().ui_state.region.begin(RegionShape::Box, RegionPurpose::Hide);
    h.run_steps(2);
    let ends = [pos2(500.0, 300.0), pos2(700.0, 500.0)];
    let sets = |h: &mut Harness<'_, State>| match &asked(h)[..] {
        [UiRequest::World(Command::Scene(SceneCommand::SetsRegion(asked)))] => asked.clone(),
        other => panic!("{other:?}"),
    };
    drag(&mut h, &ends);
    let SetsRegion { region, edit, front_faces } = sets(&mut h);
    assert_eq!((edit, front_faces), (PartEdit::Hide, false));
    let ViewRegion::Box(corners) = region else { panic!("{region:?}") };
    let off = corners.iter().zip(ends).map(|(a, b)| (*a - share(&h, b)).length());
    assert!(off.fold(0.0, f32::max) < 1e-2, "{corners:?}");
    // A slip of the hand is none.
    drag(&mut h, &[ends[0], ends[0] + egui::vec2(2.0, 1.0)]);
    assert!(asked(&mut h).is_empty());
    h.drag_at(ends[0]);
    h.run_steps(1);
    h.hover_at(ends[1]);
    h.run_steps(1);
    h.event(Event::ModifiersChanged(Modifiers::CTRL));
    h.drop_at(ends[1]);
    h.run_steps(1);
    h.event(Event::ModifiersChanged(Modifiers::NONE));
    h.run_steps(1);
    assert_eq!(sets(&mut h).edit, PartEdit::Isolate);

    h.get_by_label("Polyline").click();
    h.get_by_label("Face set").click();
    h.run_steps(3);
    let corners = [pos2(560.0, 300.0), pos2(720.0, 320.0), pos2(650.0, 480.0)];
    for at in corners {
        press(&mut h, at);
    }
    press(&mut h, pos2(500.0, 420.0));
    h.key_press(Key::Backspace);
    h.run_steps(2);
    assert!(asked(&mut h).is_empty());
    press(&mut h, corners[0]);
    let made = sets(&mut h);
    assert_eq!(made.edit, PartEdit::NewSet);
    let ViewRegion::Polygon(drawn) = made.region else { panic!("a polygon") };
    assert_eq!(drawn.len(), 3);
    assert!(drawn.iter().zip(corners).all(|(a, b)| (*a - share(&h, b)).length() < 1e-2));
    // The side of a line, ended by the button.
    h.get_by_label("Line").click();
    h.run_steps(2);
    drag(&mut h, &ends);
    assert!(matches!(sets(&mut h).region, ViewRegion::Line(_)));
    h.get_by_label("Done").click();
    h.run_steps(2);
    assert!(h.state().ui_state.region.drawing.is_none());
}

#[test]
fn regions_are_found_by_the_search_and_have_keys() {
    let mut h = harness(Tab::Look);
    h.key_press_modifiers(Modifiers::COMMAND, Key::K);
    h.run_steps(3);
    h.get_by_role(Role::TextInput).type_text("hide a region");
    h.run_steps(3);
    h.key_press(Key::Enter);
    h.run_steps(3);
    let now = h.state().ui_state.region.now();
    assert_eq!(now, Some((RegionShape::Lasso, RegionPurpose::Hide)));
    h.key_press(Key::B);
    h.run_steps(2);
    let now = h.state().ui_state.region.now();
    assert_eq!(now, Some((RegionShape::Box, RegionPurpose::Hide)));
}

#[test]
fn the_panel_of_face_sets_takes_the_brush_that_draws_one() {
    let mut h = harness(Tab::Scene);
    let mut world = super::world(2_000);
    let mut tell = |command| {
        let tick = world.tick() + 1;
        world.step(tick, &[], &[command]);
    };
    let region = ViewRegion::Box([Vec2::ZERO, Vec2::new(0.5, 1.0)]);
    let make = SetsRegion { region, edit: PartEdit::NewSet, front_faces: false };
    tell(Command::Scene(SceneCommand::SetsRegion(make)));
    h.state_mut().published = super::published(&mut world);
    h.run_steps(2);
    h.get_by_label("Face sets").click();
    h.run_steps(8);
    h.get_by_label("draw").click();
    h.run_steps(2);
    let all = asked(&mut h);
    let [UiRequest::World(Command::Brush(brush))] = &all[..] else { panic!("{all:?}") };
    assert_eq!((brush.kind, brush.extra[draw_face_sets::SET]), (BrushKind::DrawFaceSets, 1.0));
    // Once more: each stroke draws a new one.
    let mut tell = |command| {
        let tick = world.tick() + 1;
        world.step(tick, &[], &[command]);
    };
    tell(Command::Brush(*brush));
    h.state_mut().published = super::published(&mut world);
    h.run_steps(2);
    h.get_by_label("draw").click();
    h.run_steps(2);
    let all = asked(&mut h);
    let [UiRequest::World(Command::Brush(brush))] = &all[..] else { panic!("{all:?}") };
    assert_eq!(brush.extra[draw_face_sets::SET], 0.0);
}

//! The frame around the clay: what the header begins, the wall of earlier sculptures, the tree of
//! objects, and what the line below says of the session.

use std::path::PathBuf;

use egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec3;

use super::layout::misplaced;
use super::panels::{State, TestSession, brushes, harness};
use sculptd_clay::brush::BrushKind;
use sculptd_engine::command::Command;
use sculptd_engine::scene::{
    NewObject, ObjectId, ObjectSource, ObjectTransform, Primitive, PrimitiveShape, SceneCommand,
};
use sculptd_window::look::Map;
use sculptd_window::panels::state::region::{RegionPurpose, RegionShape};
use sculptd_window::panels::state::{EarlierWork, NextSculpture};
use sculptd_window::panels::{Tab, UiRequest};

fn asked(h: &mut Harness<'_, State>) -> Vec<UiRequest> {
    std::mem::take(&mut h.state_mut().asked)
}

#[test]
fn the_header_begins_anew_and_undoes_and_a_brush_has_a_key() {
    let mut h = harness(Tab::Look);
    h.get_by_role_and_label(Role::Button, "New sculpture").click();
    h.run_steps(2);
    let all = asked(&mut h);
    assert!(matches!(all[..], [UiRequest::OpenNext(NextSculpture::New)]), "{all:?}");
    // There is nothing to undo.
    h.get_by_label("Undo").click();
    h.run_steps(2);
    assert!(asked(&mut h).is_empty());
    h.state_mut().published.undo_steps = 1;
    h.run_steps(2);
    h.get_by_label("Undo").click();
    h.run_steps(2);
    let all = asked(&mut h);
    assert!(matches!(all[..], [UiRequest::World(Command::Undo)]), "{all:?}");
    h.key_press(Key::I);
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.kind), Some(BrushKind::Inflate));
}

#[test]
fn copies_are_offered_in_a_menu_and_leave_room_for_the_mirrors() {
    let mut h = harness(Tab::Look);
    h.get_by_label("Radial symmetry").click();
    h.run_steps(3);
    h.get_by_role_and_label(Role::Slider, "Copies");
    h.key_press(Key::Escape);
    h.run_steps(3);
    assert!(h.query_by_label("Copies").is_none());
    // 16 copies of a brush and its mirror image are all that a brush can have.
    h.state_mut().published.brush.symmetry = [true, false, false];
    h.state_mut().published.brush.mirror.radial = 16;
    h.run_steps(2);
    h.get_by_label("y").click();
    h.run_steps(2);
    let brush = brushes(&h).last().copied().expect("a brush");
    assert_eq!((brush.symmetry, brush.mirror.radial), ([true, true, false], 8));
    assert!(brush.check().is_ok());
}

#[test]
fn earlier_sculptures_are_offered_and_a_press_or_escape_answers() {
    let mut h = harness(Tab::Look);
    let work = |name: &str, told: Option<&str>| EarlierWork {
        path: PathBuf::from(name),
        picture: None,
        told: told.map(str::to_owned),
    };
    h.state_mut().ui_state.earlier.all = vec![
        work("/s/2026-11-22_0308_head.sculpt", None),
        work("/s/2026-11-21_1200_pot.sculpt", Some("12 ticks are missing")),
    ];
    h.run_steps(3);
    assert!(h.query_by_label_contains("(1 of 6)").is_none(), "the lesson waits for the answer");
    h.get_by_label("pot, 2026-11-21 12:00").click();
    h.run_steps(2);
    let all = asked(&mut h);
    let [UiRequest::OpenNext(NextSculpture::Session(path))] = &all[..] else { panic!("{all:?}") };
    assert!(path.ends_with("2026-11-21_1200_pot.sculpt"));
    h.key_press(Key::Escape);
    h.run_steps(3);
    assert!(h.query_by_label("pot, 2026-11-21 12:00").is_none());
    assert!(h.query_by_label_contains("(1 of 6)").is_some());
    // The page of files shows the wall again.
    h.state_mut().ui_state.tab = Tab::Files;
    h.run_steps(2);
    h.get_by_label("Earlier sculptures").click();
    h.run_steps(3);
    assert!(h.query_by_label("head, 2026-11-22 03:08").is_some());
}

/// Three objects, the last two in a group; the first is active.
fn three(h: &mut Harness<'_, State>) {
    let mut world = super::world(500);
    for (i, name) in ["left leg", "right leg"].into_iter().enumerate() {
        let shape = PrimitiveShape::Box([1.0; 3]);
        let source = ObjectSource::Primitive(Primitive { shape, edge: 0.5 });
        let shift = DVec3::new(i as f64 * 2.0, 0.0, 0.0);
        let place = ObjectTransform { shift, ..ObjectTransform::NONE };
        let add = SceneCommand::Add(NewObject::new(name, source, place));
        world.step(world.tick() + 1, &[], &[Command::Scene(add)]);
    }
    let group = SceneCommand::Group(vec![ObjectId(1), ObjectId(2)], "legs".into());
    let first = SceneCommand::Activate(ObjectId(0));
    world.step(world.tick() + 1, &[], &[Command::Scene(group), Command::Scene(first)]);
    h.state_mut().published = super::published(&mut world);
    h.run_steps(3);
}

fn scene_commands(h: &mut Harness<'_, State>) -> Vec<String> {
    let of = |request: &UiRequest| match request {
        UiRequest::World(Command::Scene(command)) => Some(format!("{command:?}")),
        _ => None,
    };
    asked(h).iter().filter_map(of).collect()
}

#[test]
fn several_objects_are_chosen_and_grouped_and_a_group_is_folded() {
    let mut h = harness(Tab::Scene);
    three(&mut h);
    h.get_by_role_and_label(Role::Button, "right leg").click_modifiers(Modifiers::COMMAND);
    h.run_steps(2);
    assert!(scene_commands(&mut h).is_empty(), "the active object stays");
    assert_eq!(h.state().ui_state.outliner.chosen, [ObjectId(0), ObjectId(2)]);
    h.get_by_role_and_label(Role::Button, "Duplicate").click();
    h.run_steps(2);
    let both = ["Duplicate(ObjectId(0))", "Duplicate(ObjectId(2))"];
    assert_eq!(scene_commands(&mut h), both);
    h.get_by_role_and_label(Role::Button, "Group").click();
    h.run_steps(3);
    h.get_by_role(Role::TextInput).type_text("body");
    h.run_steps(2);
    h.key_press(Key::Enter);
    h.run_steps(3);
    assert_eq!(scene_commands(&mut h), ["Group([ObjectId(0), ObjectId(2)], \"body\")"]);
    // A press alone chooses one object, and makes it the active one.
    h.get_by_role_and_label(Role::Button, "left leg").click();
    h.run_steps(2);
    assert!(h.state().ui_state.outliner.chosen.is_empty());
    assert_eq!(scene_commands(&mut h), ["Activate(ObjectId(1))"]);
    h.get_by_label("Fold legs").click();
    h.run_steps(3);
    assert!(h.query_by_role_and_label(Role::Button, "left leg").is_none());
    h.get_by_label("Fold legs").click();
    h.run_steps(3);
    assert!(h.query_by_role_and_label(Role::Button, "left leg").is_some());
}

#[test]
fn the_line_below_says_whether_the_work_is_kept() {
    let mut h = harness(Tab::Look);
    let says = |h: &Harness<'_, State>, text: &str| h.query_by_label_contains(text).is_some();
    assert!(says(&h, "not saved"), "no session keeps it");
    h.state_mut().session = Some(TestSession { fault: None, lost: 0 });
    h.run_steps(2);
    assert!(says(&h, "head.sculpt") && !says(&h, "not saved"));
    h.state_mut().session = Some(TestSession { fault: None, lost: 7 });
    h.run_steps(2);
    assert!(says(&h, "lacks 7 ticks") && !says(&h, "head.sculpt"));
    h.state_mut().session = Some(TestSession { fault: Some("disk full".into()), lost: 7 });
    h.run_steps(2);
    assert!(says(&h, "the session takes nothing") && !says(&h, "head.sculpt"));
}

/// Every sentence by which the window promises that the work is saved.
#[test]
fn no_page_says_that_work_is_saved_where_it_is_not() {
    let mut h = harness(Tab::Loop);
    h.state_mut().ui_state.earlier.all = vec![EarlierWork {
        path: PathBuf::from("/s/2026-11-22_0308_head.sculpt"),
        picture: None,
        told: None,
    }];
    for session in [
        None,
        Some(TestSession { fault: None, lost: 0 }),
        Some(TestSession { fault: None, lost: 7 }),
        Some(TestSession { fault: Some("disk full".into()), lost: 0 }),
    ] {
        let keeps = session.as_ref().is_some_and(|s| s.fault.is_none() && s.lost == 0);
        h.state_mut().session = session;
        for (text, help) in [
            ("This new sculpture is saved as you work.", false),
            ("saved as you work: ", false),
            ("Work is kept", true),
        ] {
            h.state_mut().ui_state.help = help;
            h.run_steps(3);
            let said = h.query_all_by_label_contains(text).next().is_some();
            assert_eq!(said, keeps, "{text} (keeps: {keeps})");
        }
    }
}

#[test]
fn bars_scales_hints_and_messages_keep_apart_on_small_screens() {
    let mut bad = Vec::new();
    for (wide, high) in [(800.0, 600.0), (1024.0, 700.0), (1280.0, 720.0)] {
        let mut h = harness(Tab::Look);
        h.set_size(egui::vec2(wide, high));
        let s = h.state_mut();
        s.ui_state.look.map = Map::Thickness;
        s.ui_state.look.scale = (0.5, 2.5);
        s.ui_state.region.begin(RegionShape::Lasso, RegionPurpose::Mask);
        s.ui_state.say("/a/long/path/to/a/file/that/was/not/there.stl: no such file", true);
        h.run_steps(4);
        let wrong = misplaced(&h);
        bad.extend(wrong.into_iter().map(|what| format!("{wide} x {high}: {what}")));
    }
    assert!(bad.is_empty(), "{} faults: {bad:#?}", bad.len());
}

//! The panel of layers: what is listed, and what is asked for by the pointer.

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::panels::{State, harness};
use sculptd_clay::{LayerEdit, LayerId};
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::scene::SceneCommand;
use sculptd_engine::world::World;
use sculptd_window::panels::state::LayerPanel;
use sculptd_window::panels::{Tab, UiRequest};

fn edit(world: &mut World, edit: LayerEdit) {
    let tick = world.tick() + 1;
    world.step(tick, &[], &[Command::Scene(SceneCommand::Layers(edit))]);
    assert!(world.answers()[0].is_ok());
}

/// Two layers, the upper one active.
fn two_layers() -> Harness<'static, State> {
    let mut world = super::world(2_000);
    edit(&mut world, LayerEdit::Add("wrinkles".into()));
    edit(&mut world, LayerEdit::Add("scar".into()));
    let mut h = harness(Tab::Scene);
    h.state_mut().published = super::published(&mut world);
    h.run_steps(3);
    h
}

fn asked(h: &Harness<'_, State>) -> Vec<LayerEdit> {
    let of = |a: &UiRequest| match a {
        UiRequest::World(Command::Scene(SceneCommand::Layers(edit))) => Some(edit.clone()),
        _ => None,
    };
    h.state().asked.iter().filter_map(of).collect()
}

#[test]
fn the_first_layer_is_added_from_the_panel() {
    let mut h = harness(Tab::Scene);
    assert!(h.query_by_label("Bake layers").is_none());
    h.get_by_role_and_label(Role::Button, "Add layer").click();
    h.run_steps(3);
    assert_eq!(asked(&h), [LayerEdit::Add("layer 1".into())]);
}

#[test]
fn layers_are_listed_and_what_is_clicked_is_asked_for() {
    let mut h = two_layers();
    for name in ["wrinkles", "base", "Down", "Merge down", "Duplicate layer", "Clear layer"] {
        // Objects are moved by buttons of the same names above.
        let all: Vec<_> = h.get_all_by_role_and_label(Role::Button, name).collect();
        all.last().expect("a button").click_accesskit();
        h.run_steps(3);
    }
    for name in ["Remove layer", "Bake layers", "Add layer"] {
        h.get_by_role_and_label(Role::Button, name).click_accesskit();
        h.run_steps(3);
    }
    let (lower, upper) = (LayerId(0), LayerId(1));
    let expected = [
        LayerEdit::Activate(Some(lower)),
        LayerEdit::Activate(None),
        LayerEdit::Move(upper, 0),
        LayerEdit::MergeDown(upper),
        LayerEdit::Duplicate(upper),
        LayerEdit::Clear(upper),
        LayerEdit::Remove(upper),
        LayerEdit::Bake,
        LayerEdit::Add("layer 3".into()),
    ];
    assert_eq!(asked(&h), expected);
    // The highest layer cannot go up.
    let up: Vec<_> = h.get_all_by_role_and_label(Role::Button, "Up").collect();
    up.last().expect("a button").click_accesskit();
    h.run_steps(3);
    assert_eq!(asked(&h).len(), expected.len());
    // The eyes: those of the object and of both layers, the upper one first.
    let eyes: Vec<_> = h.get_all_by_label("eye").collect();
    assert_eq!(eyes.len(), 3);
    eyes[1].click_accesskit();
    h.run_steps(3);
    let hide = LayerEdit::Set { id: upper, intensity: None, visible: Some(false), live: false };
    assert_eq!(asked(&h).last(), Some(&hide));
}

#[test]
fn a_dragged_intensity_is_sent_as_it_comes_and_ends_when_it_is_let_go() {
    let mut h = two_layers();
    let slider = h.get_by_role_and_label(Role::Slider, "wrinkles").rect();
    let from = slider.left_center() + egui::vec2(slider.width() * 0.5, 0.0);
    h.drag_at(from);
    h.run_steps(2);
    for k in 1..=5 {
        h.hover_at(from + egui::vec2(k as f32 * 4.0, 0.0));
        h.run_steps(2);
    }
    h.drop_at(from + egui::vec2(20.0, 0.0));
    h.run_steps(3);
    let all = asked(&h);
    assert!(all.len() >= 4, "{all:?}");
    let (last, rest) = all.split_last().expect("some");
    let of = |edit: &LayerEdit| match edit {
        LayerEdit::Set { id: LayerId(0), intensity: Some(i), visible: None, live } => (*i, *live),
        other => panic!("{other:?}"),
    };
    assert!(rest.iter().all(|e| of(e).1) && !of(last).1, "{all:?}");
    assert!(of(last).0 > of(&rest[0]).0 && of(last).0 <= 2.0, "{all:?}");
}

#[test]
fn what_takes_the_place_of_an_object_with_layers_is_told() {
    let mut world = super::world(2_000);
    let mut panel = LayerPanel::default();
    let mut told = |world: &mut World| panel.baked(&super::published(world));
    edit(&mut world, LayerEdit::Add("wrinkles".into()));
    edit(&mut world, LayerEdit::Add("scar".into()));
    assert_eq!(told(&mut world), None);
    edit(&mut world, LayerEdit::Bake);
    assert_eq!(told(&mut world), None);
    let tell = |world: &mut World, command: Command| {
        let tick = world.tick() + 1;
        world.step(tick, &[], &[command]);
    };
    tell(&mut world, Command::Undo);
    assert_eq!(told(&mut world), None);
    let plain = std::sync::Arc::new(sculptd_geometry::shapes::icosphere(0.8, 8));
    tell(&mut world, Command::Replace(NewClay::new(plain, true)));
    assert_eq!((told(&mut world), told(&mut world)), (Some(2), None));
    tell(&mut world, Command::Undo);
    assert_eq!(told(&mut world), None);
}

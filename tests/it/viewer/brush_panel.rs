//! The panel of the brush: favourites, colours, alphas, the unit of the radius, and saving.

use std::sync::Arc;

use egui::{Key, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::{Vec2, Vec3};
use sculptd_clay::Ray;
use sculptd_clay::brush::own_brush::{AlphaPicture, preset_number};
use sculptd_clay::brush::{Alpha, BrushKind, BrushSettings, OwnBrush, Picture};
use sculptd_engine::command::Command;
use sculptd_geometry::shapes;
use sculptd_window::panels::{Tab, UiRequest};

use super::super::brushes::Studio;
use super::panels::{State, brushes, harness};

/// Simulates the world's answer: the last requested brush is in hand.
fn answer(h: &mut Harness<'_, State>) {
    if let Some(brush) = brushes(h).last().copied() {
        let shown = &mut h.state_mut().published;
        shown.brush_radius *= brush.radius / shown.brush.radius;
        shown.brush = brush;
    }
    h.state_mut().asked.clear();
    h.run_steps(2);
}

/// Unfolds these parts of the panel one after another.
fn unfold(h: &mut Harness<'_, State>, parts: &[&str]) {
    for part in parts {
        h.get_by_label(part).click();
        h.run_steps(30);
    }
}

#[test]
fn a_favourite_stands_first_and_is_one_no_longer_by_a_second_click() {
    let mut h = harness(Tab::Look);
    assert!(h.query_by_label("Favourites").is_none());
    h.get_by_label("Favourite").click();
    h.run_steps(3);
    let kind = h.state().published.brush.kind;
    assert_eq!(h.state().ui_state.prefs.brushes.favourites, [kind.name()]);
    assert!(h.query_by_label("Favourites").is_some());
    // Another brush, and back by the favourite, which stands above the same brush in the list.
    h.get_by_label("Smooth").click();
    h.run_steps(2);
    answer(&mut h);
    let title = "Draw";
    let mut both: Vec<_> = h.get_all_by_label(title).collect();
    both.sort_by(|a, b| a.rect().top().total_cmp(&b.rect().top()));
    assert_eq!(both.len(), 2);
    both[0].click();
    drop(both);
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.kind), Some(BrushKind::Draw));
    answer(&mut h);
    h.get_by_label("Favourite").click();
    h.run_steps(3);
    assert!(h.state().ui_state.prefs.brushes.favourites.is_empty());
    assert!(h.query_by_label("Favourites").is_none());
}

#[test]
fn colours_are_kept_taken_and_forgotten() {
    let mut h = harness(Tab::Look);
    h.state_mut().published.brush.kind = BrushKind::Paint;
    h.state_mut().published.brush.colour = [200, 40, 10, 255];
    h.run_steps(2);
    h.get_by_role_and_label(Role::Button, "Keep").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.prefs.brushes.colours, [[200, 40, 10, 255]]);
    h.state_mut().published.brush.colour = [0, 0, 0, 255];
    h.run_steps(2);
    h.get_by_label("Colour #c8280a").click();
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.colour), Some([200, 40, 10, 255]));
    h.get_by_label("Colour #c8280a").click_secondary();
    h.run_steps(2);
    assert!(h.state().ui_state.prefs.brushes.colours.is_empty());
}

#[test]
fn a_colour_is_picked_by_a_key_and_by_a_click_that_is_no_stroke() {
    let mut h = harness(Tab::Look);
    let asked = |h: &Harness<'_, State>| -> Vec<egui::Pos2> {
        let of = |a: &UiRequest| match a {
            UiRequest::SampleColour(at) => Some(*at),
            _ => None,
        };
        h.state().asked.iter().filter_map(of).collect()
    };
    let at = egui::pos2(620.0, 330.0);
    h.hover_at(at);
    h.run_steps(2);
    h.key_press(Key::C);
    h.run_steps(2);
    assert_eq!(asked(&h), [at]);
    h.state_mut().published.brush.kind = BrushKind::Paint;
    h.run_steps(2);
    h.get_by_role_and_label(Role::Button, "Pick").click();
    h.run_steps(2);
    assert!(h.state().ui_state.brush_panel.samples);
    // Escape leaves it, and the next try is a click on the clay.
    h.key_press(Key::Escape);
    h.run_steps(2);
    assert!(!h.state().ui_state.brush_panel.samples);
    h.get_by_role_and_label(Role::Button, "Pick").click();
    h.run_steps(2);
    h.get_by_label("Click the colour on the clay").click();
    h.run_steps(3);
    assert_eq!(asked(&h).len(), 2);
    assert!(!h.state().ui_state.brush_panel.samples);
    assert!(h.query_by_label("Click the colour on the clay").is_none());
}

#[test]
fn the_colour_of_the_surface_is_that_which_was_painted_there() {
    let red = [220, 30, 20, 255];
    let brush =
        BrushSettings { colour: red, strength: 1.0, ..sculptd::presets().of(BrushKind::Paint) };
    let mut studio = Studio::new(&shapes::icosphere(1.0, 40), brush, 1);
    let seen = |studio: &mut Studio| {
        let snapshot = studio.world.snapshot();
        let ray = Ray { origin: Vec3::new(0.01, 0.02, 4.0), dir: -Vec3::Z };
        let hit = snapshot.pick(ray).expect("the ball");
        snapshot.colour_at(&hit)
    };
    let before = seen(&mut studio);
    let points: Vec<_> = (0..30).map(|i| (Vec2::new(0.45 + 0.0033 * i as f32, 0.5), 1.0)).collect();
    for _ in 0..6 {
        studio.stroke(&points);
    }
    let after = seen(&mut studio);
    let far = |a: [u8; 4]| a.iter().zip(red).map(|(a, b)| a.abs_diff(b)).max();
    assert!(far(before) > Some(100) && far(after) < Some(12), "{before:?}, then {after:?}");
}

#[test]
fn the_gallery_shows_alphas_and_pictures_and_a_click_takes_one_in_hand() {
    let mut h = harness(Tab::Look);
    let heights = (0..256u32).map(|i| (i * 257) as u16).collect();
    let picture = Arc::new(Picture { width: 16, height: 16, heights, cover: Vec::new() });
    let presets = h.state().presets.clone();
    presets.set_pictures(vec![AlphaPicture { name: "slate".into(), picture: picture.clone() }]);
    unfold(&mut h, &["More settings", "Alpha and stamp"]);
    h.get_by_label("Bricks").click();
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.alpha), Some(Alpha::Bricks));
    answer(&mut h);
    h.get_by_label("slate").click();
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.alpha), Some(Alpha::Picture));
    let sent = h.state().asked.iter().find_map(|a| match a {
        UiRequest::World(Command::Picture(p)) => Some(p.clone()),
        _ => None,
    });
    assert!(sent.is_some_and(|p| Arc::ptr_eq(&p, &picture)));
}

#[test]
fn a_radius_in_pixels_stays_on_the_screen_and_one_in_units_on_the_object() {
    let mut h = harness(Tab::Look);
    h.run_steps(2);
    let zoom = |h: &mut Harness<'_, State>| {
        h.state_mut().published.camera.zoom(2.0);
        h.run_steps(2);
    };
    zoom(&mut h);
    assert!(brushes(&h).is_empty(), "on the object it stays as it is");
    h.get_by_label("More settings").click();
    h.run_steps(8);
    h.get_by_label("Radius in pixels").click();
    h.run_steps(3);
    assert!(h.state().ui_state.prefs.brushes.radius_in_pixels);
    assert!(brushes(&h).is_empty());
    // Distance on screen between the middle and the rim of the brush, at the middle of the view.
    let seen = |h: &Harness<'_, State>, setting: f32| {
        let shown = &h.state().published;
        let (camera, world) = (&shown.camera, setting * shown.brush_radius / shown.brush.radius);
        let hit = shown.pick(camera.ray(Vec2::splat(0.5))).expect("the ball");
        let depth = (camera.eye() - hit.position).dot(camera.backward());
        world / camera.world_per_view(depth)
    };
    let first = h.state().published.brush.radius;
    let before = seen(&h, first);
    zoom(&mut h);
    let now = brushes(&h).last().expect("asked for").radius;
    assert!(now < 0.6 * first, "{first} became {now}");
    let after = seen(&h, now);
    assert!((after / before - 1.0).abs() < 1e-3, "{before} became {after}");
    answer(&mut h);
    assert!(brushes(&h).is_empty(), "what was asked for has come");
    h.state_mut().published.camera.zoom(0.25);
    h.run_steps(2);
    let back = brushes(&h).last().expect("asked for").radius;
    let after = seen(&h, back);
    assert!((after / before - 1.0).abs() < 1e-3, "{before} became {after}");
}

#[test]
fn the_brush_in_hand_is_saved_under_a_name_and_replaced_by_the_same_name() {
    let mut h = harness(Tab::Look);
    unfold(&mut h, &["More settings"]);
    assert!(h.query_by_label("Save this brush").is_none(), "there is no folder");
    h.state_mut().ui_state.brush_panel.saves = true;
    h.run_steps(2);
    unfold(&mut h, &["Save this brush"]);
    let saved = |h: &mut Harness<'_, State>| -> Vec<(String, bool)> {
        let of = |a: UiRequest| match a {
            UiRequest::SaveBrush { name, replace } => Some((name, replace)),
            _ => None,
        };
        h.state_mut().asked.drain(..).filter_map(of).collect()
    };
    // The name of a brush of the program is none for another.
    for (name, button) in [("clay", "Save"), ("my ridges", "Save")] {
        h.state_mut().ui_state.brush_panel.name = name.into();
        h.run_steps(2);
        h.get_by_role_and_label(Role::Button, button).click();
        h.run_steps(2);
    }
    assert_eq!(saved(&mut h), [("my ridges".to_owned(), false)]);
    let mut settings = h.state().published.brush;
    settings.preset = preset_number("my ridges");
    let own = OwnBrush {
        name: "my ridges".into(),
        about: String::new(),
        order: 0,
        settings,
        picture_file: None,
        picture: None,
    };
    h.state().presets.set_own(vec![own]);
    h.state_mut().ui_state.brush_panel.name = "my ridges ".into();
    h.run_steps(2);
    h.get_by_role_and_label(Role::Button, "Replace").click();
    h.run_steps(2);
    assert_eq!(saved(&mut h), [("my ridges".to_owned(), true)]);
}

#[test]
fn pressure_bends_the_radius_as_it_bends_the_strength() {
    let mut h = harness(Tab::Look);
    unfold(&mut h, &["Pressure"]);
    let at = h.get_by_label("Pressure curve of the radius").rect();
    // The middle, drawn down: the light touch is finer.
    h.drag_at(at.center());
    h.run_steps(2);
    h.hover_at(at.center() + egui::vec2(0.0, 30.0));
    h.run_steps(2);
    h.drop_at(at.center() + egui::vec2(0.0, 30.0));
    h.run_steps(2);
    let now = brushes(&h).last().copied().expect("asked for");
    let before = h.state().published.brush;
    assert!(now.pressure_radius.gamma > before.pressure_radius.gamma, "{now:?}");
    assert_eq!(now.pressure_strength, before.pressure_strength);
    assert!(h.query_all_by_label("Radius bend").count() > 0);
}

//! What a newcomer meets: the first lesson, the keys, the help.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use sculptd_clay::brush::{BrushKind, Presets};
use sculptd_daemon::tablet_actions::TabletActions;
use sculptd_daemon::tablet_controls::TabletControls;
use sculptd_devices::pad_actions::{ActionTable, Binding, Control};
use sculptd_devices::{Body, DeviceId, Pad, Sample};
use sculptd_engine::stroke::PenPoint;
use sculptd_window::panels::state::{Action, Hint, HintsFollowed, KeySet, TabletKeys};
use sculptd_window::panels::{Tab, UiRequest};

use super::panels::{State, brushes, harness};

#[test]
fn hints_are_gone_for_good_once_followed() {
    let mut h = harness(Tab::Look);
    let hint = |h: &Harness<'_, State>| h.state().ui_state.prefs.hints.hint().map(|h| h.0);
    assert!(h.query_by_label_contains("Press and drag on the clay (1 of 6)").is_some());
    h.state_mut().ui_state.prefs.hints.touched = true;
    h.run_steps(2);
    assert!(h.query_by_label_contains("Press and drag on the clay").is_none());
    assert!(h.query_by_label_contains("Drag beside the clay").is_some());
    h.state_mut().ui_state.prefs.hints.turned = true;
    h.run_steps(2);
    // Strokes as the window's keys make them: smooth, then carved, then mirrored.
    for (next, change) in [(Hint::Carve, 0), (Hint::Undo, 1)] {
        let pen = PenPoint { pressure: 0.5, ..Default::default() };
        let published = &mut h.state_mut().published;
        published.pens[0] = Some((DeviceId(1), pen));
        match change {
            0 => published.brush.kind = BrushKind::Smooth,
            _ => (published.brush.kind, published.brush.negative) = (BrushKind::Draw, true),
        }
        h.run_steps(2);
        assert_eq!(hint(&h), Some(next));
        h.state_mut().published.pens[0] = None;
    }
    h.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    h.run_steps(3);
    assert_eq!(hint(&h), Some(Hint::Mirror));
    // The rest may be skipped.
    h.state_mut().ui_state.tab = Tab::More;
    h.run_steps(2);
    h.get_by_label("Skip the lesson").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.prefs.hints, HintsFollowed::ALL);
    assert!(h.query_by_label_contains("of 6)").is_none());
    // Stored from day to day.
    let kept = toml::to_string(&h.state().ui_state.prefs).expect("plain data");
    let kept = sculptd_window::panels::state::Preferences::read(&kept).expect("read");
    assert_eq!(kept.hints.hint(), None);
}

#[test]
fn the_hand_of_the_lesson_shows_a_hint_once_and_rests() {
    let mut h = harness(Tab::Look);
    let shapes = |h: &Harness<'_, State>| h.output().shapes.len();
    // A step is a quarter of a second here, and the hand is there for four.
    h.run_steps(4);
    let shown = shapes(&h);
    h.run_steps(20);
    assert!(shapes(&h) < shown, "the hand is gone");
    assert!(h.query_by_label_contains("(1 of 6)").is_some());
    let delay = h.output().viewport_output.values().map(|v| v.repaint_delay).min();
    assert!(delay.is_some_and(|d| d.as_secs() > 60), "{delay:?}: nothing moves any more");
}

#[test]
fn keys_are_chosen_from_a_set_changed_by_a_press_and_told_where_two_actions_share_them() {
    let mut h = harness(Tab::More);
    h.get_by_label("Keys...").click();
    h.run_steps(2);
    h.state_mut().ui_state.prefs.keys.set = KeySet::Blender;
    h.run_steps(2);
    h.key_press(Key::C);
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.kind), Some(BrushKind::Clay));
    h.state_mut().asked.clear();
    h.state_mut().ui_state.keys.filter = "wireframe".into();
    h.run_steps(2);
    h.get_by_label("Keys of Wireframe").click();
    h.run_steps(2);
    assert_eq!(h.state().ui_state.keys.listening, Some(Action::Wireframe));
    h.key_press(Key::C);
    h.run_steps(2);
    assert!(brushes(&h).is_empty(), "the press that answers is no action");
    assert!(h.query_by_label_contains("2 actions share keys").is_some());
    assert!(h.query_by_label_contains("also: Clay brush").is_some());
    h.key_press(Key::C);
    h.run_steps(2);
    assert!(h.state().ui_state.look.wireframe && brushes(&h).is_empty());
    h.get_by_label("Reset").click();
    h.run_steps(2);
    h.key_press(Key::C);
    h.run_steps(2);
    assert_eq!(brushes(&h).last().map(|b| b.kind), Some(BrushKind::Clay));
    assert!(h.state().ui_state.prefs.keys.own.is_empty());
}

#[test]
fn help_lists_gestures_pages_and_every_key() {
    let mut h = harness(Tab::Look);
    h.key_press(Key::F1);
    h.run_steps(3);
    for text in ["Bare hands over a tracker", "Wheel", "Wall thickness and thin spots", "Ctrl+Z"] {
        assert!(h.query_all_by_label_contains(text).next().is_some(), "{text}");
    }
    h.key_press(Key::Escape);
    h.run_steps(2);
    assert!(h.query_by_label_contains("Bare hands over a tracker").is_none());
}

#[test]
fn a_key_of_the_tablet_is_chosen_by_pressing_it() {
    let controls = TabletControls::default();
    let mut h = harness(Tab::Devices);
    let see = |h: &mut Harness<'_, State>| {
        let (own, last) = (controls.own(), controls.last());
        h.state_mut().tablet = Some(TabletKeys { own, last });
        h.run_steps(2);
        for request in h.state_mut().asked.drain(..) {
            match request {
                UiRequest::TabletListen(listens) => controls.listen(listens),
                // Not stored, and reported as such.
                UiRequest::TabletBinding(control, binding) => {
                    assert!(controls.bind(control, binding).is_err());
                }
                _ => {}
            }
        }
    };
    see(&mut h);
    h.get_by_label("Choose by pressing it").click();
    see(&mut h);
    assert!(controls.is_listening());
    // The loop sees the third key of a tablet.
    let mut actions = TabletActions::new(ActionTable::default(), Presets::default())
        .with_controls(controls.clone());
    let pad = Pad { keys: 0b100, ..Pad::default() };
    let sample = Sample { device: DeviceId(3), t_us: 0, device_t_us: None, body: Body::Pad(pad) };
    let mut asked = Vec::new();
    actions.take(&mut [sample], &super::world(500), &mut asked);
    assert!(asked.is_empty(), "a press that is listened to does nothing");
    see(&mut h);
    see(&mut h);
    assert!(!controls.is_listening());
    h.get_by_label("Action of Key 3").click();
    see(&mut h);
    h.get_by_label("Turn the view while held").click();
    see(&mut h);
    see(&mut h);
    assert_eq!(controls.own().controls[&Control::Key(3)], Binding::Hold("view.turn".into()));
    h.get_by_label("Key 3: Turn the view while held");
    h.get_by_label("Reset").click();
    see(&mut h);
    see(&mut h);
    assert!(controls.own().controls.is_empty());
    // Another page: nobody listens any longer.
    h.get_by_label("Choose by pressing it").click();
    see(&mut h);
    assert!(controls.is_listening());
    h.state_mut().ui_state.tab = Tab::Look;
    see(&mut h);
    assert!(!controls.is_listening());
}

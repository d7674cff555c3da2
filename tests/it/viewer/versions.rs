//! The session's history in the panel: versions on branches by a click, versions of the line by a
//! drag and by the slider.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use sculptd_daemon::session::history::{Node, Tree};
use sculptd_engine::command::Command;
use sculptd_engine::world::HistoryEvent;
use sculptd_window::panels::{Tab, UiRequest};

use super::panels::{State, show, state};

/// Versions one after the other, a second apart, where no parent is named by `branches`.
fn tree(count: u64, branches: &[(u64, u64)], cursor: u64) -> Tree {
    let mut tree = Tree::default();
    for id in 0..count {
        let parent = branches.iter().find(|b| b.0 == id).map(|b| b.1).or(id.checked_sub(1));
        tree.add(Node {
            id,
            parent,
            tick: id * 120,
            deed: HistoryEvent::Step,
            object_id: 0,
            changes: vec![],
            pages: 1,
            middle: Vec3::ZERO,
            extent: 1.0,
            next: [0, 0],
            levels: None,
            scene: None,
        });
        tree.go(id);
    }
    tree.go(cursor);
    tree
}

fn harness(tree: &Tree) -> Harness<'static, State> {
    let mut s = state(Tab::Look);
    s.ui_state.versions.rate_hz = 120;
    s.ui_state.versions.set(tree);
    // Tall enough for the whole panel: what is out of sight is not pressed.
    let mut h =
        Harness::builder().with_size([1280.0, 1200.0]).with_max_steps(64).build_ui_state(show, s);
    h.run_steps(6);
    h
}

fn jumps(h: &Harness<'_, State>) -> Vec<u64> {
    let of = |a: &UiRequest| match a {
        UiRequest::Jump(node) => Some(*node),
        _ => None,
    };
    h.state().asked.iter().filter_map(of).collect()
}

#[test]
fn a_version_on_a_branch_is_gone_to_by_a_click() {
    let mut h = harness(&tree(5, &[(3, 1)], 4));
    h.get_by_label("5 versions");
    h.get_by_label("Version 2, at 0:02, on a branch").click();
    h.run_steps(3);
    assert_eq!(jumps(&h), [2]);
    h.state_mut().asked.clear();
    // The work is here already.
    h.get_by_label("Version 4, at 0:04").click();
    h.run_steps(3);
    assert_eq!(jumps(&h), [] as [u64; 0]);
    // The pictures of what is seen are asked for.
    assert_eq!(h.state().ui_state.versions.visible, [0, 1, 2, 3, 4]);
    // Memory contains no step to undo, but the file does.
    h.get_by_label("Undo").click();
    h.run_steps(3);
    assert!(
        matches!(h.state().asked[..], [UiRequest::World(Command::Undo)]),
        "{:?}",
        h.state().asked
    );
}

#[test]
fn a_drag_goes_through_the_versions_and_asks_for_each_once() {
    let mut h = harness(&tree(5, &[], 4));
    let at = |h: &Harness<'_, State>, n: u64| {
        h.get_by_label(&format!("Version {n}, at 0:0{n}")).rect().center()
    };
    let press = |pos: egui::Pos2, pressed: bool| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: Default::default(),
    };
    let (from, to) = (at(&h, 4), at(&h, 1));
    h.event(egui::Event::PointerMoved(from));
    h.event(press(from, true));
    h.run_steps(2);
    for i in 1..=12 {
        h.event(egui::Event::PointerMoved(from + (to - from) * (i as f32 / 12.0)));
        h.run_steps(1);
    }
    h.event(press(to, false));
    h.run_steps(3);
    let mut went = jumps(&h);
    // The work was at 4 when the drag began: going there is nothing.
    went.retain(|n| *n != 4);
    assert_eq!(went, [3, 2, 1]);
}

#[test]
fn a_long_history_shows_where_the_work_is_and_costs_what_is_seen() {
    let mut h = harness(&tree(4000, &[(100, 50), (2000, 1500)], 3990));
    h.run_steps(10);
    let visible = h.state().ui_state.versions.visible.clone();
    assert!(visible.contains(&3990) && visible.len() < 12, "{visible:?}");
    h.get_by_label("Version 3990, at 66:30");
    assert!(h.query_by_label("Version 0, at 0:00").is_none());
    // Elsewhere: the list follows.
    let mut t = tree(4000, &[(100, 50), (2000, 1500)], 3990);
    t.go(60);
    h.state_mut().ui_state.versions.set(&t);
    h.run_steps(10);
    h.get_by_label_contains("Version 60, ");
    let before = h.state().ui_state.versions.rows.len();
    assert_eq!(before, 4000);
    // Of the line that is left, the slider knows the places only: by keys, one at a time.
    h.get_by_role_and_label(egui::Role::Slider, "Version").focus();
    h.run_steps(2);
    h.key_press(egui::Key::ArrowRight);
    h.run_steps(3);
    assert_eq!(jumps(&h).len(), 1);
}

//! Nothing is lost: a session is always on, whether the window is closed or its screen is killed.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::stage::{MIDDLE, Stage, long, pause};

/// The sessions of the person's data folder, the first in name first.
fn kept(s: &Stage) -> Vec<PathBuf> {
    let folder = s.dir.path().join("data/sculptd/sessions");
    let found = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path());
    let mut all: Vec<PathBuf> =
        found.filter(|p| p.extension().is_some_and(|e| e == "sculpt")).collect();
    all.sort();
    all
}

fn versions_of(s: &Stage) -> usize {
    s.ask("history", &json!({}))["places"].as_array().map_or(0, Vec::len)
}

fn hash(s: &Stage) -> Value {
    s.ask("hash", &Value::Null)["hash"].clone()
}

#[test]
fn closing_and_reopening_loses_nothing_and_an_untouched_session_leaves_no_file() {
    let Some(mut s) = Stage::open(&[]) else { return };
    assert_eq!(kept(&s).len(), 1, "a session is on");
    s.restart(&[]);
    assert_eq!(kept(&s).len(), 1, "the first was empty");
    for i in 0..if long() { 20 } else { 3 } {
        let y = -80 + (i % 9) * 20;
        let versions = versions_of(&s);
        s.drag((-80, y), (80, y));
        s.until("the stroke is kept", |s| versions_of(s) == versions + 1);
        let before = hash(&s);
        let session = kept(&s)[0].display().to_string();
        s.restart(&["--session", &session]);
        assert_eq!(hash(&s), before, "after closing {i}");
        assert_eq!(versions_of(&s), versions + 1);
    }
}

#[test]
fn a_killed_screen_costs_no_stroke() {
    let Some(mut s) = Stage::open(&[]) else { return };
    s.drag((-80, -40), (80, -40));
    s.until("the stroke is done", |s| s.figure("undo_steps") == 1);
    let (session, first) = (kept(&s)[0].display().to_string(), hash(&s));
    // In the middle of another.
    let at = |dx: i32| [(MIDDLE.0 + dx).to_string(), (MIDDLE.1 + 40).to_string()];
    let [x, y] = at(-80);
    s.drive(&["mousemove", &x, &y, "mousedown", "1"]);
    for dx in [-40, 0, 40] {
        let [x, y] = at(dx);
        s.drive(&["mousemove", &x, &y]);
    }
    s.until("it has begun", |s| hash(s) != first);
    // What a crash may cost at most.
    pause(300);
    s.lose_screen();
    s.begin_anew(&["--session", &session]);
    assert_ne!(hash(&s), first, "the open stroke is there, ended as by a lifted pen");
    if long() {
        s.ask("undo", &Value::Null);
        s.until("it is one step", |s| hash(s) == first);
    }
}

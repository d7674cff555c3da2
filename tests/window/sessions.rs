//! Nothing is lost by closing a window: a session is always on.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::stage::{Stage, long};

/// The sessions of the person's data folder, the first in name first.
pub fn kept(s: &Stage) -> Vec<PathBuf> {
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

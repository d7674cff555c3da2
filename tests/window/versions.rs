//! The versions of a session in a real window.

use serde_json::{Value, json};

use super::stage::{Stage, pause};

/// Three strokes, two of them undone, one more; then every version by a click on its row.
#[test]
fn the_versions_of_a_session_in_a_real_window() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("s.sculpt");
    let args = ["--session", path.to_str().expect("UTF-8")];
    let Some(mut s) = Stage::open(&args) else { return };
    let history = |s: &Stage| s.ask("history", &json!({}));
    let count = |s: &Stage| history(s)["places"].as_array().map_or(0, Vec::len);
    let hash = |s: &Stage| s.ask("hash", &Value::Null)["hash"].clone();
    let mut hashes = vec![hash(&s)];
    let mut stroke = |s: &mut Stage, from: (i32, i32), to: (i32, i32), versions: usize| {
        s.drag(from, to);
        s.until("the stroke is kept", |s| count(s) == versions);
        hashes.push(hash(s));
    };
    for k in 0..3 {
        stroke(&mut s, (-100, -70 + 50 * k), (100, -70 + 50 * k), 2 + k as usize);
    }
    for left in [2, 1] {
        s.ask("undo", &Value::Null);
        s.until("it is taken back", |s| history(s)["here"] == left);
    }
    stroke(&mut s, (0, -120), (0, 120), 5);
    s.seen("versions-1-branch");
    // The rows are in the left panel. A click on a row goes to its version. Click from the lowest
    // row up, again and again, until each version was visited.
    let here = |s: &Stage| history(s)["here"].as_u64().expect("a version") as usize;
    let mut met = std::collections::BTreeSet::from([here(&s)]);
    let mut rows = (520..720).rev().step_by(10).cycle();
    let mut clicks = 0;
    s.until("every version is gone to", |s| {
        let y = rows.next().expect("a row").to_string();
        // A long tree is scrolled: to its end, and back to its beginning.
        clicks += 1;
        if clicks % 20 == 0 {
            let wheel = if clicks % 40 == 0 { "4" } else { "5" };
            s.drive(&["mousemove", "120", "660", "click", "--repeat", "10", wheel]);
        }
        s.drive(&["mousemove", "120", &y, "click", "1", "mousemove", "640", "650"]);
        pause(100);
        met.insert(here(s));
        met.len() == 5
    });
    s.until("the clay is that of the version", |s| {
        let now = here(s);
        hash(s) == hashes[now] && here(s) == now
    });
    s.look("versions-2-gone");
}

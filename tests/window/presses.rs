//! No press is lost and none goes astray: it belongs to what is under the pointer at that time.

use serde_json::Value;

use super::places::{CLAY, DRAW};
use super::stage::{MIDDLE, Stage};

/// Two brushes of the left panel: where their buttons are, and their names.
const BRUSHES: [((i32, i32), &str); 2] = [(DRAW, "draw"), (CLAY, "clay")];
/// Presses on each side.
const PRESSES: u32 = 100;

#[test]
fn a_press_right_after_entering_or_leaving_a_panel_goes_where_it_is() {
    let Some(mut s) = Stage::open(&[]) else { return };
    s.seen("presses-start");
    let kind =
        |s: &Stage| s.ask("status", &Value::Null)["brush"]["kind"].as_str().map(str::to_owned);
    let go = |s: &Stage, (x, y): (i32, i32), wait_ms: u32| {
        let (x, y, wait) = (x.to_string(), y.to_string(), format!("0.{wait_ms:03}"));
        s.tool("xdotool", &["mousemove", &x, &y, "sleep", &wait, "click", "1"]).expect("driven");
    };
    let (mut on_clay, mut on_panel) = (0, 0);
    for i in 0..PRESSES {
        // 0 to 50 ms, each wait twice over the run.
        let wait_ms = i * 51 / PRESSES;
        let before = s.figure("undo_steps");
        let at = (MIDDLE.0 - 60 + (i % 11) as i32 * 12, MIDDLE.1 - 60 + (i / 11) as i32 * 12);
        go(&s, at, wait_ms);
        on_clay += u32::from(s.soon(|s| s.figure("undo_steps") == before + 1));
        let now = s.figure("undo_steps");
        let (button, name) = BRUSHES[i as usize % 2];
        go(&s, button, wait_ms);
        on_panel += u32::from(s.soon(|s| kind(s).as_deref() == Some(name)));
        assert_eq!(s.figure("undo_steps"), now, "a press on the panel is no stroke");
    }
    println!(
        "of {PRESSES} presses each, {on_clay} on the clay and {on_panel} on a panel were done"
    );
    assert_eq!((on_clay, on_panel), (PRESSES, PRESSES));
}

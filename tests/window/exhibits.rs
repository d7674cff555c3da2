//! An exhibit in a real window: the task is chosen, carved, compared, finished; staff ends it.

use crate::places::{
    EXHIBIT_CARVE, EXHIBIT_COMPARE, EXHIBIT_FINISHED, STAFF_DOOR, STAFF_END, staff_key,
};
use crate::stage::{Stage, differs, pause};

fn press(s: &Stage, (x, y): (i32, i32)) {
    s.drive(&["mousemove", &x.to_string(), &y.to_string()]);
    pause(300);
    s.drive(&["click", "1"]);
    pause(700);
}

#[test]
fn a_visitor_carves_the_bear_and_staff_ends_the_day() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("kiosk.toml");
    let audit = dir.path().join("visits.log");
    let text = format!(
        "staff_pin = \"4711\"\nexhibits = [\"figurine\"]\naudit = \"{}\"\n",
        audit.display()
    );
    #[allow(clippy::disallowed_methods)] // Settings of a test.
    std::fs::write(&path, text).expect("written");
    let Some(mut s) = Stage::open(&["--kiosk", "--kiosk-config", path.to_str().expect("UTF-8")])
    else {
        return;
    };
    s.until("the film sculpts", |s| s.figure("dabs") > 30);
    s.drag((-60, -60), (60, -50));
    s.until("the first stroke", |s| s.figure("undo_steps") == 1);
    press(&s, EXHIBIT_CARVE);
    s.drag((-60, 40), (60, 60));
    s.until("a carved stroke", |s| s.figure("undo_steps") == 2);
    pause(3000);
    let ghost = s.look("exhibit-1-ghost");
    press(&s, EXHIBIT_COMPARE);
    s.until("the difference is shown", |s| differs(&ghost, &s.look("exhibit-2-difference")) > 2.0);
    press(&s, EXHIBIT_FINISHED);
    let line = || std::fs::read_to_string(&audit).unwrap_or_default();
    s.until("the visit is in the audit file", |_| !line().is_empty());
    assert!(line().contains("\"exhibit\":\"figurine\",\"percent\":"), "{}", line());
    pause(1000);
    s.look("exhibit-3-result");
    press(&s, STAFF_DOOR);
    for digit in [4, 7, 1, 1] {
        press(&s, staff_key(digit));
    }
    press(&s, staff_key(12));
    pause(1000);
    s.look("exhibit-4-staff");
    press(&s, STAFF_END);
    pause(500);
    assert!(s.daemon.0.try_wait().expect("a process").is_none(), "once is not enough");
    press(&s, STAFF_END);
    s.until("it ends", |s| {
        s.daemon.0.try_wait().is_ok_and(|ended| ended.is_some_and(|e| e.success()))
    });
}

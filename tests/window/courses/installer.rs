//! An installer: settings with a mistake, the attract loop, visits by pointer, languages, idleness.

use std::process::Command;

use super::{Course, hash, press, steps};
use crate::places::STAFF_END_BESIDE_EXPORT;
use crate::stage::{Stage, differs, pause};

/// The settings of an installation in a folder.
fn settings(dir: &std::path::Path, more: &str) -> String {
    let path = dir.join("kiosk.toml");
    let (gallery, audit) = (dir.join("gallery"), dir.join("audit.jsonl"));
    let text = format!(
        "idle_s = 12.0\ncountdown_s = 8.0\nstaff_pin = \"4711\"\ngallery = \"{}\"\naudit = \
         \"{}\"\n{more}",
        gallery.display(),
        audit.display()
    );
    #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
    std::fs::write(&path, text).expect("written");
    path.display().to_string()
}

#[test]
fn an_installer_s_hour() {
    let dir = tempfile::tempdir().expect("a folder");
    let gallery = dir.path().join("gallery");
    std::fs::create_dir(&gallery).expect("a folder");
    // An error in the settings is reported before anything opens, with the key and its range.
    let wrong = settings(dir.path(), "share_minutes = 0.0\n");
    let out = Command::new(env!("CARGO_BIN_EXE_sculptd"))
        .args(["run", "--kiosk", "--headless", "--for", "1", "--kiosk-config", &wrong])
        .output()
        .expect("it runs");
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(3), "{said}");
    assert!(said.contains("share_minutes") && said.contains("1 to 1440"), "{said}");

    let right = settings(dir.path(), "");
    let args = ["--kiosk", "--kiosk-config", &right];
    let Some(mut c) = Course::begin("installer", &args) else { return };
    c.step("the attract loop sculpts by itself", |_| {}, |s| s.figure("dabs") > 30);
    let audit = dir.path().join("audit.jsonl");
    let lines = |what: &str| {
        let text = std::fs::read_to_string(&audit).unwrap_or_default();
        text.lines().filter(|line| line.contains(what)).count()
    };
    // Visits of which a work was kept.
    let works = || lines("\"kept\":true");
    let dabs = c.s.figure("dabs");
    c.step(
        "a pointer that passes is no visitor: the loop goes on",
        |s| {
            s.drive(&["mousemove", "500", "300"]);
            s.drive(&["mousemove", "700", "420"]);
        },
        |s| s.figure("dabs") > dabs + 20,
    );
    c.step(
        "a touch begins a visit on clean clay",
        |s| s.drag((-80, 0), (80, 10)),
        |s| steps(s) == 1,
    );
    c.is_as_kept();
    c.step("a second stroke", |s| s.drag((-60, 60), (60, 50)), |s| steps(s) == 2);
    // The tools are at the lower edge: Add, Carve, Smooth, Undo, Finished.
    let tools = [(283, 651), (453, 651), (623, 651), (805, 651), (965, 651)];
    let negative = |s: &Stage| super::brush(s)["negative"].clone();
    c.step("Carve", |s| press(s, tools[1]), |s| negative(s) == true);
    c.step("a carved stroke", |s| s.drag((-80, -60), (80, -50)), |s| steps(s) == 3);
    c.step("Smooth", |s| press(s, tools[2]), |s| super::brush(s)["kind"] == "smooth");
    c.step("Add", |s| press(s, tools[0]), |s| negative(s) == false);
    c.step("Undo", |s| press(s, tools[3]), |s| steps(s) == 2);
    c.step("Italian", |s| press(s, (250, 62)), |_| true);
    c.is_as_kept();
    let visitor = hash(&c.s);
    c.step("Finished keeps the work and goes back", |s| press(s, tools[4]), |_| works() == 1);
    c.step(
        "the next visitor begins on clean clay",
        |s| {
            pause(1000);
            s.drag((-80, 0), (80, 10));
        },
        |s| steps(s) == 1 && hash(s) != visitor,
    );
    let working = c.s.look("course-installer-working");
    c.step(
        "nobody moves: a countdown",
        |_| pause(13_000),
        |s| differs(&working, &s.look("course-installer-countdown")) > 1.0,
    );
    c.is_as_kept();
    c.step("a touch stops it", |s| s.drag((-20, 20), (20, 20)), |s| steps(s) == 2);
    // The same installation for others: what is in the file is on the screen.
    let dabs = c.s.figure("dabs");
    c.step("nobody comes back: the loop begins again", |_| {}, |s| s.figure("dabs") > dabs + 60);
    c.step("and the clay is clean", |_| {}, |s| hash(s) != visitor);
    let plain = c.s.look("course-installer-plain");
    for (what, more) in [
        ("large print and strong contrast", "[screen]\ntext = 1.6\ncontrast = true\n"),
        ("everything within reach of a chair", "[screen]\nseated = true\n"),
        ("one switch walks over the buttons", "[screen]\nscan_s = 1.0\n"),
        ("Italian, with a brush of its own", "brush = \"clay-strips\"\nlanguage = \"it\"\n"),
    ] {
        let file = settings(dir.path(), more);
        let mut now = plain.clone();
        c.step(
            what,
            |s| s.restart(&["--kiosk", "--kiosk-config", &file]),
            |s| {
                now = s.look("course-installer-other");
                differs(&plain, &now) > 0.2
            },
        );
        c.step(
            "a touch begins a visit there too",
            |s| {
                pause(500);
                s.drag((-80, 0), (80, 10));
            },
            |s| steps(s) >= 1,
        );
    }
    assert_eq!(super::brush(&c.s)["kind"], "clay-strips", "the brush of the file");
    c.step("Finished keeps this work too", |s| press(s, tools[4]), |_| works() >= 2);
    let pictures = std::fs::read_dir(&gallery).expect("a folder").count();
    c.step("what was kept is in the gallery", |_| {}, |_| pictures >= 2);
    staff_comes(&mut c);
    println!("{} steps", c.steps);
}

/// The keypad of the staff: a wrong number lets nobody out, the right one ends the program.
fn staff_comes(c: &mut Course) {
    let digit = |n: i32| (1049 + (n - 1) % 3 * 78, 112 + (n - 1) / 3 * 77);
    let (door, ok) = ((1196, 75), (1205, 343));
    c.step(
        "a new visit",
        |s| {
            pause(1000);
            s.drag((-80, 0), (80, 10));
        },
        |s| steps(s) == 1,
    );
    let typed = move |number: &'static [i32]| {
        move |s: &mut Stage| {
            press(s, door);
            pause(600);
            for n in number {
                press(s, digit(*n));
                pause(200);
            }
            press(s, ok);
        }
    };
    c.step("a wrong number of the staff", typed(&[1, 2, 3, 4]), |s| steps(s) == 1);
    pause(1000);
    c.step("the visit goes on", |s| s.drag((-60, 60), (60, 50)), |s| steps(s) == 2);
    c.step("the right number opens the staff page", typed(&[4, 7, 1, 1]), |_| true);
    c.step(
        "the end, asked for twice",
        |s| {
            pause(1500);
            press(s, STAFF_END_BESIDE_EXPORT);
            pause(1000);
            press(s, STAFF_END_BESIDE_EXPORT);
        },
        |s| s.daemon.0.try_wait().is_ok_and(|ended| ended.is_some_and(|e| e.success())),
    );
}

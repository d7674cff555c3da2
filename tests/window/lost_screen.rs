//! The loss of a screen costs the window alone: the X server is killed in the middle of a stroke.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Instant;

use glam::Vec2;
use sculptd_clay::Workers;
use sculptd_daemon::adaptors::POINTER_ID;
use sculptd_daemon::session::{self, Opened, replay};
use sculptd_devices::serial::Protocol;
use sculptd_devices::sim::{PenScript, SerialPen, SerialPenConfig, Shape, Stroke};
use sculptd_devices::{Body, Sample};
use sculptd_engine::command::Command;
use sculptd_geometry::job::Job;
use serde_json::{Value, json};

use super::stage::{MIDDLE, Stage, long, pause};

fn hash(s: &Stage) -> Value {
    s.ask("hash", &Value::Null)["hash"].clone()
}

fn standing(s: &Stage) -> String {
    s.ask("status", &Value::Null)["window"].as_str().unwrap_or_default().to_owned()
}

fn alive(s: &mut Stage) -> bool {
    s.daemon.0.try_wait().is_ok_and(|ended| ended.is_none())
}

/// The pointer goes down at the left of a row and over half of the clay.
fn half_a_stroke(s: &mut Stage, row: i32, before: &Value) {
    let at = |dx: i32| [(MIDDLE.0 + dx).to_string(), (MIDDLE.1 + row).to_string()];
    let [x, y] = at(-80);
    s.drive(&["mousemove", &x, &y, "mousedown", "1"]);
    for dx in [-60, -40, -20, 0, 20, 40] {
        let [x, y] = at(dx);
        s.drive(&["mousemove", &x, &y]);
    }
    s.until("it has begun", |s| hash(s) != *before);
}

/// The screen is killed, and the daemon goes on without its window.
fn lose(s: &mut Stage) {
    s.lose_screen();
    s.until("the daemon knows", |s| standing(s) == "lost");
    assert!(alive(s));
}

/// The input of a run of which the last stroke of the pointer was ended by lifting it, in the place
/// of what the daemon did when it lost the window.
fn lifted_instead(mut opened: Opened) -> Opened {
    let last = |t: &session::format::TickInput| {
        t.samples.iter().rev().find(|p| p.device == POINTER_ID).copied()
    };
    let at = opened
        .input
        .iter()
        .position(|t| t.commands.iter().any(|c| matches!(c, Command::LiftAll)))
        .expect("the end of the stroke is in the session");
    let mut sample: Sample = opened.input[..=at].iter().rev().find_map(last).expect("a pointer");
    let Body::Pen(pen) = &mut sample.body else { panic!("the pointer is a pen") };
    pen.tip = false;
    let tick = &mut opened.input[at];
    tick.commands.retain(|c| !matches!(c, Command::LiftAll | Command::DesktopLayout(_)));
    tick.samples = vec![sample];
    opened
}

#[test]
fn a_killed_screen_ends_the_stroke_and_nothing_else() {
    let Some(mut s) = Stage::open(&[]) else { return };
    s.drag((-80, -60), (80, -60));
    s.until("the stroke is done", |s| s.figure("undo_steps") == 1);
    let first = hash(&s);
    let pid = s.daemon.0.id();
    half_a_stroke(&mut s, 40, &first);
    lose(&mut s);
    // The stroke ends as if the pen were lifted: one step, which undo removes.
    s.until("the stroke is closed", |s| s.figure("undo_steps") == 2);
    let ended = hash(&s);
    assert_ne!(ended, first);
    pause(300);
    assert_eq!(hash(&s), ended, "nothing moves on");
    s.ask("undo", &Value::Null);
    s.until("it is one step", |s| hash(s) == first);
    s.ask("redo", &Value::Null);
    s.until("it is there again", |s| hash(s) == ended);

    // Another screen: the same daemon, in a window there.
    s.new_screen();
    s.window(&["window"]);
    assert!(alive(&mut s) && s.daemon.0.id() == pid);
    assert_eq!((standing(&s).as_str(), hash(&s)), ("open", ended.clone()));
    s.seen("lost-1-new-window");
    let (well, said) = s.run(&["window"]);
    assert!(!well && said.contains("open already"), "{said}");
    // The window sculpts, and earlier steps can be undone.
    let steps = s.figure("undo_steps");
    s.drag((-80, -20), (80, -20));
    s.until("the new window sculpts", |s| s.figure("undo_steps") == steps + 1);
    s.seen("lost-2-sculpted");
    s.ask("undo", &Value::Null);
    s.until("the new stroke is taken back", |s| hash(s) == ended);
    s.ask("undo", &Value::Null);
    s.until("and the one before", |s| hash(s) == first);

    // The same bits as of a run whose pen was lifted at that moment.
    let path = s.ask("status", &Value::Null)["session"].as_str().expect("a path").to_owned();
    let opened = lifted_instead(session::open(path.as_ref()).expect("readable"));
    let undoes = |c: &Command| matches!(c, Command::Undo);
    let until = opened.input.iter().position(|t| t.commands.iter().any(undoes));
    let until = opened.input[until.expect("the undo above")].tick - 1;
    let mut run = replay::replay(&opened, Some(until), Workers::new(2), &Job::default());
    let world = &mut run.as_mut().expect("replayed").world;
    assert_eq!(json!(format!("{:016x}", world.snapshot().hash())), ended);
    // A signal ends it as ever.
    s.ask("shutdown", &Value::Null);
    s.until("the daemon ends", |s| !alive(s));
}

/// A serial pen that is down from its second second on, for an hour, and turns about the middle.
fn circling_pen() -> SerialPen {
    let area = Vec2::new(200.0, 125.0);
    let stroke = Stroke {
        from_us: 2_000_000,
        to_us: 3_602_000_000,
        // A turn takes four seconds.
        shape: Shape::Turn { centre: area * 0.5, radius: [12.0; 2], angle: [0.0, 5654.9] },
        pressure: 0.7,
        tilt: Vec2::ZERO,
        eraser: false,
        buttons: 0,
    };
    let config = SerialPenConfig::new(Protocol::Isdv4, area);
    SerialPen::new(PenScript::new(vec![stroke]), config).expect("a pseudo-terminal")
}

#[test]
#[allow(clippy::disallowed_methods)] // The pen moves in the time of the people who hold it.
fn a_tablet_s_stroke_ends_with_the_screen_and_none_begins_unseen() {
    let mut pen = circling_pen();
    let config = tempfile::tempdir().expect("a folder");
    let file = config.path().join("settings.toml");
    let settings = format!("[devices]\nhid = false\nserial = [\"{}\"]\n", pen.port());
    std::fs::write(&file, settings).expect("written");
    let Some(mut s) = Stage::open(&["--config", &file.display().to_string()]) else { return };
    let clean = hash(&s);
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = stop.clone();
    let moving = std::thread::spawn(move || {
        let begun = Instant::now();
        while !stopped.load(Relaxed) {
            pen.advance(begun.elapsed().as_micros() as u64);
            pause(5);
        }
    });
    s.until("the pen sculpts", |s| s.figure("dabs") > 20);
    // A pen that is kept from reporting for long has left, as far as a serial port can tell: on a
    // busy machine a stroke may have ended so before, and another begun, or none.
    lose(&mut s);
    s.until("a stroke is closed", |s| s.figure("undo_steps") >= 1);
    // The pen goes on, and nothing of it reaches the clay. A stroke that began now would go on too.
    s.until("a pen that nobody sees moves nothing", |s| {
        let (before, samples) = ((hash(s), s.figure("dabs")), s.figure("samples"));
        s.until("the pen moves on", |s| s.figure("samples") > samples + 100);
        (hash(s), s.figure("dabs")) == before
    });
    let (ended, steps) = (hash(&s), s.figure("undo_steps"));
    stop.store(true, Relaxed);
    moving.join().expect("the pen rests");
    s.new_screen();
    s.window(&["window"]);
    assert!(alive(&mut s));
    assert_eq!(hash(&s), ended);
    s.seen("lost-3-tablet");
    for _ in 0..steps {
        s.ask("undo", &Value::Null);
    }
    s.until("the stroke can be taken back", |s| hash(s) == clean);
}

#[test]
fn windows_lost_again_and_again_lose_nothing() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let mut hashes = vec![hash(&s)];
    for i in 0..if long() { 20 } else { 3 } {
        let before = hashes.last().expect("one").clone();
        half_a_stroke(&mut s, -80 + (i % 9) * 20, &before);
        lose(&mut s);
        let versions = |s: &Stage| s.ask("history", &json!({}))["places"].as_array().map(Vec::len);
        s.until("the stroke is kept", |s| versions(s) == Some(i as usize + 2));
        hashes.push(hash(&s));
        s.new_screen();
        // As a person does who starts the program again, and by name.
        s.window(if i % 2 == 0 { &["run"] } else { &["window"] });
        assert!(alive(&mut s));
        assert_eq!(hash(&s), hashes[hashes.len() - 1], "after losing {i}");
    }
    for before in hashes.iter().rev().skip(1) {
        s.ask("undo", &Value::Null);
        s.until("each stroke is one step", |s| hash(s) == *before);
    }
}

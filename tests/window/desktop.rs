//! A desktop that moves its pointer by the same pen that the daemon reads: a real X server beside a
//! simulated serial pen on a pseudo-terminal. One pen is one stroke, wherever the desktop puts it.

use std::time::Instant;

use glam::{DVec2, Vec2};
use sculptd_devices::serial::Protocol;
use sculptd_devices::sim::{PenScript, Shape, Stroke};
use sculptd_devices::sim::{SerialPen, SerialPenConfig};

use super::stage::{Stage, long, pause};
use super::x_server::{Driven, SCREEN, desktop};

const AREA_MM: Vec2 = Vec2::new(200.0, 125.0);

/// The desktop's own map from shares of the tablet to shares of the screen: the tablet covers the
/// middle of the screen only, as a person may set it.
fn to_screen(share: DVec2) -> DVec2 {
    DVec2::new(0.05, 0.1) + share * DVec2::new(0.9, 0.85)
}

/// A stroke from one pixel of the screen to another.
fn stroke(from_us: u64, [from, to]: [(f64, f64); 2]) -> Stroke {
    let mm = |(x, y): (f64, f64)| {
        let screen = DVec2::new(x / f64::from(SCREEN.0), y / f64::from(SCREEN.1));
        let share = (screen - DVec2::new(0.05, 0.1)) / DVec2::new(0.9, 0.85);
        share.as_vec2() * AREA_MM
    };
    Stroke {
        from_us,
        to_us: from_us + 260_000,
        shape: Shape::Line(mm(from), mm(to)),
        pressure: 0.7,
        tilt: Vec2::ZERO,
        eraser: false,
        buttons: 0,
    }
}

#[test]
#[allow(clippy::disallowed_methods)] // The pen moves in the time of the people who hold it.
fn a_pen_that_the_desktop_follows_makes_each_stroke_once() {
    // It measures what two programs make of the same moment: a loaded machine is no place for it.
    if !long() {
        println!("skipped: SCULPTD_LONG=1 runs it");
        return;
    }
    let count = 200;
    // The first strokes are on the panel on the right: on its way there and from there to the clay
    // the pen hovers for a second, and its place is learned.
    let panel = |i: u64| stroke(300_000 + i * 600_000, [(1150.0, 600.0), (1180.0, 640.0)]);
    let clay = |i: u64| {
        let (x, y) = (600.0 + (i % 7) as f64 * 12.0, 320.0 + (i % 5) as f64 * 16.0);
        stroke(300_000 + i * 600_000, [(x, y), (x + 30.0, y + 8.0)])
    };
    let on_panel = |i: &u64| *i < 2 || i.is_multiple_of(6);
    let strokes = (0..count).map(|i| if on_panel(&i) { panel(i) } else { clay(i) }).collect();
    let expected = (0..count).filter(|i| !on_panel(i)).count() as u64;
    let config = SerialPenConfig::new(Protocol::Isdv4, AREA_MM);
    let script = PenScript::new(strokes);
    let mut pen = SerialPen::new(script.clone(), config).expect("a pseudo-terminal");

    let settings = format!("[devices]\nhid = false\nserial = [\"{}\"]\n", pen.port());
    let Some(mut s) = Stage::on(desktop, &settings) else { return };
    let mut tablet = Driven::connect(&s.dir.path().join("tablet.sock"));
    let mut mouse = Driven::connect(&s.dir.path().join("mouse.sock"));
    s.until("the daemon reads the pen", |_| pen.streaming());
    s.seen("desktop-start");

    let (mut near, mut tip) = (false, false);
    let end_us = 300_000 + count * 600_000 + 500_000;
    // The pen's own time goes on by a report's at most: a test that is late draws slowly, and
    // leaves no part of a stroke out.
    let (mut t_us, mut last) = (0, Instant::now());
    while t_us <= end_us {
        t_us += (last.elapsed().as_micros() as u64).min(10_000);
        last = Instant::now();
        let pose = script.at(t_us);
        pen.advance(t_us);
        if pose.in_range != near {
            tablet.near(pose.in_range);
            near = pose.in_range;
        }
        if pose.in_range {
            tablet.place(to_screen((pose.pos_mm / AREA_MM).as_dvec2()));
        }
        if pose.tip != tip {
            tablet.button(pose.tip);
            tip = pose.tip;
        }
        pause(7);
    }
    let steps = |s: &Stage| s.figure("undo_steps");
    s.soon(|s| steps(s) >= expected);
    pause(500);
    let came = steps(&s);
    println!("{came} of {expected} strokes came");
    s.look("desktop-strokes");

    // The pen is away, and the mouse is a separate pen. The desktop decides how far a mouse moves
    // the pointer (it may accelerate), so the test steers by the pointer's position.
    let place = |s: &Stage| {
        let said = s.tool("xdotool", &["getmouselocation", "--shell"]).expect("the pointer");
        let value = |name: &str| {
            let line = said.lines().find_map(|l| l.strip_prefix(name)).expect("a coordinate");
            line.parse::<f64>().expect("a number")
        };
        DVec2::new(value("X="), value("Y="))
    };
    let goal = DVec2::new(600.0, 330.0);
    s.until("the mouse is over the clay", |s| {
        let by = goal - place(s);
        if by.length() > 8.0 {
            mouse.motion(false, by.clamp_length_max(20.0) * 0.5);
            pause(16);
        }
        by.length() <= 8.0
    });
    pause(200);
    mouse.button(true);
    for _ in 0..10 {
        mouse.motion(false, DVec2::new(3.0, 1.0));
        pause(16);
    }
    mouse.button(false);
    s.until("the mouse has sculpted", |s| steps(s) == came + 1);
    assert_eq!(came, expected, "strokes: none twice, none on a panel");
}

//! A sculptor with a tablet: strokes with pressure, brushes, the mirror, a mask.

use std::time::Instant;

use glam::Vec2;
use sculptd_devices::serial::Protocol;
use sculptd_devices::sim::{PenScript, SerialPen, SerialPenConfig, Shape, Stroke};
use serde_json::json;

use super::{Course, brush, key, press, steps};
use crate::stage::{Stage, pause};

/// The tablet, mm.
const AREA: Vec2 = Vec2::new(200.0, 125.0);

/// Where a stroke begins and ends, and its pressure.
type DrawnLine = ((f32, f32), (f32, f32), f32);

/// Every stroke of the course in turn: two places of the tablet, shares of it, and the pressure.
const STROKES: [DrawnLine; 7] = [
    ((0.40, 0.38), (0.60, 0.38), 0.15),
    ((0.40, 0.48), (0.60, 0.48), 0.5),
    ((0.40, 0.58), (0.60, 0.58), 1.0),
    ((0.40, 0.48), (0.60, 0.48), 0.6),
    ((0.42, 0.30), (0.58, 0.30), 0.7),
    ((0.42, 0.66), (0.58, 0.62), 0.8),
    ((0.36, 0.42), (0.38, 0.36), 0.9),
];
/// The pen's own time for each stroke, microseconds.
const TURN_US: u64 = 1_200_000;

/// The pen on its wire. Its time goes on while it draws, by a report's at most.
struct Tablet {
    pen: SerialPen,
    drawn: u64,
    t_us: u64,
}

impl Tablet {
    fn new() -> Tablet {
        let mm = |(x, y): (f32, f32)| Vec2::new(x, y) * AREA;
        let stroke = |(i, (from, to, pressure)): (usize, DrawnLine)| Stroke {
            from_us: i as u64 * TURN_US + 300_000,
            to_us: i as u64 * TURN_US + 800_000,
            shape: Shape::Line(mm(from), mm(to)),
            pressure,
            tilt: Vec2::ZERO,
            eraser: false,
            buttons: 0,
        };
        let script = PenScript::new(STROKES.into_iter().enumerate().map(stroke).collect());
        let config = SerialPenConfig::new(Protocol::Isdv4, AREA);
        let pen = SerialPen::new(script, config).expect("a pseudo-terminal");
        Tablet { pen, drawn: 0, t_us: 0 }
    }

    /// Draws the next stroke.
    #[allow(clippy::disallowed_methods)] // The pen moves in the time of the people who hold it.
    fn draw(&mut self) {
        self.drawn += 1;
        let mut last = Instant::now();
        while self.t_us < self.drawn * TURN_US {
            self.t_us += (last.elapsed().as_micros() as u64).min(8_000);
            last = Instant::now();
            self.pen.advance(self.t_us);
            pause(4);
        }
    }
}

/// Of the clay, read back from what it is exported as.
fn volume(s: &Stage) -> f64 {
    let path = s.dir.path().join("measured.ply");
    s.ask("export", &json!({ "path": path }));
    let read = sculptd_geometry::io::read_mesh(&path, &Default::default()).expect("a mesh");
    sculptd_geometry::measure::measures(&read.mesh.triangulate().0).volume
}

#[test]
fn a_tablet_sculptor_s_hour() {
    let mut tablet = Tablet::new();
    let dir = tempfile::tempdir().expect("a folder");
    let settings = dir.path().join("settings.toml");
    let text = format!("[devices]\nhid = false\nserial = [\"{}\"]\n", tablet.pen.port());
    #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
    std::fs::write(&settings, text).expect("written");
    let args = ["--config", settings.to_str().expect("UTF-8")];
    let Some(mut c) = Course::begin("sculptor", &args) else { return };
    c.step("the window opens on a ball", |_| {}, |s| s.figure("vertices") > 1_000);
    c.step("the pen is read", |_| {}, |_| tablet.pen.streaming());

    // Light and hard strokes: pressure is felt.
    let mut moved = Vec::new();
    for (_, _, pressure) in &STROKES[..3] {
        let before = steps(&c.s);
        let what = format!("a stroke with the pen at {pressure} of its pressure");
        let was = volume(&c.s);
        c.step(&what, |_| tablet.draw(), |s| steps(s) == before + 1);
        let now = volume(&c.s);
        moved.push(now - was);
    }
    assert!(moved[0] > 0.0 && moved[0] < moved[1] && moved[1] < moved[2], "{moved:?}");
    c.is_as_kept();

    // Shift smooths what the pen draws, and is lent for the stroke alone.
    let before = steps(&c.s);
    c.s.drive(&["keydown", "shift"]);
    let smooth = |_: &mut Stage| tablet.draw();
    c.step("Shift smooths the middle one", smooth, |s| steps(s) == before + 1);
    c.s.drive(&["keyup", "shift"]);
    c.step("the brush is draw again", |_| {}, |s| brush(s)["kind"] == "draw");

    // Brushes by button, key and name.
    c.step(
        "clay strips by its button",
        |s| press(s, (181, 80)),
        |s| brush(s)["kind"] == "clay-strips",
    );
    let before = steps(&c.s);
    let strip = |_: &mut Stage| tablet.draw();
    c.step("a strip", strip, |s| steps(s) == before + 1);
    let radius = |s: &Stage| brush(s)["radius"].as_f64().unwrap_or(0.0);
    let was = radius(&c.s);
    c.step("] makes it larger", |s| key(s, "bracketright"), |s| radius(s) > was);
    c.step("[ makes it smaller", |s| key(s, "bracketleft"), |s| (radius(s) - was).abs() < 1e-6);
    c.step(
        "crease by its name",
        |s| s.answer("ctrl+k", "crease"),
        |s| brush(s)["kind"] == "crease",
    );
    let before = steps(&c.s);
    let valley = |_: &mut Stage| tablet.draw();
    c.step("a valley", valley, |s| steps(s) == before + 1);
    c.step("draw again", |s| press(s, (41, 80)), |s| brush(s)["kind"] == "draw");

    // The mirror: what is drawn at one side comes at both.
    c.step(
        "the mirror over x",
        |s| press(s, (65, 405)),
        |s| brush(s)["symmetry"] == json!([true, false, false]),
    );
    let before = steps(&c.s);
    let ear = |_: &mut Stage| tablet.draw();
    c.step("an ear, and its mirror image", ear, |s| steps(s) == before + 1);
    c.is_as_kept();
    c.step(
        "the mirror is taken away",
        |s| press(s, (65, 405)),
        |s| brush(s)["symmetry"] == json!([false, false, false]),
    );

    // A mask by a lasso keeps the pen off.
    let before = steps(&c.s);
    c.step("L draws a lasso", |s| key(s, "l"), |_| true);
    let around = |s: &mut Stage| {
        let go = |x: i32, y: i32| s.drive(&["mousemove", &x.to_string(), &y.to_string()]);
        go(560, 280);
        s.drive(&["mousedown", "1"]);
        for (x, y) in [(720, 280), (730, 360), (700, 440), (580, 440), (550, 360), (560, 285)] {
            go(x, y);
        }
        s.drive(&["mouseup", "1"]);
    };
    c.step("around the middle", around, |s| steps(s) == before + 1);
    c.step("Escape goes back to sculpting", |s| key(s, "Escape"), |_| true);
    println!("{} steps", c.steps);
}

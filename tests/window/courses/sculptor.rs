//! A sculptor with a tablet: strokes with pressure, brushes, the mirror, a mask.

use std::time::Instant;

use glam::Vec2;
use sculptd_devices::serial::Protocol;
use sculptd_devices::sim::{PenScript, SerialPen, SerialPenConfig, Shape, Stroke};
use serde_json::json;

use super::{Course, brush, hash, key, press, steps};
use crate::places::{
    ADD_LAYER, CLAY_STRIPS, DIFFERENCE, DRAW, EYE_OF_LAYER, MIRROR_X, NAME_OF_FIRST, NAME_OF_SECOND,
};
use crate::sessions::kept;
use crate::stage::{Stage, differs, pause};

/// The tablet, mm.
const AREA: Vec2 = Vec2::new(200.0, 125.0);

/// Begin and end of a stroke, and its pressure.
type DrawnLine = ((f32, f32), (f32, f32), f32);

/// Every stroke of the course in turn: two places of the tablet, shares of it, and the pressure.
const STROKES: [DrawnLine; 11] = [
    ((0.40, 0.38), (0.60, 0.38), 0.15),
    ((0.40, 0.48), (0.60, 0.48), 0.5),
    ((0.40, 0.58), (0.60, 0.58), 1.0),
    ((0.40, 0.48), (0.60, 0.48), 0.6),
    ((0.42, 0.30), (0.58, 0.30), 0.7),
    ((0.42, 0.66), (0.58, 0.62), 0.8),
    ((0.36, 0.42), (0.38, 0.36), 0.9),
    ((0.46, 0.50), (0.54, 0.50), 0.9),
    ((0.44, 0.44), (0.56, 0.46), 0.7),
    ((0.42, 0.54), (0.58, 0.54), 0.6),
    ((0.42, 0.40), (0.58, 0.60), 0.8),
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
        |s| press(s, CLAY_STRIPS),
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
    c.step("draw again", |s| press(s, DRAW), |s| brush(s)["kind"] == "draw");

    // The mirror: what is drawn at one side comes at both.
    c.step(
        "the mirror over x",
        |s| press(s, MIRROR_X),
        |s| brush(s)["symmetry"] == json!([true, false, false]),
    );
    let before = steps(&c.s);
    let ear = |_: &mut Stage| tablet.draw();
    c.step("an ear, and its mirror image", ear, |s| steps(s) == before + 1);
    c.is_as_kept();
    c.step(
        "the mirror is taken away",
        |s| press(s, MIRROR_X),
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
    let (was, dabs) = (volume(&c.s), c.s.figure("dabs"));
    c.step("a stroke within the mask", |_| tablet.draw(), |s| s.figure("dabs") > dabs);
    let by = (volume(&c.s) - was).abs();
    assert!(by < 0.1 * moved[1], "{by} moved within the mask, {} without one", moved[1]);
    finer_and_remeshed(&mut c, &mut tablet);
    composed(&mut c);
    looked_at_and_kept(&mut c, &mut tablet, args);
    println!("{} steps", c.steps);
}

/// Levels, a remesh, undo over all of it.
fn finer_and_remeshed(c: &mut Course, tablet: &mut Tablet) {
    let vertices = |s: &Stage| s.figure("vertices");
    let masked = steps(&c.s);
    c.step(
        "Ctrl+Z takes back up to before the mask",
        |s| {
            key(s, "ctrl+z");
            if steps(s) == masked {
                key(s, "ctrl+z");
            }
        },
        |s| steps(s) < masked,
    );
    while steps(&c.s) + 1 > masked.saturating_sub(1) {
        let now = steps(&c.s);
        c.step("and once more", |s| key(s, "ctrl+z"), |s| steps(s) < now);
    }
    let coarse = vertices(&c.s);
    c.step("a finer level", |s| key(s, "ctrl+Prior"), |s| vertices(s) > 3 * coarse);
    let before = hash(&c.s);
    c.step("a stroke on it", |_| tablet.draw(), |s| hash(s) != before);
    let fine = hash(&c.s);
    c.step("the coarser level", |s| key(s, "ctrl+Next"), |s| vertices(s) == coarse);
    c.step("the finer one has the stroke still", |s| key(s, "ctrl+Prior"), |s| hash(s) == fine);
    let many = vertices(&c.s);
    c.step("a remesh", |s| key(s, "ctrl+r"), |s| vertices(s) != many);
    let even = hash(&c.s);
    let before = even.clone();
    c.step("a stroke on even triangles", |_| tablet.draw(), |s| hash(s) != before);
    c.step("Ctrl+Z takes the stroke back", |s| key(s, "ctrl+z"), |s| hash(s) == even);
    c.step("and the remesh", |s| key(s, "ctrl+z"), |s| hash(s) == fine);
}

/// A second object, a layer, a Boolean, and what leaves as a file. Places are those of the page
/// with the first object active.
fn composed(c: &mut Course) {
    let objects = |s: &Stage| {
        let list = s.ask("scene.list", &json!({}));
        (list["objects"].as_array().map_or(0, Vec::len), list["active"].as_u64())
    };
    c.step("the page of the scene", |s| s.answer("ctrl+k", "page: scene"), |_| true);
    let beside = json!({ "primitive": { "box": [40.0, 40.0, 40.0] },
        "transform": { "shift": [50.0, 0.0, 0.0] } });
    c.step("a box in its flank", |s| drop(s.ask("scene.add", &beside)), |s| objects(s).0 == 2);
    c.step("the ball is the active one", |s| press(s, NAME_OF_FIRST), |s| objects(s).1 == Some(0));
    let layers = |s: &Stage| s.ask("layers.list", &json!({}))["layers"].clone();
    let shown = move |s: &Stage| layers(s)[0]["visible"].as_bool();
    c.step("a layer", |s| press(s, ADD_LAYER), |s| shown(s) == Some(true));
    let (bare, dabs) = (hash(&c.s), c.s.figure("dabs"));
    c.step(
        "a stroke of the mouse goes to it",
        |s| s.drag((-120, 60), (-60, 80)),
        |s| s.figure("dabs") > dabs && hash(s) != bare,
    );
    // Its last dabs come with its end.
    pause(1000);
    let with = hash(&c.s);
    c.step(
        "its eye hides the layer",
        |s| press(s, EYE_OF_LAYER),
        |s| shown(s) == Some(false) && hash(s) != with,
    );
    c.step("and shows it, to the bit", |s| press(s, EYE_OF_LAYER), |s| hash(s) == with);
    let whole = volume(&c.s);
    c.step(
        "the box is cut out of the ball",
        |s| {
            let (x, y) = NAME_OF_SECOND;
            s.drive(&["mousemove", &x.to_string(), &y.to_string(), "click", "3"]);
            pause(1500);
            press(s, (x + DIFFERENCE.0, y + DIFFERENCE.1));
        },
        |s| objects(s).0 == 1,
    );
    let left = volume(&c.s);
    assert!(left < whole * 0.95, "{left} of {whole}");
    let file = c.s.dir.path().join("bust.stl");
    c.step("it leaves as a file", |s| s.answer("ctrl+e", "bust.stl"), move |_| file.exists());
    c.step("Ctrl+Z: two objects again", |s| key(s, "ctrl+z"), |s| objects(s).0 == 2);
    c.step("and the cut again", |s| key(s, "ctrl+shift+z"), |s| objects(s).0 == 1);
    c.step("back to the look", |s| s.answer("ctrl+k", "page: look"), |_| true);
}

/// Views, light, paint, a picture; closing and opening again.
fn looked_at_and_kept(c: &mut Course, tablet: &mut Tablet, args: [&str; 2]) {
    for (what, keys) in [
        ("from the right", "8"),
        ("from above", "9"),
        ("from behind", "shift+7"),
        ("and from the front", "7"),
    ] {
        let camera = |s: &Stage| s.ask("camera", &json!({}));
        let was = camera(&c.s);
        c.step(what, |s| key(s, keys), |s| camera(s) != was);
        // The way there is animated.
        pause(600);
    }
    let bare = c.s.look("course-sculptor-bare");
    let mut shaded = bare.clone();
    c.step(
        "shadows",
        |s| s.answer("ctrl+k", "shadows"),
        |s| {
            shaded = s.look("course-sculptor-shadows");
            differs(&bare, &shaded) > 0.02
        },
    );
    c.step(
        "the brush that paints",
        |s| s.answer("ctrl+k", "paint brush"),
        |s| brush(s)["kind"] == "paint",
    );
    let (was, before) = (volume(&c.s), hash(&c.s));
    c.step("a painted stroke", |_| tablet.draw(), |s| hash(s) != before);
    let by = (volume(&c.s) - was).abs();
    assert!(by < 1e-9, "paint moves nothing, and {by} was moved");
    let pictures = c.s.dir.path().join("pictures");
    std::fs::create_dir_all(&pictures).expect("a folder");
    let folders = c.s.dir.path().join("user-dirs.dirs");
    let text = format!("XDG_PICTURES_DIR=\"{}\"\n", pictures.display());
    #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
    std::fs::write(folders, text).expect("written");
    let taken = || std::fs::read_dir(&pictures).map_or(0, |all| all.count());
    c.step("F12 takes a picture", |s| key(s, "F12"), |_| taken() == 1);
    let work = hash(&c.s);
    let session = kept(&c.s).pop().expect("a session is always on").display().to_string();
    c.step(
        "the window is closed and the work opened again",
        |s| s.restart(&[&args[..], &["--session", &session]].concat()),
        |s| hash(s) == work,
    );
    // The window is there before its first frame is, and nobody presses a key on a black one.
    c.s.last = None;
    c.s.seen("course-sculptor-again");
    c.step(
        "one more step back, from before it was closed",
        |s| key(s, "ctrl+z"),
        |s| hash(s) != work,
    );
}

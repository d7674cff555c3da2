//! The real window on a screen of its own (Xvfb, software Vulkan), driven by a synthetic pointer
//! and keys: what a sculptor does in the first minutes, each step seen on the screen and heard from
//! the daemon.
//!
//! `SCULPTD_SHOTS=folder` keeps the pictures; `SCULPTD_BLESS=1` writes the kept references anew:
//! look at them first.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use image::RgbaImage;
use image::imageops::FilterType;
use sculptd_daemon::control::client::call;
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::shapes;
use serde_json::{Value, json};

const SIZE: (u32, u32) = (1280, 720);
/// The middle of the clay: between two panels.
const MIDDLE: (i32, i32) = (640, 360);
const PATIENCE: Duration = Duration::from_secs(30);
/// References are kept this small: form and colour, not the pixels of one driver.
const KEPT: (u32, u32) = (160, 90);
/// Mean difference of a kept picture, of 255.
const TOLERANCE: f64 = 10.0;
/// Pictures that differ by less than this, of 255 in the mean, show the same: a light stroke of
/// smoothing is twice as much.
const STILL: f64 = 0.02;

struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub(super) struct Stage {
    dir: tempfile::TempDir,
    display: String,
    // In this order: the daemon goes before its screen.
    _daemon: Option<Ended>,
    _screen: Ended,
    last: Option<RgbaImage>,
}

fn present(tool: &str) -> bool {
    Command::new(tool).arg("-help").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

#[allow(clippy::disallowed_methods)] // A test waits for other processes.
fn pause(ms: u64) {
    std::thread::sleep(Duration::from_millis(ms));
}

impl Stage {
    /// A screen and the daemon's window on it; `None`, and why, where one of the tools is missing.
    pub(super) fn open(args: &[&str]) -> Option<Stage> {
        for tool in ["Xvfb", "xdotool", "import"] {
            if !present(tool) {
                println!("skipped: {tool} is not installed");
                return None;
            }
        }
        let dir = tempfile::tempdir().expect("a folder");
        // Xvfb chooses a free number and writes it.
        let told = dir.path().join("display");
        let file = std::fs::File::create(&told).expect("a file");
        let screen = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                &format!("{}x{}x24", SIZE.0, SIZE.1),
                "-nolisten",
                "tcp",
            ])
            .stdout(file)
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let screen = Ended(screen);
        let mut display = String::new();
        for _ in 0..200 {
            display = std::fs::read_to_string(&told).unwrap_or_default();
            if display.ends_with('\n') {
                break;
            }
            pause(50);
        }
        let display = format!(":{}", display.trim());
        let daemon = Command::new(env!("CARGO_BIN_EXE_sculptd"))
            .arg("run")
            .args(args)
            .env("DISPLAY", &display)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", dir.path())
            .env("XDG_CONFIG_HOME", dir.path())
            .env("HOME", dir.path())
            .stdout(Stdio::null())
            .stderr(std::fs::File::create(dir.path().join("log")).expect("a file"))
            .spawn()
            .expect("the daemon starts");
        let mut stage =
            Stage { dir, display, _daemon: Some(Ended(daemon)), _screen: screen, last: None };
        stage.until("the daemon answers", |s| s.asked("status", &Value::Null).is_some());
        let log = stage.dir.path().join("log");
        let none =
            || std::fs::read_to_string(&log).unwrap_or_default().contains("without a window");
        for _ in 0..600 {
            if none() {
                println!("skipped: {}", std::fs::read_to_string(&log).unwrap_or_default().trim());
                return None;
            }
            if stage
                .tool("xdotool", &["search", "--onlyvisible", "--name", "^sculptd$"])
                .is_some_and(|id| !id.trim().is_empty())
            {
                break;
            }
            pause(50);
        }
        let id = stage
            .tool("xdotool", &["search", "--onlyvisible", "--name", "^sculptd$"])
            .unwrap_or_default();
        let id = id.lines().next().expect("a window").to_owned();
        stage.drive(&["windowfocus", &id]);
        Some(stage)
    }

    fn tool(&self, name: &str, args: &[&str]) -> Option<String> {
        let out = Command::new(name).args(args).env("DISPLAY", &self.display).output().ok()?;
        out.status.success().then(|| String::from_utf8_lossy(&out.stdout).into_owned())
    }

    pub(super) fn drive(&self, args: &[&str]) {
        let _ = self.tool("xdotool", args);
        pause(60);
    }

    fn asked(&self, method: &str, params: &Value) -> Option<Value> {
        call(&self.dir.path().join("sculptd.sock"), method, params, PATIENCE).ok()
    }

    pub(super) fn ask(&self, method: &str, params: &Value) -> Value {
        call(&self.dir.path().join("sculptd.sock"), method, params, PATIENCE)
            .unwrap_or_else(|e| panic!("{method}: {e:?}"))
    }

    pub(super) fn figure(&self, name: &str) -> u64 {
        self.ask("status", &Value::Null)[name].as_u64().unwrap_or(0)
    }

    pub(super) fn until(&mut self, what: &str, mut so: impl FnMut(&mut Stage) -> bool) {
        for _ in 0..600 {
            if so(self) {
                return;
            }
            pause(50);
        }
        panic!("never: {what}");
    }

    /// A drag over the clay, in pixels from its middle.
    pub(super) fn drag(&self, from: (i32, i32), to: (i32, i32)) {
        let at = |p: (i32, i32)| [(MIDDLE.0 + p.0).to_string(), (MIDDLE.1 + p.1).to_string()];
        let go = |p: (i32, i32)| {
            let [x, y] = at(p);
            self.drive(&["mousemove", &x, &y]);
        };
        go(from);
        self.drive(&["mousedown", "1"]);
        for i in 1..=8 {
            go((from.0 + (to.0 - from.0) * i / 8, from.1 + (to.1 - from.1) * i / 8));
        }
        self.drive(&["mouseup", "1"]);
    }

    /// The screen as it is, kept where asked for.
    pub(super) fn look(&self, name: &str) -> RgbaImage {
        let path = self.dir.path().join(format!("{name}.png"));
        let text = path.display().to_string();
        self.tool("import", &["-window", "root", &text]).expect("a picture");
        if let Some(folder) = std::env::var_os("SCULPTD_SHOTS") {
            let _ = std::fs::copy(&path, PathBuf::from(folder).join(format!("{name}.png")));
        }
        image::open(&path).expect("a PNG").to_rgba8()
    }

    /// The next picture, once it is another than the last one: what was asked for is on the screen,
    /// and stands still.
    pub(super) fn seen(&mut self, name: &str) -> RgbaImage {
        for _ in 0..100 {
            let now = self.look(name);
            // Nothing is drawn yet while all is black.
            let drawn = now.pixels().any(|p| p.0[0] > 0);
            let moved = drawn && self.last.as_ref().is_none_or(|last| differs(last, &now) > STILL);
            pause(250);
            if moved && differs(&now, &self.look(name)) < STILL {
                self.last = Some(now.clone());
                return now;
            }
        }
        panic!("{name}: nothing new on the screen");
    }
}

/// Mean difference of two pictures over the clay, of 255.
fn differs(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let sum: u64 = a.iter().zip(b.iter()).map(|(x, y)| u64::from(x.abs_diff(*y))).sum();
    sum as f64 / a.len() as f64
}

/// Against the small picture that is kept.
fn as_kept(name: &str, now: &RgbaImage) {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/window/{name}.png"));
    let small = image::imageops::resize(now, KEPT.0, KEPT.1, FilterType::Triangle);
    if std::env::var_os("SCULPTD_BLESS").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        small.save(&path).expect("written");
        return;
    }
    let kept = image::open(&path).expect("the reference").to_rgba8();
    let off = differs(&kept, &small);
    println!("{name}: {off:.2} of 255 from its reference");
    assert!(off < TOLERANCE, "{name}: {off:.2} of 255 from its reference");
}

#[test]
fn the_first_minutes_in_a_real_window() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let ball = s.dir.path().join("ball.obj");
    write_mesh(&ball, &shapes::sphere_of_about(20_000).to_poly()).expect("written");
    let begun = s.figure("vertices");
    s.seen("1-start");
    s.ask("load", &json!({ "path": ball }));
    s.until("the ball is there", |s| s.figure("vertices") != begun);
    s.drive(&["key", "Home"]);
    s.drive(&["key", "m"]);
    as_kept("loaded", &s.seen("2-load"));

    s.drag((-90, -40), (90, -60));
    s.until("the stroke is done", |s| s.figure("undo_steps") == 1);
    as_kept("sculpted", &s.seen("3-sculpt"));
    let rough = s.ask("hash", &Value::Null)["hash"].clone();

    s.drive(&["keydown", "shift"]);
    s.drag((-90, -40), (90, -60));
    s.drive(&["keyup", "shift"]);
    s.until("it is smoothed", |s| s.figure("undo_steps") == 2);
    s.seen("4-smooth");
    assert_ne!(s.ask("hash", &Value::Null)["hash"], rough);
    let kind = |s: &Stage| s.ask("brush", &json!({}))["kind"].clone();
    assert_eq!(kind(&s), "gaussian", "Shift lends the brush for one stroke");

    s.ask("brush", &json!({ "kind": "mask" }));
    s.drive(&["key", "shift+m"]);
    s.drag((-60, 60), (60, 80));
    s.until("it is masked", |s| s.figure("undo_steps") == 3);
    as_kept("masked", &s.seen("5-mask"));
    s.drive(&["key", "shift+m"]);

    s.drive(&["key", "ctrl+z"]);
    s.drive(&["key", "ctrl+z"]);
    s.until("two steps are taken back", |s| s.figure("undo_steps") == 1);
    assert_eq!(s.ask("hash", &Value::Null)["hash"], rough);
    s.seen("6-undo");

    let tool = s.dir.path().join("tool.obj");
    write_mesh(&tool, &shapes::sphere_of_about(2_000).to_poly()).expect("written");
    s.ask("take-up", &json!({ "path": tool }));
    s.seen("7-thing");
    let before = s.figure("triangles");
    s.ask("join", &json!({ "operation": "add" }));
    s.until("they are one", |s| s.figure("triangles") != before);
    s.seen("8-boolean");

    s.drive(&["key", "t"]);
    as_kept("thickness", &s.seen("9-thickness"));
    let walls = s.ask("thickness", &json!({}));
    assert!(walls["valid"].as_u64().unwrap_or(0) > 10_000, "{walls}");

    let out = s.dir.path().join("work.stl");
    s.ask("export", &json!({ "path": out }));
    let read = sculptd_geometry::io::read_mesh(&out, &Default::default())
        .expect("the export is read back");
    assert_eq!(read.mesh.triangulate().0.triangles.len() as u64, s.figure("triangles"));
}

#[test]
fn a_curve_is_laid_changed_and_drawn_with_the_pointer() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let ball = s.dir.path().join("ball.obj");
    write_mesh(&ball, &shapes::sphere_of_about(20_000).to_poly()).expect("written");
    let begun = s.figure("vertices");
    s.seen("c1-start");
    s.ask("load", &json!({ "path": ball }));
    s.until("the ball is there", |s| s.figure("vertices") != begun);
    s.drive(&["key", "Home"]);
    s.ask("brush", &json!({ "radius": 0.1, "path": { "method": "curve" } }));
    let smooth = s.ask("hash", &Value::Null)["hash"].clone();
    s.seen("c2-loaded");
    let points = |n: u64| move |s: &mut Stage| s.figure("curve_points") == n;
    // Drawn freely: five handles.
    s.drag((-120, 0), (120, 20));
    s.until("it is laid", points(5));
    s.seen("c3-laid");
    // The middle one dragged up, one more beside the end, the first taken away by the right button.
    s.drag((0, 10), (0, -80));
    s.seen("c4-dragged");
    s.drag((140, 60), (140, 80));
    s.until("there is one more", points(6));
    let [x, y] = [(MIDDLE.0 - 120).to_string(), MIDDLE.1.to_string()];
    s.drive(&["mousemove", &x, &y, "click", "3"]);
    s.until("there is one less", points(5));
    s.seen("c5-changed");
    assert_eq!(
        (s.figure("undo_steps"), s.ask("hash", &Value::Null)["hash"].clone()),
        (0, smooth.clone())
    );
    s.drive(&["key", "Return"]);
    s.until("it is drawn", |s| s.figure("undo_steps") == 1);
    s.until("nothing is laid", points(0));
    s.seen("c6-drawn");
    assert_ne!(s.ask("hash", &Value::Null)["hash"], smooth);
    s.drive(&["key", "ctrl+z"]);
    s.until("it is one step", |s| s.figure("undo_steps") == 0);
    assert_eq!(s.ask("hash", &Value::Null)["hash"], smooth);
    // Another, and put away.
    s.drag((-100, -50), (100, -60));
    s.until("it is laid", points(5));
    s.drive(&["key", "Escape"]);
    s.until("it is put away", points(0));
    assert_eq!(s.figure("undo_steps"), 0);
}

/// Types an action's name into the search and takes the first that is found.
fn act(s: &Stage, name: &str) {
    s.drive(&["key", "ctrl+k"]);
    pause(300);
    s.drive(&["type", "--delay", "40", name]);
    pause(300);
    s.drive(&["key", "Return"]);
    pause(500);
}

#[test]
fn what_would_come_is_seen_before_it_is_made() {
    let Some(mut s) = Stage::open(&[]) else { return };
    let (ball, tool) = (s.dir.path().join("ball.obj"), s.dir.path().join("tool.obj"));
    write_mesh(&ball, &shapes::sphere_of_about(20_000).to_poly()).expect("written");
    write_mesh(&tool, &shapes::sphere_of_about(2_000).to_poly()).expect("written");
    let begun = s.figure("vertices");
    s.seen("a1-start");
    s.ask("load", &json!({ "path": ball }));
    s.until("the ball is there", |s| s.figure("vertices") != begun);
    s.drive(&["key", "Home"]);
    s.ask("take-up", &json!({ "path": tool }));
    s.seen("a2-thing");
    let (triangles, hash) = (s.figure("triangles"), s.ask("hash", &Value::Null)["hash"].clone());
    // It stands beside the work: the preview shows it as clay.
    act(&s, "try to add");
    s.seen("a3-preview");
    assert_eq!(s.ask("hash", &Value::Null)["hash"], hash, "a preview is of the window alone");
    act(&s, "try to add");
    s.seen("a4-dismissed");
    s.ask("join", &json!({ "operation": "add" }));
    s.until("it is added", |s| s.figure("triangles") != triangles);
    s.seen("a5-added");
    // Distances are to the work as it was opened: what was added lies outside.
    s.drive(&["key", "shift+d"]);
    s.seen("a6-distance");
    s.drive(&["key", "shift+d"]);
    s.seen("a7-clay");
    let added = s.figure("triangles");
    act(&s, "trim by a box");
    s.look("a8-asked");
    s.drag((-150, 60), (150, 250));
    s.look("a8-dragged");
    s.until("it is trimmed", |s| s.figure("triangles") != added);
    s.seen("a8-trimmed");
    let trimmed = s.figure("triangles");
    act(&s, "finer");
    s.until("it is finer", |s| s.figure("triangles") == trimmed * 4);
    s.seen("a9-finer");
    act(&s, "coarser");
    s.until("it is coarser", |s| s.figure("triangles") == trimmed);
}

#[test]
fn the_installation_s_screen() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("kiosk.toml");
    #[allow(clippy::disallowed_methods)]
    std::fs::write(&path, "idle_s = 3.0\ncountdown_s = 8.0\nstaff_pin = \"4711\"\n")
        .expect("written");
    let Some(mut s) = Stage::open(&["--kiosk", "--kiosk-config", path.to_str().expect("UTF-8")])
    else {
        return;
    };
    s.until("the film sculpts", |s| s.figure("dabs") > 30);
    pause(1500);
    let attract = s.look("kiosk-1-attract");
    assert_eq!(attract.dimensions(), SIZE);
    s.drag((-80, 0), (80, 10));
    s.until("the visitor's own work", |s| s.figure("undo_steps") == 1);
    s.last = Some(attract);
    s.seen("kiosk-2-working");
    pause(3600);
    s.seen("kiosk-3-countdown");
}

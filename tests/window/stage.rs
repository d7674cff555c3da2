//! A separate screen (Xvfb, software Vulkan) with the daemon's window on it, driven by a synthetic
//! pointer and keys. One stage at a time: each waits for the one before.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use glam::Vec2;
use image::RgbaImage;
use image::imageops::FilterType;
use sculptd_daemon::control::client::call;
use sculptd_window::panels::{HEADER, PANEL, STATUS};
use serde_json::Value;

pub const SIZE: (u32, u32) = (1280, 720);
/// The middle of the clay: between the panels.
pub const MIDDLE: (i32, i32) = (640, (HEADER + (SIZE.1 as f32 - HEADER - STATUS) / 2.0) as i32);
/// The first pixel of the clay, and its size.
pub const VIEW: [Vec2; 2] = [
    Vec2::new(PANEL, HEADER),
    Vec2::new(SIZE.0 as f32 - 2.0 * PANEL, SIZE.1 as f32 - HEADER - STATUS),
];
const PATIENCE: Duration = Duration::from_secs(30);
/// References are kept this small: form and colour, not the pixels of one driver.
const KEPT: (u32, u32) = (160, 90);
/// Mean difference of a kept picture, of 255.
const TOLERANCE: f64 = 10.0;
/// Pictures that differ by less than this, of 255 in the mean, show the same: a light stroke of
/// smoothing is twice as much.
const STILL: f64 = 0.02;

/// One generous bound for whatever a test waits for: the machine may be loaded.
const BOUND: Duration = Duration::from_secs(120);
/// For a thing of which some may be lost and are counted.
const SOON: Duration = Duration::from_secs(20);

/// Real windows run one at a time: they measure and they click.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Keeps other real windows away until it is dropped.
pub fn alone() -> MutexGuard<'static, ()> {
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

pub struct Ended(pub Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub struct Stage {
    pub dir: tempfile::TempDir,
    display: String,
    // In this order: the daemon goes before its screen.
    pub daemon: Ended,
    screen: Ended,
    pub last: Option<RgbaImage>,
    _alone: MutexGuard<'static, ()>,
}

fn present(tool: &str) -> bool {
    Command::new(tool).arg("-help").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Returns true if the long tests were requested.
pub fn long() -> bool {
    std::env::var_os("SCULPTD_LONG").is_some_and(|v| v == "1")
}

#[allow(clippy::disallowed_methods)] // A test waits for other processes.
pub fn pause(ms: u64) {
    std::thread::sleep(Duration::from_millis(ms));
}

/// Returns the program on a screen, with a separate data folder and control socket.
fn program(dir: &Path, display: &str) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    program
        .env("DISPLAY", display)
        // Widgets are found by their English names.
        .env("LC_ALL", "C")
        .env_remove("WAYLAND_DISPLAY")
        .env("XDG_RUNTIME_DIR", dir)
        .env("XDG_CONFIG_HOME", dir)
        .env("XDG_DATA_HOME", dir.join("data"))
        .env("HOME", dir)
        .env_remove("DBUS_SESSION_BUS_ADDRESS")
        .env("SCULPTD_LOG", "info,sculptd_window=debug");
    program
}

fn start(dir: &Path, display: &str, args: &[&str]) -> Ended {
    let daemon = program(dir, display)
        .arg("run")
        .args(args)
        .stdout(Stdio::null())
        .stderr(std::fs::File::create(dir.join("log")).expect("a file"))
        .spawn()
        .expect("the daemon starts");
    Ended(daemon)
}

/// A new screen: its process and its name.
fn screen(dir: &Path) -> (Ended, String) {
    // Xvfb chooses a free number and writes it.
    let told = dir.join("display");
    let file = std::fs::File::create(&told).expect("a file");
    let size = format!("{}x{}x24", SIZE.0, SIZE.1);
    // Without `-noreset` the server restarts when its last client leaves, which may be a tool that
    // looked for the window, and refuses the daemon that connects meanwhile.
    let screen = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", &size, "-noreset", "-nolisten", "tcp"])
        .stdout(file)
        .stderr(Stdio::null())
        .spawn()
        .expect("Xvfb starts");
    let display = wait("Xvfb has chosen a display", || {
        std::fs::read_to_string(&told).ok().filter(|d| d.ends_with('\n'))
    });
    (Ended(screen), format!(":{}", display.trim()))
}

/// Waits until a condition returns a value, and returns it.
#[allow(clippy::disallowed_methods)] // A test waits for other processes.
pub fn wait<T>(what: &str, mut so: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = so() {
            return found;
        }
        assert!(begun.elapsed() < BOUND, "never: {what}");
        pause(20);
    }
}

impl Stage {
    /// A screen and the daemon's window on it; `None`, and why, where one of the tools is missing.
    pub fn open(args: &[&str]) -> Option<Stage> {
        for tool in ["Xvfb", "xdotool", "import"] {
            if !present(tool) {
                println!("skipped: {tool} is not installed");
                return None;
            }
        }
        let alone = alone();
        let dir = tempfile::tempdir().expect("a folder");
        let (screen, display) = screen(dir.path());
        let daemon = start(dir.path(), &display, args);
        let mut stage = Stage { dir, display, daemon, screen, last: None, _alone: alone };
        stage.shown().then_some(stage)
    }

    /// The same on a screen of the caller's own, with these settings; `None`, and why, where there
    /// is no such screen.
    pub fn on(
        screen: impl FnOnce(&Path) -> Result<(Ended, String), String>,
        settings: &str,
    ) -> Option<Stage> {
        let alone = alone();
        let dir = tempfile::tempdir().expect("a folder");
        let (screen, display) = match screen(dir.path()) {
            Ok(screen) => screen,
            Err(why) => {
                println!("skipped: {why}");
                return None;
            }
        };
        let file = dir.path().join("settings.toml");
        #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
        std::fs::write(&file, settings).expect("written");
        let daemon = start(dir.path(), &display, &["--config", &file.display().to_string()]);
        let mut stage = Stage { dir, display, daemon, screen, last: None, _alone: alone };
        stage.shown().then_some(stage)
    }

    /// Waits for the window and gives it the keyboard; `false`, and why, where it cannot open.
    fn shown(&mut self) -> bool {
        self.until("the daemon answers", |s| s.asked("status", &Value::Null).is_some());
        let log = self.dir.path().join("log");
        let mut id = String::new();
        self.until("the window is there, or cannot be", |s| {
            let find = ["search", "--onlyvisible", "--name", "^sculptd$"];
            id = s.tool("xdotool", &find).unwrap_or_default();
            let text = std::fs::read_to_string(&log).unwrap_or_default();
            !id.trim().is_empty() || text.contains("without a window")
        });
        if id.trim().is_empty() {
            let why = std::fs::read_to_string(&log).unwrap_or_default();
            let required = std::env::var_os("SCULPTD_REQUIRE_ADAPTER").is_some();
            assert!(!required, "no window: {why}");
            println!("skipped: {}", why.trim());
            return false;
        }
        self.drive(&["windowfocus", id.lines().next().expect("a window")]);
        true
    }

    /// Ends the daemon as a closed window does, and starts it again.
    pub fn restart(&mut self, args: &[&str]) {
        self.ask("shutdown", &Value::Null);
        self.until("the daemon ends", |s| s.daemon.0.try_wait().is_ok_and(|d| d.is_some()));
        self.daemon = start(self.dir.path(), &self.display, args);
        assert!(self.shown());
    }

    /// The X server is killed: the daemon loses its screen in the middle of what it does.
    pub fn lose_screen(&mut self) {
        let _ = self.screen.0.kill();
        let _ = self.screen.0.wait();
    }

    /// Starts another screen to replace a lost one, without a window.
    pub fn new_screen(&mut self) {
        (self.screen, self.display) = screen(self.dir.path());
    }

    /// Another command of the program, on the screen; whether it went well, and what it said.
    pub fn run(&self, args: &[&str]) -> (bool, String) {
        let out = program(self.dir.path(), &self.display).args(args).output().expect("runs");
        let said = [out.stdout, out.stderr].concat();
        (out.status.success(), String::from_utf8_lossy(&said).into_owned())
    }

    /// A window of the running daemon on the screen as it now is.
    pub fn window(&mut self, args: &[&str]) {
        let (well, said) = self.run(args);
        assert!(well, "{said}\n{}", self.log());
        self.last = None;
        assert!(self.shown());
    }

    /// Returns the daemon's log.
    pub fn log(&self) -> String {
        std::fs::read_to_string(self.dir.path().join("log")).unwrap_or_default()
    }

    pub fn tool(&self, name: &str, args: &[&str]) -> Option<String> {
        let out = Command::new(name).args(args).env("DISPLAY", &self.display).output().ok()?;
        out.status.success().then(|| String::from_utf8_lossy(&out.stdout).into_owned())
    }

    pub fn drive(&self, args: &[&str]) {
        let _ = self.tool("xdotool", args);
        pause(60);
    }

    fn asked(&self, method: &str, params: &Value) -> Option<Value> {
        call(&self.dir.path().join("sculptd.sock"), method, params, PATIENCE).ok()
    }

    pub fn ask(&self, method: &str, params: &Value) -> Value {
        call(&self.dir.path().join("sculptd.sock"), method, params, PATIENCE)
            .unwrap_or_else(|e| panic!("{method}: {e:?}"))
    }

    pub fn figure(&self, name: &str) -> u64 {
        self.ask("status", &Value::Null)[name].as_u64().unwrap_or(0)
    }

    #[allow(clippy::disallowed_methods)] // A test waits for other processes.
    pub fn until(&mut self, what: &str, mut so: impl FnMut(&mut Stage) -> bool) {
        let begun = Instant::now();
        while !so(self) {
            assert!(begun.elapsed() < BOUND, "never: {what}");
            pause(20);
        }
    }

    /// Waits until the condition is true, with a long limit: a loaded machine is late, not wrong.
    /// Returns false after that.
    #[allow(clippy::disallowed_methods)] // A test waits for other processes.
    pub fn soon(&mut self, mut so: impl FnMut(&mut Stage) -> bool) -> bool {
        let begun = Instant::now();
        loop {
            match so(self) {
                true => return true,
                false if begun.elapsed() > SOON => return false,
                false => pause(20),
            }
        }
    }

    /// A drag over the clay, in pixels from its middle.
    pub fn drag(&self, from: (i32, i32), to: (i32, i32)) {
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
    pub fn look(&self, name: &str) -> RgbaImage {
        let path = self.dir.path().join(format!("{name}.png"));
        let text = path.display().to_string();
        self.tool("import", &["-window", "root", &text]).expect("a picture");
        if let Some(folder) = std::env::var_os("SCULPTD_SHOTS") {
            let _ = std::fs::copy(&path, PathBuf::from(folder).join(format!("{name}.png")));
        }
        let mut picture = image::open(&path).expect("a PNG").to_rgba8();
        // The figures of the status bar change while nothing else does.
        let bar = picture.height() - STATUS as u32;
        let below = picture.enumerate_rows_mut().filter(|(y, _)| *y >= bar);
        below.flat_map(|(_, row)| row).for_each(|(_, _, p)| *p = image::Rgba([0, 0, 0, 255]));
        picture
    }

    /// The next picture, once it is another than the last one: what was asked for is on the screen,
    /// and stands still.
    pub fn seen(&mut self, name: &str) -> RgbaImage {
        let now = self.changed(name, self.last.as_ref());
        self.last = Some(now.clone());
        now
    }

    /// A picture that differs from `before`, once it stands still.
    #[allow(clippy::disallowed_methods)] // A test waits for other processes.
    fn changed(&self, name: &str, before: Option<&RgbaImage>) -> RgbaImage {
        let begun = Instant::now();
        while begun.elapsed() < BOUND {
            let now = self.look(name);
            // Nothing is drawn yet while all is black.
            let drawn = now.pixels().any(|p| p.0[0] > 0);
            let moved = drawn && before.is_none_or(|before| differs(before, &now) > STILL);
            pause(250);
            if moved && differs(&now, &self.look(name)) < STILL {
                return now;
            }
        }
        panic!("{name}: nothing new on the screen");
    }

    /// Opens a field by a key, types into it once it is on the screen, and confirms what is typed
    /// once that is there too, until the field is gone. On a loaded machine a window is late, and
    /// letters that come before the field are shortcuts.
    pub fn answer(&self, key: &str, text: &str) {
        let before = self.look("before-the-field");
        self.drive(&["key", key]);
        let open = self.changed("the-field", Some(&before));
        self.drive(&["key", "ctrl+a"]);
        self.drive(&["type", "--delay", "60", text]);
        let typed = self.changed("the-text", Some(&open));
        self.drive(&["key", "Return"]);
        self.changed("after-the-field", Some(&typed));
    }
}

/// Mean difference of two pictures over the clay, of 255.
pub fn differs(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let sum: u64 = a.iter().zip(b.iter()).map(|(x, y)| u64::from(x.abs_diff(*y))).sum();
    sum as f64 / a.len() as f64
}

/// Compares a picture, made small, with the one that is kept.
pub fn as_kept(name: &str, now: &RgbaImage) {
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

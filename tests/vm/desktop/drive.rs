//! What moves the desktop: the tablet's reports, and the X server's own tools.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use glam::{DMat3, DVec2, Vec2};
use sculptd_daemon::control::client::call;
use sculptd_devices::catalogue::{Catalogue, Found, Identification, Identity};
use sculptd_devices::hid::transport::Transport;
use sculptd_devices::sim::{PenScript, Shape, SimTablet, Stroke, TabletConfig};
use serde_json::Value;

use super::desktops::{Area, Desktop};
use super::uhid::{DESCRIPTOR, Uhid};

/// The screen, pixels: as `devices/tests/vm/desktop.sh` has it.
pub const SCREEN: DVec2 = DVec2::new(1024.0, 640.0);
pub const DISPLAY: &str = ":0";
const PATIENCE: Duration = Duration::from_secs(60);
/// Reports a second of the pen.
const RATE: f32 = 125.0;
/// Microseconds that a stroke takes, and from the start of one to the start of the next.
pub const STROKE_US: u64 = 300_000;
pub const EVERY_US: u64 = 800_000;

/// A process that ends with this value.
pub struct Ended(pub Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub fn pause(ms: u64) {
    std::thread::sleep(Duration::from_millis(ms));
}

pub fn spawn(name: &str, args: &[&str], log: &str) -> io::Result<Ended> {
    let file = std::fs::File::create(log)?;
    let child = Command::new(name)
        .args(args)
        .envs(Desktop::of_machine().variables())
        .env("XDG_RUNTIME_DIR", "/tmp/run")
        .env("XDG_CONFIG_HOME", "/tmp/config")
        .env("XDG_DATA_HOME", "/tmp/data")
        .env("WGPU_BACKEND", "gl")
        // A seat without a console.
        .env("SEATD_VTBOUND", "0")
        .env("WINIT_X11_SCALE_FACTOR", "1")
        .env("SCULPTD_LOG", "info,sculptd_window=debug")
        .stdout(Stdio::from(file.try_clone()?))
        .stderr(Stdio::from(file))
        .spawn()?;
    Ok(Ended(child))
}

/// Returns the output of a tool; empty if it fails.
pub fn tool(name: &str, args: &[&str]) -> String {
    let mut command = Command::new(name);
    command.args(args).env("DISPLAY", DISPLAY).env("XDG_RUNTIME_DIR", "/tmp/run");
    let out = command.stderr(Stdio::null()).output();
    out.map_or_else(|_| String::new(), |o| String::from_utf8_lossy(&o.stdout).into_owned())
}

/// Waits for a condition; `false` after `seconds`.
pub fn until(seconds: u64, mut so: impl FnMut() -> bool) -> bool {
    let begun = Instant::now();
    loop {
        if so() {
            return true;
        }
        if begun.elapsed() > Duration::from_secs(seconds) {
            return false;
        }
        pause(200);
    }
}

pub fn ask(method: &str, params: &Value) -> Option<Value> {
    let socket: PathBuf = "/tmp/run/sculptd.sock".into();
    call(&socket, method, params, PATIENCE).ok()
}

pub fn status() -> Value {
    ask("status", &Value::Null).unwrap_or_default()
}

pub fn steps() -> u64 {
    status()["undo_steps"].as_u64().unwrap_or(0)
}

/// Frames of the window that have shown where a pen is.
pub fn frames() -> u64 {
    status()["frames"].as_u64().unwrap_or(0)
}

/// Returns the position of the pen's ring, in pixels of the desktop; `None` if no stroke may begin
/// there.
pub fn ring() -> Option<DVec2> {
    let all = status()["pens"].clone();
    let pen = all.as_array()?.iter().find(|p| is_tablet(p))?.clone();
    let pixel = DVec2::new(pen["pixel"][0].as_f64()?, pen["pixel"][1].as_f64()?);
    Some(Desktop::of_machine().origin() + pixel)
}

/// Pointers have higher numbers.
pub fn is_tablet(pen: &Value) -> bool {
    pen["device"].as_u64().is_some_and(|d| d < 100)
}

/// A pen tablet: the simulated one's reports, through uhid.
pub struct Tablet {
    uhid: Option<Uhid>,
    found: Found,
    /// From shares of the tablet to shares of the screen, as the X server has it.
    pub to_screen: DMat3,
}

impl Tablet {
    pub fn new() -> io::Result<Tablet> {
        let catalogue = Catalogue::builtin().map_err(io::Error::other)?;
        let who = Identity {
            vid: 0x056a,
            pid: 0xb8,
            descriptor: DESCRIPTOR.to_vec(),
            ..Identity::default()
        };
        match catalogue.identify(&who) {
            Identification::Identified(found) => {
                Ok(Tablet { uhid: None, found, to_screen: DMat3::IDENTITY })
            }
            other => Err(io::Error::other(format!("{other:?}"))),
        }
    }

    /// Plugs in the pen. Returns true if the X server has it.
    pub fn plug(&mut self) -> io::Result<bool> {
        self.uhid = None;
        pause(1500);
        let mut uhid = Uhid::plug()?;
        uhid.serve(Duration::from_millis(3000))?;
        self.uhid = Some(uhid);
        // The desktop makes a pointer of the pen when it first sees it.
        self.hover(&[SCREEN * 0.5, SCREEN * 0.45])?;
        let there = until(20, || Desktop::of_machine().has_pen());
        self.serve(500)?;
        Ok(there)
    }

    pub fn serve(&mut self, ms: u64) -> io::Result<()> {
        match &mut self.uhid {
            Some(uhid) => uhid.serve(Duration::from_millis(ms)),
            None => Ok(()),
        }
    }

    pub fn report(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Some(uhid) = &mut self.uhid {
            uhid.report(bytes)?;
        }
        self.serve(60)
    }

    /// Lays the tablet over another part of the screen, as a person does.
    pub fn set_area(&mut self, area: &Area) {
        self.to_screen = area.to_screen;
        Desktop::of_machine().set_area(area);
    }

    fn size_mm(&self) -> Vec2 {
        let a = &self.found.tablet.area;
        Vec2::new(a.width_mm as f32, a.height_mm as f32)
    }

    /// Returns the position on the tablet, in mm, that moves the pointer to a pixel.
    fn mm(&self, pixel: DVec2) -> Vec2 {
        let share = self.to_screen.inverse().transform_point2(pixel / SCREEN);
        share.as_vec2() * self.size_mm()
    }

    /// A touch from one pixel of the screen to another.
    pub fn touch(&self, from_us: u64, from: DVec2, to: DVec2, buttons: u32) -> Stroke {
        Stroke {
            from_us,
            to_us: from_us + STROKE_US,
            shape: Shape::Line(self.mm(from), self.mm(to)),
            pressure: 0.7,
            tilt: Vec2::ZERO,
            eraser: false,
            buttons,
        }
    }

    /// Draws in the time of the people who hold a pen.
    pub fn draw(&mut self, strokes: Vec<Stroke>) -> io::Result<()> {
        let script = PenScript::new(strokes);
        let end_us = script.end_us() + 100_000;
        self.perform(script, end_us, 0)
    }

    fn perform(&mut self, script: PenScript, until_us: u64, from_us: u64) -> io::Result<()> {
        let config = TabletConfig { rate: RATE, keeps: 100_000, ..TabletConfig::default() };
        let (mut tablet, mut end) = SimTablet::new(&self.found, script, config);
        tablet.skip_to(from_us);
        let begun = Instant::now();
        let mut buf = [0; 64];
        loop {
            let now = from_us + begun.elapsed().as_micros() as u64;
            tablet.advance(now.min(until_us));
            while let Ok(n @ 1..) = end.read(&mut buf, 0) {
                if let Some(uhid) = &mut self.uhid {
                    uhid.report(&buf[..n])?;
                }
            }
            if now >= until_us {
                return Ok(());
            }
            self.serve(3)?;
        }
    }

    /// Hovers from one pixel to the next, a quarter of a second each way, and rests at each for as
    /// long; stays in range over the last.
    pub fn hover(&mut self, pixels: &[DVec2]) -> io::Result<()> {
        // Strokes that are left out: the pen travels from the end of one to the begin of the next.
        let mut strokes = Vec::new();
        for (i, pixel) in pixels.iter().enumerate() {
            for at in [10_000, 260_000] {
                let at = at + i as u64 * 500_000;
                strokes.push(Stroke { to_us: at + 1, ..self.touch(at, *pixel, *pixel, 0) });
            }
        }
        let (first, last) = (10_002, 260_000 + (pixels.len() as u64 - 1) * 500_000 - 1);
        self.perform(PenScript::new(strokes), last, first)
    }
}

pub fn exists(path: &str) -> bool {
    Path::new(path).exists()
}

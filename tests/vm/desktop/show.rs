//! What is shown, one after the other.

use std::io;
use std::process::ExitCode;

use glam::{DMat3, DVec2, Vec3};
use sculptd_engine::camera::Camera;
use serde_json::{Value, json};

use super::drive::{
    DISPLAY, EVERY_US, Ended, SCREEN, Tablet, ask, cursor, exists, pause, spawn, status, steps,
    tool, until,
};
use super::moved::{ViewRect, beside, vertices};

/// The emulated card, drawn by the machine outside; the tablet comes and goes by itself.
const XORG: &str = r#"Section "Device"
Identifier "card"
Driver "modesetting"
EndSection
"#;
/// A processor that is emulated draws what costs least.
const LOOK: &str = "[look]\nshade = 0.0\ncavity = 0.0\n";
const SETTINGS: &str = "[loop]\nrate_hz = 60\n";
/// Pixels: the cursor and the ring may be so far apart.
const WITHIN: f64 = 2.0;

fn tell(good: bool, what: &str) -> bool {
    println!("VM {} {what}", if good { "ok  " } else { "FAIL" });
    good
}

struct Show {
    tablet: Tablet,
    view: ViewRect,
    camera: Camera,
    radius: f32,
    good: bool,
}

/// Strokes over the clay: its middle is the view's.
fn over_clay(middle: DVec2, count: u64) -> Vec<(DVec2, DVec2)> {
    let at =
        |i: u64| middle + DVec2::new((i % 7) as f64 * 16.0 - 60.0, (i % 5) as f64 * 18.0 - 50.0);
    (0..count).map(|i| (at(i), at(i) + DVec2::new(34.0, 10.0))).collect()
}

impl Show {
    fn tell(&mut self, good: bool, what: &str) {
        self.good &= tell(good, what);
    }

    fn middle(&self) -> DVec2 {
        self.view.corner + self.view.size * 0.5
    }

    /// Hovers about a place until the map can be known. A window learns from one place of the
    /// pointer a frame, and a frame takes a quarter of a second here: a second of hovering on a
    /// real desktop is ten here.
    fn approach(&mut self, m: DVec2) -> io::Result<()> {
        for _ in 0..10 {
            self.tablet.hover(&[m - 100.0, m + DVec2::new(90.0, -60.0), m + 80.0])?;
        }
        pause(1000);
        Ok(())
    }

    /// Draws; how many strokes came of it, once nothing more comes.
    fn draw(&mut self, lines: &[(DVec2, DVec2)]) -> io::Result<u64> {
        let before = steps();
        let touch = |(i, (from, to)): (usize, &(DVec2, DVec2))| {
            self.tablet.touch(400_000 + i as u64 * EVERY_US, *from, *to, 0)
        };
        let strokes = lines.iter().enumerate().map(touch).collect();
        self.tablet.draw(strokes)?;
        settle();
        Ok(steps() - before)
    }

    /// Hovers over places and compares the desktop's cursor with the ring at each.
    fn ring(&mut self, what: &str, places: &[DVec2]) -> io::Result<()> {
        let middle = self.middle();
        self.approach(middle)?;
        let (mut worst, mut seen) = (0.0f64, 0);
        let mut from = middle + 80.0;
        for place in places {
            self.tablet.hover(&[from, *place, *place + 0.5])?;
            from = *place;
            pause(1500);
            let ring = ring_pixel();
            let (Some(cursor), Some(ring)) = (cursor(), ring) else { continue };
            seen += 1;
            worst = worst.max(cursor.distance(ring));
        }
        let what = format!(
            "{what}: cursor and ring {worst:.2} pixels apart at most, at {seen} of {} places",
            places.len()
        );
        self.tell(seen == places.len() && worst <= WITHIN, &what);
        Ok(())
    }

    /// The view's place, by two places of the pen.
    fn find_view(&mut self) -> io::Result<bool> {
        let mut seen = Vec::new();
        for place in [SCREEN * 0.45, SCREEN * 0.55] {
            self.tablet.hover(&[SCREEN * 0.5, place, place + 0.5])?;
            pause(1500);
            let all = status()["pens"].clone();
            let Some(pen) = all.as_array().and_then(|p| p.iter().find(|p| is_tablet(p))).cloned()
            else {
                continue;
            };
            let pair = |v: &Value| Some(DVec2::new(v[0].as_f64()?, v[1].as_f64()?));
            seen.extend(pair(&pen["view"]).zip(pair(&pen["pixel"])));
        }
        let [(v0, p0), (v1, p1)] = seen[..] else { return Ok(false) };
        let size = (p1 - p0) / (v1 - v0);
        self.view = ViewRect { corner: p0 - v0 * size, size };
        Ok(size.is_finite() && size.x > 100.0)
    }
}

fn is_tablet(pen: &Value) -> bool {
    pen["device"].as_u64().is_some_and(|d| d < 100)
}

fn ring_pixel() -> Option<DVec2> {
    let all = status()["pens"].clone();
    let pen = all.as_array()?.iter().find(|p| is_tablet(p))?;
    Some(DVec2::new(pen["pixel"][0].as_f64()?, pen["pixel"][1].as_f64()?))
}

/// Waits until no more strokes come.
fn settle() {
    let mut last = (u64::MAX, 0);
    for _ in 0..40 {
        pause(500);
        let now = steps();
        last = if now == last.0 { (now, last.1 + 1) } else { (now, 0) };
        if last.1 >= 3 {
            return;
        }
    }
}

fn camera() -> Camera {
    let said = ask("camera", &json!({})).unwrap_or_default();
    serde_json::from_value(said).unwrap_or_default()
}

fn radius() -> f64 {
    status()["brush"]["radius"].as_f64().unwrap_or(0.0)
}

/// A ball of few triangles, as Wavefront OBJ.
fn ball() -> String {
    let (rings, around) = (80, 160);
    let mut out = String::new();
    for i in 1..rings {
        let (height, radius) = {
            let a = std::f64::consts::PI * f64::from(i) / f64::from(rings);
            (a.cos(), a.sin())
        };
        for k in 0..around {
            let a = std::f64::consts::TAU * f64::from(k) / f64::from(around);
            out += &format!("v {:.6} {height:.6} {:.6}\n", radius * a.cos(), -radius * a.sin());
        }
    }
    out += "v 0 1 0\nv 0 -1 0\n";
    let at = |i: i32, k: i32| i * around + k % around + 1;
    let (top, bottom) = ((rings - 1) * around + 1, (rings - 1) * around + 2);
    for k in 0..around {
        out += &format!("f {top} {} {}\n", at(0, k), at(0, k + 1));
        out += &format!("f {bottom} {} {}\n", at(rings - 2, k + 1), at(rings - 2, k));
        for i in 0..rings - 2 {
            let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
            out += &format!("f {a} {b} {c} {d}\n");
        }
    }
    out
}

fn start() -> io::Result<(Ended, Ended)> {
    std::fs::create_dir_all("/tmp/run")?;
    std::fs::write("/tmp/xorg.conf", XORG)?;
    std::fs::write("/tmp/settings.toml", SETTINGS)?;
    std::fs::create_dir_all("/tmp/config/sculptd")?;
    std::fs::write("/tmp/config/sculptd/viewer.toml", LOOK)?;
    let args = [
        DISPLAY,
        "-config",
        "/tmp/xorg.conf",
        "-logfile",
        "/tmp/xorg.log",
        "-novtswitch",
        "-sharevts",
        "-noreset",
        "-nolisten",
        "tcp",
    ];
    let server = spawn("/usr/lib/xorg/Xorg", &args, "/tmp/xorg.out")?;
    if !until(60, || !tool("xinput", &["list"]).is_empty()) {
        return Err(io::Error::other("no X server"));
    }
    println!("   the X server is there");
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions("/tmp/run", std::fs::Permissions::from_mode(0o700))?;
    std::fs::write("/tmp/ball.obj", ball())?;
    let args = [
        "run",
        "--mesh",
        "/tmp/ball.obj",
        "--config",
        "/tmp/settings.toml",
        "--stats",
        "/tmp/stats.json",
    ];
    let daemon = spawn("sculptd", &args, "/tmp/sculptd.log")?;
    if !until(120, || status()["window"] == "open") {
        return Err(io::Error::other("no window"));
    }
    println!("   the window is open");
    let id = tool("xdotool", &["search", "--onlyvisible", "--name", "^sculptd$"]);
    let id = id.lines().next().unwrap_or_default().to_owned();
    tool("xdotool", &["windowfocus", &id]);
    Ok((server, daemon))
}

fn run() -> io::Result<bool> {
    let (_server, mut daemon) = start()?;
    let mut tablet = Tablet::new()?;
    let there = tablet.plug()?;
    let mut show = Show {
        tablet,
        view: ViewRect { corner: DVec2::ZERO, size: SCREEN },
        camera: camera(),
        radius: 0.0,
        good: true,
    };
    println!("{}", tool("xinput", &["list"]).trim());
    show.tell(there, "the X server's libinput has made a pointer of the pen");
    show.approach(SCREEN * 0.5)?;
    let mut known = show.find_view()?;
    for _ in 0..4 {
        if known {
            break;
        }
        show.approach(SCREEN * 0.5)?;
        known = show.find_view()?;
    }
    let what = format!("the view on the desktop is {:?}", show.view);
    show.tell(known, &what);
    if !known {
        return Ok(false);
    }
    let shown = status();
    show.camera = camera();
    show.radius = shown["brush"]["radius"].as_f64().unwrap_or(0.0) as f32;

    let before = vertices("before");
    // The measure of brushes is half of the bounding box's diagonal.
    let lo = before.iter().fold(Vec3::INFINITY, |m, v| m.min(*v));
    let hi = before.iter().fold(Vec3::NEG_INFINITY, |m, v| m.max(*v));
    let extent = lo.distance(hi) * 0.5;
    let lines = over_clay(show.middle(), 20);
    let came = show.draw(&lines)?;
    show.tell(came == 20, &format!("20 strokes drawn over the clay, {came} sculpted"));
    let after = vertices("after");
    let (moved, outside, worst) =
        beside(&before, &after, &lines, &show.camera, &show.view, show.radius * extent);
    let what = format!(
        "{moved} vertices moved, {outside} of them outside of the drawn paths (the farthest at \
         {worst:.2} radii of the brush)"
    );
    show.tell(moved > 50 && outside == 0, &what);
    let places: Vec<DVec2> = over_clay(show.middle(), 5).iter().map(|l| l.1).collect();
    show.ring("the whole area over the whole screen", &places)?;

    beyond(&mut show)?;
    areas(&mut show)?;
    controls(&mut show)?;

    let there = show.tablet.plug()?;
    let m = show.middle();
    show.approach(m)?;
    show.approach(m)?;
    let lines = over_clay(show.middle(), 6);
    let came = show.draw(&lines)?;
    show.tell(there && came == 6, &format!("after a replug 6 strokes drawn, {came} sculpted"));
    ask("shutdown", &Value::Null);
    until(20, || daemon.0.try_wait().is_ok_and(|end| end.is_some()));
    let stats = std::fs::read_to_string("/tmp/stats.json").unwrap_or_default();
    let stats: Value = serde_json::from_str(&stats).unwrap_or_default();
    println!("   from sample to screen, microseconds: {}", stats["sample_to_present"]);
    Ok(show.good)
}

/// On a panel and behind another window.
fn beyond(show: &mut Show) -> io::Result<()> {
    let right = show.view.corner.x + show.view.size.x;
    let on_panel = DVec2::new((right + SCREEN.x) * 0.5, SCREEN.y * 0.93);
    let lines = (0..6).map(|i| {
        let at = on_panel + DVec2::new(-20.0, f64::from(i));
        (at, at + DVec2::new(30.0, 4.0))
    });
    let lines: Vec<(DVec2, DVec2)> = lines.collect();
    let came = show.draw(&lines)?;
    show.tell(came == 0, &format!("6 strokes on a panel, {came} sculpted"));
    let corner = show.middle() - DVec2::new(150.0, 100.0);
    let place = format!("300x200+{:.0}+{:.0}", corner.x, corner.y);
    let cover = spawn("xev", &["-geometry", &place], "/tmp/xev.log")?;
    pause(2500);
    let lines = over_clay(show.middle(), 6);
    // The window hears that the pointer has left it with its next frame.
    let m = show.middle();
    show.tablet.hover(&[m, m + 10.0, m, m + 10.0])?;
    let came = show.draw(&lines)?;
    show.tell(came == 0, &format!("6 strokes on another window before the clay, {came} sculpted"));
    drop(cover);
    pause(1000);
    let id = tool("xdotool", &["search", "--onlyvisible", "--name", "^sculptd$"]);
    let id = id.lines().next().unwrap_or_default().to_owned();
    tool("xdotool", &["windowfocus", &id]);
    show.tablet.hover(&[m, m + 10.0, m, m + 10.0])?;
    let came = show.draw(&lines)?;
    show.tell(came == 6, &format!("that window gone, 6 strokes drawn, {came} sculpted"));
    Ok(())
}

/// The window moved, the area turned and cropped.
fn areas(show: &mut Show) -> io::Result<()> {
    let id = tool("xdotool", &["search", "--onlyvisible", "--name", "^sculptd$"]);
    let id = id.lines().next().unwrap_or_default().to_owned();
    tool("xdotool", &["windowmove", &id, "-60", "35"]);
    pause(1500);
    show.view.corner += DVec2::new(-60.0, 35.0);
    let places =
        |show: &Show| over_clay(show.middle(), 5).iter().map(|l| l.1).collect::<Vec<DVec2>>();
    let at = places(show);
    show.ring("the window moved", &at)?;
    let turned = DMat3::from_cols_array(&[-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 1.0, 1.0]);
    let cropped = DMat3::from_cols_array(&[0.6, 0.0, 0.0, 0.0, 0.7, 0.0, 0.2, 0.15, 1.0]);
    for (name, area) in [("turned by half a turn", turned), ("over a part of the screen", cropped)]
    {
        show.tablet.set_area(area);
        pause(500);
        // The old map is contradicted: it goes, and another is learned.
        let m = show.middle();
        show.approach(m)?;
        show.approach(m)?;
        let at = places(show);
        show.ring(&format!("the area {name}"), &at)?;
        let lines = over_clay(show.middle(), 5);
        let came = show.draw(&lines)?;
        show.tell(came == 5, &format!("the area {name}: 5 strokes drawn, {came} sculpted"));
    }
    show.tablet.set_area(DMat3::IDENTITY);
    Ok(())
}

/// Keys, ring and barrel button.
fn controls(show: &mut Show) -> io::Result<()> {
    let m = show.middle();
    show.approach(m)?;
    show.approach(m)?;
    let pad = |ring: u8, key: u8| [0x0c, ring, key, 0, 0, 0, 0, 0, 0, 0];
    let before = steps();
    show.tablet.report(&pad(0, 1))?;
    show.tablet.report(&pad(0, 0))?;
    pause(1500);
    let now = steps();
    show.tell(now + 1 == before, &format!("key 1 takes a step back: {before} steps, then {now}"));
    let before = radius();
    for place in (10..40).step_by(3) {
        show.tablet.report(&pad(0x80 | place, 0))?;
    }
    show.tablet.report(&pad(0, 0))?;
    pause(1000);
    let grown = radius() / before;
    show.tell(grown > 1.1, &format!("a finger round the ring: the radius grows by {grown:.2}"));
    let (yaw, steps_before) = (camera().yaw, steps());
    let stroke = show.tablet.touch(400_000, m - 80.0, m + DVec2::new(80.0, -80.0), 1);
    show.tablet.draw(vec![stroke])?;
    pause(1500);
    let turned = (camera().yaw - yaw).abs();
    let what = format!(
        "the barrel button held: the view turns by {turned:.2} radians, {} strokes",
        steps() - steps_before
    );
    show.tell(turned > 0.05 && steps() == steps_before, &what);
    // Back to the view before, for what follows.
    let back = json!({ "yaw": yaw, "pitch": show.camera.pitch });
    ask("camera", &back);
    pause(1000);
    Ok(())
}

pub fn main() -> ExitCode {
    let shown = run();
    if !matches!(shown, Ok(true)) {
        for log in ["/tmp/xorg.out", "/tmp/sculptd.log"] {
            if exists(log) {
                let text = std::fs::read_to_string(log).unwrap_or_default();
                let lines: Vec<&str> = text.lines().collect();
                println!("--- {log}\n{}", lines[lines.len().saturating_sub(60)..].join("\n"));
            }
        }
    }
    match &shown {
        Ok(true) => println!("VM PASSED"),
        Ok(false) => println!("VM FAILED"),
        Err(e) => println!("VM FAILED: {e}"),
    }
    if matches!(shown, Ok(true)) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

//! The steps of the demonstration in order. No step waits for a time: each waits for a report of
//! the daemon or the desktop. Learning is counted in frames of the window, which take a third of a
//! second each here.

use std::io;
use std::process::ExitCode;

use glam::{DVec2, Vec3};
use sculptd_engine::camera::Camera;
use serde_json::{Value, json};

use super::desktops::Desktop;
use super::drive::{
    EVERY_US, Ended, SCREEN, Tablet, ask, exists, frames, is_tablet, pause, ring, spawn, status,
    steps, tool, until,
};
use super::moved::{ViewRect, beside, vertices};

/// A processor that is emulated draws what costs least.
const LOOK: &str = "smooth_edges = false\n[look]\nshade = 0.0\ncavity = 0.0\n";
const SETTINGS: &str = "[loop]\nrate_hz = 60\n";
/// Pixels: the cursor and the ring may be so far apart.
const WITHIN: f64 = 2.0;
/// Frames in which a map must be learned: two seconds of sixty, for the pen rests at each stop as
/// long as it moves, and an emulated X server is late by something else each time.
const LEARNED_IN: u64 = 120;
/// Places to which the pen hovers for it at most.
const STUCK: usize = 24;
/// So many places in turn at which cursor and ring meet show that the map is learned.
const MEET: usize = 4;
/// Pixels from the middle of the view: where a pen hovers, in no order.
const STOPS: [(f64, f64); 8] = [
    (-90.0, -70.0),
    (70.0, 55.0),
    (85.0, -60.0),
    (-60.0, 75.0),
    (10.0, -85.0),
    (-100.0, 5.0),
    (40.0, 90.0),
    (95.0, 10.0),
];
/// Seconds after which something that did not come will not come.
const BOUND: u64 = 60;

fn tell(good: bool, what: &str) -> bool {
    println!("VM {} {what}", if good { "ok  " } else { "FAIL" });
    good
}

struct Show {
    desktop: Desktop,
    tablet: Tablet,
    view: ViewRect,
    camera: Camera,
    radius: f32,
    /// Position of the pen, in pixels.
    at: DVec2,
    /// Stops that were made.
    stops: usize,
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

    /// Hovers to a place and rests there.
    fn go(&mut self, to: DVec2) -> io::Result<()> {
        self.tablet.hover(&[self.at, to, to + 0.5])?;
        self.at = to + 0.5;
        Ok(())
    }

    /// The desktop's cursor and the pen's ring, once both stand still.
    fn rest(&mut self) -> io::Result<(Option<DVec2>, Option<DVec2>)> {
        let where_both = |at| (self.desktop.cursor(at), ring());
        let mut last = where_both(self.at);
        for _ in 0..20 {
            self.tablet.serve(100)?;
            let now = where_both(self.at);
            if now == last && now.0.is_some() {
                break;
            }
            last = now;
        }
        Ok(last)
    }

    /// Returns the distance between cursor and ring, in pixels; `None` if no ring is shown.
    fn apart(&mut self) -> io::Result<Option<f64>> {
        let (cursor, ring) = self.rest()?;
        Ok(cursor.zip(ring).map(|(c, r)| c.distance(r)))
    }

    /// Hovers about the middle until the map is right at several places in turn; the frames that
    /// were shown until the first of them, or `None`.
    fn learn(&mut self) -> io::Result<Option<u64>> {
        let (begun, first, mut meet, mut took) = (frames(), self.stops, 0, 0);
        let middle = self.middle();
        while meet < MEET {
            let shown = frames() - begun;
            // A window that shows nothing learns nothing.
            let stuck = self.stops - first > STUCK;
            if meet == 0 && shown > LEARNED_IN || stuck {
                let (cursor, ring) = self.rest()?;
                let tablets = status()["tablets"].clone();
                println!("   the pen {:?}, cursor {cursor:?}, ring {ring:?}, {tablets}", self.at);
                return Ok(None);
            }
            let (x, y) = STOPS[self.stops % STOPS.len()];
            // Not the same places again and again.
            let by = DVec2::splat((self.stops / STOPS.len() % 5) as f64 * 4.0);
            self.stops += 1;
            took = if meet == 0 { shown } else { took };
            self.go(middle + DVec2::new(x, y) + by)?;
            meet = if self.apart()?.is_some_and(|off| off <= WITHIN) { meet + 1 } else { 0 };
        }
        Ok(Some(took))
    }

    /// The same, told.
    fn learned(&mut self, what: &str) -> io::Result<bool> {
        let took = self.learn()?;
        let text = match took {
            Some(took) => format!("{what}: the map is right after {took} frames of hovering"),
            None => format!("{what}: the map is not right after {LEARNED_IN} frames of hovering"),
        };
        self.tell(took.is_some(), &text);
        Ok(took.is_some())
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
    fn ring(&mut self, what: &str) -> io::Result<()> {
        let middle = self.middle();
        let places: Vec<DVec2> = over_clay(middle, 5).iter().map(|l| l.1).collect();
        let (mut worst, mut seen) = (0.0f64, 0);
        for place in &places {
            self.go(*place)?;
            let Some(off) = self.apart()? else { continue };
            seen += 1;
            worst = worst.max(off);
        }
        let what = format!(
            "{what}: cursor and ring {worst:.2} pixels apart at most, at {seen} of {} places",
            places.len()
        );
        self.tell(seen == places.len() && worst <= WITHIN, &what);
        Ok(())
    }

    /// Waits, with the pen moving a little, until its ring is shown or is not.
    fn until_ring(&mut self, shown: bool, about: DVec2) -> io::Result<bool> {
        for i in 0..BOUND {
            self.go(about + DVec2::splat((i % 2) as f64 * 8.0))?;
            if until(1, || ring().is_some() == shown) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The view's place, by two places of the pen.
    fn find_view(&mut self) -> io::Result<bool> {
        let mut seen = Vec::new();
        for place in [SCREEN * 0.46, SCREEN * 0.54] {
            self.go(place)?;
            self.rest()?;
            let all = status()["pens"].clone();
            let Some(pen) = all.as_array().and_then(|p| p.iter().find(|p| is_tablet(p))).cloned()
            else {
                continue;
            };
            let pair = |v: &Value| Some(DVec2::new(v[0].as_f64()?, v[1].as_f64()?));
            let pixel = pair(&pen["pixel"]).map(|at| at + self.desktop.origin());
            seen.extend(pair(&pen["view"]).zip(pixel));
        }
        let [(v0, p0), (v1, p1)] = seen[..] else { return Ok(false) };
        let size = (p1 - p0) / (v1 - v0);
        self.view = ViewRect { corner: p0 - v0 * size, size };
        Ok(size.is_finite() && size.x > 100.0)
    }
}

/// Waits until no more strokes come.
fn settle() {
    let mut last = (u64::MAX, 0);
    for _ in 0..BOUND {
        pause(300);
        let now = steps();
        last = if now == last.0 { (now, last.1 + 1) } else { (now, 0) };
        if last.1 >= 4 {
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
    let (rings, around) = (50, 100);
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

fn start() -> io::Result<(Vec<Ended>, Ended)> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::create_dir_all("/tmp/run")?;
    std::fs::write("/tmp/settings.toml", SETTINGS)?;
    std::fs::create_dir_all("/tmp/config/sculptd")?;
    std::fs::write("/tmp/config/sculptd/viewer.toml", LOOK)?;
    std::fs::set_permissions("/tmp/run", std::fs::Permissions::from_mode(0o700))?;
    let desktop = Desktop::of_machine();
    let server = desktop.start()?;
    println!("   {desktop:?} is there");
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
    desktop.focus();
    Ok((server, daemon))
}

fn run() -> io::Result<bool> {
    let (_server, mut daemon) = start()?;
    let mut tablet = Tablet::new()?;
    let there = tablet.plug()?;
    let mut show = Show {
        desktop: Desktop::of_machine(),
        tablet,
        view: ViewRect { corner: DVec2::ZERO, size: SCREEN },
        camera: camera(),
        radius: 0.0,
        at: SCREEN * 0.45,
        stops: 0,
        good: true,
    };
    show.tell(there, "the desktop's libinput has made a pointer of the pen");
    let known = show.learned("the whole area over the whole screen")? && show.find_view()?;
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
    show.ring("the whole area over the whole screen")?;

    beyond(&mut show)?;
    areas(&mut show)?;
    controls(&mut show)?;

    let there = show.tablet.plug()?;
    show.at = SCREEN * 0.45;
    show.learned("after a replug")?;
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
    // The panel of the brush, at the right edge.
    let on_panel = SCREEN - DVec2::new(110.0, 110.0);
    let lines = (0..6).map(|i| {
        let at = on_panel + DVec2::new(-20.0, f64::from(i));
        (at, at + DVec2::new(30.0, 4.0))
    });
    let lines: Vec<(DVec2, DVec2)> = lines.collect();
    let came = show.draw(&lines)?;
    show.tell(came == 0, &format!("6 strokes on a panel, {came} sculpted"));
    if show.desktop == Desktop::X11 {
        return behind(show);
    }
    println!("   not shown here: another window before the clay");
    Ok(())
}

fn behind(show: &mut Show) -> io::Result<()> {
    let m = show.middle();
    let corner = m - DVec2::new(150.0, 100.0);
    let place = format!("300x200+{:.0}+{:.0}", corner.x, corner.y);
    let cover = spawn("xev", &["-geometry", &place], "/tmp/xev.log")?;
    let there =
        || !tool("xdotool", &["search", "--onlyvisible", "--name", "Event Tester"]).is_empty();
    let covered = until(BOUND, there) && show.until_ring(false, m)?;
    let lines = over_clay(m, 6);
    let came = show.draw(&lines)?;
    let what = format!("6 strokes on another window before the clay, {came} sculpted");
    show.tell(covered && came == 0, &what);
    drop(cover);
    let gone = until(BOUND, || !there());
    show.desktop.focus();
    let free = gone && show.until_ring(true, m)?;
    let came = show.draw(&lines)?;
    let what = format!("that window gone, 6 strokes drawn, {came} sculpted");
    show.tell(free && came == 6, &what);
    Ok(())
}

/// The window moved, the area turned and cropped.
fn areas(show: &mut Show) -> io::Result<()> {
    show.view.corner += show.desktop.move_window();
    show.learned("the window moved")?;
    show.ring("the window moved")?;
    for area in show.desktop.areas() {
        show.tablet.set_area(&area);
        show.learned(area.name)?;
        show.ring(area.name)?;
        let lines = over_clay(show.middle(), 5);
        let came = show.draw(&lines)?;
        show.tell(came == 5, &format!("{}: 5 strokes drawn, {came} sculpted", area.name));
    }
    Ok(())
}

/// Keys, ring and barrel button.
fn controls(show: &mut Show) -> io::Result<()> {
    let m = show.middle();
    let pad = |ring: u8, key: u8| [0x0c, ring, key, 0, 0, 0, 0, 0, 0, 0];
    settle();
    let before = steps();
    show.tablet.report(&pad(0, 1))?;
    show.tablet.report(&pad(0, 0))?;
    until(BOUND, || steps() != before);
    settle();
    let now = steps();
    show.tell(now + 1 == before, &format!("key 1 takes a step back: {before} steps, then {now}"));
    let before = radius();
    for place in (10..40).step_by(3) {
        show.tablet.report(&pad(0x80 | place, 0))?;
    }
    show.tablet.report(&pad(0, 0))?;
    until(BOUND, || radius() > 1.1 * before);
    let grown = radius() / before;
    show.tell(grown > 1.1, &format!("a finger round the ring: the radius grows by {grown:.2}"));
    let (yaw, steps_before) = (camera().yaw, steps());
    let stroke = show.tablet.touch(400_000, m - 80.0, m + DVec2::new(80.0, -80.0), 1);
    show.tablet.draw(vec![stroke])?;
    until(BOUND, || (camera().yaw - yaw).abs() > 0.05);
    settle();
    let turned = (camera().yaw - yaw).abs();
    let what = format!(
        "the barrel button held: the view turns by {turned:.2} radians, {} strokes",
        steps() - steps_before
    );
    show.tell(turned > 0.05 && steps() == steps_before, &what);
    // Back to the view before, for what follows.
    ask("camera", &json!({ "yaw": yaw, "pitch": show.camera.pitch }));
    until(BOUND, || (camera().yaw - yaw).abs() < 1e-3);
    Ok(())
}

pub fn main() -> ExitCode {
    let shown = run();
    if !matches!(shown, Ok(true)) {
        for log in ["/tmp/desktop.log", "/tmp/sculptd.log"] {
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

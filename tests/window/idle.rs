//! Nothing happens when nothing happens: what an idle window takes of the processor.

use std::collections::BTreeMap;

use sculptd_geometry::io::write_mesh;
use sculptd_geometry::shapes;
use serde_json::json;

use super::stage::{Stage, long, pause};

/// Ticks of the processor a second, as Linux counts them for `/proc`.
const TICKS: f64 = 100.0;

/// Seconds of the processor that each thread of a process has taken, by the thread's number.
fn threads(pid: u32) -> BTreeMap<u64, (String, f64)> {
    let mut out = BTreeMap::new();
    for entry in std::fs::read_dir(format!("/proc/{pid}/task")).expect("threads").flatten() {
        let id = entry.file_name().to_string_lossy().parse().expect("a number");
        let Ok(text) = std::fs::read_to_string(entry.path().join("stat")) else { continue };
        let Some((name, rest)) = text.split_once('(').and_then(|t| t.1.rsplit_once(')')) else {
            continue;
        };
        let fields: Vec<f64> = rest.split_whitespace().filter_map(|f| f.parse().ok()).collect();
        // The state is no number: utime and stime are the 11th and 12th of what is left.
        out.insert(id, (name.to_owned(), (fields[10] + fields[11]) / TICKS));
    }
    out
}

/// Shares of one core over `seconds`, by the threads' names.
fn shares(s: &Stage, seconds: u64) -> BTreeMap<String, f64> {
    let pid = s.daemon.0.id();
    let told = s.log().lines().count();
    let before = threads(pid);
    pause(seconds * 1000);
    // Frames that were drawn in the meantime.
    s.log().lines().skip(told).for_each(|line| println!("{line}"));
    let mut out = BTreeMap::new();
    for (id, (name, now)) in threads(pid) {
        let then = before.get(&id).map_or(0.0, |t| t.1);
        *out.entry(name).or_insert(0.0) += (now - then) / seconds as f64;
    }
    out
}

/// Returns the share of the window's threads: all but the tick and session threads.
fn of_the_window(shares: &BTreeMap<String, f64>) -> f64 {
    let daemon = ["sculptd-tick", "sculptd-journal", "sculptd-tail", "sculptd-history"];
    // Linux keeps fifteen letters of a name.
    let own = |name: &str| daemon.iter().any(|d| d[..d.len().min(15)] == *name);
    shares.iter().filter(|(name, _)| !own(name)).map(|(_, share)| share).sum()
}

fn told(what: &str, shares: &BTreeMap<String, f64>) {
    let busy: Vec<String> = shares
        .iter()
        .filter(|(_, share)| **share > 0.0005)
        .map(|(name, share)| format!("{name} {:.1} %", share * 100.0))
        .collect();
    let all = of_the_window(shares) * 100.0;
    println!("{what}: the window's threads {all:.2} % of one core; {}", busy.join(", "));
}

#[test]
fn an_idle_window_takes_no_processor() {
    let Some(mut s) = Stage::open(&[]) else { return };
    // The aim is one percent; the gate's machine does other things beside it.
    let most = if long() { 0.01 } else { 0.03 };
    s.seen("idle-start");
    // Away from the clay and the panels' buttons.
    s.drive(&["mousemove", "640", "700"]);
    pause(5000);
    let idle = shares(&s, 30);
    told("idle, the start ball", &idle);
    assert!(of_the_window(&idle) <= most, "{idle:?}");
    if !long() {
        return;
    }
    let path = s.dir.path().join("large.ply");
    write_mesh(&path, &shapes::sphere_of_about(2_500_000).to_poly()).expect("written");
    let begun = s.figure("vertices");
    s.ask("load", &json!({ "path": path }));
    s.until("it is loaded", |s| s.figure("vertices") != begun);
    s.seen("idle-large");
    pause(5000);
    let idle = shares(&s, 30);
    told("idle, 5 M triangles", &idle);
    // Cost of a frame in which the clay does not change: the pointer moves, and the ring with it.
    let lines = s.log().lines().count();
    for i in 0..200 {
        let (x, y) = ((500 + i).to_string(), (300 + i / 2).to_string());
        s.tool("xdotool", &["mousemove", &x, &y]);
        pause(10);
    }
    pause(2000);
    let log = s.log();
    let figure = |line: &str, name: &str| -> f64 {
        let value = line.split(name).nth(1).and_then(|v| v.split_whitespace().next());
        value.and_then(|v| v.parse().ok()).unwrap_or_else(|| panic!("{name} in {line}"))
    };
    let (mut frames, mut total_ms) = (0.0, 0.0);
    for line in log.lines().skip(lines).filter(|l| l.contains("mean_ms=")) {
        let now = figure(line, "frames=");
        assert!(now <= 61.0, "more frames in a second than the screen shows: {line}");
        (frames, total_ms) = (frames + now, total_ms + now * figure(line, "mean_ms="));
        println!("{line}");
    }
    println!("{frames} frames, {:.2} ms of the processor each", total_ms / frames.max(1.0));
    assert!(frames > 0.0, "the ring follows the pointer");
    assert!(of_the_window(&idle) <= most, "{idle:?}");
}

//! A reply means done: whatever a request changed, the very next request of the same client sees
//! it. Every method of the schema is called with random parameters; right after its reply the
//! state is read, and again once the loop has had time for more. Where the two differ, the reply
//! came before its effect.

use std::path::Path;
use std::sync::{Arc, Mutex};

use serde_json::{Value, json};

use crate::seeded::Random;
use crate::waiting::until;
use sculptd_control::METHODS;
use sculptd_daemon::config::{Config, LoopConfig};
use sculptd_daemon::control::Host;
use sculptd_daemon::control::handler::call;
use sculptd_daemon::control::stroke::VirtualPen;
use sculptd_daemon::live::Live;
use sculptd_daemon::startup;
use sculptd_daemon::tick::Journal;
use sculptd_devices::{Clock, queue};
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

/// Methods that change nothing that can be read, or end the daemon.
const LEFT_OUT: [&str; 3] = ["subscribe", "window", "shutdown"];
/// Ticks after which whatever a request began late would be seen.
const LATER: u64 = 6;

/// Everything that a client can read of the sculpture and its settings.
fn state(host: &Host) -> Value {
    let read = |method: &str| call(host, method, Value::Null).unwrap_or_else(|e| json!(e.message));
    let mut hash = read("hash");
    hash.as_object_mut().expect("an object").remove("tick");
    let shown = host.published.load();
    let held = shown.thing.as_ref().map(|t| (t.plain.positions.len(), t.place.shift.to_array()));
    json!({
        "hash": hash,
        "scene": read("scene.list"),
        "layers": read("layers.list"),
        "sets": read("sets.list"),
        "brush": read("brush"),
        "camera": read("camera"),
        "here": read("history")["here"],
        "held": held,
        "reach": shown.volume.scale,
        "picture": shown.picture.as_ref().map(|p| [p.width, p.height]),
        "undo": [shown.undo_steps, shown.redo_steps],
    })
}

fn region(r: &mut Random) -> Value {
    let (x, y) = (0.3 + 0.2 * r.part(), 0.3 + 0.2 * r.part());
    json!({ "box": [x, y, x + 0.2, y + 0.2] })
}

/// Parameters that mean something in the present state, mostly.
fn params(method: &str, r: &mut Random, host: &Host, dir: &Path) -> Value {
    let shown = host.published.load_full();
    let any = shown.scene.objects[r.below(shown.scene.objects.len() as u64) as usize].id.0;
    let other = shown.scene.objects[r.below(shown.scene.objects.len() as u64) as usize].id.0;
    let layers = shown.mesh.layers().map(|l| l.layers.clone()).unwrap_or_default();
    let layer = layers.get(r.below(layers.len().max(1) as u64) as usize).map_or(0, |l| l.id.0);
    let set = 1 + r.below(2);
    let file = dir.join(r.of(&["ball.ply", "box.ply"]));
    let operation = r.of(&["union", "intersection", "difference", "reverse-difference"]);
    let node = || call(host, "history", Value::Null).map(|h| h["places"].clone());
    let turn = [0.0, 0.0, 0.0, 1.0];
    match method {
        "guests.invite" => json!({ "role": "viewer" }),
        "guests.revoke" => json!({ "key": 1 }),
        "brush" => {
            json!({ "radius": 0.05 + 0.3 * r.part(), "kind": r.of(&["draw", "clay", "smooth"]) })
        }
        "picture" => json!({ "path": dir.join("heights.png") }),
        "mask" => json!({ "action": r.of(&["clear", "fill", "invert", "blur", "grow", "shrink"]) }),
        "mask-measured" => json!({ "by": { "thin": 0.1 + r.part() } }),
        "mask-region" => json!({ "region": region(r), "mask": r.part() }),
        "curve" => json!({ "act": r.of(&["apply", "cancel"]) }),
        "stroke" => {
            let (x, y) = (0.45 + 0.1 * r.part(), 0.45 + 0.1 * r.part());
            let points = json!([[x, y, 1.0, 0], [x + 0.05, y, 1.0, 20], [x + 0.1, y, 1.0, 40]]);
            json!({ "points": points, "space": "view" })
        }
        "camera" => json!({ "yaw": r.part() * 3.0, "pitch": r.part() - 0.5 }),
        "jump" => {
            let places = node().unwrap_or_default();
            let count = places.as_array().map_or(0, Vec::len).max(1) as u64;
            json!({ "node": places[r.below(count) as usize]["node"] })
        }
        "load" | "take-up" => json!({ "path": file }),
        "export" => json!({ "path": dir.join("out.ply") }),
        "thickness" => json!({ "rays": 1 }),
        "join" => json!({ "operation": operation }),
        "trim" => json!({ "part": { "box": [0.0, 0.0, 0.45, 1.0] } }),
        "level" => json!({ "to": r.of(&["up", "down"]) }),
        "remesh" => json!({ "voxel": 0.08 + 0.1 * r.part() }),
        "remesh.quads" => json!({ "quads": 200 + r.below(200) }),
        "remesh.local" => json!({ "stretched_only": false, "edge": null }),
        "decimate" => json!({ "triangles": 400 + r.below(400) }),
        "boolean" => {
            let at = [r.part() - 0.5, 0.9, r.part() - 0.5];
            json!({ "operation": operation, "path": dir.join("box.ply"), "at": at })
        }
        "scene.add" => match r.below(3) {
            0 => json!({ "path": file }),
            1 => json!({ "held": true }),
            _ => json!({ "primitive": { "ball": 0.4 }, "edge": 0.1 }),
        },
        "scene.rename" => json!({ "id": any, "name": format!("object {}", r.below(100)) }),
        "scene.transform" => {
            let shift = [r.part() - 0.5, 0.0, 0.0];
            json!({ "id": any, "transform": { "shift": shift, "turn": turn, "scale": 1.0 } })
        }
        "scene.show" => json!({ "id": any, "visible": r.below(4) > 0 }),
        "scene.lock" => json!({ "id": any, "locked": r.below(4) == 0 }),
        "scene.reshape" => json!({ "id": any, "primitive": { "ball": 0.3 }, "edge": 0.1 }),
        "scene.snap" => {
            json!({ "id": any, "at": [0.0, 0.0, 1.0], "to": other, "to_at": [0.0, 1.0, 0.0] })
        }
        "scene.boolean" => json!({ "operation": operation, "a": any, "b": other }),
        "scene.mirror" => json!({ "id": any, "axis": r.of(&["x", "y", "z"]) }),
        "scene.move" => json!({ "id": any, "to": r.below(3) }),
        "scene.group" => json!({ "ids": [any], "name": "group" }),
        "scene.merge" => json!({ "ids": [any, other] }),
        "layers.add" => json!({ "name": format!("layer {}", r.below(100)) }),
        "layers.rename" => json!({ "layer": layer, "name": "renamed" }),
        "layers.move" => json!({ "layer": layer, "to": r.below(3) }),
        "layers.set" => {
            json!({ "layer": layer, "intensity": r.part() * 2.0, "live": r.below(2) == 0 })
        }
        "layers.activate" => {
            json!({ "layer": if r.below(2) == 0 { json!(layer) } else { Value::Null } })
        }
        m if m.starts_with("layers.") && !["layers.list", "layers.bake"].contains(&m) => {
            json!({ "layer": layer })
        }
        "sets.rename" => json!({ "set": set, "name": "a set" }),
        "sets.make" => {
            json!({ "from": r.of(&["mask", "visible", "loose", "normals", "crease", "walls"]) })
        }
        "sets.hide" | "sets.isolate" => json!({ "set": set }),
        "sets.region" => {
            json!({ "region": region(r), "action": r.of(&["make", "hide", "isolate"]) })
        }
        "sets.extract" => json!({ "thickness": 0.05, "set": set }),
        "reach" => json!({ "middle_mm": [0.0, 250.0, 0.0], "half_mm": 100.0 + 100.0 * r.part() }),
        m if m.starts_with("scene.") && m != "scene.list" => json!({ "id": any }),
        _ => Value::Null,
    }
}

/// Brings the sculpture into a state in which the method can be carried out, mostly.
fn prepare(method: &str, host: &Host, dir: &Path) {
    let ask = |method: &str, params: Value| {
        let _ = call(host, method, params);
    };
    let shown = host.published.load_full();
    if shown.mesh.triangle_count() < 100 {
        ask("load", json!({ "path": dir.join("ball.ply") }));
    }
    if let Some(active) = shown.scene.active() {
        ask("scene.lock", json!({ "id": active.id.0, "locked": false }));
        ask("scene.show", json!({ "id": active.id.0, "visible": true }));
    }
    match method {
        "join" => ask("take-up", json!({ "path": dir.join("box.ply") })),
        m if m.starts_with("layers.") => {
            (0..2).for_each(|k| ask("layers.add", json!({ "name": format!("layer {k}") })));
        }
        m if m.starts_with("sets.") && m != "sets.make" => {
            ask("sets.show", json!({}));
            ask("sets.make", json!({ "from": "visible" }));
        }
        _ => {}
    }
}

#[test]
fn every_reply_comes_after_its_effect() {
    let dir = tempfile::tempdir().expect("a folder");
    let small = shapes::icosphere(0.3, 8).to_poly();
    write_mesh(&dir.path().join("ball.ply"), &shapes::icosphere(1.0, 12).to_poly()).expect("file");
    write_mesh(&dir.path().join("box.ply"), &small).expect("file");
    let picture = image::GrayImage::from_fn(16, 16, |x, y| image::Luma([(x * y) as u8]));
    picture.save(dir.path().join("heights.png")).expect("a picture");
    let session = dir.path().join("s.sculpt");
    let r#loop = LoopConfig { workers: 1, rate_hz: 240, ..Default::default() };
    let config = Config { r#loop, ..Default::default() };
    let ball = dir.path().join("ball.ply");
    let begun = startup::begin(Some(&ball), Some(&session), &config, &Job::default());
    let begun = begun.expect("begins");
    let (writer, thread) = begun.journal.expect("a session");
    let history = thread.history.as_ref().expect("a history").handle.clone();
    let (factory, receiver) = queue::channel(4096);
    let clock = Clock::monotonic();
    let journal: Box<dyn Journal> = Box::new(writer);
    let live =
        Live::start(begun.world, receiver, clock.clone(), config.r#loop, 4096, Some(journal))
            .expect("runs");
    history.connect(live.commands.clone());
    let host = Host {
        pen: Some(Arc::new(Mutex::new(VirtualPen::new(&factory, clock.clone())))),
        history: Some(history),
        ..Host::new(live.commands.clone(), live.published.clone(), sculptd::presets().clone())
    };
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 100 } else { 3 };
    let mut r = Random(0x5eed);
    let (mut stale, mut waits, mut done) =
        (Vec::new(), Vec::new(), std::collections::BTreeMap::new());
    for round in 0..rounds {
        for method in METHODS.iter().map(|m| m.name).filter(|m| !LEFT_OUT.contains(m)) {
            prepare(method, &host, dir.path());
            let asked = params(method, &mut r, &host, dir.path());
            let begun_us = clock.now_us();
            let reply = call(&host, method, asked.clone());
            waits.push(clock.now_us() - begun_us);
            let at_once = state(&host);
            let tick = live.published.load().tick + LATER;
            until("the loop goes on", || live.published.load().tick >= tick);
            let later = state(&host);
            let count: &mut (u32, u32) = done.entry(method).or_default();
            (count.0, count.1) = (count.0 + 1, count.1 + u32::from(reply.is_ok()));
            if let Err(e) = &reply {
                assert_ne!(e.code, -32602, "{method} {asked}: {}", e.message);
            }
            for (key, value) in at_once.as_object().expect("an object") {
                if *value != later[key] {
                    stale.push(format!("round {round}: {method} {asked}: {key} came later"));
                }
            }
            // The scene stays small, and something of it can be changed.
            if host.published.load().scene.objects.len() > 4 {
                call(&host, "load", json!({ "path": ball })).ok();
                let objects = host.published.load().scene.objects.clone();
                for o in &objects[..objects.len() - 1] {
                    let _ = call(&host, "scene.lock", json!({ "id": o.id.0, "locked": false }));
                    let _ = call(&host, "scene.remove", json!({ "id": o.id.0 }));
                }
            }
        }
    }
    waits.sort_unstable();
    let at = |share: usize| waits[(waits.len() - 1) * share / 100] as f64 * 1e-3;
    println!(
        "{} replies: p50 {:.2} ms, p90 {:.2} ms, p99 {:.2} ms",
        waits.len(),
        at(50),
        at(90),
        at(99)
    );
    let never: Vec<_> = done.iter().filter(|(_, n)| n.1 == 0).map(|(m, _)| *m).collect();
    println!("never carried out: {never:?}");
    assert!(stale.is_empty(), "{} stale: {:#?}", stale.len(), stale);
    live.stop().expect("ends");
    assert_eq!(thread.finish(), None);
}

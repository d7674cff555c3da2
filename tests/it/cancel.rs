//! Whatever takes long can be cancelled: each method that computes is begun on a large ball and
//! cancelled at a random moment. It answers soon, says so, and has changed nothing.

use std::path::Path;

use serde_json::{Value, json};

use crate::seeded::Random;
use crate::waiting::comes;
use sculptd_clay::Clay;
use sculptd_daemon::config::{Config, LoopConfig};
use sculptd_daemon::control::Host;
use sculptd_daemon::control::handler::call;
use sculptd_daemon::live::Live;
use sculptd_daemon::startup;
use sculptd_devices::{Clock, queue};
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

/// The methods that compute, with parameters for a scene of two balls of radius 1.
fn methods(dir: &Path, other: &Value) -> Vec<(&'static str, Value)> {
    let file = dir.join("tool.ply");
    let plane = json!({ "point": [0, 0, 0.1], "normal": [0, 0, 1], "radius": 0.1 });
    let both = |operation: &str| json!({ "operation": operation, "a": 0, "b": other });
    vec![
        ("load", json!({ "path": file })),
        ("scene.add", json!({ "path": file })),
        ("boolean", json!({ "operation": "difference", "path": file, "at": [0.3, 0.2, 0.1] })),
        ("trim", json!({ "part": { "box": [0.0, 0.0, 0.45, 1.0] } })),
        ("repair", json!({ "repair": { "base": 0.4 } })),
        ("repair", json!({ "repair": { "split": plane } })),
        ("scene.boolean", both("union")),
        ("scene.merge", json!({ "ids": [0, other] })),
        ("scene.mirror", json!({ "id": 0, "axis": "x" })),
        ("level", json!({ "to": "up" })),
        ("remesh", json!({ "voxel": 0.012 })),
        ("remesh", json!({ "voxel": 0.02, "sharp": true })),
        ("remesh.quads", json!({ "quads": 4000 })),
        ("decimate", json!({ "triangles": 20_000 })),
        ("thickness", json!({ "rays": 10 })),
        ("thickness", json!({ "rays": 1 })),
        ("thickness", json!({ "method": "sphere" })),
        ("mask-measured", json!({ "by": { "thin": 3.0 } })),
        ("mask-measured", json!({ "by": { "occlusion": 0.5 } })),
        ("sets.make", json!({ "from": "loose" })),
        ("sets.make", json!({ "from": "normals" })),
        ("sets.make", json!({ "from": "crease" })),
        ("sets.make", json!({ "from": "walls" })),
        ("sets.extract", json!({ "thickness": 0.05 })),
        ("export", json!({ "path": dir.join("out.3mf") })),
    ]
}

#[test]
fn what_takes_long_is_cancelled_at_once() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let (rounds, segments) = if long { (45, 90) } else { (1, 30) };
    let dir = tempfile::tempdir().expect("a folder");
    let ball = shapes::icosphere(1.0, segments);
    write_mesh(&dir.path().join("tool.ply"), &ball.to_poly()).expect("a file");
    let config =
        Config { r#loop: LoopConfig { workers: 1, ..Default::default() }, ..Default::default() };
    let world = startup::world(Clay::build(&ball, &Job::default()).expect("a ball"), &config);
    let (_factory, receiver) = queue::channel(64);
    let clock = Clock::monotonic();
    let live = Live::start(world, receiver, clock.clone(), config.r#loop, 64, None).expect("runs");
    let presets = sculptd::presets().clone();
    let host = Host::new(live.commands.clone(), live.published.clone(), presets);
    let ask = |method: &str, params: Value| call(&host, method, params).expect(method);
    let at = json!({ "shift": [0.4, 0.1, 0.2], "turn": [0.0, 0.0, 0.0, 1.0], "scale": 1.0 });
    let tool = dir.path().join("tool.ply");
    let other = ask("scene.add", json!({ "path": tool, "transform": at }))["id"].clone();
    ask("scene.activate", json!({ "id": 0 }));
    let masked = || json!({ "region": { "box": [0.4, 0.4, 0.6, 0.6] }, "mask": 1.0 });
    ask("mask-region", masked());
    let before = (ask("hash", Value::Null)["hash"].clone(), ask("scene.list", Value::Null));
    let mut r = Random(0xca_9ce1);
    let (mut waits, mut never): (Vec<(u64, &str)>, Vec<&str>) = Default::default();
    // `SCULPTD_METHOD`: one of the methods alone.
    let one = std::env::var("SCULPTD_METHOD").ok();
    let all = methods(dir.path(), &other).into_iter();
    for (method, mut params) in all.filter(|m| one.as_ref().is_none_or(|one| m.0 == one)) {
        let mut whole_us = 0;
        for round in 0..=rounds {
            // Undone in the first round, which tells how long it takes.
            if method == "thickness" {
                // Else the last answer is given again.
                params["limit"] = json!(0.1 + 0.1 * r.part());
            }
            let moment = whole_us * r.below(1000) / 1000;
            let (begun, asked) = (clock.now_us(), std::sync::atomic::AtomicU64::new(u64::MAX));
            let reply = std::thread::scope(|scope| {
                let asked_here = &asked;
                let working = scope.spawn(|| call(&host, method, params.clone()));
                if round > 0 {
                    let wait = std::time::Duration::from_micros(moment);
                    let _ = crossbeam_channel::never::<()>().recv_timeout(wait);
                    if call(&host, "cancel", Value::Null).expect("an answer")["cancelled"] == true {
                        asked_here.store(clock.now_us(), std::sync::atomic::Ordering::Relaxed);
                    }
                }
                working.join().expect("no panic")
            });
            let now = clock.now_us();
            whole_us = whole_us.max(if round == 0 { now - begun } else { 0 });
            match reply {
                Ok(_) => {
                    if ["load", "mask-measured"].contains(&method) {
                        ask("mask", json!({ "action": "clear" }));
                        ask("mask-region", masked());
                    } else if !["thickness", "export"].contains(&method) {
                        ask("undo", Value::Null);
                    }
                }
                Err(e) if e.message.contains("nothing of the object") => {}
                Err(e) => {
                    assert!(round > 0 && e.message.contains("cancel"), "{method}: {}", e.message);
                    let asked = asked.into_inner();
                    waits.push((now.saturating_sub(asked), method));
                }
            }
            let now = || (ask("hash", Value::Null)["hash"].clone(), ask("scene.list", Value::Null));
            if !comes(|| now() == before) {
                panic!("{method} {params}: {:#?}, and before {before:#?}", now());
            }
        }
        let of_it: Vec<u64> = waits.iter().filter(|w| w.1 == method).map(|w| w.0).collect();
        println!(
            "{method} {params}: {:.0} ms, cancelled {} times, within {:.1} ms",
            whole_us as f64 * 1e-3,
            of_it.len(),
            of_it.iter().max().copied().unwrap_or(0) as f64 * 1e-3
        );
        if long && of_it.is_empty() {
            never.push(method);
        }
    }
    waits.sort_unstable();
    let at = |share: usize| waits[(waits.len() - 1) * share / 100].0 as f64 * 1e-3;
    println!("{}: p50 {:.1} ms, p99 {:.1} ms, all {:.1} ms", waits.len(), at(50), at(99), at(100));
    assert!(one.is_some() || waits.len() > rounds * 4, "{} were cancelled", waits.len());
    assert!(never.is_empty(), "never cancelled: {never:?}");
    if long {
        assert!(at(100) <= 100.0, "{:?}", waits.last());
    }
    live.stop().expect("ends");
}

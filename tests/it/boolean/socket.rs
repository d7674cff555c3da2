//! Booleans asked for, watched and ended over the control socket, with the loop running.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use glam::DVec3;
use sculptd_clay::Clay;
use sculptd_daemon::config::{Config, LoopConfig};
use sculptd_daemon::control::{Host, Server};
use sculptd_daemon::live::Live;
use sculptd_daemon::startup;
use sculptd_devices::{Clock, queue};
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::{check, shapes};
use serde_json::{Value, json};

/// Makes one call on a separate connection and returns the answer.
fn call(socket: &Path, method: &str, params: &Value) -> Value {
    let mut out = UnixStream::connect(socket).expect("connects");
    out.set_read_timeout(Some(Duration::from_secs(120))).expect("set");
    let line = json!({ "jsonrpc": "2.0", "id": 1, "method": method, "params": params }).to_string();
    out.write_all(format!("{line}\n").as_bytes()).expect("sent");
    let mut answer = String::new();
    BufReader::new(out).read_line(&mut answer).expect("an answer");
    serde_json::from_str(&answer).expect("JSON")
}

#[test]
fn asked_watched_and_ended_over_the_socket() {
    let config =
        Config { r#loop: LoopConfig { workers: 1, ..Default::default() }, ..Default::default() };
    let mesh = Clay::build(&shapes::icosphere(1.0, 100), &Job::default()).expect("a ball");
    let (_, receiver) = queue::channel(64);
    let clock = Clock::monotonic();
    let world = startup::world(mesh, &config);
    let live =
        Live::start(world, receiver, clock.clone(), LoopConfig::default(), 64, None).expect("runs");
    let presets = sculptd::presets().clone();
    let host = Host::new(live.commands.clone(), live.published.clone(), presets);
    let dir = tempfile::tempdir().expect("a folder");
    let socket = dir.path().join("s.sock");
    let server = Server::start(&socket, host).expect("listens");
    let small = dir.path().join("small.ply");
    write_mesh(&small, &shapes::icosphere(0.1, 8).to_poly()).expect("written");
    let large = dir.path().join("large.ply");
    write_mesh(&large, &shapes::icosphere(1.0, 180).to_poly()).expect("written");

    // A cut in the pages around it, and what was written.
    let cut = call(
        &socket,
        "boolean",
        &json!({ "operation": "difference", "path": small, "at": [0, 0, 1] }),
    );
    let done = &cut["result"];
    assert_eq!(done["local"], json!(true), "{cut}");
    assert!(
        done["pages_written"].as_u64() >= Some(1) && done["pages_shared"].as_u64() > Some(50),
        "{cut}"
    );
    assert!(done["seconds"].as_f64().is_some_and(|s| s > 0.0));
    assert_eq!(
        call(&socket, "progress", &json!({}))["result"],
        json!({ "running": false, "done": null })
    );
    assert_eq!(call(&socket, "cancel", &json!({}))["result"], json!({ "cancelled": false }));

    // A long one: seen to run, ended, and the clay is as it was.
    let before = call(&socket, "hash", &json!({}));
    let revision = live.published.load().mesh.revision();
    let long = {
        let socket = socket.clone();
        std::thread::spawn(move || {
            call(
                &socket,
                "boolean",
                &json!({ "operation": "union", "path": large, "at": [0.3, 0.2, 0.1] }),
            )
        })
    };
    let never = crossbeam_channel::never::<()>();
    let running = (0..4_000).find_map(|_| {
        let _ = never.recv_timeout(Duration::from_millis(5));
        let now = call(&socket, "progress", &json!({}))["result"].clone();
        (now["running"] == json!(true)).then_some(now)
    });
    let done = running.expect("it runs")["done"].as_f64();
    assert!(done.is_some_and(|d| (0.0..1.0).contains(&d)), "{done:?}");
    // Only one at a time.
    let other = call(&socket, "boolean", &json!({ "operation": "union", "path": small }));
    assert!(other["error"]["message"].as_str().is_some_and(|m| m.contains("under way")), "{other}");
    let asked = clock.now_us();
    assert_eq!(call(&socket, "cancel", &json!({}))["result"], json!({ "cancelled": true }));
    let ended = long.join().expect("answers");
    println!("ended {:.1} ms after the wish", (clock.now_us() - asked) as f64 * 1e-3);
    // Also while it still reads its file, whose name is said then.
    let said = ended["error"]["message"].as_str();
    assert!(said.is_some_and(|m| m.ends_with("cancelled")), "{ended}");
    assert_eq!(live.published.load().mesh.revision(), revision);
    assert_eq!(call(&socket, "hash", &json!({}))["result"]["hash"], before["result"]["hash"]);

    // Impossible requests return an error.
    let nothing = json!({ "operation": "intersection", "path": small, "at": [9, 9, 9] });
    assert!(call(&socket, "boolean", &nothing)["error"]["message"].is_string());
    let trimmed = call(&socket, "trim", &json!({ "part": { "line": [0.5, 1.0, 0.5, 0.0] } }));
    assert!(trimmed["result"]["tries"].as_u64() >= Some(1), "{trimmed}");
    let nowhere = call(&socket, "trim", &json!({ "part": { "box": [0.5, 0.5, 0.5, 0.5] } }));
    assert!(
        nowhere["error"]["message"]
            .as_str()
            .is_some_and(|m| m.contains("no part") || m.contains("nothing")),
        "{nowhere}"
    );
    drop(server);
    let mesh = live.stop().expect("ends").world.mesh().to_tri().to_poly();
    let facts = check::report(&mesh, false, &Job::default()).expect("not cancelled");
    assert!(facts.closed && facts.manifold, "{facts:?}");
    let half = 0.5 * 4.0 / 3.0 * std::f64::consts::PI;
    assert!(facts.volume.is_some_and(|v| (v - half).abs() < 0.02 * half), "{facts:?}");
    assert!(mesh.positions.iter().all(|p| p.is_finite() && p.distance(DVec3::ZERO) < 1.001));
}

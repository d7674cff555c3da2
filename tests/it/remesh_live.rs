//! Remeshing while the loop runs: one closed surface, one step of undo, masks carried over.

use std::time::Duration;

use serde_json::{Value, json};

use sculptd_clay::{Clay, Workers};
use sculptd_daemon::config::LoopConfig;
use sculptd_daemon::control::Host;
use sculptd_daemon::control::handler::call;
use sculptd_daemon::live::Live;
use sculptd_devices::{Clock, queue};
use sculptd_engine::camera::Camera;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::check;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

#[test]
fn a_remesh_is_one_step_of_undo_and_carries_the_mask() {
    // Uneven triangles, half of them under a mask.
    let ball = shapes::uv_sphere(1.0, 48, 96).triangulate().0;
    let masks: Vec<f32> = ball.positions.iter().map(|p| f32::from(p.x > 0.0)).collect();
    let clay = Clay::build_masked(&ball, &masks, &Job::default()).expect("a ball");
    let options =
        WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 28, hands: Default::default() };
    let brush = sculptd::presets().of(sculptd_clay::brush::BrushKind::Draw);
    let world = World::new(clay, Camera::default(), brush, Workers::new(1), options);
    let (_factory, receiver) = queue::channel(64);
    let live = Live::start(world, receiver, Clock::monotonic(), LoopConfig::default(), 64, None);
    let live = live.expect("runs");
    let presets = sculptd::presets().clone();
    let host = Host::new(live.commands.clone(), live.published.clone(), presets);
    let ask = |method: &str, params: Value| call(&host, method, params);
    let hash = || ask("hash", Value::Null).expect("a hash")["hash"].clone();
    let before = hash();

    for wrong in [json!({ "voxel": 1.0 }), json!({ "voxel": 1e-6 })] {
        let e = ask("remesh", wrong).expect_err("refused").message;
        assert!(e.contains("expected") && e.contains("longest side"), "{e}");
    }
    let made = ask("remesh", json!({ "voxel": 0.05 })).expect("remeshed");
    let (old, new) = (made["volume_before"].as_f64(), made["volume"].as_f64());
    let share = new.expect("a volume") / old.expect("a volume");
    assert!((share - 1.0).abs() < 0.01, "the volume's share: {share}");
    let wait = || {
        let (_hold, never) = crossbeam_channel::bounded::<()>(0);
        let _ = never.recv_timeout(Duration::from_millis(10));
    };
    let patience = Clock::monotonic();
    while hash() == before {
        assert!(patience.now_us() < 30_000_000, "never in place");
        wait();
    }
    let shown = live.published.load_full();
    assert_eq!(shown.mesh.vertex_count() as u64, made["vertices"].as_u64().expect("a number"));
    let facts = check::report(&shown.mesh.to_tri().to_poly(), true, &Job::default());
    let facts = facts.expect("not cancelled");
    assert!(facts.closed && facts.self_intersections == Some(0));
    let masks = shown.mesh.masks().expect("a mask");
    let places = shown.mesh.to_tri().positions;
    for (p, mask) in places.iter().zip(&masks).filter(|(p, _)| p.x.abs() > 0.1) {
        assert_eq!(*mask, f32::from(p.x > 0.0), "at {p}");
    }
    assert_eq!(shown.undo_steps, 1);
    ask("undo", Value::Null).expect("sent");
    while hash() != before {
        assert!(patience.now_us() < 60_000_000, "never as before");
        wait();
    }
    live.stop().expect("ends");
}

//! Quads and decimation while the loop runs: one step of undo each, masks carried over, nothing
//! that crosses itself.

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

/// A loop with a ball of 5,000 vertices, its half of positive x under a mask.
struct MaskedBall {
    live: Live,
    host: Host,
    clock: Clock,
}

impl MaskedBall {
    fn new() -> MaskedBall {
        let mut ball = shapes::uv_sphere(1.0, 48, 96).triangulate().0;
        ball.colours = Some(ball.positions.iter().map(|p| colour(p.y)).collect());
        let masks: Vec<f32> = ball.positions.iter().map(|p| f32::from(p.x > 0.0)).collect();
        let clay = Clay::build_masked(&ball, &masks, &Job::default()).expect("a ball");
        let options =
            WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 28, hands: Default::default() };
        let brush = sculptd::presets().of(sculptd_clay::brush::BrushKind::Draw);
        let world = World::new(clay, Camera::default(), brush, Workers::new(1), options);
        let (_factory, receiver) = queue::channel(64);
        let live =
            Live::start(world, receiver, Clock::monotonic(), LoopConfig::default(), 64, None)
                .expect("runs");
        let presets = sculptd::presets().clone();
        let host = Host::new(live.commands.clone(), live.published.clone(), presets);
        MaskedBall { live, host, clock: Clock::monotonic() }
    }

    fn ask(&self, method: &str, params: Value) -> Value {
        call(&self.host, method, params).expect("an answer")
    }

    fn refused(&self, method: &str, params: Value) -> String {
        call(&self.host, method, params).expect_err("refused").message
    }

    fn hash(&self) -> Value {
        self.ask("hash", Value::Null)["hash"].clone()
    }

    fn wait(&self, what: &str, done: impl Fn() -> bool) {
        let begun = self.clock.now_us();
        let (_hold, never) = crossbeam_channel::bounded::<()>(0);
        while !done() {
            assert!(self.clock.now_us() - begun < 60_000_000, "never {what}");
            let _ = never.recv_timeout(Duration::from_millis(10));
        }
    }

    /// Asks for another surface; that is in place afterwards and carries mask and colours, and undo
    /// has brought the old one back.
    fn replaced(&self, method: &str, params: Value) -> Value {
        let before = self.hash();
        let made = self.ask(method, params);
        self.wait("in place", || self.hash() != before);
        let shown = self.live.published.load_full();
        assert_eq!(shown.undo_steps, 1);
        let mesh = shown.mesh.to_tri();
        assert_eq!(mesh.positions.len() as u64, made["vertices"].as_u64().expect("a number"));
        assert_eq!(mesh.triangles.len() as u64, made["triangles"].as_u64().expect("a number"));
        let facts = check::report(&mesh.to_poly(), true, &Job::default()).expect("a report");
        assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
        assert_eq!(facts.self_intersections, Some(0));
        let (old, new) = (made["volume_before"].as_f64(), made["volume"].as_f64());
        let share = new.expect("a volume") / old.expect("a volume");
        assert!((share - 1.0).abs() < 0.02, "the volume's share: {share}");
        let masks = shown.mesh.masks().expect("a mask");
        let colours = mesh.colours.as_ref().expect("colours");
        for ((p, mask), c) in mesh.positions.iter().zip(&masks).zip(colours) {
            if p.x.abs() > 0.1 {
                assert_eq!(*mask, f32::from(p.x > 0.0), "at {p}");
            }
            if p.y.abs() > 0.2 {
                assert_eq!(*c, colour(p.y), "at {p}");
            }
        }
        self.ask("undo", Value::Null);
        self.wait("as before", || self.hash() == before);
        made
    }
}

fn colour(y: f32) -> [u8; 4] {
    if y > 0.0 { [250, 20, 10, 255] } else { [10, 30, 240, 255] }
}

#[test]
fn quads_are_one_step_of_undo_and_the_base_of_levels() {
    let ball = MaskedBall::new();
    assert!(ball.refused("remesh.quads", json!({ "quads": 2 })).contains("quads = 2"));
    let wrong = json!({ "quads": 500, "creases": 200.0 });
    assert!(ball.refused("remesh.quads", wrong).contains("0 to 180"));
    let wrong = json!({ "quads": 500, "levels": 9 });
    assert!(ball.refused("remesh.quads", wrong).contains("levels"));

    let made = ball.replaced("remesh.quads", json!({ "quads": 600 }));
    let (quads, others) = (made["quads"].as_u64(), made["other_faces"].as_u64());
    let (quads, others) = (quads.expect("a number"), others.expect("a number"));
    assert!(quads.abs_diff(600) < 60 && others * 100 <= quads, "{made}");
    assert_eq!(made["triangles"].as_u64(), Some(2 * quads + others));

    let fine = ball.replaced("remesh.quads", json!({ "quads": 600, "levels": 2 }));
    assert_eq!(fine["triangles"].as_u64(), Some(16 * (2 * quads + others)));
    assert_eq!(fine["without_detail"], json!(0));

    // The levels are there: down and up again.
    let before = ball.hash();
    ball.ask("remesh.quads", json!({ "quads": 600, "levels": 2 }));
    ball.wait("in place", || ball.hash() != before);
    let shown = ball.live.published.load_full();
    let mesh = shown.mesh.to_tri();
    let off = mesh.positions.iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f32::max);
    assert!(off < 0.003, "the detail is back to the facets of the old surface: {off}");
    let reply = ball.ask("level", json!({ "to": "down" }));
    assert_eq!((&reply["level"], &reply["levels"]), (&json!(1), &json!(3)));
    ball.live.stop().expect("ends");
}

#[test]
fn an_export_of_quads_holds_quads() {
    let ball = MaskedBall::new();
    let before = ball.hash();
    let made = ball.ask("remesh.quads", json!({ "quads": 400 }));
    ball.wait("in place", || ball.hash() != before);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("quads.obj");
    ball.ask("export", json!({ "path": path }));
    let text = std::fs::read_to_string(&path).expect("a file");
    let corners = |l: &str| l.split_whitespace().count() - 1;
    let quads = text.lines().filter(|l| l.starts_with("f ") && corners(l) == 4).count();
    assert_eq!(Some(quads as u64), made["quads"].as_u64());
    ball.live.stop().expect("ends");
}

#[test]
fn a_decimation_is_one_step_of_undo_and_keeps_the_border_of_the_mask() {
    let ball = MaskedBall::new();
    assert!(ball.refused("decimate", json!({ "triangles": 2 })).contains("at least 4"));
    assert!(ball.refused("decimate", json!({ "max_error": -1.0 })).contains("max_error"));
    let made = ball.replaced("decimate", json!({ "triangles": 2000 }));
    assert!(made["triangles"].as_u64().expect("a number") <= 2000, "{made}");
    assert_eq!(made["new_self_intersections"], json!(0));
    let made = ball.replaced("decimate", json!({ "max_error": 0.001 }));
    assert!(made["triangles"].as_u64() < made["triangles_before"].as_u64(), "{made}");
    ball.live.stop().expect("ends");
}

#[test]
fn one_side_becomes_the_mirror_image_of_the_other() {
    let ball = MaskedBall::new();
    for axis in ["y", "z"] {
        let wrong = json!({ "axis": axis, "side": 1 });
        ball.refused("symmetrise", wrong);
    }
    ball.replaced("symmetrise", json!({ "axis": "z" }));
    // A hollow on the side that has no mask, which is then on both.
    let tool = shapes::icosphere(0.4, 12);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("tool.stl");
    sculptd_geometry::io::write_mesh(&file, &tool.to_poly()).expect("written");
    let params = json!({ "path": file, "operation": "difference", "at": [-0.9, 0.3, 0.2] });
    ball.ask("boolean", params);
    ball.wait("carved", || ball.live.published.load().undo_steps == 1);
    let carved = ball.hash();
    let crossings = || {
        let mesh = ball.live.published.load().mesh.to_tri().to_poly();
        let facts = check::report(&mesh, true, &Job::default()).expect("a report");
        assert!(facts.closed && facts.manifold, "{facts:?}");
        facts.self_intersections.expect("counted")
    };
    // The rim of the hollow, rounded to single precision.
    let before = crossings();
    let made = ball.ask("symmetrise", json!({ "axis": "x", "negative": true }));
    ball.wait("in place", || ball.hash() != carved);
    let shown = ball.live.published.load_full();
    let (middle, mesh) = (shown.middle.x, shown.mesh.to_tri());
    let solid = sculptd_geometry::distance::DistanceSolid::build(&mesh, &Job::default());
    let solid = solid.expect("a solid");
    let hollows = [-0.9f32, 0.9].map(|x| glam::DVec3::new(f64::from(x + middle), 0.3, 0.2));
    assert!(hollows.iter().all(|p| solid.signed_distance(*p) > 0.1), "hollow on both sides");
    for p in &mesh.positions {
        let twin = glam::DVec3::new(f64::from(2.0 * middle - p.x), p.y.into(), p.z.into());
        let off = solid.signed_distance(twin).abs();
        assert!(off < 1e-5, "the mirror image of {p} is {off} off");
    }
    let masks = shown.mesh.masks().unwrap_or_default();
    let beside = |p: &glam::Vec3| (p.x - middle).abs() > 0.1;
    assert!(mesh.positions.iter().zip(&masks).all(|(p, m)| !beside(p) || *m == 0.0));
    println!("{before} crossings before, {} after", crossings());
    assert!(crossings() <= 2 * before, "{before} before, {} after", crossings());
    assert_eq!(made["self_intersections"], crossings());
    assert_eq!(made["triangles"].as_u64(), Some(mesh.triangles.len() as u64));
    ball.ask("undo", Value::Null);
    ball.wait("as before", || ball.hash() == carved);
}

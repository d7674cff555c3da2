//! Golden runs: real recordings on real meshes, and the demo's journal on the ball. The facts are
//! readable and show how a stroke changed. The hash is the same on every machine and with any
//! number of workers.
//!
//! `SCULPTD_BLESS=1` rewrites the facts: look at the difference before you keep it.

use std::path::{Path, PathBuf};

use sculptd_daemon::config::Config;
use sculptd_daemon::simulated_loop::{Feed, Pace, SimulatedLoop, SimulatedOptions};
use sculptd_daemon::startup;
use sculptd_daemon::startup::RecordingFeed;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::recording::Player;
use sculptd_devices::{Clock, DeviceId, queue};
use sculptd_engine::world::World;
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;
use serde::{Deserialize, Serialize};

use crate::corpus;

/// Summary of a run for people.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Facts {
    what: String,
    samples: u64,
    dabs: u64,
    /// Vertices that are not where they were.
    displaced: u64,
    /// The longest way, as a share of the work's bounding radius.
    longest_percent: f64,
    /// Change of the enclosed volume.
    volume_percent: f64,
    /// Box around the displaced vertices, in per cent of the work's own box.
    from_percent: [f64; 3],
    to_percent: [f64; 3],
    undo_steps: usize,
    /// The same with 1, 2, 3, 7 and 16 workers; told, and not held across machines.
    hash: String,
}

fn volume(mesh: &TriMesh) -> f64 {
    let corner = |v: u32| mesh.positions[v as usize].as_dvec3();
    mesh.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2])))).sum::<f64>()
        / 6.0
}

/// Plays a recording on a mesh with so many workers.
fn play(recording: &Path, mesh: &Path, workers: usize) -> (TriMesh, World, u64, u64) {
    let mut config = Config::default();
    config.r#loop.workers = workers;
    let loaded = startup::load(Some(mesh), &Job::default()).expect("a mesh");
    let catalogue = Catalogue::builtin().expect("the embedded tablets are valid");
    let open = || Player::open(recording, DeviceId(0), &catalogue).expect("a recording");
    let area = startup::used_area(open(), config.camera.aspect);
    let (factory, mut receiver) = queue::channel(config.channel.capacity);
    let mut feeds: Vec<Box<dyn Feed>> =
        vec![Box::new(RecordingFeed::new(open(), factory.sender(), area))];
    let mut world = startup::world(loaded.mesh, &config);
    let options = SimulatedOptions {
        rate_hz: config.r#loop.rate_hz,
        pace: Pace::Fast,
        max_ticks: None,
        drain_per_tick: config.channel.drain_per_tick,
        verify: false,
    };
    let stepped = SimulatedLoop {
        world: &mut world,
        feeds: &mut feeds,
        receiver: &mut receiver,
        clock: &Clock::manual(),
        journal: None,
        observer: &mut |_, _, _| {},
        script: &[],
    };
    let figures = stepped.run(&options).expect("the run ends");
    world.verify_invariants().expect("all is in order");
    let count = receiver.stats().total();
    assert_eq!(
        count.sent,
        count.received + count.coalesced + count.lost_motion + count.lost_transition
    );
    assert_eq!(count.lost_transition, 0);
    (loaded.plain, world, figures.samples, figures.dabs)
}

fn facts(what: &str, recording: &Path, mesh: &Path) -> Facts {
    let (start, world, samples, dabs) = play(recording, mesh, 1);
    let hash = world.hash();
    for workers in [2, 3, 7, 16] {
        assert_eq!(play(recording, mesh, workers).1.hash(), hash, "with {workers} workers");
    }
    let end = world.mesh().to_tri();
    let (lo, hi) = start.bounds();
    let share = |p: glam::Vec3| {
        ((p - lo) / (hi - lo)).to_array().map(|c| (f64::from(c) * 1000.0).round() / 10.0)
    };
    let moved: Vec<usize> =
        (0..start.positions.len()).filter(|&i| start.positions[i] != end.positions[i]).collect();
    let none = (glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY);
    let (from, to) = moved
        .iter()
        .fold(none, |(a, b), &i| (a.min(start.positions[i]), b.max(start.positions[i])));
    let longest =
        moved.iter().map(|&i| (start.positions[i] - end.positions[i]).length()).fold(0.0, f32::max);
    let percent = |v: f64| (v * 1e4).round() / 100.0;
    Facts {
        what: what.into(),
        samples,
        dabs,
        displaced: moved.len() as u64,
        longest_percent: percent(f64::from(longest / ((hi - lo).length() * 0.5))),
        volume_percent: percent(volume(&end) / volume(&start) - 1.0),
        from_percent: share(from),
        to_percent: share(to),
        undo_steps: world.mesh().undo_steps(),
        hash: format!("{hash:016x}"),
    }
}

fn near(name: &str, a: f64, b: f64, tolerance: f64) {
    assert!(
        (a - b).abs() <= tolerance,
        "{name}: {a} now, {b} in the golden facts (within {tolerance})"
    );
}

fn hold(name: &str, now: &Facts) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden")
        .join(name)
        .join("facts.toml");
    if std::env::var_os("SCULPTD_BLESS").is_some() {
        let text = toml::to_string(now).expect("facts are plain");
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        #[allow(clippy::disallowed_methods)] // Under version control: a torn file is seen.
        std::fs::write(&path, text).expect("written");
        return;
    }
    let text = std::fs::read_to_string(&path).expect("golden facts");
    let then: Facts = toml::from_str(&text).expect("golden facts parse");
    println!("{name}: {}\n  hash {} now, {} when it was written", now.what, now.hash, then.hash);
    assert_eq!((now.samples, now.undo_steps), (then.samples, then.undo_steps));
    near("dabs", now.dabs as f64, then.dabs as f64, 2.0 + then.dabs as f64 * 0.02);
    near(
        "displaced",
        now.displaced as f64,
        then.displaced as f64,
        20.0 + then.displaced as f64 * 0.02,
    );
    near("longest", now.longest_percent, then.longest_percent, 0.5);
    near("volume", now.volume_percent, then.volume_percent, 0.2);
    for axis in 0..3 {
        near("from", now.from_percent[axis], then.from_percent[axis], 2.0);
        near("to", now.to_percent[axis], then.to_percent[axis], 2.0);
    }
    // The facts come first, because they say what became different.
    assert_eq!(now.hash, then.hash, "{name}: the same facts within tolerance, but other bits");
}

#[test]
fn a_real_tablet_on_a_real_mesh() {
    let Some(corpus) = corpus() else { return };
    let recording = corpus.join("devices/open/hid/Wacom_Intuos4_4x6_056a_00B8.hid");
    let now = facts(
        "a Wacom PTK-440 draws on the armadillo",
        &recording,
        &corpus.join("meshes/igl_armadillo.obj"),
    );
    assert!(now.displaced > 0 && now.dabs > 0);
    hold("tablet-on-armadillo", &now);
}

#[test]
fn a_second_maker_s_tablet_on_a_scanned_part() {
    let Some(corpus) = corpus() else { return };
    let recording = corpus.join("devices/open/hid/DIGImend_UC-Logic_TWHL850.hid");
    let now = facts(
        "a UC-Logic TWHL850 draws on a rocker arm",
        &recording,
        &corpus.join("meshes/ajc_rocker-arm.obj"),
    );
    assert!(now.displaced > 0 && now.dabs > 0);
    hold("uclogic-on-rocker-arm", &now);
}

#[test]
fn a_real_hand_on_a_real_mesh() {
    let Some(corpus) = corpus() else { return };
    let recording = corpus.join("devices/open/leap/pinch.jsonl.gz");
    let now =
        facts("a hand pinches at the bunny", &recording, &corpus.join("meshes/mlab_bunny70k.ply"));
    assert!(now.displaced > 0 && now.dabs > 0);
    hold("hand-on-bunny", &now);
}

//! The history in the session file: undo beyond memory and beyond a restart, branches, jumps,
//! checkpoints that follow what moved. Every world here is compared, to the bit, with the one that
//! a replay from the start gives.

mod bound;
mod moved;
mod random;
mod scene;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::waiting::{comes, pause};
use crossbeam_channel as cc;
use glam::Vec2;
use sculptd_clay::brush::Measure;
use sculptd_clay::{Clay, Workers};
use sculptd_daemon::command_queue::{QueuedCommand, command_queue};
use sculptd_daemon::config::Config;
use sculptd_daemon::session;
use sculptd_daemon::session::format::Settings;
use sculptd_daemon::session::history::{Handle, Keeper, Want, listing};
use sculptd_daemon::session::reopen;
use sculptd_daemon::session::writer::WriterThread;
use sculptd_daemon::session::{SessionWriter, replay};
use sculptd_daemon::startup;
use sculptd_daemon::startup::Begun;
use sculptd_daemon::tick::Journal;
use sculptd_devices::{Body, Clock, DeviceId, Pen, Sample};
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

fn pen(tick: u64, at: Vec2, tip: bool) -> Sample {
    let area_mm = Vec2::new(160.0, 100.0);
    let pen = Pen {
        in_range: true,
        tip,
        pos_mm: area_mm * (Vec2::splat(0.5) + at),
        area_mm,
        pressure: Some(0.7),
        ..Pen::default()
    };
    Sample { device: DeviceId(1), t_us: tick * 8333, device_t_us: None, body: Body::Pen(pen) }
}

/// A session under way, with its history.
struct Studio {
    path: PathBuf,
    world: World,
    writer: Option<SessionWriter>,
    thread: Option<WriterThread>,
    history: Handle,
    jumps: cc::Receiver<QueuedCommand>,
    /// Time of the tick thread to hand over each tick, in ns. The maximum may include another
    /// thread's time on the processor.
    handed: Vec<u64>,
    clock: Clock,
}

impl Studio {
    fn begin(dir: &Path, vertices: usize, undo_bytes: u64) -> Studio {
        Studio::bounded(dir, vertices, undo_bytes, 1 << 40)
    }

    /// `most`: bytes of the history in the file.
    fn bounded(dir: &Path, vertices: usize, undo_bytes: u64, most: u64) -> Studio {
        let c = Config::default();
        let settings = Settings {
            rate_hz: 120,
            dab_budget: c.r#loop.dab_budget,
            undo_bytes,
            camera: c.camera.camera(),
            brush: c.brush,
            hands: c.hand,
        };
        let start = shapes::sphere_of_about(vertices);
        let path = dir.join("s.sculpt");
        let (mut writer, mut thread) = session::create(&path, &start, &settings).expect("created");
        let mesh = Clay::build(&start, &Job::default()).expect("a ball");
        let options =
            WorldOptions { dab_budget: settings.dab_budget, undo_bytes, hands: settings.hands };
        let mut world = World::new(mesh, settings.camera, settings.brush, Workers::new(1), options);
        let keeper = Keeper::start(path.as_path(), &mut world, 0, None, most).expect("a history");
        writer.keep(keeper.handle.clone());
        thread.history = Some(keeper);
        Studio::of(
            path,
            Begun { world, journal: Some((writer, thread)), warnings: vec![], started_with: None },
        )
    }

    fn of(path: PathBuf, begun: Begun) -> Studio {
        let (writer, thread) = begun.journal.expect("a session");
        let history = thread.history.as_ref().expect("a history").handle.clone();
        let (commands, jumps) = command_queue(64);
        history.connect(commands);
        let (world, writer, clock) = (begun.world, Some(writer), Clock::monotonic());
        let thread = Some(thread);
        Studio { path, world, writer, thread, history, jumps, handed: Vec::new(), clock }
    }

    /// Restarts from the file.
    fn reopened(path: &Path) -> Studio {
        let begun =
            startup::begin(None, Some(path), &Config::default(), &Job::default()).expect("opens");
        // A file that was cut off or copied says that its session was still open.
        let mut said = begun.warnings.clone();
        said.retain(|text| !text.contains("the session was still open"));
        assert_eq!(said, Vec::<String>::new());
        Studio::of(path.into(), begun)
    }

    fn tick(&mut self, samples: &[Sample], commands: &[Command]) {
        let tick = self.world.tick() + 1;
        let mut all = commands.to_vec();
        all.extend(self.jumps.try_iter().map(|jump| jump.deliver(&mut self.world)));
        self.world.step(tick, samples, &all);
        self.world.verify_invariants().expect("sound");
        if let Some(writer) = &mut self.writer {
            let before = self.clock.now_ns();
            writer.tick(tick, samples, &all, &mut self.world);
            self.handed.push(self.clock.now_ns() - before);
        }
    }

    /// A short stroke; the world's hash after it.
    fn stroke(&mut self, at: Vec2) -> u64 {
        for k in 0..6u64 {
            let tick = self.world.tick() + 1;
            self.tick(&[pen(tick, at + Vec2::new(0.004 * k as f32, 0.0), k < 5)], &[]);
        }
        self.tick(&[], &[]);
        // Carried-over dynamic topology belongs to the stroke.
        while self.world.report().paused {
            self.tick(&[], &[]);
        }
        self.world.hash()
    }

    /// Ticks until the work is as it was then.
    fn becomes(&mut self, hash: u64) {
        let became = comes(|| {
            if self.world.hash() != hash {
                self.tick(&[], &[]);
            }
            self.world.hash() == hash
        });
        assert!(became, "never became {hash:016x}; history: {:?}", self.history.trouble());
        // The history has seen it too.
        self.settle();
    }

    /// Until the history has written all that was done.
    fn settle(&mut self) {
        let idle = comes(|| self.history.is_idle());
        assert!(idle, "the history is behind: {:?}", self.history.trouble());
    }

    fn end(mut self) -> PathBuf {
        self.writer = None;
        assert_eq!(self.thread.take().and_then(WriterThread::finish), None);
        self.path
    }
}

/// The hash that a replay from the start gives, and the one of opening at the newest checkpoint.
fn both_ways(path: &Path) -> (u64, u64) {
    let opened = session::open(path).expect("opens");
    assert_eq!(opened.loss, None);
    let replayed =
        replay::replay(&opened, None, Workers::new(2), &Job::default()).expect("replays");
    assert_eq!(replayed.jumps_missed, 0);
    let quick = reopen(path, &opened, None, 1, &Job::default()).expect("a checkpoint");
    assert_eq!(quick.replayed.ticks, replayed.ticks);
    (replayed.world.hash(), quick.replayed.world.hash())
}

/// Four strokes, and the hashes before them and after each. One byte of memory: every step is
/// forgotten at once, and all undo comes from the file.
fn four_forgotten_strokes(dir: &Path) -> (Studio, Vec<u64>) {
    let mut s = Studio::begin(dir, 3000, 1);
    let mut hashes = vec![s.world.hash()];
    for k in 0..4 {
        hashes.push(s.stroke(Vec2::new(-0.1 + 0.06 * k as f32, 0.05)));
    }
    s.settle();
    (s, hashes)
}

#[test]
fn undo_goes_back_beyond_memory_and_a_restart_and_branches_stay() {
    let dir = tempfile::tempdir().expect("a folder");
    let (mut s, hashes) = four_forgotten_strokes(dir.path());
    assert_eq!(s.world.undo_steps(), 0);
    for k in [3, 2] {
        s.tick(&[], &[Command::Undo]);
        s.becomes(hashes[k]);
    }
    s.tick(&[], &[Command::Redo]);
    s.becomes(hashes[3]);
    s.tick(&[], &[Command::Undo]);
    s.becomes(hashes[2]);
    // A branch beside the third stroke.
    let branch = s.stroke(Vec2::new(0.0, -0.1));
    s.settle();
    let places = listing::places(&s.history.tree());
    assert_eq!(places.len(), 6);
    let here = places.iter().find(|p| p.here).expect("here").node;
    assert_eq!(places.iter().filter(|p| p.branch).count(), 2);
    // To the end of the branch that was left, and back.
    s.history.want(Want::Node(4));
    s.becomes(hashes[4]);
    s.history.want(Want::Node(here));
    s.becomes(branch);
    assert!(s.history.thumbnail(here).is_some_and(|png| png.starts_with(b"\x89PNG")));
    let path = s.end();
    assert_eq!(both_ways(&path), (branch, branch));

    let mut s = Studio::reopened(&path);
    assert_eq!(s.world.hash(), branch);
    for k in [2, 1, 0] {
        s.tick(&[], &[Command::Undo]);
        s.becomes(hashes[k]);
    }
    s.tick(&[], &[Command::Undo]);
    s.tick(&[], &[]);
    assert_eq!(s.world.hash(), hashes[0], "nothing before the beginning");
    s.history.want(Want::Node(4));
    s.becomes(hashes[4]);
    let path = s.end();
    assert_eq!(both_ways(&path), (hashes[4], hashes[4]));
    assert_eq!(listing::read(&path).expect("reads").places.len(), 6);
}

#[test]
fn undos_of_one_tick_each_go_back_a_step_beyond_memory() {
    let dir = tempfile::tempdir().expect("a folder");
    let (mut s, hashes) = four_forgotten_strokes(dir.path());
    s.tick(&[], &[Command::Undo, Command::Undo, Command::Undo]);
    s.becomes(hashes[1]);
    s.tick(&[], &[Command::Redo, Command::Redo]);
    s.becomes(hashes[3]);
    s.end();
}

#[test]
fn steps_in_memory_and_steps_in_the_file_are_one_history() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1 << 28);
    let mut hashes = vec![s.world.hash()];
    for k in 0..3 {
        hashes.push(s.stroke(Vec2::new(-0.1 + 0.06 * k as f32, 0.0)));
    }
    // Out of memory, two in one tick.
    s.tick(&[], &[Command::Undo, Command::Undo]);
    assert_eq!(s.world.hash(), hashes[1]);
    s.settle();
    assert_eq!(s.history.tree().len(), 4, "going back makes no place");
    let path = s.end();
    assert_eq!(both_ways(&path).0, hashes[1]);
    // Beyond the restart, forth again too.
    let mut s = Studio::reopened(&path);
    s.tick(&[], &[Command::Redo]);
    s.becomes(hashes[2]);
    s.tick(&[], &[Command::Redo]);
    s.becomes(hashes[3]);
    s.tick(&[], &[Command::Undo]);
    s.becomes(hashes[2]);
    // A step in memory on top, undone from memory, and on into the file.
    let top = s.stroke(Vec2::new(0.05, 0.1));
    assert_eq!(s.world.undo_steps(), 1);
    s.tick(&[], &[Command::Undo, Command::Undo]);
    s.becomes(hashes[1]);
    assert_ne!(top, hashes[3]);
    let path = s.end();
    assert_eq!(both_ways(&path), (hashes[1], hashes[1]));
}

#[test]
fn cut_triangles_and_other_works_come_back_from_the_file() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1);
    let mut brush = *s.world.brush();
    brush.topology.by = Measure::Brush;
    brush.topology.edge = 0.08;
    s.tick(&[], &[Command::Brush(brush)]);
    let mut hashes = vec![s.world.hash()];
    let before = s.world.mesh().vertex_count();
    hashes.push(s.stroke(Vec2::new(0.0, 0.0)));
    hashes.push(s.stroke(Vec2::new(0.05, 0.05)));
    assert!(s.world.mesh().vertex_count() > before, "nothing was cut");
    let other = Arc::new(shapes::sphere_of_about(900));
    s.tick(&[], &[Command::Replace(NewClay::new(other, true))]);
    hashes.push(s.world.hash());
    hashes.push(s.stroke(Vec2::new(0.0, 0.05)));
    s.settle();
    let path = s.end();
    assert_eq!(both_ways(&path), (hashes[4], hashes[4]));

    let mut s = Studio::reopened(&path);
    for k in [3, 2, 1, 0] {
        s.tick(&[], &[Command::Undo]);
        s.becomes(hashes[k]);
    }
    for k in [1, 2, 3, 4] {
        s.tick(&[], &[Command::Redo]);
        s.becomes(hashes[k]);
    }
    s.history.want(Want::Node(1));
    s.becomes(hashes[1]);
    // And it can be worked on.
    let last = s.stroke(Vec2::new(-0.05, 0.0));
    let path = s.end();
    assert_eq!(both_ways(&path), (last, last));
}

#[test]
fn pages_that_a_step_added_go_and_come_back_with_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1 << 28);
    let mut brush = *s.world.brush();
    brush.topology.by = Measure::Brush;
    brush.topology.edge = 0.03;
    s.tick(&[], &[Command::Brush(brush)]);
    let (first, pages) = (s.world.hash(), s.world.mesh().page_count());
    let second = s.stroke(Vec2::ZERO);
    assert!(s.world.mesh().page_count() > pages, "no page was added");
    for hash in [first, second, first] {
        let back = hash == first;
        s.tick(&[], &[if back { Command::Undo } else { Command::Redo }]);
        assert_eq!(s.world.hash(), hash);
        s.settle();
        assert_eq!(s.history.tree().len(), 2, "going to and fro makes no place");
    }
    let path = s.end();
    assert_eq!(both_ways(&path), (first, first));
    let mut s = Studio::reopened(&path);
    s.tick(&[], &[Command::Redo]);
    s.becomes(second);
    let path = s.end();
    assert_eq!(both_ways(&path), (second, second));
}

#[test]
fn a_session_cut_off_anywhere_opens_as_its_replay() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 1500, 1 << 20);
    let copy = dir.path().join("c.sculpt");
    let mut served = 0;
    for k in 0..24u64 {
        let at = Vec2::new(-0.1 + 0.008 * k as f32, 0.01 * (k % 5) as f32);
        if k % 4 == 3 {
            s.tick(&[], &[Command::Undo]);
        }
        for i in 0..5u64 {
            let tick = s.world.tick() + 1;
            s.tick(&[pen(tick, at, i < 3)], &[]);
            pause(i * k % 7);
        }
        // As a kill leaves it: the files as they are.
        for ending in ["", "-wal"] {
            let from = format!("{}{ending}", s.path.display());
            let _ = std::fs::copy(&from, format!("{}{ending}", copy.display()));
        }
        let _ = std::fs::remove_file(format!("{}-shm", copy.display()));
        let Ok(opened) = session::open(&copy) else { continue };
        let whole =
            replay::replay(&opened, None, Workers::new(1), &Job::default()).expect("replays");
        if let Some(quick) = reopen(&copy, &opened, None, 1, &Job::default()) {
            served += 1;
            assert_eq!(quick.replayed.world.hash(), whole.world.hash(), "at {k}");
            assert_eq!(quick.replayed.ticks, whole.ticks);
        }
        // And it continues: a stroke, undone by the file's history.
        let now = whole.world.hash();
        let mut again = Studio::reopened(&copy);
        let lifted = again.world.hash();
        assert!(lifted == now || whole.world.mesh().is_in_step(), "at {k}");
        again.stroke(Vec2::new(0.1, 0.1));
        again.tick(&[], &[Command::Undo]);
        again.becomes(lifted);
        let path = again.end();
        assert_eq!(both_ways(&path), (lifted, lifted), "at {k}");
    }
    assert!(served >= 18, "a checkpoint served {served} of 24 times");
    s.end();
}

#[test]
fn a_checkpoint_costs_what_moved() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let sizes: &[usize] = if long { &[40_000, 1_000_000] } else { &[10_000, 80_000] };
    let mut a_stroke = Vec::new();
    for &vertices in sizes {
        let dir = tempfile::tempdir().expect("a folder");
        let mut s = Studio::begin(dir.path(), vertices, 1 << 28);
        let mut brush = *s.world.brush();
        // As many vertices under the brush, however fine the work is.
        brush.radius = 8.0 / (vertices as f32).sqrt();
        s.tick(&[], &[Command::Brush(brush)]);
        let strokes = 8;
        for k in 0..strokes {
            s.stroke(Vec2::new(-0.04 + 0.01 * k as f32, 0.0));
        }
        s.settle();
        s.handed.sort_unstable();
        let (half, most) = (s.handed[s.handed.len() / 2], *s.handed.last().expect("ticks"));
        println!(
            "handing a tick over takes {:.1} us, {:.1} us at most",
            half as f64 / 1e3,
            most as f64 / 1e3
        );
        let pages = s.world.mesh().page_count();
        let whole = s.world.mesh().memory().pages;
        let path = s.end();
        let found = listing::read(&path).expect("reads");
        let changed: usize = found.places.iter().map(|p| p.changed).sum();
        println!(
            "{vertices} vertices, {pages} pages, {} KiB: a stroke changes {:.1} pages and adds \
                {:.0} KiB",
            whole / 1024,
            changed as f64 / strokes as f64,
            found.bytes as f64 / 1024.0 / strokes as f64
        );
        a_stroke.push(found.bytes as f64 / strokes as f64);
        // The first touch of a page keeps it as it was, too.
        assert!(found.bytes < 2 * (changed as u64) * 40_000);
    }
    let ratio = a_stroke[1] / a_stroke[0];
    assert!(ratio < 2.5, "{}-fold work, {ratio:.2}-fold bytes", sizes[1] / sizes[0]);
}

#[test]
fn a_session_becomes_a_film_at_even_steps_of_time() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1 << 26);
    for k in 0..6 {
        s.stroke(Vec2::new(-0.1 + 0.04 * k as f32, 0.0));
    }
    let ticks = s.world.tick();
    let path = s.end();
    let frames = dir.path().join("film");
    let out = std::process::Command::new(env!("CARGO_BIN_EXE_sculptd"))
        .arg("replay")
        .arg(&path)
        .arg("--frames")
        .arg(&frames)
        .args(["--every", "0.1", "--json"])
        .output()
        .expect("runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let said: serde_json::Value = serde_json::from_slice(&out.stdout).expect("one object");
    // Twelve ticks a picture, the first of the beginning; after the last input nothing is replayed.
    let count = said["frames"].as_u64().expect("a number");
    assert!(
        count == said["ticks"].as_u64().expect("ticks") / 12 + 1 && count >= ticks / 12,
        "{said}"
    );
    let picture = |n: u64| {
        let bytes = std::fs::read(frames.join(format!("frame-{n:05}.png"))).expect("a frame");
        image::load_from_memory(&bytes).expect("a PNG").to_rgb8()
    };
    let (first, last) = (picture(0), picture(count - 1));
    assert_eq!(first.dimensions(), (1280, 720));
    assert_eq!(std::fs::read_dir(&frames).expect("listed").count() as u64, count);
    let changed = first.pixels().zip(last.pixels()).filter(|(a, b)| a != b).count();
    assert!((500..400_000).contains(&changed), "{changed} pixels changed");
}

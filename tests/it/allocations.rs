//! Allocations and frees of one thread, counted.
//!
//! The law: in the steady state of a stroke the tick thread neither allocates nor frees.
//!
//! Each test runs in a separate process: rayon's queues reclaim memory for the whole process, so
//! that a thread which takes work from another one's queue may free what other tests retired.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::process;
use std::sync::atomic::{AtomicI64, Ordering::Relaxed};
use std::sync::mpsc;
use std::time::Duration;

use glam::{Vec2, Vec3};
use sculptd_clay::brush::{BrushKind, BrushSettings, GaussianBrush, Measure, SmoothBrush};
use sculptd_clay::{Clay, Reach, Snapshot, Workers};
use sculptd_daemon::garbage_thread::GarbageThread;
use sculptd_daemon::page_thread::PageThread;
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

struct Counting;

/// Bytes that the whole process holds.
static LIVE: AtomicI64 = AtomicI64::new(0);

thread_local! {
    static COUNTED: Cell<bool> = const { Cell::new(false) };
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

fn note() {
    if COUNTED.get() {
        CALLS.set(CALLS.get() + 1);
    }
}

// SAFETY: everything is handed on to the system's allocator unchanged.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        LIVE.fetch_add(layout.size() as i64, Relaxed);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        note();
        LIVE.fetch_sub(layout.size() as i64, Relaxed);
        unsafe { System.dealloc(at, layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        LIVE.fetch_add(size as i64 - layout.size() as i64, Relaxed);
        unsafe { System.realloc(at, layout, size) }
    }
}

/// Calls of the allocator that this thread makes in `work`.
pub(crate) fn counted(work: impl FnOnce()) -> u64 {
    let before = CALLS.get();
    COUNTED.set(true);
    work();
    COUNTED.set(false);
    CALLS.get() - before
}

/// Bytes that this process holds now, by the allocator's own count.
pub(crate) fn live_bytes() -> i64 {
    LIVE.load(Relaxed)
}

/// Runs the test of this name in a separate process, where no other thread allocates. Returns false
/// in that process, and true here once the test has passed there.
pub(crate) fn passed_alone(name: &str) -> bool {
    const ALONE: &str = "SCULPTD_TEST_ALONE";
    if std::env::var_os(ALONE).is_some() {
        return false;
    }
    let me = std::env::current_exe().expect("this binary");
    let out = process::Command::new(me)
        .args(["--exact", name, "--nocapture", "--test-threads=1"])
        .env(ALONE, "1")
        .output()
        .expect("it runs");
    println!("{}", String::from_utf8_lossy(&out.stdout));
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{said}");
    assert!(String::from_utf8_lossy(&out.stdout).contains("1 passed"), "no test is called {name}");
    true
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn a_stroke_in_its_steady_state_neither_allocates_nor_frees() {
    if passed_alone("allocations::a_stroke_in_its_steady_state_neither_allocates_nor_frees") {
        return;
    }
    let mut mesh = Clay::build(&shapes::sphere_of_about(200_000), &Job::default()).expect("builds");
    let workers = Workers::new(2);
    workers.warm();
    mesh.begin_step();
    let mut shown = None;
    for round in 0..6 {
        // The first rounds touch each page once and fill the pools; the later ones go over the same
        // ground.
        let steady = round >= 3;
        CALLS.set(0);
        for i in 0..60 {
            let turn = i as f32 * 0.02;
            let at = Vec3::new(turn.cos(), turn.sin(), 0.0);
            let reach = Reach::Sphere { centre: at, radius: 0.3 };
            COUNTED.set(true);
            if i % 2 == 0 {
                mesh.dab(&reach, &GaussianBrush::new(at, 0.3, at, 1e-4), &workers);
            } else {
                mesh.dab(&reach, &SmoothBrush::new(at, 0.3, 0.1), &workers);
            }
            shown.replace(mesh.snapshot());
            COUNTED.set(false);
        }
        if steady {
            assert_eq!(CALLS.get(), 0, "allocations and frees in round {round}");
        }
    }
    mesh.end_step();
}

/// A pen on a ball, with dynamic topology and what the daemon gives the tick thread.
struct TopologyStroke {
    world: World,
    brush: BrushSettings,
    supply: PageThread,
    tick: u64,
    shown: Option<Snapshot>,
}

impl TopologyStroke {
    fn new(radius: f32) -> TopologyStroke {
        let clay = Clay::build(&shapes::sphere_of_about(160_000), &Job::default()).expect("builds");
        let mut brush = BrushSettings { radius, ..sculptd::presets().of(BrushKind::Clay) };
        brush.topology.by = Measure::Brush;
        let options = WorldOptions {
            dab_budget: 400_000,
            undo_bytes: 1 << 30,
            hands: HandSettings::default(),
        };
        let camera = Camera { yaw: 0.0, pitch: 0.0, ..Camera::default() };
        let mut world = World::new(clay, camera, brush, Workers::new(2), options);
        world.warm();
        world.set_garbage_sink(GarbageThread::start().expect("a thread").sink());
        let supply = PageThread::start().expect("a thread");
        world.set_page_supply(supply.supply());
        TopologyStroke { world, brush, supply, tick: 0, shown: None }
    }

    /// Lifts the pen, for a stroke keeps its brush, and sets the next one.
    fn set_brush(&mut self) {
        let commands = [Command::LiftAll, Command::Brush(self.brush)];
        self.tick += 1;
        self.world.step(self.tick, &[], &commands);
    }

    /// A loaded machine must not make the thread that makes pages late.
    fn wait_for_pages(&self) {
        let (_silent, never) = mpsc::channel::<()>();
        for _ in 0..60_000 {
            if self.supply.ready() >= 64 {
                break;
            }
            let _ = never.recv_timeout(Duration::from_millis(1));
        }
    }

    /// One tick with the pen at this angle and distance from the middle of the view; the calls.
    fn draw(&mut self, turn: f32, far: f32) -> u64 {
        let area_mm = Vec2::new(self.world.camera().aspect, 1.0) * 100.0;
        let at = Vec2::splat(0.5) + Vec2::new(turn.cos(), turn.sin()) * far;
        self.tick += 1;
        let pen = Pen {
            in_range: true,
            tip: true,
            pos_mm: at * area_mm,
            area_mm,
            pressure: Some(0.5),
            ..Pen::default()
        };
        let (t_us, body) = (self.tick * 8000, Body::Pen(pen));
        let sample = Sample { device: DeviceId(1), t_us, device_t_us: None, body };
        counted(|| {
            self.world.step(self.tick, &[sample], &[]);
            self.shown.replace(self.world.snapshot());
        })
    }
}

/// A pen that goes round and round again, with triangles made coarser and finer by turns.
#[test]
fn dynamic_topology_in_its_steady_state_neither_allocates_nor_frees() {
    if passed_alone("allocations::dynamic_topology_in_its_steady_state_neither_allocates_nor_frees")
    {
        return;
    }
    let mut stroke = TopologyStroke::new(0.12);
    for round in 0..10 {
        stroke.brush.topology.edge = [0.15, 0.08][round % 2];
        stroke.brush.negative = round % 4 >= 2;
        stroke.set_brush();
        let vertices = stroke.world.mesh().vertex_count();
        let mut calls = 0;
        for i in 0..240 {
            stroke.wait_for_pages();
            let now = stroke.draw(i as f32 / 240.0 * std::f32::consts::TAU, 0.12);
            // The first dabs of a stroke open its undo step.
            calls += if i >= 20 { now } else { 0 };
        }
        let now = stroke.world.mesh().vertex_count();
        println!("round {round}: {vertices} -> {now} vertices, {calls} calls");
        assert!(vertices.abs_diff(now) > 1000, "nothing changed in round {round}");
        // The first rounds touch each page once and fill the pools.
        if round >= 2 {
            assert_eq!(calls, 0, "allocations and frees in round {round}");
        }
    }
}

/// A spiral over clay that it has not touched before, which is made finer: new pages in every
/// tick, and more of them than there were.
#[test]
fn clay_that_grows_under_a_stroke_takes_its_pages_from_the_supply() {
    if passed_alone("allocations::clay_that_grows_under_a_stroke_takes_its_pages_from_the_supply") {
        return;
    }
    let mut stroke = TopologyStroke::new(0.08);
    stroke.brush.topology.edge = 0.03;
    stroke.set_brush();
    let (before, mut calls) = (stroke.world.mesh().page_count(), 0);
    for i in 0..300 {
        stroke.wait_for_pages();
        let t = i as f32 / 300.0;
        let now = stroke.draw(t * 20.0, 0.02 + 0.22 * t);
        // The first dabs of a stroke open its undo step.
        calls += if i >= 20 { now } else { 0 };
    }
    let grown = stroke.world.mesh().page_count();
    println!("{before} pages, {grown} at the end, {calls} calls");
    assert!(grown > before + 50, "{before} pages, then {grown}");
    assert_eq!(calls, 0, "allocations and frees while the clay grows");
}

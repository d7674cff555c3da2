//! Allocations and frees of one thread, counted.
//!
//! The law: in the steady state of a stroke the tick thread neither allocates nor frees.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::process;
use std::sync::atomic::{AtomicI64, Ordering::Relaxed};

use glam::{Vec2, Vec3};
use sculptd_clay::brush::{BrushKind, BrushSettings, GaussianBrush, Measure, SmoothBrush};
use sculptd_clay::{Clay, Reach, Workers};
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

/// Runs the test of this name in a process of its own, where nobody else allocates, and answers
/// false there and true when it has passed there.
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

/// A pen that goes round a ball and round again, with triangles made finer and coarser by turns.
#[test]
fn dynamic_topology_in_its_steady_state_neither_allocates_nor_frees() {
    let clay = Clay::build(&shapes::sphere_of_about(160_000), &Job::default()).expect("builds");
    let mut brush = BrushSettings { radius: 0.12, ..sculptd::presets().of(BrushKind::Clay) };
    brush.topology.by = Measure::Brush;
    let options =
        WorldOptions { dab_budget: 400_000, undo_bytes: 1 << 30, hands: HandSettings::default() };
    let camera = Camera { yaw: 0.0, pitch: 0.0, ..Camera::default() };
    let mut world = World::new(clay, camera, brush, Workers::new(2), options);
    world.warm();
    world.set_garbage_sink(GarbageThread::start().expect("a thread").sink());
    world.set_page_supply(PageThread::start().expect("a thread").supply());
    let area_mm = Vec2::new(world.camera().aspect, 1.0) * 100.0;
    let (mut tick, mut shown) = (0, None);
    for round in 0..10 {
        brush.topology.edge = [0.15, 0.08][round % 2];
        brush.negative = round % 4 >= 2;
        tick += 1;
        world.step(tick, &[], &[Command::Brush(brush)]);
        // The first rounds touch each page once and fill the pools.
        let steady = round >= 4;
        let vertices = world.mesh().vertex_count();
        CALLS.set(0);
        for i in 0..240 {
            let turn = i as f32 / 240.0 * std::f32::consts::TAU;
            let at = Vec2::splat(0.5) + Vec2::new(turn.cos(), turn.sin()) * 0.12;
            tick += 1;
            let pen = Pen {
                in_range: true,
                tip: true,
                pos_mm: at * area_mm,
                area_mm,
                pressure: Some(0.5),
                ..Pen::default()
            };
            let t_us = tick * 8000;
            let body = Body::Pen(pen);
            let sample = Sample { device: DeviceId(1), t_us, device_t_us: None, body };
            COUNTED.set(true);
            world.step(tick, &[sample], &[]);
            shown.replace(world.snapshot());
            COUNTED.set(false);
        }
        let now = world.mesh().vertex_count();
        println!("round {round}: {vertices} -> {now} vertices, {} calls", CALLS.get());
        assert!(vertices.abs_diff(now) > 1000, "nothing changed in round {round}");
        if steady {
            assert_eq!(CALLS.get(), 0, "allocations and frees in round {round}");
        }
    }
}

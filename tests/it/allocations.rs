//! Allocations and frees of one thread, counted.
//!
//! The law: in the steady state of a stroke the tick thread neither allocates nor frees.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use glam::Vec3;
use sculptd::analysis::cancel::Job;
use sculptd::brush::{Gaussian, Smooth};
use sculptd::mesh::{Mesh, Reach, Workers, shapes};

struct Counting;

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
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        note();
        unsafe { System.dealloc(at, layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
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

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn a_stroke_in_its_steady_state_neither_allocates_nor_frees() {
    let mut mesh = Mesh::build(&shapes::sphere_of_about(200_000), &Job::default()).expect("builds");
    let workers = Workers::new(2);
    workers.warm();
    mesh.begin_step();
    let mut shown = None;
    for round in 0..6 {
        // The first rounds touch each page once and fill the pools; the later ones go over the same ground.
        let steady = round >= 3;
        CALLS.set(0);
        for i in 0..60 {
            let turn = i as f32 * 0.02;
            let at = Vec3::new(turn.cos(), turn.sin(), 0.0);
            let reach = Reach::Sphere { centre: at, radius: 0.3 };
            COUNTED.set(true);
            if i % 2 == 0 {
                mesh.dab(&reach, &Gaussian::new(at, 0.3, at, 1e-4), &workers);
            } else {
                mesh.dab(&reach, &Smooth::new(at, 0.3, 0.1), &workers);
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

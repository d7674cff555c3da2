//! How long a checkpoint of a ball of so many vertices takes: `checkpoint VERTICES`.

use std::time::Instant;

use sculptd_clay::brush::BrushSettings;
use sculptd_clay::{Clay, Workers};
use sculptd_engine::camera::Camera;
use sculptd_engine::checkpoint::{Captured, restore};
use sculptd_engine::hand::HandSettings;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

fn main() {
    let vertices = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(1_000_000);
    let mesh = Clay::build(&shapes::sphere_of_about(vertices), &Job::default()).expect("a ball");
    let hands = HandSettings::default();
    let options = WorldOptions { dab_budget: 400_000, undo_bytes: 64 << 20, hands };
    let workers = Workers::new(2);
    let mut world = World::new(mesh, Camera::default(), BrushSettings::default(), workers, options);
    world.step(1, &[], &[]);
    for _ in 0..3 {
        let begun = Instant::now();
        let captured = Captured::of(&mut world).expect("at rest");
        let captured_s = begun.elapsed().as_secs_f64();
        let begun = Instant::now();
        let bytes = captured.to_bytes();
        let made_s = begun.elapsed().as_secs_f64();
        let begun = Instant::now();
        let mut again = restore(&bytes, Workers::new(2)).expect("restored");
        let restored_s = begun.elapsed().as_secs_f64();
        assert_eq!(again.snapshot().vertex_count(), world.snapshot().vertex_count());
        println!(
            "captured {:.1} ms, made {made_s:.2} s, {:.1} MB, restored {restored_s:.2} s",
            captured_s * 1e3,
            bytes.len() as f64 / 1e6
        );
    }
}

//! What a dab, an idle tick and publishing cost in a scene of many objects, against one alone.
//!
//! `cargo run --release -p sculptd-engine --example many_objects -- [OBJECTS [VERTICES]]`
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // It measures and prints.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use glam::{DVec3, Vec2};
use sculptd_clay::brush::BrushSettings;
use sculptd_clay::{Clay, Workers};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{NewObject, ObjectId, ObjectSource, ObjectTransform, SceneCommand};
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::{TriMesh, job::Job, shapes};

/// Microseconds at the middle and at the 99th of 100.
fn quantiles(mut all: Vec<u64>) -> (f64, f64) {
    all.sort_unstable();
    let at = |share: f64| all[((all.len() - 1) as f64 * share) as usize] as f64 / 1e3;
    (at(0.5), at(0.99))
}

fn world(objects: usize, plain: &Arc<TriMesh>) -> Result<World, Box<dyn Error>> {
    let options =
        WorldOptions { dab_budget: 400_000, undo_bytes: 1 << 30, hands: HandSettings::default() };
    let first = Clay::build(plain, &Job::default())?;
    let brush = BrushSettings { radius: 0.1, ..BrushSettings::default() };
    let mut world = World::new(first, Camera::default(), brush, Workers::new(1), options);
    for k in 1..objects {
        // Each object gets separate clay, so that memory use matches that of different objects.
        let clay = Clay::build(plain, &Job::default())?;
        let place = DVec3::new((k % 10) as f64 * 3.0, 0.0, (k / 10) as f64 * -3.0);
        let transform = ObjectTransform { shift: place, ..ObjectTransform::NONE };
        let source = ObjectSource::Mesh(plain.clone());
        let new = NewObject::new("ball", source, transform);
        let mut command = Command::Scene(SceneCommand::Add(new));
        world.deliver(&mut command, Payload::Clay(Box::new(clay)));
        world.step(k as u64, &[], &[command]);
    }
    let back = Command::Scene(SceneCommand::Activate(ObjectId(0)));
    world.step(objects as u64, &[], &[back]);
    Ok(world)
}

/// Ticks of strokes, ticks without input, and both with what is published after each.
fn measure(world: &mut World, ticks: u64) -> [(f64, f64); 3] {
    let area_mm = Vec2::new(world.camera().aspect, 1.0) * 100.0;
    let [mut dabs, mut idle, mut published] = [const { Vec::new() }; 3];
    for k in 0..ticks {
        let tick = world.tick() + 1;
        let along = (k % 60) as f32 / 60.0;
        let view = Vec2::new(0.4 + 0.2 * along, 0.4 + 0.002 * (k / 60 % 100) as f32);
        let pen = Pen {
            in_range: true,
            tip: k % 60 < 58,
            pos_mm: view * area_mm,
            area_mm,
            pressure: Some(0.6),
            ..Pen::default()
        };
        let body = Body::Pen(pen);
        let sample = Sample { device: DeviceId(1), t_us: tick * 8333, device_t_us: None, body };
        let begun = Instant::now();
        let moved = world.step(tick, &[sample], &[]).vertices_moved;
        if moved > 0 {
            dabs.push(begun.elapsed().as_nanos() as u64);
        }
        let begun = Instant::now();
        let shown = (world.snapshot(), world.scene_view());
        published.push(begun.elapsed().as_nanos() as u64);
        drop(shown);
    }
    for _ in 0..ticks {
        let tick = world.tick() + 1;
        let begun = Instant::now();
        world.step(tick, &[], &[]);
        let shown = (world.snapshot(), world.scene_view());
        idle.push(begun.elapsed().as_nanos() as u64);
        drop(shown);
    }
    [quantiles(dabs), quantiles(idle), quantiles(published)]
}

/// Resident memory, MiB; 0 where the system does not say.
fn resident() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split(' ').nth(1).and_then(|n| n.parse::<u64>().ok()).map_or(0, |n| n * 4 / 1024)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1).map(|a| a.parse::<usize>());
    let objects = args.next().transpose()?.unwrap_or(100);
    let vertices = args.next().transpose()?.unwrap_or(100_000);
    let plain = Arc::new(shapes::sphere_of_about(vertices));
    let before = resident();
    let mut alone = world(1, &plain)?;
    let one = resident();
    let mut many = world(objects, &plain)?;
    println!("{objects} objects of {} vertices", plain.positions.len());
    println!("resident: {} MiB with one, {} MiB more with all", one - before, resident() - one);
    // In turns, so that a loaded machine is as loaded for both.
    for round in 0..5 {
        for (name, world) in [("alone", &mut alone), ("many", &mut many)] {
            let [dab, idle, published] = measure(world, 600);
            println!(
                "{round} {name:>5}: stroke tick p50 {:.1} p99 {:.1} us; publish p50 {:.2} us; \
                 idle tick p50 {:.2} p99 {:.2} us",
                dab.0, dab.1, published.0, idle.0, idle.1
            );
        }
    }
    let activate = |world: &mut World, id: u32| {
        let tick = world.tick() + 1;
        let begun = Instant::now();
        world.step(tick, &[], &[Command::Scene(SceneCommand::Activate(ObjectId(id)))]);
        let shown = world.scene_view();
        let took = begun.elapsed().as_nanos() as u64;
        drop(shown);
        took
    };
    let most = objects.max(2) as u32;
    let all = (0..50).map(|k| activate(&mut many, k % most)).collect();
    println!("activating another: p50 {:.1} us", quantiles(all).0);
    let twins = (0..10).map(|_| {
        let tick = many.tick() + 1;
        let begun = Instant::now();
        many.step(tick, &[], &[Command::Scene(SceneCommand::Duplicate(ObjectId(0)))]);
        begun.elapsed().as_nanos() as u64
    });
    println!("duplicating: p50 {:.1} us", quantiles(twins.collect()).0);
    Ok(())
}

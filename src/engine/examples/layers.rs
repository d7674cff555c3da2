//! What showing and hiding a layer costs, and dragging its intensity, by ticks.
//!
//! `cargo run --release -p sculptd-engine --example layers -- [VERTICES [WORKERS]]`
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // It measures and prints.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use sculptd_clay::brush::BrushSettings;
use sculptd_clay::layers::LayerOffsets;
use sculptd_clay::{Clay, LayerEdit, LayerId, Workers};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::scene::SceneCommand;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::{job::Job, shapes};

/// Milliseconds of each tick from an edit on until nothing is left to be done.
fn ticks(world: &mut World, edit: LayerEdit) -> Vec<f64> {
    let mut commands = vec![Command::Scene(SceneCommand::Layers(edit))];
    let mut all = Vec::new();
    loop {
        let tick = world.tick() + 1;
        let begun = Instant::now();
        let paused = world.step(tick, &[], &commands).paused;
        all.push(begun.elapsed().as_secs_f64() * 1e3);
        // What others are shown is published after each tick.
        drop(world.snapshot());
        commands.clear();
        if !paused {
            return all;
        }
    }
}

fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let vertices: usize = args.next().map_or(Ok(100_000), |a| a.parse())?;
    let workers: usize = args.next().map_or(Ok(1), |a| a.parse())?;
    let plain = shapes::sphere_of_about(vertices);
    let clay = Clay::build(&plain, &Job::default())?;
    let options =
        WorldOptions { dab_budget: 400_000, undo_bytes: 1 << 30, hands: HandSettings::default() };
    let brush = BrushSettings::default();
    let mut world = World::new(clay, Camera::default(), brush, Workers::new(workers), options);
    let offsets = (0..plain.positions.len() as u32)
        .map(|v| (v, (plain.positions[v as usize] * (0.01 + (v % 7) as f32 * 1e-3)).to_array()));
    let layer = LayerOffsets {
        name: "all".into(),
        intensity: 1.0,
        visible: true,
        offsets: offsets.collect(),
    };
    let made = ticks(&mut world, LayerEdit::Import(Arc::new(vec![layer])));
    println!("{} vertices, {workers} workers", plain.positions.len());
    println!("layer made in {:.1} ms, {} ticks", made.iter().sum::<f64>(), made.len());
    let id = LayerId(0);
    let set = |intensity, visible, live| LayerEdit::Set { id, intensity, visible, live };
    let (mut sums, mut most, mut counts) = (Vec::new(), 0.0f64, Vec::new());
    for k in 0..21 {
        let all = ticks(&mut world, set(None, Some(k % 2 == 1), false));
        sums.push(all.iter().sum());
        most = all.iter().copied().fold(most, f64::max);
        counts.push(all.len() as f64);
    }
    println!(
        "shown or hidden: {:.2} ms in all (median of 21) over {} ticks, no tick above {most:.2} ms",
        median(sums),
        median(counts)
    );
    // Two ticks of 120 Hz for each change of 60 Hz.
    let (mut drag, mut behind) = (Vec::new(), Vec::new());
    for k in 0..120 {
        let intensity = 1.0 + (k as f32 - 60.0) / 60.0;
        let edit = Command::Scene(SceneCommand::Layers(set(Some(intensity), Some(true), true)));
        for commands in [&[edit][..], &[]] {
            let tick = world.tick() + 1;
            let begun = Instant::now();
            world.step(tick, &[], commands);
            drag.push(begun.elapsed().as_secs_f64() * 1e3);
            drop(world.snapshot());
        }
    }
    behind.extend(ticks(&mut world, set(Some(1.0), None, false)));
    let most = drag.iter().copied().fold(0.0, f64::max);
    println!(
        "dragged at 60 Hz: tick {:.2} ms (median), {most:.2} ms (most); the last value is whole \
         after {} ticks",
        median(drag),
        behind.len()
    );
    world.verify_invariants()?;
    Ok(())
}

//! What showing and hiding a layer costs, and dragging its intensity, by ticks.
//!
//! `cargo run --release -p sculptd-engine --example layers -- [VERTICES [WORKERS]]`
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // It measures and prints.

use std::error::Error;
use std::sync::{Arc, mpsc};
use std::time::Instant;

use sculptd_clay::brush::BrushSettings;
use sculptd_clay::layers::LayerOffsets;
use sculptd_clay::{
    Clay, CollectGarbage, Garbage, GarbageSink, LayerEdit, LayerId, Snapshot, Workers,
};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::scene::SceneCommand;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::{job::Job, shapes};

/// Frees what the tick no longer needs on a separate thread, as the daemon does.
#[derive(Debug)]
struct Freed(mpsc::Sender<Garbage>);

impl CollectGarbage for Freed {
    fn collect(&self, garbage: Garbage) {
        let _ = self.0.send(garbage);
    }
}

/// Shows a state: the one before it is let go elsewhere, as a window does.
fn show(shown: &mut Vec<Snapshot>, old: &mpsc::Sender<Snapshot>, now: Snapshot) {
    shown.push(now);
    if shown.len() > 1 {
        let _ = old.send(shown.remove(0));
    }
}

/// Milliseconds of each tick from an edit on until nothing is left to be done.
fn ticks(world: &mut World, old: &mpsc::Sender<Snapshot>, edit: LayerEdit) -> Vec<f64> {
    let mut commands = vec![Command::Scene(SceneCommand::Layers(edit))];
    let (mut all, mut shown) = (Vec::new(), Vec::new());
    loop {
        let tick = world.tick() + 1;
        let begun = Instant::now();
        let paused = world.step(tick, &[], &commands).paused;
        // The snapshot for readers is published after each tick and held until the next.
        show(&mut shown, old, world.snapshot());
        all.push(begun.elapsed().as_secs_f64() * 1e3);
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
    let (freed, garbage) = mpsc::channel::<Garbage>();
    let freeing = std::thread::spawn(move || garbage.into_iter().for_each(drop));
    world.set_garbage_sink(GarbageSink::new(Arc::new(Freed(freed))));
    let (old, snapshots) = mpsc::channel::<Snapshot>();
    let letting_go = std::thread::spawn(move || snapshots.into_iter().for_each(drop));
    let offsets = (0..plain.positions.len() as u32)
        .map(|v| (v, (plain.positions[v as usize] * (0.01 + (v % 7) as f32 * 1e-3)).to_array()));
    let layer = LayerOffsets {
        name: "all".into(),
        intensity: 1.0,
        visible: true,
        offsets: offsets.collect(),
    };
    let made = ticks(&mut world, &old, LayerEdit::Import(Arc::new(vec![layer])));
    println!("{} vertices, {workers} workers", plain.positions.len());
    println!("layer made in {:.1} ms, {} ticks", made.iter().sum::<f64>(), made.len());
    let id = LayerId(0);
    let set = |intensity, visible, live| LayerEdit::Set { id, intensity, visible, live };
    let (mut sums, mut most, mut counts) = (Vec::new(), 0.0f64, Vec::new());
    for k in 0..21 {
        let all = ticks(&mut world, &old, set(None, Some(k % 2 == 1), false));
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
    let (mut drag, mut behind, mut shown) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..120 {
        let intensity = 1.0 + (k as f32 - 60.0) / 60.0;
        let edit = Command::Scene(SceneCommand::Layers(set(Some(intensity), Some(true), true)));
        for commands in [&[edit][..], &[]] {
            let tick = world.tick() + 1;
            let begun = Instant::now();
            world.step(tick, &[], commands);
            show(&mut shown, &old, world.snapshot());
            drag.push(begun.elapsed().as_secs_f64() * 1e3);
        }
    }
    behind.extend(ticks(&mut world, &old, set(Some(1.0), None, false)));
    let mut longest: Vec<(f64, usize)> = drag.iter().copied().zip(0..).collect();
    longest.sort_by(|a, b| b.0.total_cmp(&a.0));
    let longest: Vec<String> =
        longest.iter().take(4).map(|(ms, tick)| format!("{ms:.2} (tick {tick})")).collect();
    println!(
        "dragged at 60 Hz: tick {:.2} ms (median), longest {}; the last value is whole after {} \
         ticks",
        median(drag),
        longest.join(", "),
        behind.len()
    );
    world.verify_invariants()?;
    drop((world, shown, old));
    let _ = (freeing.join(), letting_go.join());
    Ok(())
}

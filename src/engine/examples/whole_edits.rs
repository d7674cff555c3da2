//! What edits of a whole object's mask and face sets cost, by ticks: how many there are until
//! nothing is left to be done, and how long the longest took.
//!
//! `cargo run --release -p sculptd-engine --example whole_edits -- [VERTICES [WORKERS]]`
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // It measures and prints.

use std::error::Error;
use std::sync::{Arc, mpsc};
use std::time::Instant;

use glam::Vec2;
use sculptd_clay::brush::{BrushSettings, MaskAction};
use sculptd_clay::face_sets::{PartEdit, Partition, SetsEdit, partition};
use sculptd_clay::{Clay, CollectGarbage, Garbage, GarbageSink, Workers};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::mask_region::MaskRegion;
use sculptd_engine::scene::SceneCommand;
use sculptd_engine::view_region::{SetsRegion, ViewRegion};
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

/// Number of times that each edit is done and undone.
const TIMES: usize = 5;

/// Milliseconds of each tick from a command on until nothing is left to be done, each with what
/// others are shown afterwards.
fn ticks(world: &mut World, command: Command) -> Vec<f64> {
    let mut commands = vec![command];
    let mut all = Vec::new();
    loop {
        let tick = world.tick() + 1;
        let begun = Instant::now();
        let paused = world.step(tick, &[], &commands).paused;
        drop(world.snapshot());
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

/// A closed polygon about the middle of the view that a hand may have drawn.
fn lasso(corners: usize) -> ViewRegion {
    let at = |i: usize| {
        let angle = i as f32 / corners as f32 * std::f32::consts::TAU;
        let r = 0.25 + 0.03 * (9.0 * angle).sin();
        Vec2::splat(0.5) + r * Vec2::from_angle(angle)
    };
    ViewRegion::Polygon(Arc::new((0..corners).map(at).collect()))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let vertices: usize = args.next().map_or(Ok(1_000_000), |a| a.parse())?;
    let workers: usize = args.next().map_or(Ok(1), |a| a.parse())?;
    let plain = shapes::sphere_of_about(vertices);
    println!("{} vertices, {workers} workers", plain.positions.len());
    let clay = Clay::build(&plain, &Job::default())?;
    drop(plain);
    let options =
        WorldOptions { dab_budget: 400_000, undo_bytes: 4 << 30, hands: HandSettings::default() };
    let brush = BrushSettings::default();
    let mut world = World::new(clay, Camera::default(), brush, Workers::new(workers), options);
    let (freed, garbage) = mpsc::channel::<Garbage>();
    let freeing = std::thread::spawn(move || garbage.into_iter().for_each(drop));
    world.set_garbage_sink(GarbageSink::new(Arc::new(Freed(freed))));
    let half = ViewRegion::Box([Vec2::ZERO, Vec2::new(0.5, 1.0)]);
    let mask = |region, mask| Command::MaskRegion(MaskRegion { region, mask, front_faces: false });
    let sets = |edit| Command::Scene(SceneCommand::Sets(edit));
    let part = |region, edit| {
        let asked = SetsRegion { region, edit, front_faces: false };
        Command::Scene(SceneCommand::SetsRegion(asked))
    };
    ticks(&mut world, mask(half.clone(), 1.0));
    ticks(&mut world, sets(SetsEdit::FromMask));
    let edits: Vec<(&str, Command)> = vec![
        ("mask: invert", Command::Mask(MaskAction::Invert)),
        ("mask: blur", Command::Mask(MaskAction::Blur)),
        ("mask: grow", Command::Mask(MaskAction::Grow)),
        ("mask: cavity", Command::Mask(MaskAction::Cavity(0.0))),
        ("mask: box", mask(half.clone(), 0.5)),
        ("mask: lasso of 200", mask(lasso(200), 0.5)),
        ("mask: lasso of 1000", mask(lasso(1000), 0.5)),
        ("sets: from mask", sets(SetsEdit::FromMask)),
        ("sets: from visible", sets(SetsEdit::FromVisible)),
        ("sets: hide", sets(SetsEdit::Hide(1))),
        ("sets: hide masked", sets(SetsEdit::HideMasked)),
        ("sets: isolate", sets(SetsEdit::Isolate(1))),
        ("sets: invert hidden", sets(SetsEdit::Invert)),
        ("sets: clear", sets(SetsEdit::Clear)),
        ("sets: by connectivity", sets(SetsEdit::ShowAll)),
        ("region: set, box", part(half, PartEdit::NewSet)),
        ("region: set, lasso of 200", part(lasso(200), PartEdit::NewSet)),
        ("region: hide, lasso of 1000", part(lasso(1000), PartEdit::Hide)),
    ];
    for (name, command) in edits {
        let (mut most, mut counts, mut sums, mut which) = (Vec::new(), 0, Vec::new(), 0);
        for _ in 0..TIMES {
            let command = match name {
                "sets: by connectivity" => {
                    sets(partition(&world.snapshot(), Partition::Loose, &Job::default())?)
                }
                _ => command.clone(),
            };
            let steps = world.undo_steps();
            let all = ticks(&mut world, command);
            most.push(all.iter().copied().fold(0.0, f64::max));
            which = (0..all.len()).max_by(|a, b| all[*a].total_cmp(&all[*b])).unwrap_or(0);
            sums.push(all.iter().sum());
            counts = all.len();
            if world.undo_steps() > steps {
                ticks(&mut world, Command::Undo);
            }
        }
        println!(
            "{name:28} {counts:5} ticks, longest {:8.2} ms, in all {:9.2} ms (medians of {TIMES}), \
             the longest of the last was tick {which}",
            median(most),
            median(sums)
        );
    }
    world.verify_invariants()?;
    drop(world);
    freeing.join().map_err(|_| "the thread that frees ended early")?;
    Ok(())
}

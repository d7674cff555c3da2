//! How long a local remesh takes: of a region of a large ball, by ticks.
//!
//! `cargo run --release -p sculptd-engine --example local_remesh -- [VERTICES]`
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // It measures and prints.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec2;
use sculptd_clay::brush::BrushSettings;
use sculptd_clay::{Clay, Workers};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::local_remesh::{LocalRemesh, WantedEdge};
use sculptd_engine::scene::SceneCommand;
use sculptd_engine::view_region::ViewRegion;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::{job::Job, shapes};

fn main() -> Result<(), Box<dyn Error>> {
    let wanted = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(1_000_000.0f64);
    let ball = shapes::icosphere(1.0, (wanted / 10.0).sqrt() as u32);
    let clay = Clay::build(&ball, &Job::default())?;
    let options =
        WorldOptions { dab_budget: 400_000, undo_bytes: 1 << 30, hands: HandSettings::default() };
    let workers = Workers::new(2);
    let mut world = World::new(clay, Camera::default(), BrushSettings::default(), workers, options);
    for (half, times) in [(0.05, 1.0), (0.03, 0.5), (0.05, 0.5), (0.1, 0.5), (0.1, 1.0), (0.2, 1.5)]
    {
        let corner = |i: usize| Vec2::splat(0.5) + half * Vec2::from_angle(i as f32 / 10.0);
        let circle = ViewRegion::Polygon(Arc::new((0..62).map(corner).collect()));
        let edge = WantedEdge::OfUsual(times);
        let asked = LocalRemesh { edge, stretched_only: false, region: Some(circle) };
        let inside = |world: &World| {
            let all = world.mesh().to_tri().positions;
            let seen = all.iter().filter_map(|p| world.camera().project(*p));
            seen.filter(|p| p.distance(Vec2::splat(0.5)) < half).count()
        };
        let before = inside(&world);
        let mut commands = vec![Command::Scene(SceneCommand::RemeshLocal(asked))];
        let (mut all, mut longest, mut ticks) = (0.0, 0.0f64, 0);
        loop {
            let (tick, begun) = (world.tick() + 1, Instant::now());
            world.step(tick, &[], &commands);
            let took = begun.elapsed().as_secs_f64() * 1e3;
            commands.clear();
            (all, longest, ticks) = (all + took, longest.max(took), ticks + 1);
            if !world.report().paused {
                break;
            }
        }
        println!(
            "edge {times} times the usual: {before} vertices seen before, {} after: {all:.1} ms in \
             {ticks} ticks, the longest {longest:.1} ms",
            inside(&world)
        );
        let tick = world.tick() + 1;
        world.step(tick, &[], &[Command::Undo]);
    }
    Ok(())
}

//! Replaying a session: the same world, the same input, tick by tick.

use super::reader::Opened;
use crate::analysis::cancel::Job;
use crate::mesh::{BuildError, Mesh, Workers};
use crate::world::{World, WorldOptions};

/// A session that was replayed to its end, or to the tick asked for.
#[derive(Debug)]
pub struct Replayed {
    pub world: World,
    /// The last tick that was stepped.
    pub ticks: u64,
}

/// Ticks without any input over which a resting pen is followed: ten minutes at 120 a second.
const RESTING: u64 = 72_000;

/// Steps every tick from the first to the last with input (at most `until`), and on until nothing of a stroke waits. Ticks
/// without input matter only while a stroke waits for its budget; over the others the world is at rest.
pub fn replay(
    opened: &Opened,
    until: Option<u64>,
    workers: Workers,
    job: &Job,
) -> Result<Replayed, BuildError> {
    replay_seen(opened, until, workers, job, &mut |_, _| {})
}

/// The same; `see` is shown the world before the first tick and after each one that was stepped.
pub fn replay_seen(
    opened: &Opened,
    until: Option<u64>,
    workers: Workers,
    job: &Job,
    see: &mut dyn FnMut(u64, &mut World),
) -> Result<Replayed, BuildError> {
    let mesh = Mesh::build(&opened.start, job)?;
    let s = &opened.settings;
    let options = WorldOptions { dab_budget: s.dab_budget, undo_bytes: s.undo_bytes, hands: s.hands };
    let mut world = World::new(mesh, s.camera, s.brush, workers, options);
    see(0, &mut world);
    let until = until.unwrap_or(u64::MAX);
    let mut tick = 0;
    let (mut busy, mut waits) = (false, false);
    let total = opened.input.len().max(1) as f32;
    for (i, input) in opened.input.iter().enumerate() {
        if input.tick > until || job.cancelled() {
            break;
        }
        // The ticks between two inputs: stepped while the last one left work, or while a hand may let go by time.
        while busy && tick + 1 < input.tick {
            tick += 1;
            let report = *world.step(tick, &[], &[]);
            busy = report.paused || report.resting;
            see(tick, &mut world);
        }
        tick = input.tick;
        let report = *world.step(tick, &input.samples, &input.commands);
        busy = report.paused || report.resting;
        waits = report.paused;
        see(tick, &mut world);
        job.progress(i as f32 / total);
    }
    // A pen that rests at the end goes on resting as long as was asked for, and no longer than anybody rests.
    let rested = if until == u64::MAX { tick } else { until.min(tick.saturating_add(RESTING)) };
    while tick < until && (waits || busy && tick < rested) {
        tick += 1;
        let report = *world.step(tick, &[], &[]);
        see(tick, &mut world);
        (waits, busy) = (report.paused, report.paused || report.resting);
    }
    Ok(Replayed { world, ticks: tick })
}

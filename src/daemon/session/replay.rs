//! Replaying a session: the same world, the same input, tick by tick.

use super::history::Store;
use super::history::keeper::assemble;
use super::reader::Opened;
use sculptd_clay::{BuildError, Snapshot, Workers};
use sculptd_engine::command::{Command, Jump, SceneJump};
use sculptd_engine::payload::Payload;
use sculptd_engine::world::World;
use sculptd_geometry::job::Job;

/// A session that was replayed to its end, or to the tick asked for.
#[derive(Debug)]
pub struct Replayed {
    pub world: World,
    /// The last tick that was stepped.
    pub ticks: u64,
    /// Jumps within the history that were not made, because what they name is not in the file. A
    /// jump that the live world ignored is not counted.
    pub jumps_missed: u64,
}

/// Ticks without any input over which a resting pen is followed: ten minutes at 120 a second.
const RESTING: u64 = 72_000;

/// Steps every tick from the first to the last with input (at most `until`), and on until nothing
/// of a stroke waits. Ticks without input matter only while a stroke waits for its budget; over the
/// others the world is at rest.
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
    let mut world = opened.start.begin(&opened.settings, workers, job)?;
    let base = world.snapshot();
    let store = Store::read(&opened.path).ok();
    Ok(Run { opened, base: &base, store: store.as_ref(), until }.from(world, job, see))
}

/// Sources of a replay.
#[derive(Debug)]
pub struct Run<'a> {
    pub opened: &'a Opened,
    /// The sculpture at the start of the session.
    pub base: &'a Snapshot,
    /// Store in which jumps find their pages.
    pub store: Option<&'a Store>,
    pub until: Option<u64>,
}

impl Run<'_> {
    /// Goes on from a world with the input after its tick.
    pub fn from(
        &self,
        mut world: World,
        job: &Job,
        see: &mut dyn FnMut(u64, &mut World),
    ) -> Replayed {
        see(world.tick(), &mut world);
        let until = self.until.unwrap_or(u64::MAX);
        let mut tick = world.tick();
        let (mut busy, mut waits) = (false, false);
        let mut jumps_missed = 0;
        let input = &self.opened.input;
        let first = input.partition_point(|t| t.tick <= tick);
        let total = (input.len() - first).max(1) as f32;
        for (i, input) in input[first..].iter().enumerate() {
            if input.tick > until || job.cancelled() {
                break;
            }
            // The ticks between two inputs: stepped while the last one left work, or while a hand
            // may let go by time.
            while busy && tick + 1 < input.tick {
                tick += 1;
                let report = *world.step(tick, &[], &[]);
                busy = report.paused || report.resting;
                see(tick, &mut world);
            }
            tick = input.tick;
            for command in &input.commands {
                match command {
                    Command::Jump(jump) => self.fetch(jump, &mut world),
                    Command::JumpScene(jump) => self.fetch_scene(jump, &mut world),
                    _ => {}
                }
            }
            let report = *world.step(tick, &input.samples, &input.commands);
            jumps_missed += report.jumps_missing;
            busy = report.paused || report.resting;
            waits = report.paused;
            see(tick, &mut world);
            job.progress(i as f32 / total);
        }
        // A pen that rests at the end goes on resting as long as was asked for, and no longer than
        // anybody rests.
        let rested = if until == u64::MAX { tick } else { until.min(tick.saturating_add(RESTING)) };
        while tick < until && (waits || busy && tick < rested) {
            tick += 1;
            let report = *world.step(tick, &[], &[]);
            see(tick, &mut world);
            (waits, busy) = (report.paused, report.paused || report.resting);
        }
        Replayed { world, ticks: tick, jumps_missed }
    }

    /// The same for a jump to another scene.
    fn fetch_scene(&self, jump: &SceneJump, world: &mut World) {
        let Some(store) = self.store else { return };
        let each = jump
            .objects
            .iter()
            .map(|o| assemble(store, self.base, &o.clay.rest, &o.pages, o.clay.levels));
        match each.collect::<Result<Vec<_>, _>>() {
            Ok(clays) => world.deliver_for_scene_jump(jump, Payload::Clays(clays)),
            Err(e) => tracing::warn!("a jump to {} cannot be replayed: {e}", jump.node),
        }
    }

    /// Puts what a jump names beside the world; where that is not in the file, the world ignores
    /// the jump, and it is counted.
    fn fetch(&self, jump: &Jump, world: &mut World) {
        let Some(store) = self.store else { return };
        let object_id = jump.object_id;
        let fetched = match &jump.other {
            Some(other) => assemble(store, self.base, &other.rest, &jump.pages, other.levels)
                .map(|mesh| Payload::Clay(Box::new(mesh))),
            None => jump
                .pages
                .iter()
                .map(|&(i, revision)| {
                    let near = (object_id == self.base.object_id()
                        && (i as usize) < self.base.page_count())
                    .then(|| (self.base.page(i), 0));
                    Ok((i, store.page((object_id, i, revision), near)?.0))
                })
                .collect::<Result<Vec<_>, _>>()
                .map(Payload::Pages),
        };
        match fetched {
            Ok(payload) => world.deliver_for_jump(jump, payload),
            Err(e) => tracing::warn!("a jump to {} cannot be replayed: {e}", jump.node),
        }
    }
}

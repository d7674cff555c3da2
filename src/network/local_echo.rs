//! The local strokes before they are ordered: a world that runs ahead of the replica's, for the
//! picture alone. Sculpting depends only on frames.
//!
//! Local input goes into the world ahead in the tick in which it was given. When it returns in a
//! frame, the replica's world has it too; if frames contain nothing else, the world ahead stays
//! right. If they contain input of others, another fork of the replica's world is made. It catches
//! up with the local input still in transit, some batches a tick, while the first fork is still
//! shown. When nothing is in transit the replica's world itself is shown.

use std::collections::VecDeque;

use crate::executor::Executor;
use crate::wire::frame::{Batch, Frame, Mark, PersonId};
use sculptd_devices::{Body, Sample};
use sculptd_engine::command::Command;
use sculptd_engine::world::World;

/// Batches that a world which catches up takes in one tick.
const CATCH_UP: usize = 4;
/// Ticks between two forks at least: so long what others do may lag behind in the picture of who
/// draws.
const FORK_TICKS: u32 = 12;
/// Own batches on their way beyond which nothing runs ahead any more.
const MOST: usize = 2000;
/// Revisions of two forks are so far apart.
const FORK_REVISIONS: u64 = 1 << 32;

/// The own input that is on its way, and the world ahead.
#[derive(Debug)]
pub struct LocalEcho {
    executor: Executor,
    person: PersonId,
    waiting: VecDeque<Batch>,
    ahead: Option<Box<World>>,
    /// A fork that catches up, and the number of waiting batches in it.
    next: Option<(Box<World>, usize)>,
    /// Frames brought what the world ahead does not have.
    stale: bool,
    forks: u64,
    /// Ticks since the last fork.
    since: u32,
}

/// Returns true if a command may be applied ahead: it sets something, and changes no clay.
fn is_tried(command: &Command) -> bool {
    matches!(
        command,
        Command::Brush(_) | Command::Camera(_) | Command::DesktopLayout(_) | Command::LiftAll
    )
}

impl LocalEcho {
    /// For a replica's person.
    pub fn new(rate_hz: u32, person: PersonId) -> LocalEcho {
        LocalEcho {
            executor: Executor::new(rate_hz, person),
            person,
            waiting: VecDeque::new(),
            ahead: None,
            next: None,
            stale: false,
            forks: 0,
            since: FORK_TICKS,
        }
    }

    /// The replica's person has this number from now on, or its world is another.
    pub fn reset(&mut self, rate_hz: u32, person: PersonId) {
        self.let_go();
        self.waiting.clear();
        let forks = self.forks;
        *self = LocalEcho { forks, ..LocalEcho::new(rate_hz, person) };
    }

    /// Returns the world shown instead of the replica's.
    pub fn ahead(&mut self) -> Option<&mut World> {
        self.ahead.as_deref_mut()
    }

    /// Forks that were made.
    pub fn forks(&self) -> u64 {
        self.forks
    }

    /// Takes the local input of a tick as it is sent, even if it is empty; called once a tick,
    /// before the received frames. `world`: the replica's.
    pub fn take(&mut self, world: &World, samples: &[Sample], commands: &[Command]) {
        self.since = self.since.saturating_add(1);
        if samples.is_empty() && commands.is_empty() {
            if let Some(ahead) = &mut self.ahead {
                step(&self.executor, self.person, ahead, None);
            }
            return;
        }
        let (samples, commands) = (samples.to_vec(), commands.to_vec());
        let batch = Batch { person: self.person, number: 0, samples, commands };
        self.waiting.push_back(batch);
        if !self.may_run_ahead() {
            return self.let_go();
        }
        match (&mut self.ahead, self.waiting.back()) {
            (Some(ahead), Some(batch)) => {
                step(&self.executor, self.person, ahead, Some(batch));
            }
            _ => self.catch_up(world),
        }
    }

    fn may_run_ahead(&self) -> bool {
        let tried = |b: &Batch| b.commands.iter().all(is_tried);
        self.person != 0 && self.waiting.len() <= MOST && self.waiting.iter().all(tried)
    }

    /// The replica's world has stepped a frame.
    pub fn ordered(&mut self, frame: &Frame) {
        let mut gone = 0;
        for batch in &frame.batches {
            if batch.person != self.person {
                self.stale = true;
                continue;
            }
            // Several ticks may have become one batch, and too much motion may have been left out.
            let same = |own: &Batch| is_same(own, batch);
            let place = self.waiting.iter().position(same).unwrap_or(0);
            gone += self.waiting.drain(..(place + 1).min(self.waiting.len())).count();
        }
        self.stale |= frame.mark == Mark::Checkpoint;
        if self.waiting.is_empty() {
            self.let_go();
        } else if let Some((world, taken)) = self.next.take() {
            match taken.checked_sub(gone) {
                Some(left) => self.next = Some((world, left)),
                None => world.discard(),
            }
        }
    }

    /// Once a tick, after the frames that have come: a world that catches up goes on.
    pub fn advance(&mut self, world: &World) {
        if !self.waiting.is_empty() && self.may_run_ahead() {
            self.catch_up(world);
        }
    }

    fn catch_up(&mut self, world: &World) {
        let stale = self.stale && self.since >= FORK_TICKS;
        if self.next.is_none() && (stale || self.ahead.is_none()) {
            (self.stale, self.since) = (false, 0);
            self.forks += 1;
            let fork = world.fork(self.forks * FORK_REVISIONS);
            self.next = fork.map(|fork| (Box::new(fork), 0));
            if self.next.is_none() {
                return self.let_go();
            }
        }
        let Some((fork, taken)) = &mut self.next else { return };
        for batch in self.waiting.iter().skip(*taken).take(CATCH_UP) {
            step(&self.executor, self.person, fork, Some(batch));
            *taken += 1;
        }
        if *taken == self.waiting.len()
            && let Some((fork, _)) = self.next.take()
            && let Some(old) = self.ahead.replace(fork)
        {
            old.discard();
        }
    }

    fn let_go(&mut self) {
        self.ahead.take().into_iter().for_each(World::discard);
        self.next.take().into_iter().for_each(|(world, _)| world.discard());
        self.stale = false;
    }
}

/// Returns true if a batch of a frame is the end of a tick's input.
fn is_same(own: &Batch, ordered: &Batch) -> bool {
    let body = |b: &Batch| b.samples.last().map(|s| (s.device, s.body));
    body(own) == body(ordered) && own.commands.len() == ordered.commands.len()
}

/// The next tick of a world ahead.
fn step(executor: &Executor, person: PersonId, world: &mut World, batch: Option<&Batch>) {
    let tick = world.tick() + 1;
    let pens = |s: &&Sample| matches!(s.body, Body::Pen(_));
    let batches = batch.map(|b| Batch {
        person,
        number: 0,
        // Hands are followed by the replica's world alone.
        samples: b.samples.iter().filter(pens).copied().collect(),
        commands: b.commands.clone(),
    });
    let frame = Frame { tick, batches: batches.into_iter().collect(), ..Frame::default() };
    let input = executor.input(&frame, world);
    world.step(input.tick, &input.samples, &input.commands);
    world.show_to(person);
}

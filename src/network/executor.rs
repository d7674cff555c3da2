//! Steps a world by frames. Every replica does nothing else: same frames, same bits.

use std::sync::Arc;

use crate::wire::frame::{Frame, Mark, PersonId};
use crate::wire::hands::with_unit_lengths;
use sculptd_clay::Snapshot;
use sculptd_devices::{DeviceId, Sample};
use sculptd_engine::checkpoint::Captured;
use sculptd_engine::command::{Command, OfPerson};
use sculptd_engine::scene::{KnownHashes, SceneView};
use sculptd_engine::world::World;

/// Ticks without input that are stepped while a stroke goes on by itself: a minute at 120 a second.
const MOST_EMPTY: u64 = 7_200;

/// The number under which the world knows a device of a person.
pub fn world_device(person: PersonId, device: DeviceId) -> DeviceId {
    DeviceId(u16::from(person) << 8 | device.0 & 0xff)
}

/// A world's state to be hashed by another thread.
#[derive(Debug, Clone)]
pub struct HashView {
    /// The frame that it is after.
    pub index: u64,
    /// The tick of that frame.
    pub tick: u64,
    /// All objects.
    pub scene: Arc<SceneView>,
    /// The active object's clay.
    pub active: Snapshot,
}

impl HashView {
    /// One number for positions, masks, colours, triangles and transforms of all objects: equal for
    /// replicas, whose pages are the same. Costs as much as what changed since the last view that
    /// `known` saw.
    pub fn hash(&self, known: &mut KnownHashes) -> u64 {
        self.scene.page_hash(&self.active, known)
    }
}

/// The input of one tick.
#[derive(Debug, Clone, Default)]
pub struct TickInput {
    /// The tick.
    pub tick: u64,
    /// In the order in which they are stepped.
    pub samples: Vec<Sample>,
    /// In the order in which they are stepped.
    pub commands: Vec<Command>,
    /// Indices of the commands that came from the local person: their results are awaited.
    pub own: Vec<usize>,
}

/// Requests of a frame after its tick.
#[derive(Debug, Default)]
pub struct Asked {
    /// To be hashed.
    pub hash: Option<HashView>,
    /// To be made a checkpoint of.
    pub captured: Option<Captured>,
}

/// Chooses the next tick.
#[derive(Debug)]
pub struct Executor {
    rate_hz: u32,
    person: PersonId,
    busy: bool,
}

impl Executor {
    /// For the replica of one person.
    pub fn new(rate_hz: u32, person: PersonId) -> Executor {
        Executor { rate_hz, person, busy: false }
    }

    /// The replica's person has this number from now on.
    pub fn set_person(&mut self, person: PersonId, rate_hz: u32) {
        (self.person, self.rate_hz) = (person, rate_hz);
    }

    /// Ticks a second.
    pub fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    /// The replica's person.
    pub fn person(&self) -> PersonId {
        self.person
    }

    /// Returns the ticks without input before a frame's tick that must be stepped. While nothing is
    /// under way they would change nothing, and the range is empty.
    pub fn empty_ticks(&self, world: &World, frame: &Frame) -> std::ops::Range<u64> {
        let first = world.tick() + 1;
        match self.busy {
            true => first..frame.tick.min(first + MOST_EMPTY),
            false => first..first,
        }
    }

    /// The input of a frame's own tick.
    pub fn input(&self, frame: &Frame, world: &World) -> TickInput {
        // A frame of the same tick as the one before it comes after it.
        let tick = frame.tick.max(world.tick());
        let mut input = TickInput { tick, ..TickInput::default() };
        let t_us = (frame.tick as u128 * 1_000_000 / u128::from(self.rate_hz.max(1))) as u64;
        // A world that was one person's is of several from the first of their input on. The command
        // is part of the input, so that every session file says the same.
        let first = frame.batches.first().map(|b| b.person);
        let first = first.or(frame.arrivals.first().map(|a| a.person));
        if let Some(person) = first.filter(|_| !world.has_people()) {
            let of = OfPerson { person, command: Command::LiftAll };
            input.commands.push(Command::OfPerson(Box::new(of)));
        }
        // The pens of those who have gone will tell nothing any more.
        for gone in frame.arrivals.iter().filter(|a| !a.here) {
            let of = OfPerson { person: gone.person, command: Command::LiftAll };
            input.commands.push(Command::OfPerson(Box::new(of)));
        }
        for batch in &frame.batches {
            for sample in &batch.samples {
                let device = world_device(batch.person, sample.device);
                let mut sample = Sample { device, t_us, ..*sample };
                with_unit_lengths(&mut sample);
                input.samples.push(sample);
            }
            for command in &batch.commands {
                if batch.person == self.person {
                    input.own.push(input.commands.len());
                }
                let mut command = command.clone();
                if let Command::DesktopLayout(desktop) = &mut command {
                    for (device, _) in desktop.tablets.iter_mut().flatten() {
                        *device = world_device(batch.person, *device);
                    }
                }
                let of = OfPerson { person: batch.person, command };
                input.commands.push(Command::OfPerson(Box::new(of)));
            }
        }
        if frame.mark == Mark::Checkpoint {
            input.commands.push(Command::Reopened);
        }
        input
    }

    /// Updates the state after a stepped tick; `frame` is `None` for an empty tick.
    pub fn after_step(&mut self, world: &mut World, frame: Option<&Frame>) -> Asked {
        world.show_to(self.person);
        let report = *world.report();
        self.busy = report.paused || report.resting || !world.is_at_rest();
        let Some(frame) = frame else { return Asked::default() };
        let (index, tick) = (frame.index, frame.tick);
        let hash = (frame.mark == Mark::Compare).then(|| HashView {
            index,
            tick,
            scene: world.scene_view(),
            active: world.snapshot(),
        });
        let captured = if frame.mark == Mark::Checkpoint { Captured::of(world) } else { None };
        Asked { hash, captured }
    }

    /// All of a frame at once.
    pub fn execute(&mut self, world: &mut World, frame: &Frame) -> Asked {
        for tick in self.empty_ticks(world, frame) {
            world.step(tick, &[], &[]);
            self.after_step(world, None);
        }
        let input = self.input(frame, world);
        world.step(input.tick, &input.samples, &input.commands);
        self.after_step(world, Some(frame))
    }
}

//! The loop's door to a shared sculpture: the own input goes out, the ordered input of all comes
//! back, and the world steps nothing else. Who implements it orders the input over a network.

use std::sync::Arc;

use crate::command_queue::QueuedCommand;
use crate::people::{OwnInput, PeopleHere};
use crate::session::SessionWriter;
use crate::session::writer::WriterThread;
use sculptd_devices::Sample;
use sculptd_engine::command::Command;
use sculptd_engine::world::World;

/// The ordered input of one tick.
#[derive(Debug, Clone, Default)]
pub struct SharedTick {
    /// The tick.
    pub tick: u64,
    /// In the order in which they are stepped.
    pub samples: Vec<Sample>,
    /// In the order in which they are stepped.
    pub commands: Vec<Command>,
    /// The places of the own commands among them, in order.
    pub own: Vec<usize>,
}

/// A session that records a shared world from where it was taken over.
pub type SharedJournal = Box<(SessionWriter, WriterThread)>;

/// What the loop does next.
#[derive(Debug)]
pub enum NextTick {
    /// Nothing more has come.
    Wait,
    /// A tick is stepped.
    Step(SharedTick),
    /// Another world takes the place of this one: the replica has joined anew. Where the session
    /// is written, it goes on in another file, which begins with that world.
    World(Box<World>, Option<SharedJournal>),
}

/// A sculpture that several daemons share. Called by the tick thread; nothing of it waits.
pub trait SharedInput: Send + std::fmt::Debug {
    /// Whether a command of this daemon cannot be shared; it is told, and goes no further.
    fn refuses(&mut self, command: &QueuedCommand) -> bool;
    /// The own input of one tick, once a tick; both lists are taken. `world`: the loop's.
    fn submit(&mut self, world: &World, samples: &mut Vec<Sample>, commands: &mut Vec<Command>);
    /// What is next.
    fn next(&mut self, world: &World) -> NextTick;
    /// The tick of [`NextTick::Step`] was stepped.
    fn after_step(&mut self, world: &mut World);
    /// The world that is shown in the place of the loop's, as it has the own input that is still on
    /// its way; once a tick, after all of its steps.
    fn ahead(&mut self, world: &World) -> Option<&mut World>;
    /// Who shares the sculpture; the same list as before, where nobody came or went.
    fn people(&self) -> Arc<PeopleHere>;
    /// What became of the own input.
    fn own_input(&self) -> OwnInput;
    /// Whether this daemon orders the input. It alone starts what a step asks for once.
    fn hosts(&self) -> bool;
}

//! The loop's interface to a shared sculpture: local input goes out, the ordered input of everyone
//! comes back, and the world steps only that. An implementation orders the input over a network.

use std::sync::Arc;

use crate::command_queue::QueuedCommand;
use crate::people::{OwnInput, PeopleHere, SharedEnd, SharedStanding};
use crate::session::SessionWriter;
use crate::session::writer::WriterThread;
use sculptd_devices::Sample;
use sculptd_engine::answer::CommandResult;
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
    /// Indices of the local commands among them, in order, and the number that
    /// [`SharedInput::submit`] gave each.
    pub own: Vec<(usize, u64)>,
    /// Numbers of local commands that the host refused.
    pub refused: Vec<u64>,
}

/// A session that records a shared world from the state at which this replica joined.
pub type SharedJournal = Box<(SessionWriter, WriterThread)>;

/// Next action of the loop.
#[derive(Debug)]
pub enum NextTick {
    /// No further input has arrived.
    Wait,
    /// Step this tick.
    Step(SharedTick),
    /// Replace the world: the replica has joined again. If the session is recorded, it continues in
    /// another file, which begins with that world. Local commands with lower numbers than the last
    /// value are in it already, or lost.
    World(Box<World>, Option<SharedJournal>, u64),
}

/// A sculpture shared by several daemons. The tick thread calls it; no method waits.
pub trait SharedInput: Send + std::fmt::Debug {
    /// The result of a command of this daemon that is not submitted: it is refused, or it is a
    /// viewer's own view of `world`. `None`: it is submitted.
    fn result_here(&mut self, world: &mut World, command: &QueuedCommand) -> Option<CommandResult>;
    /// Submits the local input of one tick, once a tick, and empties both lists. Returns the number
    /// of the first command; the others' follow. `world`: the loop's.
    fn submit(
        &mut self,
        world: &World,
        samples: &mut Vec<Sample>,
        commands: &mut Vec<Command>,
    ) -> u64;
    /// Returns the next action.
    fn next(&mut self, world: &World) -> NextTick;
    /// Called after the tick of [`NextTick::Step`].
    fn after_step(&mut self, world: &mut World);
    /// Returns the world to show instead of the loop's: it includes the local input still in
    /// transit. Called once a tick, after all of its steps.
    fn ahead(&mut self, world: &World) -> Option<&mut World>;
    /// Returns the people who share the sculpture; the same list as before if nobody came or went.
    fn people(&self) -> Arc<PeopleHere>;
    /// Returns the counts of the local input.
    fn own_input(&self) -> OwnInput;
    /// Returns the state of the connection.
    fn standing(&self) -> SharedStanding;
    /// The run ends: what is still on its way is delivered, and what cannot be is stepped here.
    fn close(&mut self);
    /// After [`SharedInput::close`]: how it ended, once it has.
    fn closed(&self) -> Option<SharedEnd>;
    /// Returns true if this daemon orders the input. Only that daemon starts the one-time jobs of a
    /// step.
    fn hosts(&self) -> bool;
}

//! What the tick thread and the station's thread send each other.

use std::sync::Arc;

use crate::executor::{Asked, Executor};
use crate::wire::frame::{Batch, Frame, PersonId};
use sculptd_daemon::people::{OwnInput, PeopleHere, SharedEnd, SharedStanding};
use sculptd_daemon::shared_input::SharedJournal;
use sculptd_devices::Sample;
use sculptd_engine::command::Command;
use sculptd_engine::world::World;

/// From the tick thread.
pub enum FromLoop {
    /// The number is that of the first command.
    Input(Vec<Sample>, Vec<Command>, u64),
    Stepped {
        frame: Arc<Frame>,
        asked: Box<Asked>,
        at_rest: bool,
    },
    /// The world is at this tick: it may be shared.
    Host {
        rate_hz: u32,
        tick: u64,
    },
    Close,
}

/// A frame, and the numbers of the own commands in it, and of those that the host refused.
pub type NumberedFrame = (Arc<Frame>, Vec<u64>, Vec<u64>);

/// To the tick thread.
pub enum ToLoop {
    Frame(NumberedFrame),
    /// Own commands with lower numbers than the last are in the world, or lost.
    World(Box<World>, Executor, Option<SharedJournal>, u64),
    NobodyHosts,
    Entered(PersonId, u32),
    /// Bytes of a checkpoint that have come.
    Coming(u64),
    People(Arc<PeopleHere>),
    Input(OwnInput, SharedStanding, usize),
    /// Nobody orders the own input any more: these batches, each with the number of its first
    /// command, are stepped here alone, before all that comes later.
    Alone(Vec<(Batch, u64)>),
    Closed(SharedEnd),
}

/// Reports to the run about its shared sculpture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Told {
    /// For a person.
    Note(String),
    /// The host admits nobody any more.
    Refused(String),
    /// The sculpture cannot be recorded.
    NoSession(String),
}

impl std::fmt::Debug for ToLoop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("ToLoop")
    }
}

impl std::fmt::Debug for FromLoop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("FromLoop")
    }
}

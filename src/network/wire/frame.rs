//! Frames: the ordered input. The host makes them, everybody steps them.
//!
//! A frame covers all ticks after the previous frame's tick, up to and including its tick; only its
//! tick has input. A frame without input records that time has passed.

use super::bytes::{BadBytes, ByteReader, put_bytes};
use sculptd_devices::Sample;
use sculptd_engine::command::Command;

/// A person's number in one sculpture, from 1. Nobody has 0.
pub type PersonId = u8;

/// Bytes that a command may take: a mesh of about two hundred thousand triangles.
pub const MAX_COMMAND: usize = 8 << 20;
/// Samples and commands of one batch.
pub const MAX_ENTRIES: usize = 256;
/// Batches of one frame, and of one message.
pub const MAX_BATCHES: usize = 1024;
/// Ticks that a frame may stand for: over an hour at 1000 a second.
pub const MAX_TICKS: u64 = 1 << 22;
/// Bytes of a person's name.
pub const MAX_NAME: usize = 64;

/// Input of one person from one tick of their loop.
#[derive(Debug, Clone, Default)]
pub struct Batch {
    /// Whose it is.
    pub person: PersonId,
    /// Counts the person's batches, from 1 without a gap.
    pub number: u64,
    /// Rounded ([`super::samples::rounded`]); their devices are those of the person, from 0.
    pub samples: Vec<Sample>,
    /// In their order.
    pub commands: Vec<Command>,
}

/// Task of a replica after the tick of a frame, besides stepping it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mark {
    /// Nothing.
    #[default]
    None,
    /// It computes the hash of its world, for the comparison.
    Compare,
    /// Every stroke ends and no earlier step can be undone, so that a world restored from a
    /// checkpoint of this tick goes on like all others.
    Checkpoint,
}

/// Permissions of a person.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Sculpts, sees, and may take over from a host that is gone.
    Sculptor,
    /// Sees, and does nothing: a wall, a projector.
    Viewer,
    /// Sends samples, and sees nothing: a tablet on a computer without a screen.
    Device,
}

impl Role {
    /// As a person writes it.
    pub fn name(self) -> &'static str {
        match self {
            Role::Sculptor => "sculptor",
            Role::Viewer => "viewer",
            Role::Device => "device",
        }
    }

    pub(crate) fn code(self) -> u8 {
        match self {
            Role::Sculptor => 0,
            Role::Viewer => 1,
            Role::Device => 2,
        }
    }

    pub(crate) fn of_code(code: u8) -> Result<Role, BadBytes> {
        [Role::Sculptor, Role::Viewer, Role::Device].get(usize::from(code)).copied().ok_or(BadBytes)
    }
}

/// Marks the role of somebody who has gone.
const GONE: u8 = 0x80;

/// Somebody who came, or has gone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Arrival {
    /// The person's number.
    pub person: PersonId,
    /// The person's name, at most [`MAX_NAME`] bytes.
    pub name: String,
    /// Permissions of the person.
    pub role: Role,
    /// The person is connected from now on; else no longer.
    pub here: bool,
}

impl Arrival {
    pub(crate) fn put(&self, out: &mut Vec<u8>) {
        let gone = if self.here { 0 } else { GONE };
        out.extend([self.person, self.role.code() | gone]);
        put_bytes(out, self.name.as_bytes());
    }

    pub(crate) fn take(bytes: &mut ByteReader<'_>) -> Result<Arrival, BadBytes> {
        let person = bytes.byte()?;
        let code = bytes.byte()?;
        let (role, here) = (Role::of_code(code & !GONE)?, code & GONE == 0);
        Ok(Arrival { person, name: bytes.text(MAX_NAME)?, role, here })
    }
}

/// The input of one tick, in its order.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Counts frames, from 1 without a gap, across all hosts.
    pub index: u64,
    /// The tick of the input.
    pub tick: u64,
    /// Task after the tick.
    pub mark: Mark,
    /// People who came, and those found to be gone, before the tick.
    pub arrivals: Vec<Arrival>,
    /// In the order in which they are stepped.
    pub batches: Vec<Batch>,
}

impl Frame {
    /// Returns true if the frame has input.
    pub fn has_input(&self) -> bool {
        !self.batches.is_empty()
    }
}

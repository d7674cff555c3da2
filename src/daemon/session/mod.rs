//! The session file `NAME.sculpt`: one SQLite database that holds the start mesh, the settings in
//! force, and every `Sample` and `Command` by tick. Opening it is replaying it: the same start and
//! the same input give the same bits.
//!
//! Laws kept here:
//! * The tick thread only hands over data and never waits ([`writer`]).
//! * Input is safe from a kill as soon as the journal has it ([`shared_memory_log`]), is committed
//!   at most [`GROUP_MS`] after its tick, and then synced, safe from a power cut.
//! * What was written is never rewritten: a group is a row, a row carries its checksum, a torn tail
//!   is dropped and said.

pub mod catalog;
pub mod film;
pub mod format;
pub mod history;
pub mod reader;
pub mod replay;
pub mod salvage;
pub mod shared_memory_log;
mod syncer;
pub mod writer;

pub use reader::{Loss, OpenError, Opened, open};
pub use salvage::{Saved, salvage};
pub use writer::{Fault, Health, SessionWriter, create, resume};

/// Longest time that input waits for its group to be written, milliseconds. Well under the 250 ms
/// that a crash may cost.
pub const GROUP_MS: u64 = 50;

/// The version of the file's layout, and of what the clay does with the input in it: where strokes
/// fall, what brushes and levels do. A session is its input, so a file of another version is
/// refused by name and left as it is.
pub const VERSION: u32 = 3;

/// "SCLP": tells a session from any other SQLite file (`PRAGMA application_id`).
pub const APPLICATION_ID: i32 = 0x53_43_4c_50;

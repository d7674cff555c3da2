//! The session file `NAME.sculpt`: one SQLite database that holds the start mesh, the settings in
//! force, and every `Sample` and `Command` by tick. Opening it is replaying it: the same start and
//! the same input give the same bits.
//!
//! Laws kept here:
//! * The tick thread only hands over data and never waits ([`writer`]).
//! * Input is safe from a kill as soon as the journal has it ([`shared_memory_log`]), is committed
//!   at most [`GROUP_MS`] after its tick, and then synced, safe from a power cut.
//! * Written input is never rewritten: a group is a row, and a row carries its number, its checksum
//!   and the chain of all rows before it. Missing or torn input is reported in ticks ([`reader`]).
//! * A file of a session's name is a whole session or none ([`create`]).
//! * A damaged file is never written to: what can be read goes into a new one ([`salvage()`]).

pub mod acknowledgement;
pub mod carve;
pub mod catalog;
mod connection;
mod create;
pub mod film;
pub mod format;
mod health;
pub mod history;
mod hold;
mod input_end;
pub mod place;
pub mod reader;
mod reopen;
pub mod replay;
pub mod salvage;
pub mod shared_memory_log;
mod start;
pub mod stored_polygons;
mod syncer;
pub mod writer;

pub use connection::in_use;
pub use create::{CreateError, is_half_made};
pub use health::{Fault, Health};
pub use hold::{HeldSession, hold};
pub use reader::{Loss, OpenError, Opened, open};
pub use reopen::{Reopened, reopen};
pub use salvage::{Saved, salvage};
pub use start::SessionStart;
pub use writer::{SessionWriter, create, create_with, resume, resume_held};

/// Longest time that input waits for its group to be written, milliseconds. Well under the 250 ms
/// that a crash may cost.
pub const GROUP_MS: u64 = 50;

/// The version of the file's layout. Files of older layouts open at their newest checkpoint; those
/// of newer ones are refused by name and left as they are. It goes up with every release in which
/// the bytes change, or what the clay does with the same input.
pub const VERSION: u32 = 4;

/// "SCLP": tells a session from any other SQLite file (`PRAGMA application_id`).
pub const APPLICATION_ID: i32 = 0x53_43_4c_50;

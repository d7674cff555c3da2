//! The history of a session: every place that the work was at, in the file, for undo that goes back
//! further than memory does, for branches, and for opening without replaying all.
//!
//! * A **node** is the work after a step. It names the pages that the step changed, before and
//!   after; a page is named by its number and revision, and stored once. So a node costs what its
//!   step changed, on a work of any size.
//! * Nodes make a **tree**: a step after an undo begins a branch beside the one that was taken
//!   back, which stays.
//! * A **checkpoint** is a node and the rest of the world's state. Opening a session is the newest
//!   checkpoint and the replay of what follows it.
//! * The file is bounded ([`retention`]): beyond so many bytes the oldest places go, never what
//!   opening the session needs.
//! * The world is changed by commands alone: [`keeper`] fetches pages and sends a
//!   [`sculptd_engine::command::Jump`], which names them. A replay finds them in the file again.
//!   What the keeper has not written yet is in memory still; what it never wrote is replayed from
//!   the log.

mod history_writer;
pub mod keeper;
pub mod listing;
mod page_name;
pub mod retention;
pub mod store;
pub mod stored_scene;
mod thumbnail;
pub mod tree;
mod world_at_rest;

pub use keeper::{Handle, Keeper, Want};
pub use store::{Store, StoreError};
pub use tree::{Node, Tree};

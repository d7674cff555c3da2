//! The control socket: JSON-RPC 2.0, one message a line, on a Unix socket that only its owner may
//! open. The requests, the replies and the limits are the crate `sculptd-control`.
//!
//! Laws kept here:
//! * Nobody from outside holds up the loop: a request becomes a `Command` in a bounded queue or
//!   samples in the bounded channel, or reads what was published.
//! * Everything has a limit: a message's bytes, its nesting, requests a second, clients at a time,
//!   the time that a silent client keeps its place, the bytes of a file that is loaded.
//! * No TCP. A web page cannot reach a Unix socket; mode 0600 and the peer's user id keep other
//!   users out.
//!
//! Read first: [`host`] (what a request may touch), [`handler`] (what each method does), [`server`]
//! (connections), [`stroke`] (a stroke as a request).

pub mod events;
mod face_sets;
mod guests_reply;
pub mod handler;
mod history;
pub mod host;
pub mod jobs;
mod joining;
mod layers;
pub mod loop_link;
mod mask;
mod measurement;
mod people_reply;
mod places;
mod repairs;
mod retopology;
mod scene;
pub mod server;
mod snap;
mod status_reply;
pub mod stroke;
mod view_region;
mod waiting_room;

pub use host::Host;
pub use sculptd_control::client;
pub use sculptd_control::client::default_path;
pub use sculptd_control::status::PROTOCOL;
pub use sculptd_control::wire::{IDLE_SECONDS, MAX_CLIENTS, MAX_DEPTH, MAX_MESSAGE, MAX_RATE};
pub use server::Server;

/// The user that this process runs as.
pub fn user_id() -> u32 {
    rustix::process::getuid().as_raw()
}

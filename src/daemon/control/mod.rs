//! The control socket: JSON-RPC 2.0, one message a line, on a Unix socket that only its owner may
//! open.
//!
//! Laws kept here:
//! * Nobody from outside holds up the loop: a request becomes a `Command` in a bounded queue, or
//!   reads what was published.
//! * Everything has a limit: a message's bytes, its nesting, requests a second, clients at a time.
//! * No TCP. A web page cannot reach a Unix socket; mode 0600 and the peer's user id keep other
//!   users out.

pub mod client;
pub mod events;
pub mod methods;
pub mod protocol;
pub mod server;

pub use server::{Host, Server};

use std::path::PathBuf;

/// Longest line, bytes. The largest honest request is a path and a dozen numbers.
pub const MAX_MESSAGE: usize = 64 << 10;
/// Deepest nesting of a request. The deepest honest one has four levels.
pub const MAX_DEPTH: usize = 16;
/// Clients at a time; the next is told so and closed.
pub const MAX_CLIENTS: usize = 8;
/// Requests a second and client; more are answered with an error.
pub const MAX_RATE: u32 = 200;
/// The protocol's own version, told by `status` and checked when a client names one.
pub const PROTOCOL: u32 = 1;

/// Where the daemon listens: `$XDG_RUNTIME_DIR/sculptd.sock`, else a folder of the user's own under
/// the temporary folder.
pub fn default_path() -> PathBuf {
    match std::env::var_os("XDG_RUNTIME_DIR") {
        Some(dir) if !dir.is_empty() => PathBuf::from(dir).join("sculptd.sock"),
        _ => std::env::temp_dir().join(format!("sculptd-{}", user_id())).join("sculptd.sock"),
    }
}

/// The user that this process runs as.
pub fn user_id() -> u32 {
    rustix::process::getuid().as_raw()
}

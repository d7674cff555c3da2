//! Tracked hands over the Leap WebSocket protocol, versions 6 and 7.
//!
//! Rules:
//! * Nothing that a server can send panics, allocates without bound, or yields a number that is not
//!   finite.
//! * A field that is missing, null, of the wrong shape or out of reason is an absence, not an
//!   error; only a message that is not JSON, too large or too deep is one.
//! * Bytes and messages a second are bounded, and so is the time until the stop flag is seen,
//!   whatever the server sends or withholds.
//!
//! Sources: the leapjs client 1.1.1 (field names and handshake) and recordings of real services
//! (what is missing when).

mod bounded_stream;
pub mod client;
pub mod clock_map;
pub mod file;
pub mod frame;
mod lenient;

pub use client::{LeapConfig, LeapHandle, LeapStatus, start};
pub use clock_map::ClockMap;
pub use file::FrameFile;
pub use frame::{Frame, FrameError, Message, parse_frame, parse_message};

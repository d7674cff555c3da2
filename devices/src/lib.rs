//! Everything between a wire and a [`Sample`].
//!
//! Pens over HID: [`catalogue`] says which model a device is, [`hid`] reads its reports, [`pen_state`] judges them;
//! [`recording::Player`] plays recorded bytes through the same objects:
//!
//! ```no_run
//! # use sculptd_devices::{catalogue::Catalogue, recording::Player, DeviceId};
//! let catalogue = Catalogue::builtin()?;
//! let mut player = Player::open("pen.hid".as_ref(), DeviceId(1), &catalogue)?;
//! player.start_at(5_000_000); // the first report falls at 5 s
//! while let Some(due) = player.next_due_us() {
//!     player.advance(due, &mut |sample| println!("{sample:?}"));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod builtin;
pub mod calibration;
pub mod catalogue;
pub mod clock;
pub mod filter;
#[doc(hidden)]
pub mod fuzzing;
pub mod hid;
pub mod latency;
pub mod leap;
mod lifeline;
pub mod pen_state;
pub mod queue;
pub mod recording;
pub mod sample;
pub mod serial;
pub mod sim;
pub mod tablet;

pub use clock::Clock;
pub use sample::{Body, DeviceId, Finger, Hand, Hands, Pad, Pen, Sample, Tool};

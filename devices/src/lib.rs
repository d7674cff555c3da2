//! Everything between a wire and a [`Sample`].
//!
//! | room | what it does | its threads |
//! |---|---|---|
//! | [`hid`] with [`catalogue`], [`tablet`] | pen tablets: which model, its reports, plug and replug | one watcher, one reader an interface |
//! | [`serial`] | serial pens: four protocols, resync, probing of allowed ports only | one a port |
//! | [`leap`] | tracked hands: WebSocket client, frames, the tracker's clock | one a service |
//! | [`pen_state`] | what a pen means, alike for every family | none |
//! | [`calibration`], [`filter`] | what a person set for a tablet; steady hands | none |
//! | [`queue`] | the one door out: bounded, lock-free, no transition lost | none |
//! | [`recording`] | recorded bytes through the same objects | none |
//! | [`sim`] | simulated devices that speak bytes, for anyone's tests | one a device, if it runs by itself |
//!
//! Absences: no mesh, no config file, no global state; no reader waits for the consumer except with
//! its own list of kept samples full of transitions; no port or service is opened that was not
//! named or allowed.
//!
//! Pens over HID: [`catalogue`] says which model a device is, [`hid`] reads its reports,
//! [`pen_state`] judges them; [`recording::Player`] plays recorded bytes through the same objects:
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
//!
//! [`hid::start`] watches the machine's own tablets and reads each on a thread of its own;
//! [`hid::HidHandle::status`] lists what is read and what is not, with the reason. A new model is a
//! file in `tablets/`, or in a folder given to [`catalogue::Catalogue::with_dir`]: [`tablet`] says
//! what stands in it.

#![warn(missing_docs)]

mod builtin;
pub mod calibration;
pub mod catalogue;
pub mod clock;
pub mod descriptor;
mod device_thread;
pub mod filter;
#[doc(hidden)]
pub mod fuzzing;
pub mod hid;
pub mod latency;
pub mod leap;
pub mod long_array;
pub mod pad_actions;
pub mod pen_state;
pub mod queue;
pub mod recording;
pub mod report;
pub mod sample;
#[cfg(test)]
mod scenarios;
pub mod serial;
pub mod sim;
pub mod tablet;

pub use clock::Clock;
pub use sample::{Body, DeviceId, Finger, Hand, Hands, Pad, Pen, Sample, Tool};

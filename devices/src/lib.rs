//! Reads pen tablets, serial pens and hand trackers: from the bytes on the wire to [`Sample`]s.
//!
//! **Read first:** [`sample`], the type that comes out; then [`catalogue`], how a model is
//! recognised; then [`hid`], how its reports are read. `examples/decode.rs` shows all three.
//!
//! | module | what it does | its threads |
//! |---|---|---|
//! | [`sample`] | the state of a device at one instant: mm, 0 to 1, radians | none |
//! | [`hid`] | pen tablets over HID: parsers, readers, replug | one, and one an interface |
//! | [`catalogue`], [`tablet`] | facts of each model, and identification of devices | none |
//! | [`descriptor`], [`report`] | report descriptors; data that a parser reads in a report | none |
//! | [`pen_state`] | proximity, contact, tool and buttons, for every family alike | none |
//! | [`pad_actions`] | actions of keys, wheels, rings, barrel buttons and the eraser | none |
//! | [`serial`] | serial pens: four protocols, resync, probing of allowed ports only | one a port |
//! | [`leap`] | tracked hands: WebSocket client, frames, the tracker's clock | one a service |
//! | [`browser`] | pens, fingers and mice of a web page, from its batches | none |
//! | [`calibration`], [`filter`] | settings for a tablet; jitter of tracked hands | none |
//! | [`prediction`] | predicted pen position when a frame is seen; only for display | none |
//! | [`queue`] | the channel to the consumer: bounded, lock-free, no transition lost | none |
//! | [`recording`] | recorded bytes, played through the same decoders | none |
//! | [`sim`] | simulated devices that send bytes, for tests and demos | one a device that plays |
//!
//! The crate has no mesh, window or global state, and reads no configuration file. No reader waits
//! for the consumer, except when its list of kept samples is full of transitions. Only ports
//! and services that were named or allowed are opened.
//!
//! [`recording::Player`] plays a recording through the decoders that read live devices:
//!
//! ```
//! use sculptd_devices::catalogue::Catalogue;
//! use sculptd_devices::recording::{Player, hid_recorder};
//! use sculptd_devices::{Body, DeviceId};
//!
//! // A pen over a tablet with this report descriptor, as `hid-recorder` writes it.
//! let text = "\
//! N: Acme Slate
//! I: 3 1209 0001
//! R: 52 05 0d 09 02 a1 01 85 01 09 20 a1 00 09 42 09 32 15 00 25 01 75 01 95 02 81 02 95 06 \
//!     81 03 05 01 26 10 27 75 10 95 01 09 30 81 02 26 88 13 09 31 81 02 c0 c0
//! E: 0.000 6 01 02 88 13 c4 09
//! E: 0.004 6 01 03 88 13 c4 09
//! E: 0.008 6 01 00 00 00 00 00
//! ";
//! let recording = hid_recorder::parse(text).map_err(|bad| bad.what)?;
//! let catalogue = Catalogue::builtin()?;
//! let mut player = Player::of("slate".as_ref(), recording, DeviceId(1), &catalogue)?;
//! let mut contacts = Vec::new();
//! player.advance(1_000_000, &mut |sample| {
//!     if let Body::Pen(pen) = sample.body {
//!         contacts.push((pen.in_range, pen.tip));
//!     }
//! });
//! assert_eq!(contacts, [(true, false), (true, true), (false, false)]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`hid::start`] watches the machine's tablets and reads each on a separate thread;
//! [`hid::HidHandle::status`] lists the read and the rejected interfaces, with the reason. A new
//! model is a file in `tablets/`, or in a folder passed to
//! [`catalogue::Catalogue::with_dir`]; [`tablet`] documents its fields.
//!
//! The crate was run on Linux only. The code for Windows and macOS is built from the same sources.

#![deny(missing_docs)]

pub mod browser;
mod builtin;
pub mod calibration;
pub mod catalogue;
pub mod clock;
pub mod descriptor;
pub mod device_thread;
pub mod filter;
#[doc(hidden)]
pub mod fuzzing;
pub mod hid;
pub mod latency;
pub mod leap;
pub mod long_array;
pub mod pad_actions;
pub mod pen_state;
pub mod prediction;
pub mod pressure_use;
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

//! Pens over HID: from report bytes to samples.
//!
//! ```text
//! transport -> bytes -> parser -> Parsed -> PenState, PadState -> Sample
//! ```
//!
//! A transport is hidapi or a simulation; recordings feed their bytes to the decoder. There is one
//! parser for each family of tablets: it sees one report and a few bytes of memory, and it never
//! indexes by a size that a descriptor declares. A [`decoder::Decoder`] joins a parser, the facts
//! of a model and a [`crate::pen_state::PenState`]; live devices, recordings and tests all use it.

pub mod bus;
pub mod crosscheck;
pub mod decoder;
pub mod digitiser;
pub mod family;
pub mod pad_state;
pub mod pen_firmware;
pub mod reader;
pub mod tap;
pub mod transport;
pub mod uclogic;
pub mod vendors;
pub mod wacom_bamboo;
pub mod wacom_bluetooth;
pub mod wacom_display;
pub mod wacom_graphire;
pub mod wacom_intuos;
pub mod wacom_pad;
pub mod wacom_pro;
pub mod watch;

pub use watch::{HidConfig, HidHandle, NodeStatus, start};

//! HID pens: from report bytes to samples.
//!
//! ```text
//! transport (hidapi, a recording, a simulator) -> bytes -> parser (pure, one file a family) -> Parsed -> PenState -> Sample
//! ```
//!
//! A parser sees one report and a few bytes of memory; it never indexes by a declared size. A
//! [`decoder::Decoder`] binds a parser to a model's facts and to a [`crate::pen_state::PenState`];
//! live reading, recordings and tests all use it.

pub mod bus;
pub mod decoder;
pub mod digitiser;
pub mod family;
pub mod pad_state;
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

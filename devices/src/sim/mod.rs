//! Simulated devices that speak bytes: what they say goes through the same parsers and reader threads as a real device's.
//!
//! A **script** ([`PenScript`], [`HandScript`]) says where a pen or a hand is at any instant; a **device** ([`Tracker`] and
//! its fellows) turns that into wire bytes; [`Faults`] spoil them, the same way for the same seed. A device can be stepped
//! (`advance(until)`), so that with a manual [`crate::Clock`] two runs give the same bits.

pub mod faults;
pub mod hand;
pub mod journal;
pub mod pen;
pub mod serial;
pub mod tablet;
pub mod tracker;

pub use faults::Faults;
pub use hand::{HandKey, HandScript};
pub use journal::{Journal, journal};
pub use pen::{PenPose, PenScript, Shape, Stroke};
pub use serial::{SerialPen, SerialPenConfig};
pub use tablet::{Tablet, TabletConfig, TabletEnd};
pub use tracker::{Tracker, TrackerConfig};

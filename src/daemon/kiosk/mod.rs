//! An installation that nobody looks after: visitors come, sculpt and go, and each finds the place
//! as the first one did.
//!
//! Laws kept here:
//! * The cycle is a state machine driven by ticks ([`cycle`]): no clock, no IO.
//! * A reset leaves nothing of the visitor before: the world is begun anew by
//!   [`sculptd_engine::command::Command::Begin`].
//! * What is written (gallery, audit) appears whole or not at all, and says nothing of who was
//!   here.

#[cfg(feature = "s3")]
pub mod bucket;
pub mod cycle;
pub mod film;
pub mod gallery;
pub mod keeper;
pub mod names;
pub mod settings;
#[cfg(unix)]
pub mod share;
mod speech;
pub mod spool;

pub use cycle::{Cycle, KioskAct, Stage, View};
pub use settings::{FleetSettings, KioskConfig, Language, ScreenSettings};

//! An unattended installation: visitors come, sculpt and go, and each visitor starts from the same
//! state.
//!
//! Laws kept here:
//! * The cycle is a state machine driven by ticks ([`cycle`]): no clock, no IO.
//! * A reset removes everything of the previous visitor:
//!   [`sculptd_engine::command::Command::Begin`] replaces the world.
//! * Files (gallery, audit) appear complete or not at all, and contain nothing about the visitors.
//! * A visit that a kill or a power cut interrupts goes on at the next start, or its work goes to
//!   the gallery ([`visit_journal`]).
//! * A visitor's first stroke is whole: it waits for the visit that it begins ([`visit_door`]).

mod attract;
#[cfg(feature = "s3")]
pub mod bucket;
pub mod cycle;
pub mod desk;
pub mod exhibit;
mod farewell;
mod felt;
pub mod film;
pub mod gallery;
pub mod hours;
pub mod keeper;
pub mod names;
pub mod recovery;
pub mod settings;
#[cfg(unix)]
pub mod setup;
#[cfg(unix)]
pub mod share;
mod speech;
pub mod spool;
pub mod staff;
pub mod start;
#[cfg(target_os = "linux")]
pub mod trial;
pub mod unrecorded;
pub mod visit_door;
pub mod visit_journal;
pub mod wall;

pub use cycle::{Cycle, KioskAct, NextOpening, Stage, View};
pub use settings::{FleetSettings, Hint, Interrupted, KioskConfig, Language, ScreenSettings};

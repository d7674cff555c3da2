//! Wiring: the tick loop, its clock, what it publishes, and where input comes from.

pub mod adaptors;
#[cfg(unix)]
pub mod control;
pub mod doctor;
pub mod figures;
pub mod ghost;
pub mod joiner;
pub mod kiosk;
pub mod live;
#[cfg(unix)]
pub mod metrics;
#[cfg(unix)]
pub mod notify;
pub mod pacer;
pub mod published;
pub mod rig;
#[cfg(unix)]
pub mod service;
pub mod session;
pub mod stepped;
pub mod trim;

pub use figures::{Figures, Summary};
pub use published::{Published, Publisher};

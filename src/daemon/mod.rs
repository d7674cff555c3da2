//! Wiring: the tick loop, its clock, what it publishes, and where input comes from.

pub mod adaptors;
#[cfg(unix)]
pub mod control;
pub mod figures;
pub mod ghost;
pub mod joiner;
pub mod live;
pub mod pacer;
pub mod published;
pub mod rig;
pub mod session;
pub mod stepped;

pub use figures::{Figures, Summary};
pub use published::{Published, Publisher};

//! The window: a wgpu viewer and egui panels over snapshots of the clay.
//!
//! Law kept here: the window sees snapshots and sends commands; it changes nothing itself. It has
//! the main thread of the daemon's process, and the loss of its X server or compositor costs that
//! thread alone: `sculptd_daemon::window_link` says what is taken back, `cli::window_guard` how the
//! process goes on.
//!
//! Read first: [`viewer`], then [`panels`]; what they say comes from [`language`].
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod language;
pub mod look;
pub mod panels;
pub mod sound;
pub mod viewer;

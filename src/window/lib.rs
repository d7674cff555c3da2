//! The window: a wgpu viewer and egui panels over snapshots of the clay.
//!
//! Law kept here: the window sees snapshots and sends commands; it changes nothing itself. It runs
//! on the main thread of the daemon's process, and the loss of its X server or compositor ends only
//! that thread. `sculptd_daemon::window_link` defines what is undone then, and `cli::window_guard`
//! how the process continues.
//!
//! Read first: [`viewer`], then [`panels`]; their texts come from [`language`].
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod language;
pub mod look;
pub mod panels;
pub mod viewer;

//! The window: a wgpu viewer and egui panels over snapshots of the clay.
//!
//! Law kept here: the window sees snapshots and sends commands; it changes nothing itself. It runs
//! in the process of the daemon, so the loss of the X server still ends both; the session file
//! stays.
//!
//! Read first: [`viewer`], then [`panels`].
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod look;
pub mod panels;
pub mod viewer;

//! # sculptd: the map
//!
//! `sculptd` turns the movements of a hand into clay, in real time.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod analysis;
pub mod brush;
pub mod cli;
pub mod command;
pub mod config;
pub mod daemon;
pub mod hand;
pub mod mesh;
#[cfg(feature = "viewer")]
pub mod panels;
pub mod simd;
pub mod stroke;
#[cfg(feature = "viewer")]
pub mod viewer;
pub mod world;

pub use sculptd_devices as devices;

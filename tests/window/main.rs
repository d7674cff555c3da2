//! The real window on a separate screen: a separate binary, because these tests run one at a time.
//!
//! `SCULPTD_SHOTS=folder` saves the pictures; `SCULPTD_BLESS=1` rewrites the references: look at
//! them first.
#![cfg(unix)]
#![allow(clippy::print_stdout)] // Figures and skips are told on standard output.

mod check;
mod courses;
mod desktop;
mod exhibits;
mod files;
mod fingers;
mod first_minutes;
mod four_views;
mod idle;
mod kiosk_screens;
mod lost_screen;
mod objects;
mod places;
mod presses;
mod regions;
mod sessions;
mod stage;
mod versions;
mod x_server;

//! One binary for all integration tests: one link, one start.
#![allow(clippy::print_stdout)] // Tables and skips are told on standard output.

mod allocations;
mod bad_input;
mod boolean;
mod brushes;
mod camera;
#[cfg(unix)]
mod cancel;
mod check;
mod clay;
#[cfg(unix)]
mod control;
#[cfg(unix)]
mod daemon_process;
mod exhibits;
#[cfg(target_os = "linux")]
mod faulty_disk;
mod field;
#[cfg(all(unix, feature = "network"))]
mod fleet;
#[cfg(unix)]
mod gallery;
mod golden;
mod hands;
mod history;
#[cfg(target_os = "linux")]
mod hostile;
#[cfg(target_os = "linux")]
mod hostile_files;
#[cfg(target_os = "linux")]
mod hostile_trackers;
#[cfg(target_os = "linux")]
mod http_server;
mod io;
mod io_files;
mod kiosk;
#[cfg(unix)]
mod kiosk_kills;
#[cfg(unix)]
mod kiosk_setup;
#[cfg(target_os = "linux")]
mod kiosk_trial;
mod meanwhile;
mod mesh_craft;
#[cfg(unix)]
mod mutations;
mod new_surfaces;
mod own_brushes;
#[cfg(unix)]
mod random_requests;
#[cfg(unix)]
mod random_work;
#[cfg(unix)]
mod read_back;
mod recovery;
mod remesh_live;
#[cfg(unix)]
mod repairs;
mod retopology_live;
#[cfg(unix)]
mod scene;
mod seeded;
mod service;
mod sessions;
#[cfg(all(unix, feature = "network"))]
mod shared;
mod slices;
mod soak;
mod synthetic_hands;

use std::path::PathBuf;

#[cfg(target_os = "linux")]
mod telemetry;
mod thickness;
mod thickness_live;
mod thickness_shapes;
#[cfg(target_os = "linux")]
mod time;
mod tree;
#[cfg(feature = "viewer")]
mod viewer;
mod waiting;
mod wall_parts;
#[cfg(unix)]
mod web;

/// The folder of real recordings and meshes, where the environment names one.
pub fn corpus() -> Option<PathBuf> {
    let found = std::env::var_os("SCULPTD_CORPUS").map(PathBuf::from).filter(|p| p.is_dir());
    if found.is_none() {
        println!("skipped: SCULPTD_CORPUS not set or not a folder");
    }
    found
}

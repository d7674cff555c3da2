//! Pens over HID against real devices: the kernel's own decode, every recording, another descriptor
//! parser.

#![allow(clippy::print_stdout)] // Tests print what they compared and what they skipped.

use std::path::PathBuf;

mod catalogue;
mod corpus;
mod crosscheck;
mod facts;
mod oracle;
mod pens;
mod plausible;

/// The folder of real recordings, where the environment names one.
fn devices() -> Option<PathBuf> {
    let found = std::env::var_os("SCULPTD_CORPUS").map(|p| PathBuf::from(p).join("devices/open"));
    let found = found.filter(|p| p.is_dir());
    if found.is_none() {
        println!("skipped: SCULPTD_CORPUS not set or without devices");
    }
    found
}

fn files(dir: &std::path::Path, ending: &str) -> Vec<PathBuf> {
    let mut all: Vec<PathBuf> =
        std::fs::read_dir(dir).unwrap().map(|e| e.unwrap().path()).collect();
    all.retain(|p| p.to_string_lossy().ends_with(ending));
    all.sort();
    all
}

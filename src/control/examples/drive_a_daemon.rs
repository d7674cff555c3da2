//! Drives a running daemon: agrees on a version, takes a larger brush, makes a stroke across the
//! view, prints what changed.
//!
//! `sculptd run --headless` in one terminal, then
//! `cargo run -p sculptd-control --example drive_a_daemon [SOCKET]` in another.
#![allow(clippy::print_stdout)] // An example tells what it did.

use std::error::Error;
use std::path::PathBuf;
use std::time::Duration;

use sculptd_control::Client;
use sculptd_control::brush::{BrushSettings, StrokeParams, StrokePoint, StrokeSpace};
use sculptd_control::client::default_path;
use sculptd_control::method::{Brush, Hash, Status, Stroke, Subscribe};

fn main() -> Result<(), Box<dyn Error>> {
    let socket = std::env::args_os().nth(1).map_or_else(default_path, PathBuf::from);
    let mut daemon = Client::connect(&socket, Duration::from_secs(30))?;
    let hello = daemon.hello()?;
    println!("sculptd {}, protocol {}", hello.version, hello.protocol);

    daemon.call::<Subscribe>(&Default::default())?;
    let larger = BrushSettings { radius: Some(0.2), ..Default::default() };
    let brush = daemon.call::<Brush>(&larger)?;
    println!("brush {} of radius {}", brush.kind.unwrap_or_default(), larger.radius.unwrap_or(0.0));

    let before = daemon.call::<Hash>(&Default::default())?.hash;
    // From left to right through the middle of the view, in a second, harder in the middle.
    let points = (0..=100).map(|i| {
        let along = f64::from(i) / 100.0;
        let pressure = (along * std::f64::consts::PI).sin();
        StrokePoint::View([0.3 + 0.4 * along, 0.5, pressure, 10.0 * f64::from(i)])
    });
    let stroke = StrokeParams { points: points.collect(), space: StrokeSpace::View, brush: None };
    let made = daemon.call::<Stroke>(&stroke)?;
    println!("{} samples, taken by tick {}", made.samples, made.tick);

    while let Some(notice) = daemon.next_event(Duration::from_millis(500))? {
        println!("tick {}: {:?}", notice.tick, notice.event.name());
    }
    let status = daemon.call::<Status>(&Default::default())?;
    let after = daemon.call::<Hash>(&Default::default())?.hash;
    println!("{} dabs, hash {before} -> {after}", status.dabs);
    Ok(())
}

//! A Boolean by the library alone, for `python.py`, which takes turns with it.
//!
//! `library A.ply B.ply` reads two meshes once. Then for each line of standard input it takes B out
//! of A and prints the seconds from the loaded polygons to the result's triangles, their number and
//! the volume.

#![allow(clippy::print_stdout)] // What `python.py` reads.

use std::io::BufRead;
use std::path::Path;
use std::process::ExitCode;

use sculptd_devices::Clock;
use sculptd_geometry::boolean::{BooleanOptions, Operation, compute};
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::written::triangulated;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("{e}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let (job, clock) = (Job::default(), Clock::monotonic());
    let files: Vec<String> = std::env::args().skip(1).collect();
    let [a, b] = &files[..] else { return Err("expected two mesh files".into()) };
    let (a, b) = (read_mesh(Path::new(a), &job)?.mesh, read_mesh(Path::new(b), &job)?.mesh);
    for line in std::io::stdin().lock().lines() {
        line?;
        let begun = clock.now_us();
        let options = BooleanOptions::default();
        let (solids, _) = compute([&a, &b], &[Operation::Difference], &options, &job, || 0.0)?;
        let Some(solid) = solids.into_iter().next() else { return Err("no result".into()) };
        let made = triangulated(&solid.mesh);
        let seconds = (clock.now_us() - begun) as f64 * 1e-6;
        println!("{seconds} {} {:?}", made.face_count(), solid.facts.volume);
    }
    Ok(())
}

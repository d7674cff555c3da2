//! Wall thickness of a mesh file as numbers, one line a vertex: x, y, z and the thickness there.
//!
//! ```text
//! cargo run --release -p sculptd-geometry --example thickness_as_numbers -- part.stl
//! ```
//!
//! Without an argument the part is a ring, 2 mm thick.
#![allow(clippy::print_stdout)] // An example tells what it did.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::{Reason, ThicknessSettings, measure};
use sculptd_geometry::{CentredMesh, shapes};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("{e}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let job = Job::default();
    let mesh = match std::env::args().nth(1) {
        Some(path) => read_mesh(Path::new(&path), &job)?.mesh,
        None => shapes::torus(20.0, 1.0, 96, 24),
    };
    // Single precision is enough in the part's own frame, wherever the part lies.
    let part = CentredMesh::new(&mesh, 1.0);
    let walls = measure(&part.mesh, &ThicknessSettings::default(), &job)?;
    for (v, (&value, &reason)) in walls.values.iter().zip(&walls.reasons).enumerate() {
        let p = part.to_file(part.mesh.positions[v]);
        match reason {
            Reason::Measured => println!("{} {} {} {value}", p.x, p.y, p.z),
            other => println!("{} {} {} {value} # {other:?}", p.x, p.y, p.z),
        }
    }
    let summary = walls.summary();
    println!(
        "# least {:?}, median {:?}, most {:?}, error bound {}",
        summary.min, summary.median, summary.max, summary.error_bound
    );
    Ok(())
}

//! Union, intersection or difference of two mesh files:
//!
//! ```text
//! cargo run --release -p sculptd-geometry --example boolean_of_two_files -- \
//!     difference part.stl tool.obj result.ply
//! ```
//!
//! Without arguments the operands are a cube and a ball, and the result is written to a temporary
//! folder.
#![allow(clippy::print_stdout)] // An example tells what it did.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::DVec3;
use sculptd_geometry::boolean::{BooleanOptions, Operation, compute};
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, check, shapes};

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
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (operation, a, b, out) = match &arguments[..] {
        [] => {
            let cube = shapes::cuboid(DVec3::splat(-1.0), DVec3::splat(1.0));
            let out = std::env::temp_dir().join("boolean_of_two_files.ply");
            (Operation::Difference, cube, shapes::icosphere(1.2, 20).to_poly(), out)
        }
        [operation, a, b, out] => {
            let operation = match operation.as_str() {
                "union" => Operation::Union,
                "intersection" => Operation::Intersection,
                "difference" => Operation::Difference,
                _ => return Err("expected union, intersection or difference".into()),
            };
            let read = |path: &String| -> Result<PolyMesh, Box<dyn Error>> {
                Ok(read_mesh(Path::new(path), &Job::default())?.mesh)
            };
            (operation, read(a)?, read(b)?, PathBuf::from(out))
        }
        _ => return Err("expected an operation, two mesh files and the result's name".into()),
    };
    // The last argument is a clock for the phases' times, which this program does not print.
    let (solids, report) =
        compute([&a, &b], &[operation], &BooleanOptions::default(), &job, || 0.0)?;
    for warning in &report.warnings {
        eprintln!("warning: {warning}");
    }
    let Some(solid) = solids.into_iter().next() else { return Err("no result".into()) };
    write_mesh(&out, &solid.mesh)?;
    // Prints the facts of the file, not of the mesh in memory.
    let written = check::report(&read_mesh(&out, &job)?.mesh, true, &job)?;
    println!(
        "{}: {} faces, volume {:?}, closed {}, {} crossing pairs",
        out.display(),
        written.faces,
        written.volume,
        written.closed,
        written.self_intersections.unwrap_or_default()
    );
    Ok(())
}

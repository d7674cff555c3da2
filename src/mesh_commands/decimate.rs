//! `sculptd decimate`: quadric edge collapse on a mesh file.

use std::path::PathBuf;

use super::convert::deliver;
use super::info::interrupted;
use super::{Fail, Outcome};
use sculptd_geometry::decimate::{DecimationTarget, decimate};
use sculptd_geometry::io::{read_mesh, writable_format};
use sculptd_geometry::job::Job;

#[derive(Debug, Clone, clap::Args)]
pub struct DecimateArgs {
    pub mesh: PathBuf,
    /// Stop at this many triangles.
    #[arg(long, default_value_t = 0, required_unless_present = "max_error")]
    pub faces: usize,
    /// Stop before the error of a collapse exceeds this, in the mesh's unit: the root of the mean
    /// square distance of the new vertex from the planes of the triangles that it stands for. It
    /// is no bound on the distance between the surfaces.
    #[arg(long, value_name = "DISTANCE")]
    pub max_error: Option<f64>,
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

pub fn run(args: &DecimateArgs, json: bool) -> Outcome {
    writable_format(&args.output)?;
    if args.max_error.is_some_and(|e| e.is_nan() || e < 0.0) {
        return Err(Fail::Usage("--max-error: expected a distance of 0 or more".into()));
    }
    let job = Job::default();
    let loaded = read_mesh(&args.mesh, &job)?;
    let mut warnings = loaded.warnings;
    let target = DecimationTarget {
        triangles: args.faces,
        error: args.max_error.unwrap_or(f64::INFINITY),
        single: false,
    };
    let done = decimate(&loaded.mesh, None, target, &job).map_err(interrupted)?;
    let made = done.mesh;
    if done.new_crossings > 0 {
        warnings.push(format!(
            "{} pairs of triangles cross each other that did not before",
            done.new_crossings
        ));
    }
    if args.max_error.is_none() && made.face_count() > args.faces {
        warnings.push(format!(
            "stopped at {} triangles: more would break the surface",
            made.face_count()
        ));
    }
    deliver(&args.output, &made, warnings, json)
}

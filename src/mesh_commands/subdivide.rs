//! `sculptd subdivide`: Loop's or Catmull and Clark's scheme on a mesh file.

use std::path::PathBuf;

use super::convert::deliver;
use super::info::interrupted;
use super::{Fail, Outcome};
use sculptd_geometry::io::{read_mesh, writable_format};
use sculptd_geometry::job::Job;
use sculptd_geometry::subdivide::{MAX_CORNERS, catmull_clark, corners_after, loop_};

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Scheme {
    /// Triangles, each into four.
    Loop,
    /// Polygons, each into as many quadrilaterals as it has corners.
    CatmullClark,
}

#[derive(Debug, Clone, clap::Args)]
pub struct SubdivideArgs {
    pub mesh: PathBuf,
    #[arg(long, value_enum, default_value = "catmull-clark")]
    pub scheme: Scheme,
    /// Number of levels; each has four times the faces.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=12))]
    pub levels: u32,
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

pub fn run(args: &SubdivideArgs, json: bool) -> Outcome {
    writable_format(&args.output)?;
    let job = Job::default();
    let loaded = read_mesh(&args.mesh, &job)?;
    let corners = corners_after(&loaded.mesh, args.levels);
    if corners > MAX_CORNERS {
        return Err(Fail::Usage(format!(
            "--levels {}: expected at most {MAX_CORNERS} corners, found up to {corners}",
            args.levels
        )));
    }
    let made = match args.scheme {
        Scheme::Loop => loop_(&loaded.mesh, args.levels, &job),
        Scheme::CatmullClark => catmull_clark(&loaded.mesh, args.levels, &job),
    };
    deliver(&args.output, &made.map_err(interrupted)?, loaded.warnings, json)
}

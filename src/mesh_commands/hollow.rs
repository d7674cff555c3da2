//! `sculptd hollow`: a cavity inside a part, a wall of stated thickness around it.

use std::path::PathBuf;

use super::distance::{Ready, solid, timed, warn};
use super::remesh::{OldSurface, RemeshHow, finish, place};
use super::{Fail, Outcome};
use sculptd_geometry::io::writable_format;
use sculptd_geometry::job::Job;
use sculptd_geometry::offset::{hollow, too_thin};

#[derive(Debug, clap::Args)]
pub struct HollowArgs {
    /// The mesh file.
    pub mesh: PathBuf,
    /// The wall's thickness.
    #[arg(long, value_name = "MM")]
    pub wall: f64,
    /// File to write the new mesh to; the extension decides the format.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    #[command(flatten)]
    pub how: RemeshHow,
}

pub fn run(args: &HollowArgs, json: bool) -> Outcome {
    let job = Job::default();
    writable_format(&args.out)?;
    if !(args.wall > 0.0 && args.wall.is_finite()) {
        return Err(Fail::Usage("expected a wall thicker than nothing".into()));
    }
    let mut ready = solid(&args.mesh, &job)?;
    let mut warnings = std::mem::take(&mut ready.warnings);
    let Ready { part, solid, .. } = &ready;
    let (made, seconds) = timed(|| hollow(&part.mesh, solid, args.wall, args.how.side, &job));
    let made = made?;
    if made.spacing > args.wall * 0.5 {
        warnings.push(format!(
            "the wall is only {:.1} samples thick: a larger --side keeps it more exactly",
            args.wall / made.spacing
        ));
    }
    if made.wall < args.wall {
        warnings.push(format!(
            "the wall is {} at its thinnest place instead of {}: a larger --side keeps it",
            made.wall, args.wall
        ));
    }
    let cavity = &made.mesh.positions[part.mesh.positions.len()..];
    if let Some(lost) = too_thin(&part.mesh, solid, cavity, args.wall, args.how.side) {
        warnings.push(format!(
            "{:.1} mm2 of the surface have no cavity beneath them, for instance at {}: the part is \
             thinner than twice the wall there and stays solid",
            lost.area,
            place(&lost, part.centre)
        ));
    }
    warn(&args.mesh, &warnings);
    let old = OldSurface::of(&ready, &args.how, false);
    finish(&args.out, &made.mesh, part.centre, Some(old), seconds, warnings, json)
}

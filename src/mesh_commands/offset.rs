//! `sculptd offset`: a solid grown or shrunk, or melted together with another.

use std::path::PathBuf;

use super::distance::{Ready, solid, solid_about, timed, warn};
use super::remesh::{OldSurface, RemeshHow, finish, place};
use super::{Fail, Outcome};
use sculptd_geometry::io::writable_format;
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::offset::{offset, smooth_union, too_thin};

#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true).args(["distance", "unite"])))]
pub struct OffsetArgs {
    /// The mesh file.
    pub mesh: PathBuf,
    /// Distance to move the surface, at least, everywhere: outwards, or inwards if negative.
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub distance: Option<f64>,
    /// Instead: unite with the solid in this file, by a fillet of `--radius`.
    #[arg(long, value_name = "MESH")]
    pub unite: Option<PathBuf>,
    /// The fillet's radius, for `--unite`.
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    pub radius: f64,
    /// File to write the new mesh to; the extension decides the format.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    #[command(flatten)]
    pub how: RemeshHow,
}

pub fn run(args: &OffsetArgs, json: bool) -> Outcome {
    let job = Job::default();
    writable_format(&args.out)?;
    if !args.radius.is_finite() || !args.distance.unwrap_or(0.0).is_finite() {
        return Err(Fail::Usage("expected lengths that are finite".into()));
    }
    let mut ready = solid(&args.mesh, &job)?;
    let mut warnings = std::mem::take(&mut ready.warnings);
    let Ready { part, solid: a, .. } = &ready;
    let (made, seconds) = match (&args.unite, args.distance) {
        (Some(other), _) => {
            let Ready { solid: b, warnings: more, .. } =
                solid_about(other, Some(part.centre), &job)?;
            warnings.extend(more);
            timed(|| smooth_union(a, &b, args.radius, args.how.side, &job))
        }
        (None, distance) => {
            let wanted = distance.unwrap_or(0.0);
            let (made, seconds) = timed(|| offset(a, wanted, args.how.side, &job));
            let made = made?;
            if made.least < wanted.abs() {
                warnings.push(format!(
                    "the new surface is {} from the old one at its nearest place instead of {}: a \
                     larger --side keeps it",
                    made.least,
                    wanted.abs()
                ));
            }
            if wanted < 0.0
                && let Some(lost) =
                    too_thin(&part.mesh, a, &made.mesh.positions, -wanted, args.how.side)
            {
                let before = measures(&part.mesh).volume;
                warnings.push(format!(
                    "{:.1} mm2 of the surface vanish with the solid beneath them, for \
                     instance at {}: the part is thinner than twice the offset there. Its volume \
                     was {before:.4}",
                    lost.area,
                    place(&lost, part.centre)
                ));
            }
            (Ok(made.mesh), seconds)
        }
    };
    let made = made?;
    warn(&args.mesh, &warnings);
    let old = args.unite.is_none().then(|| OldSurface::of(&ready, &args.how, false));
    finish(&args.out, &made, part.centre, old, seconds, warnings, json)
}

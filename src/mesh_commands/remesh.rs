//! `sculptd remesh`: one closed surface of even triangles out of any mesh, or a mesh of quads that
//! follow the shape.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::Serialize;

use super::distance::{Ready, solid, timed, warn};
use super::remesh_quads::{QuadArgs, remesh_quads};
use super::{Fail, Outcome, answer};
use sculptd_geometry::bvh::Bvh8;
use sculptd_geometry::deviation::{Deviation, deviation};
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::io::{read_mesh, writable_format, write_mesh};
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::measure::measures;
use sculptd_geometry::remesh::{LostParts, RemeshError, RemeshSettings, remesh};
use sculptd_geometry::{CentredMesh, TriMesh};

#[derive(Debug, clap::Args)]
pub struct RemeshArgs {
    /// The mesh file: closed or not, crossed or not, of any number of shells.
    pub mesh: PathBuf,
    /// File to write the new mesh to; the extension decides the format.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    #[command(flatten)]
    pub how: RemeshHow,
    /// Keep sharp edges.
    #[arg(long)]
    pub sharp: bool,
    #[command(flatten)]
    pub quads: QuadArgs,
}

/// The resolution of the field.
#[derive(Debug, Clone, clap::Args)]
pub struct RemeshHow {
    /// Samples along the longest side of the box, 8 to 1024.
    #[arg(long, value_name = "N", default_value_t = 256)]
    pub side: usize,
}

/// The result; the same for every command that makes a mesh from the field. All of it is found on
/// the file that was written.
#[derive(Debug, Serialize)]
pub struct RemeshMade {
    pub file: PathBuf,
    pub vertices: usize,
    pub triangles: usize,
    pub volume: f64,
    pub area: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside_old: Option<BesideOld>,
    pub seconds: f64,
    pub warnings: Vec<String>,
}

/// The new surface beside the old one.
#[derive(Debug, Serialize)]
pub struct BesideOld {
    /// Volume of the old surface.
    pub volume: f64,
    /// The farthest place of the new surface from the old one.
    pub new_to_old: Farthest,
    /// The farthest place of the old surface from the new one, where the new one stands for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub old_to_new: Option<Farthest>,
}

/// The distance of a farthest place, between two bounds, and a place that is as far as the lower
/// one.
#[derive(Debug, Serialize)]
pub struct Farthest {
    pub at_least: f64,
    pub at_most: f64,
    pub place: [f64; 3],
}

/// The surface that a new one is made from.
#[derive(Debug)]
pub struct OldSurface<'a> {
    pub part: &'a CentredMesh,
    pub solid: &'a DistanceSolid,
    /// Distance between two samples of the field, along the longest side.
    pub spacing: f64,
    /// The new surface stands for the old one: they should be near each other.
    pub is_same: bool,
}

/// The bounds differ by at most this share of the spacing, and two per cent.
const RESOLUTION: f64 = 0.25;

impl<'a> OldSurface<'a> {
    pub fn of(ready: &'a Ready, how: &RemeshHow, is_same: bool) -> OldSurface<'a> {
        let (lo, hi) = ready.part.mesh.bounds();
        let spacing = f64::from((hi - lo).max_element()) / how.side as f64;
        OldSurface { part: &ready.part, solid: &ready.solid, spacing, is_same }
    }

    /// Measures the new surface beside it.
    fn beside(&self, new: &TriMesh, job: &Job) -> Result<BesideOld, Cancelled> {
        let old = &self.part.mesh;
        // The places are rounded to single precision in both.
        let rounding = f64::from(f32::EPSILON) * 4.0 * f64::from(largest(old).max(largest(new)));
        let farthest = |found: Deviation| Farthest {
            at_least: (found.at_least - rounding).max(0.0),
            at_most: found.at_most + rounding,
            place: (found.place + self.part.centre).to_array(),
        };
        let resolution = RESOLUTION * self.spacing;
        let new_to_old = deviation(new, old, &self.solid.tree, resolution, job)?;
        let old_to_new = match self.is_same {
            true => Some(deviation(old, new, &Bvh8::build(new, job)?, resolution, job)?),
            false => None,
        };
        Ok(BesideOld {
            volume: measures(old).volume,
            new_to_old: farthest(new_to_old),
            old_to_new: old_to_new.map(farthest),
        })
    }
}

fn largest(mesh: &TriMesh) -> f32 {
    let (lo, hi) = mesh.bounds();
    lo.abs().max(hi.abs()).max_element()
}

impl From<RemeshError> for Fail {
    fn from(e: RemeshError) -> Self {
        match e {
            RemeshError::Side(_) => Fail::Usage(e.to_string()),
            _ => Fail::Input(e.to_string()),
        }
    }
}

/// Writes the mesh, whose frame has its origin at `centre`, reads the file and prints what it is.
pub fn finish(
    out: &Path,
    mesh: &TriMesh,
    centre: DVec3,
    old: Option<OldSurface<'_>>,
    seconds: f64,
    warnings: Vec<String>,
    json: bool,
) -> Outcome {
    let job = Job::default();
    let mut poly = mesh.to_poly();
    poly.positions.iter_mut().for_each(|p| *p += centre);
    write_mesh(out, &poly)?;
    let mesh = CentredMesh::about(&read_mesh(out, &job)?.mesh, centre, 1.0).mesh;
    let m = measures(&mesh);
    let beside_old = old.map(|old| old.beside(&mesh, &job)).transpose();
    let made = RemeshMade {
        file: out.into(),
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
        volume: m.volume,
        area: m.area,
        beside_old: beside_old.map_err(|e| Fail::Input(e.to_string()))?,
        seconds,
        warnings,
    };
    answer(json, &made, |w| {
        writeln!(w, "{}: {} vertices, {} triangles", out.display(), made.vertices, made.triangles)?;
        writeln!(w, "volume {:.4} mm3, area {:.4} mm2, {:.3} s", made.volume, made.area, seconds)?;
        let Some(beside) = &made.beside_old else { return Ok(()) };
        if beside.old_to_new.is_some() {
            let gained = 100.0 * (made.volume - beside.volume) / beside.volume;
            writeln!(w, "volume before {:.4} mm3: {gained:+.3} %", beside.volume)?;
        }
        let far = &beside.new_to_old;
        let bounds = |far: &Farthest| format!("{:.4} to {:.4} mm", far.at_least, far.at_most);
        writeln!(w, "farthest place of the new surface from the old one: {}", bounds(far))?;
        match &beside.old_to_new {
            Some(far) => {
                writeln!(w, "farthest place of the old surface from the new one: {}", bounds(far))
            }
            None => Ok(()),
        }
    });
    Ok(())
}

/// A place of lost parts, in the coordinates of the file.
pub fn place(lost: &LostParts, centre: DVec3) -> String {
    let [x, y, z] = (lost.place.as_dvec3() + centre).to_array();
    format!("({x:.3}, {y:.3}, {z:.3})")
}

pub fn run(args: &RemeshArgs, json: bool) -> Outcome {
    if let Some(quads) = args.quads.quads {
        return remesh_quads(&args.mesh, &args.out, quads, &args.quads, json);
    }
    let job = Job::default();
    writable_format(&args.out)?;
    let mut ready = solid(&args.mesh, &job)?;
    let mut warnings = std::mem::take(&mut ready.warnings);
    let Ready { part, solid, .. } = &ready;
    let settings = RemeshSettings { side: args.how.side, sharp: args.sharp };
    let (made, seconds) = timed(|| remesh(&part.mesh, solid, settings, &job));
    let made = made?;
    if made.crossings > 0 {
        warnings.push(format!("the new mesh crosses itself {} times", made.crossings));
    }
    if let Some(lost) = made.lost {
        warnings.push(format!(
            "{:.1} mm2 of the surface are lost, for instance at {}: parts there are thinner than \
             the samples are apart. Use more of them, with --side",
            lost.area,
            place(&lost, part.centre)
        ));
    }
    warn(&args.mesh, &warnings);
    let old = OldSurface::of(&ready, &args.how, true);
    finish(&args.out, &made.mesh, part.centre, Some(old), seconds, warnings, json)
}

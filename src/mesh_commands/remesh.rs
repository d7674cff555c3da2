//! `sculptd remesh`: one closed surface of even triangles out of any mesh, or a mesh of quads that
//! follow the shape.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::Serialize;

use super::distance::{Ready, solid, timed, warn};
use super::remesh_quads::{QuadArgs, remesh_quads};
use super::{Fail, Outcome, answer};
use sculptd_geometry::TriMesh;
use sculptd_geometry::io::{writable_format, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::remesh::{LostParts, RemeshError, RemeshSettings, remesh};

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

/// The result; the same for every command that makes a mesh from the field.
#[derive(Debug, Serialize)]
pub struct RemeshMade {
    pub file: PathBuf,
    pub vertices: usize,
    pub triangles: usize,
    pub volume: f64,
    pub area: f64,
    pub seconds: f64,
    pub warnings: Vec<String>,
}

impl From<RemeshError> for Fail {
    fn from(e: RemeshError) -> Self {
        match e {
            RemeshError::Side(_) => Fail::Usage(e.to_string()),
            _ => Fail::Input(e.to_string()),
        }
    }
}

/// Writes the mesh, whose frame has its origin at `centre`, and prints what it is.
pub fn finish(
    out: &Path,
    mesh: &TriMesh,
    centre: DVec3,
    seconds: f64,
    warnings: Vec<String>,
    json: bool,
) -> Outcome {
    let mut poly = mesh.to_poly();
    poly.positions.iter_mut().for_each(|p| *p += centre);
    write_mesh(out, &poly)?;
    let m = sculptd_geometry::measure::measures(mesh);
    let made = RemeshMade {
        file: out.into(),
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
        volume: m.volume,
        area: m.area,
        seconds,
        warnings,
    };
    answer(json, &made, |w| {
        writeln!(w, "{}: {} vertices, {} triangles", out.display(), made.vertices, made.triangles)?;
        writeln!(w, "volume {:.4} mm3, area {:.4} mm2, {:.3} s", made.volume, made.area, seconds)
    });
    Ok(())
}

/// Where parts were lost, in the coordinates of the file.
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
    let Ready { part, solid, mut warnings } = solid(&args.mesh, &job)?;
    let settings = RemeshSettings { side: args.how.side, sharp: args.sharp };
    let (made, seconds) = timed(|| remesh(&part.mesh, &solid, settings, &job));
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
    finish(&args.out, &made.mesh, part.centre, seconds, warnings, json)
}

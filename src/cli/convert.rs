//! `sculptd convert`: a mesh from one format to another, scaled or mended on the way.

use std::path::PathBuf;

use serde::Serialize;

use super::{Fail, Outcome, answer};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::{read_mesh, writable_format, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::repair;

#[derive(Debug, Clone, clap::Args)]
pub struct ConvertArgs {
    pub input: PathBuf,
    /// The ending names the format: .obj, .stl, .ply, .off, .glb or .3mf.
    pub output: PathBuf,
    /// Multiply all coordinates, for instance by 25.4 from inches to millimetres.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    pub scale: f64,
    /// Cut polygons into triangles.
    #[arg(long)]
    pub triangulate: bool,
    /// Make one vertex of vertices nearer than this; 0 for those in exactly the same place.
    #[arg(long, value_name = "DISTANCE")]
    pub weld: Option<f64>,
    /// Remove faces without extent, turn all faces outwards and close holes.
    #[arg(long)]
    pub mend: bool,
}

#[derive(Debug, Serialize)]
pub(super) struct Written {
    pub file: String,
    pub vertices: usize,
    pub faces: usize,
    pub warnings: Vec<String>,
}

/// Writes `mesh` and says so: the end of every command that makes a mesh.
pub(super) fn deliver(
    path: &std::path::Path,
    mesh: &PolyMesh,
    warnings: Vec<String>,
    json: bool,
) -> Outcome {
    if mesh.positions.iter().any(|p| !p.as_vec3().is_finite()) {
        return Err(Fail::Check(
            "the result has coordinates beyond 3.4e38; nothing was written".into(),
        ));
    }
    write_mesh(path, mesh)?;
    let file = path.display().to_string();
    let written =
        Written { file, vertices: mesh.positions.len(), faces: mesh.face_count(), warnings };
    answer(json, &written, |out| {
        for w in &written.warnings {
            writeln!(out, "warning: {w}")?;
        }
        writeln!(out, "{}: {} vertices, {} faces", written.file, written.vertices, written.faces)
    });
    Ok(())
}

pub fn run(args: &ConvertArgs, json: bool) -> Outcome {
    writable_format(&args.output)?;
    if !args.scale.is_finite() || args.scale == 0.0 {
        return Err(Fail::Usage(format!(
            "--scale: expected a number other than 0, found {}",
            args.scale
        )));
    }
    if args.weld.is_some_and(|w| !(w.is_finite() && w >= 0.0)) {
        return Err(Fail::Usage("--weld: expected a distance of 0 or more".into()));
    }
    let job = Job::default();
    let loaded = read_mesh(&args.input, &job)?;
    let (mut mesh, mut warnings) = (loaded.mesh, loaded.warnings);
    for p in &mut mesh.positions {
        *p *= args.scale;
    }
    if args.scale < 0.0 {
        repair::flip(&mut mesh);
    }
    let mut done = |n: usize, what: &str| {
        if n > 0 {
            warnings.push(format!("{n} {what}"));
        }
    };
    if let Some(distance) = args.weld {
        done(repair::weld(&mut mesh, distance), "vertices welded to others");
    }
    if args.mend {
        done(repair::remove_degenerate(&mut mesh), "faces without extent removed");
        done(repair::orient(&mut mesh), "faces turned over");
        let filled = repair::fill_holes(&mut mesh, usize::MAX);
        done(filled.holes, "holes closed");
        done(filled.left, "open borders that are no simple loop left as they are");
    }
    if args.triangulate {
        let (triangles, of) = mesh.triangles();
        mesh.corners = triangles.into_iter().flatten().collect();
        mesh.face_starts = (0..=of.len() as u32).map(|t| t * 3).collect();
        mesh.groups = mesh.groups.map(|g| of.iter().map(|&f| g[f as usize]).collect());
    }
    deliver(&args.output, &mesh, warnings, json)
}

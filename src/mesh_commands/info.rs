//! `sculptd info`: the facts of mesh files.

use std::io::Write;
use std::path::PathBuf;

use serde::Serialize;

use super::{Fail, Outcome, answer};
use sculptd_geometry::check::{MeshReport, report};
use sculptd_geometry::io::{FileContents, read_mesh};
use sculptd_geometry::job::{Cancelled, Job};

#[derive(Debug, Clone, clap::Args)]
pub struct InfoArgs {
    #[arg(required = true, value_name = "MESH")]
    pub meshes: Vec<PathBuf>,
    /// Do not look for triangles that cross each other, the slowest part.
    #[arg(long)]
    pub quick: bool,
}

#[derive(Debug, Serialize)]
struct Facts {
    file: String,
    format: &'static str,
    #[serde(flatten)]
    report: MeshReport,
    #[serde(flatten)]
    contents: FileContents,
    warnings: Vec<String>,
}

/// With several meshes: one object all the same.
#[derive(Debug, Serialize)]
struct ManyFiles {
    meshes: Vec<Facts>,
}

/// Nobody cancels a command's job but the signal that ends the process.
pub(super) fn interrupted(_: Cancelled) -> Fail {
    Fail::Check("cancelled".into())
}

pub fn run(args: &InfoArgs, json: bool) -> Outcome {
    let job = Job::default();
    let mut meshes = Vec::new();
    for path in &args.meshes {
        let loaded = read_mesh(path, &job)?;
        let report = report(&loaded.mesh, !args.quick, &job).map_err(interrupted)?;
        let (file, contents) = (path.display().to_string(), loaded.contents());
        meshes.push(Facts {
            file,
            format: loaded.format.name(),
            report,
            contents,
            warnings: loaded.warnings,
        });
    }
    if meshes.len() == 1 {
        answer(json, &meshes[0], |out| text(out, &meshes[0]));
    } else {
        let several = ManyFiles { meshes };
        answer(json, &several, |out| several.meshes.iter().try_for_each(|m| text(out, m)));
    }
    Ok(())
}

fn text(out: &mut dyn Write, facts: &Facts) -> std::io::Result<()> {
    let r = &facts.report;
    let yes = |b: bool| if b { "yes" } else { "no" };
    let size: Vec<String> =
        (0..3).map(|i| format!("{}", r.bounds.max[i] - r.bounds.min[i])).collect();
    writeln!(out, "{}: {}", facts.file, facts.format)?;
    writeln!(
        out,
        "  {} vertices, {} faces, {} triangles, {} components",
        r.vertices, r.faces, r.triangles, r.components
    )?;
    writeln!(
        out,
        "  closed {}, manifold {}, oriented {}, Euler {}{}",
        yes(r.closed),
        yes(r.manifold),
        yes(r.oriented),
        r.euler,
        r.genus.map(|g| format!(", genus {g}")).unwrap_or_default()
    )?;
    writeln!(
        out,
        "  size {}, from {:?} to {:?}",
        size.join(" x "),
        r.bounds.min.to_array(),
        r.bounds.max.to_array()
    )?;
    let volume = r.volume.map(|v| format!("volume {v}, ")).unwrap_or_default();
    writeln!(out, "  {volume}area {}", r.area)?;
    for (n, what) in [
        (r.boundary_edges, "edges with one face"),
        (r.nonmanifold_edges, "edges with more than two faces"),
        (r.misoriented_edges, "edges whose faces disagree on the outside"),
        (r.degenerate_faces, "faces without area"),
        (r.unused_vertices, "vertices that no face uses"),
        (r.self_intersections.unwrap_or(0), "pairs of triangles that cross"),
    ] {
        if n > 0 {
            writeln!(out, "  {n} {what}")?;
        }
    }
    if r.volume.is_some_and(|v| v < 0.0) {
        writeln!(out, "  inside out")?;
    }
    let has = &facts.contents;
    for (names, what) in [(&has.names, "objects"), (&has.materials, "materials")] {
        if !names.is_empty() {
            writeln!(out, "  {what}: {}", names.join(", "))?;
        }
    }
    let parts = [
        (has.colours, "colours of vertices"),
        (has.texture_coordinates, "texture coordinates"),
        (has.morph_targets > 0, "morph targets"),
    ];
    let parts: Vec<&str> = parts.iter().filter(|p| p.0).map(|p| p.1).collect();
    if !parts.is_empty() {
        writeln!(out, "  with {}", parts.join(", "))?;
    }
    facts.warnings.iter().try_for_each(|w| writeln!(out, "  warning: {w}"))
}

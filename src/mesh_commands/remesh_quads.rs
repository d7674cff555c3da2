//! `sculptd remesh --quads`: a mesh of quads that follow the shape.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::Serialize;

use super::distance::{read_polylines, timed, warn};
use super::info::interrupted;
use super::{Fail, Outcome, answer};
use sculptd_geometry::io::{left_out, read_mesh, writable_format, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::quads::{QuadError, QuadMetrics, QuadSettings, metrics, quad_remesh};
use sculptd_geometry::{check, repair};

/// A mesh of quads instead of triangles.
#[derive(Debug, clap::Args)]
pub struct QuadArgs {
    /// Make about so many quads that follow the shape instead, 6 to 1,000,000. The mesh must be
    /// manifold; it may be open. OBJ, PLY and OFF keep quads.
    #[arg(long, value_name = "N", conflicts_with_all = ["side", "sharp"])]
    pub quads: Option<usize>,
    /// With `--quads`: keep edges whose faces turn by more than this many degrees.
    #[arg(long, value_name = "DEGREES", requires = "quads")]
    pub creases: Option<f64>,
    /// With `--quads`: strokes that the quads follow, as text, one point of three numbers a line in
    /// the mesh's unit; an empty line begins another stroke.
    #[arg(long, value_name = "FILE", requires = "quads")]
    pub guides: Option<PathBuf>,
}

/// The facts of the file that was written, as it is read again.
#[derive(Debug, Serialize)]
struct QuadsMade {
    file: PathBuf,
    vertices: usize,
    faces: usize,
    components: usize,
    closed: bool,
    manifold: bool,
    genus: Option<i64>,
    self_intersections: Option<usize>,
    #[serde(flatten)]
    metrics: QuadMetrics,
    seconds: f64,
    warnings: Vec<String>,
}

impl From<QuadError> for Fail {
    fn from(e: QuadError) -> Self {
        match e {
            QuadError::Count(_) => Fail::Usage(format!("--quads: {e}")),
            _ => Fail::Input(e.to_string()),
        }
    }
}

/// A mesh file, its triangles joined at equal corners where the format tells them apart.
fn read(path: &Path, job: &Job) -> Result<(sculptd_geometry::PolyMesh, Vec<String>), Fail> {
    let loaded = read_mesh(path, job)?;
    let mut mesh = loaded.mesh;
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("stl")) {
        repair::weld(&mut mesh, 0.0);
    }
    Ok((mesh, loaded.warnings))
}

/// Remeshes file `mesh` to about so many quads in file `out`, and prints what that one holds.
pub(super) fn remesh_quads(
    mesh_file: &Path,
    out: &Path,
    quads: usize,
    args: &QuadArgs,
    json: bool,
) -> Outcome {
    let job = Job::default();
    let format = writable_format(out)?;
    if args.creases.is_some_and(|c| !(0.0..=180.0).contains(&c)) {
        return Err(Fail::Usage("--creases: expected an angle of 0 to 180 degrees".into()));
    }
    let guides: Vec<Vec<DVec3>> =
        args.guides.as_deref().map(read_polylines).transpose()?.unwrap_or_default();
    let (mesh, mut warnings) = read(mesh_file, &job)?;
    let settings = QuadSettings { quads, creases: args.creases, guides };
    let (made, seconds) = timed(|| quad_remesh(&mesh, &settings, &job));
    let made = made.map_err(|e| match Fail::from(e) {
        Fail::Input(text) => Fail::Input(format!("{}: {text}", mesh_file.display())),
        other => other,
    })?;
    warnings.extend(made.warnings);
    warnings.extend(left_out(format, &made.mesh));
    write_mesh(out, &made.mesh)?;
    let (written, _) = read(out, &job)?;
    let report = check::report(&written, true, &job).map_err(interrupted)?;
    let metrics = metrics(&written, &mesh, &job).map_err(interrupted)?;
    let quads_made = made.mesh.faces().filter(|face| face.len() == 4).count();
    if metrics.quads < quads_made {
        warnings.push(format!(
            "the format of the output holds triangles: {} of {quads_made} quads were cut; OBJ, PLY \
             and OFF keep them",
            quads_made - metrics.quads
        ));
    }
    warn(mesh_file, &warnings);
    let facts = QuadsMade {
        file: out.into(),
        vertices: report.vertices,
        faces: report.faces,
        components: report.components,
        closed: report.closed,
        manifold: report.manifold,
        genus: report.genus,
        self_intersections: report.self_intersections,
        metrics,
        seconds,
        warnings,
    };
    answer(json, &facts, |w| {
        let f = &facts.metrics;
        writeln!(
            w,
            "{}: {} vertices, {} quads, {} triangles, {} other polygons",
            facts.file.display(),
            facts.vertices,
            f.quads,
            f.triangles,
            f.other
        )?;
        if let (Some(least), Some(greatest), Some(deviation)) =
            (f.least_angle, f.greatest_angle, f.mean_deviation)
        {
            writeln!(
                w,
                "angles {:.1} to {:.1} degrees, {:.1} from 90 in the mean; {:.1} % of the \
                 vertices regular",
                least,
                greatest,
                deviation,
                f.regular * 100.0
            )?;
        }
        writeln!(
            w,
            "off the old surface by {:.4} at most, the old one off it by {:.4}; {:.3} s",
            f.hausdorff[0], f.hausdorff[1], facts.seconds
        )
    });
    Ok(())
}

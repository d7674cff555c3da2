//! `sculptd convert`: a mesh from one format to another, scaled or mended on the way.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{Fail, Outcome, answer};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::filaments::{Filaments, MAX_FILAMENTS};
use sculptd_geometry::io::{
    left_out, read_mesh, read_painting, writable_format, write_mesh, write_painted,
};
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::written::KnownFaces;
use sculptd_geometry::{boolean, check, repair, written};

#[derive(Debug, Clone, clap::Args)]
pub struct ConvertArgs {
    pub input: PathBuf,
    /// The ending names the format: .obj, .stl, .ply, .off, .glb, .gltf or .3mf.
    #[arg(required_unless_present = "out", conflicts_with = "out")]
    pub output: Option<PathBuf>,
    /// The output, as other commands take it.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Multiply all coordinates, for instance by 25.4 from inches to millimetres.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    pub scale: f64,
    /// Cut polygons into triangles.
    #[arg(long)]
    pub triangulate: bool,
    /// Make one vertex of vertices nearer than this; 0 for those in exactly the same place.
    #[arg(long, value_name = "DISTANCE")]
    pub weld: Option<f64>,
    /// Remove faces without extent, turn all faces outwards, close holes, and make one solid of
    /// shells that overlap, by how often the surface goes around a place.
    #[arg(long)]
    pub mend: bool,
    /// Paint the triangles for slicers with this number of filaments, 1 to 16: the colours of the
    /// mesh reduced, in the attributes of PrusaSlicer, OrcaSlicer and Bambu Studio (3MF alone).
    #[arg(long, value_name = "NUMBER",
        value_parser = clap::value_parser!(u8).range(1..=MAX_FILAMENTS as i64))]
    pub filaments: Option<u8>,
}

#[derive(Debug, Serialize)]
pub(super) struct Written {
    pub file: String,
    pub vertices: usize,
    pub faces: usize,
    /// Of a closed mesh; 0 of an empty one.
    pub volume: Option<f64>,
    pub closed: bool,
    pub manifold: bool,
    /// Of a file that is painted for slicers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub filaments: Vec<WrittenFilament>,
    pub warnings: Vec<String>,
}

/// A filament in a painted file.
#[derive(Debug, Serialize)]
pub(super) struct WrittenFilament {
    /// As slicers count them, from 1.
    pub number: usize,
    /// `#RRGGBB`, sRGB.
    pub colour: String,
    pub triangles: usize,
}

/// The facts of a written file, which is read again.
#[derive(Debug, Clone)]
pub(super) struct FileFacts {
    pub vertices: usize,
    pub faces: usize,
    pub volume: Option<f64>,
    pub area: f64,
    pub components: usize,
    pub genus: Option<i64>,
    pub closed: bool,
    pub manifold: bool,
    /// None where it was not asked for.
    pub self_intersections: Option<usize>,
    pub warnings: Vec<String>,
}

/// A mesh rounded to its file's format, looked at for triangles that cross, and repaired within
/// the format's precision and a tolerance.
pub(super) struct ReadyMesh {
    /// The mesh to write, if it differs from the input.
    changed: Option<PolyMesh>,
    /// Pairs of triangles that still cross.
    pub crossings: usize,
}

impl ReadyMesh {
    pub fn of(
        path: &Path,
        mesh: &PolyMesh,
        tolerance: f64,
        known: Option<KnownFaces<'_>>,
        job: &Job,
    ) -> Result<ReadyMesh, Fail> {
        let kind = writable_format(path)?;
        if mesh.face_count() == 0 {
            return Ok(ReadyMesh { changed: None, crossings: 0 });
        }
        let made = written::for_file(mesh, kind, tolerance, known, job);
        let made = made.map_err(|e: Cancelled| Fail::Input(e.to_string()))?;
        let changed = match made.mesh {
            Cow::Owned(mesh) => Some(mesh),
            Cow::Borrowed(_) => None,
        };
        Ok(ReadyMesh { changed, crossings: made.crossings })
    }
}

/// Writes `mesh`, reads the file again and says what is in it. `crossings`: what is written is
/// looked at for triangles that cross after rounding to the format, and repaired within the
/// format's precision and this tolerance.
pub(super) fn write_checked(
    path: &Path,
    mesh: &PolyMesh,
    crossings: Option<f64>,
    job: &Job,
) -> Result<FileFacts, Fail> {
    let ready =
        crossings.map(|tolerance| ReadyMesh::of(path, mesh, tolerance, None, job)).transpose()?;
    write_ready(path, mesh, ready.as_ref(), job)
}

/// Writes `mesh`, or what `ready` has in its place, reads the file again and says what is in it.
pub(super) fn write_ready(
    path: &Path,
    mesh: &PolyMesh,
    ready: Option<&ReadyMesh>,
    job: &Job,
) -> Result<FileFacts, Fail> {
    let mut warnings = left_out(writable_format(path)?, mesh);
    let crossings = ready.map(|r| r.crossings);
    write_mesh(path, ready.and_then(|r| r.changed.as_ref()).unwrap_or(mesh))?;
    if let Some(left) = crossings.filter(|n| *n > 0) {
        warnings.push(format!(
            "{left} pairs of triangles cross in {} after rounding to the format",
            path.display()
        ));
    }
    if mesh.face_count() == 0 {
        // An empty solid: a valid file of its format, which no reader takes for a mesh.
        return Ok(FileFacts {
            vertices: mesh.positions.len(),
            faces: 0,
            volume: Some(0.0),
            area: 0.0,
            components: 0,
            genus: None,
            closed: true,
            manifold: true,
            self_intersections: crossings,
            warnings,
        });
    }
    file_facts(path, crossings, warnings, job)
}

fn file_facts(
    path: &Path,
    self_intersections: Option<usize>,
    mut warnings: Vec<String>,
    job: &Job,
) -> Result<FileFacts, Fail> {
    let loaded = read_mesh(path, job)?;
    let mut mesh = loaded.mesh;
    // STL repeats the corners of each triangle.
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("stl")) {
        repair::weld(&mut mesh, 0.0);
    }
    let facts = check::report(&mesh, false, job).map_err(|e| Fail::Input(e.to_string()))?;
    if facts.closed && !facts.manifold {
        warnings.push(format!("{} is closed but not manifold as it was written", path.display()));
    }
    Ok(FileFacts {
        vertices: facts.vertices,
        faces: facts.faces,
        volume: facts.volume,
        area: facts.area,
        components: facts.components,
        genus: facts.genus,
        closed: facts.closed,
        manifold: facts.manifold,
        self_intersections,
        warnings,
    })
}

/// Writes `mesh` and reports it: the end of every command that makes a mesh.
pub(super) fn deliver(path: &Path, mesh: &PolyMesh, warnings: Vec<String>, json: bool) -> Outcome {
    deliver_checked(path, mesh, (None, None), warnings, json)
}

/// The same; `crossings` as of [`write_checked`]; `filaments`: paint the triangles with so many.
fn deliver_checked(
    path: &Path,
    mesh: &PolyMesh,
    (crossings, filaments): (Option<f64>, Option<u8>),
    warnings: Vec<String>,
    json: bool,
) -> Outcome {
    if mesh.positions.iter().any(|p| !p.as_vec3().is_finite()) {
        return Err(Fail::Check(
            "the result has coordinates beyond 3.4e38; nothing was written".into(),
        ));
    }
    let (facts, painted) = match filaments {
        None => (write_checked(path, mesh, crossings, &Job::default())?, Vec::new()),
        Some(count) => paint(path, mesh, count, crossings)?,
    };
    let file = path.display().to_string();
    let mut all = warnings;
    all.extend(facts.warnings);
    if crossings.is_some() && !facts.closed {
        all.push(format!(
            "{file} is not closed as it was written: rounded to the format, some triangles have no \
             extent; PLY, OBJ and OFF hold what was made"
        ));
    }
    let written = Written {
        file,
        vertices: facts.vertices,
        faces: facts.faces,
        volume: facts.volume,
        closed: facts.closed,
        manifold: facts.manifold,
        filaments: painted,
        warnings: all,
    };
    answer(json, &written, |out| {
        for w in &written.warnings {
            writeln!(out, "warning: {w}")?;
        }
        writeln!(out, "{}: {} vertices, {} faces", written.file, written.vertices, written.faces)?;
        for f in &written.filaments {
            writeln!(out, "filament {}: {}, {} triangles", f.number, f.colour, f.triangles)?;
        }
        Ok(())
    });
    Ok(())
}

/// Writes a painted file, reads it again, and compares the filaments and the colours.
fn paint(
    path: &Path,
    mesh: &PolyMesh,
    count: u8,
    crossings: Option<f64>,
) -> Result<(FileFacts, Vec<WrittenFilament>), Fail> {
    let job = Job::default();
    let ready = crossings.map(|t| ReadyMesh::of(path, mesh, t, None, &job)).transpose()?;
    let mesh = ready.as_ref().and_then(|r| r.changed.as_ref()).unwrap_or(mesh);
    let Some(filaments) = Filaments::of(mesh, usize::from(count)) else {
        return Err(Fail::Input(
            "--filaments: the mesh has no colours; convert a PLY, OBJ, glTF or 3MF file with \
             colours"
                .into(),
        ));
    };
    let warnings = left_out("3mf", mesh);
    write_painted(path, mesh, &filaments)?;
    let again = read_mesh(path, &job)?.mesh;
    // Vertices of no triangle have no colour in the file.
    let corners = |m: &PolyMesh| -> Vec<[[u8; 4]; 3]> {
        let of = |v: u32| m.colours.as_ref().map_or([0; 4], |c| c[v as usize]);
        m.triangles().0.iter().map(|t| t.map(of)).collect()
    };
    if read_painting(path, &job)? != filaments || corners(&again) != corners(mesh) {
        return Err(Fail::Check(format!(
            "{}: the filaments or colours read back differ from those written; do not use the file",
            path.display()
        )));
    }
    let facts = file_facts(path, ready.map(|r| r.crossings), warnings, &job)?;
    let painted = filaments.colours.iter().enumerate().map(|(i, [r, g, b])| WrittenFilament {
        number: i + 1,
        colour: format!("#{r:02X}{g:02X}{b:02X}"),
        triangles: filaments.triangles.iter().filter(|&&k| usize::from(k) == i).count(),
    });
    Ok((facts, painted.collect()))
}

pub fn run(args: &ConvertArgs, json: bool) -> Outcome {
    let Some(output) = args.output.as_ref().or(args.out.as_ref()) else {
        return Err(Fail::Usage("expected a name for the output".into()));
    };
    writable_format(output)?;
    if !args.scale.is_finite() || args.scale == 0.0 {
        return Err(Fail::Usage(format!(
            "--scale: expected a number other than 0, found {}",
            args.scale
        )));
    }
    if args.weld.is_some_and(|w| !(w.is_finite() && w >= 0.0)) {
        return Err(Fail::Usage("--weld: expected a distance of 0 or more".into()));
    }
    if args.filaments.is_some() && writable_format(output)? != "3mf" {
        return Err(Fail::Usage(format!(
            "--filaments: only .3mf holds filaments, and the output is {}",
            output.display()
        )));
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
    let mut crossings = None;
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
        let oriented = repair::orient_shells(&mut mesh);
        done(oriented.turned, "faces turned over");
        if oriented.crossing > 0 {
            done(oriented.guessed, "shells whose direction was guessed");
        }
        let filled = repair::fill_holes(&mut mesh, usize::MAX);
        done(filled.holes, "holes closed");
        done(filled.left, "open borders that are no simple loop left as they are");
        if oriented.crossing + oriented.nested > 0 {
            done(oriented.crossing, "pairs of shells that cross made one solid");
            done(
                oriented.nested,
                "shells within others that face outwards made one solid with them",
            );
            match boolean::solve(&mesh, &job) {
                Ok(solved) => {
                    mesh = solved;
                    // The exact result of the solver is rounded to doubles, and may then cross
                    // itself.
                    crossings = Some(0.0);
                }
                Err(e) => return Err(Fail::Check(format!("shells overlap and {e}"))),
            }
        }
    }
    if args.triangulate {
        mesh = written::triangulated(&mesh);
    }
    deliver_checked(output, &mesh, (crossings, args.filaments), warnings, json)
}

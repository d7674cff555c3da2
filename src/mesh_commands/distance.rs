//! `sculptd distance`: the signed distance at points, or sampled on a grid.

use std::path::{Path, PathBuf};

use glam::DVec3;
use sculptd_devices::Clock;
use serde::Serialize;

use super::{Fail, Outcome, answer};
use sculptd_geometry::CentredMesh;
use sculptd_geometry::bvh::REACH;
use sculptd_geometry::distance::{DistanceSolid, Sign};
use sculptd_geometry::grid::DistanceGrid;
use sculptd_geometry::io::{read_mesh, write_beside};
use sculptd_geometry::job::Job;

#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true).args(["points", "grid"])))]
pub struct DistanceArgs {
    /// The mesh file.
    pub mesh: PathBuf,
    /// Points as text, three numbers a line, in the mesh's unit.
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// Sample a grid of this many samples along the longest side, 2 to 1024; or of so many along x,
    /// y and z. The spacing is the same along all three.
    #[arg(
        long,
        value_name = "N|X,Y,Z",
        value_delimiter = ',',
        value_parser = clap::value_parser!(u64).range(2..=1024)
    )]
    pub grid: Vec<u64>,
    /// Samples outside the mesh's box on each side of the grid.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub margin: usize,
    /// Method that separates inside from outside.
    #[arg(long, value_enum, default_value = "winding")]
    pub sign: SignArg,
    /// File to write the grid to, as .npy, or the points' distances, one per line.
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum SignArg {
    /// The generalised winding number: right on crossed and broken meshes too.
    Winding,
    /// The normal at the nearest point: faster, for clean closed meshes.
    Pseudonormal,
}

#[derive(Debug, Serialize)]
struct DistanceAnswer {
    count: usize,
    seconds: f64,
    queries_per_second: f64,
    /// Negative inside.
    #[serde(skip_serializing_if = "Option::is_none")]
    distances: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    grid: Option<GridFacts>,
    closed: bool,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct GridFacts {
    size: [usize; 3],
    origin: [f64; 3],
    spacing: f64,
    min: f32,
    max: f32,
    file: Option<PathBuf>,
}

/// A mesh as triangles in its own frame, ready for questions of distance.
#[derive(Debug)]
pub struct Ready {
    pub part: CentredMesh,
    /// The solid in the part's frame: subtract `part.centre` from the input and add it to the
    /// output.
    pub solid: DistanceSolid,
    /// The reader's warnings, and one if the surface is open.
    pub warnings: Vec<String>,
}

/// Reads a mesh and makes it ready, in its own frame.
pub fn solid(path: &Path, job: &Job) -> Result<Ready, Fail> {
    solid_about(path, None, job)
}

/// The same in the frame of another part, by its centre.
pub fn solid_about(path: &Path, centre: Option<DVec3>, job: &Job) -> Result<Ready, Fail> {
    let loaded = read_mesh(path, job)?;
    let part = match centre {
        Some(centre) => CentredMesh::about(&loaded.mesh, centre, 1.0),
        None => CentredMesh::new(&loaded.mesh, 1.0),
    };
    if part.mesh.triangles.is_empty() {
        return Err(Fail::Input(format!("{}: expected faces, found none", path.display())));
    }
    let (lo, hi) = part.mesh.bounds();
    let most = lo.abs().max(hi.abs()).max_element();
    if most as f64 > REACH {
        return Err(Fail::Input(format!(
            "{}: expected an extent of up to {REACH:e}, found {most:e}",
            path.display()
        )));
    }
    let solid = DistanceSolid::build(&part.mesh, job).map_err(|e| Fail::Input(e.to_string()))?;
    let own: Vec<DVec3> = loaded.mesh.positions.iter().map(|&p| p - part.centre).collect();
    let corners = part.mesh.triangles.iter().map(|t| t.map(|v| own[v as usize])).collect();
    let solid = solid.with_corners(corners);
    let mut warnings = loaded.warnings;
    if !solid.topology.closed {
        warnings.push(
            "the surface is not closed: inside is where its winding number is above a half".into(),
        );
    }
    Ok(Ready { part, solid, warnings })
}

/// Prints warnings on standard error.
pub fn warn(path: &Path, warnings: &[String]) {
    for w in warnings {
        eprintln!("sculptd: warning: {}: {w}", path.display());
    }
}

/// Runs `work` and returns its result and its duration in seconds.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let clock = Clock::monotonic();
    let start = clock.now_us();
    let out = work();
    (out, (clock.now_us() - start) as f64 * 1e-6)
}

fn read_points(path: &Path) -> Result<Vec<DVec3>, Fail> {
    Ok(read_polylines(path)?.concat())
}

/// Points as text, three numbers a line; what follows a `#` is left out. An empty line ends a
/// polyline.
pub(super) fn read_polylines(path: &Path) -> Result<Vec<Vec<DVec3>>, Fail> {
    let text = std::fs::read_to_string(path).map_err(|e| Fail::io(path, &e))?;
    let mut all = Vec::new();
    let mut out = Vec::new();
    for (i, line) in text.lines().enumerate() {
        if line.trim().is_empty() && !out.is_empty() {
            all.push(std::mem::take(&mut out));
        }
        let line = line.split('#').next().unwrap_or("").trim();
        if line.is_empty() {
            continue;
        }
        let words = line
            .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
            .filter(|w| !w.is_empty());
        let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
        match numbers.as_deref() {
            Ok(&[x, y, z]) if x.is_finite() && y.is_finite() && z.is_finite() => {
                out.push(DVec3::new(x, y, z))
            }
            _ => {
                return Err(Fail::Input(format!(
                    "{}: line {}: expected three numbers, found \"{line}\"",
                    path.display(),
                    i + 1
                )));
            }
        }
    }
    if !out.is_empty() {
        all.push(out);
    }
    Ok(all)
}

pub fn run(args: &DistanceArgs, json: bool) -> Outcome {
    let job = Job::default();
    let points = args.points.as_deref().map(read_points).transpose()?;
    let Ready { part, solid, warnings } = solid(&args.mesh, &job)?;
    let solid = solid.with_sign(match args.sign {
        SignArg::Winding => Sign::Winding,
        SignArg::Pseudonormal => Sign::Pseudonormal,
    });
    let cancelled = |e: sculptd_geometry::job::Cancelled| Fail::Input(e.to_string());
    let closed = solid.topology.closed;
    let mut out = DistanceAnswer {
        count: 0,
        seconds: 0.0,
        queries_per_second: 0.0,
        distances: None,
        grid: None,
        closed,
        warnings,
    };
    if let Some(points) = &points {
        let own: Vec<DVec3> = points.iter().map(|&p| p - part.centre).collect();
        let (distances, seconds) = timed(|| solid.signed_distances(&own, &job));
        let distances = distances.map_err(cancelled)?;
        (out.count, out.seconds) = (points.len(), seconds);
        if let Some(file) = &args.out {
            write_beside(file, |w| distances.iter().try_for_each(|d| writeln!(w, "{d}")))
                .map_err(|e| Fail::io(file, &e))?;
        }
        out.distances = Some(distances);
    } else {
        let (lo, hi) = solid.tree.bounds();
        let span = (lo.as_dvec3(), hi.as_dvec3());
        let margin = |side: usize| args.margin.min((side / 2).saturating_sub(1));
        let layout = match args.grid[..] {
            [x, y, z] => {
                let size = [x, y, z].map(|n| n as usize);
                let least = size.into_iter().min().unwrap_or(2);
                DistanceGrid::layout_of(span, size, margin(least))
            }
            [side] => DistanceGrid::layout(span, side as usize, margin(side as usize)),
            _ => return Err(Fail::Usage("--grid: expected one number or three".into())),
        };
        let (grid, seconds) = timed(|| DistanceGrid::sample(&solid, layout, &job));
        let mut grid = grid.map_err(cancelled)?;
        grid.origin += part.centre;
        if let Some(file) = &args.out {
            write_beside(file, |w| grid.write_npy(w)).map_err(|e| Fail::io(file, &e))?;
        }
        (out.count, out.seconds) = (grid.values.len(), seconds);
        let (min, max) = grid
            .values
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), &v| (a.min(v), b.max(v)));
        out.grid = Some(GridFacts {
            size: grid.size,
            origin: grid.origin.to_array(),
            spacing: grid.spacing,
            min,
            max,
            file: args.out.clone(),
        });
    }
    out.queries_per_second = if out.seconds > 0.0 { out.count as f64 / out.seconds } else { 0.0 };
    warn(&args.mesh, &out.warnings);
    answer(json, &out, |w| {
        if let Some(g) = &out.grid {
            let [x, y, z] = g.size;
            writeln!(w, "grid       {x} x {y} x {z}, spacing {}", g.spacing)?;
            writeln!(w, "distances  {} to {}", g.min, g.max)?;
        } else if args.out.is_none() {
            out.distances.iter().flatten().try_for_each(|d| writeln!(w, "{d}"))?;
        }
        writeln!(w, "{} distances in {:.4} s", out.count, out.seconds)
    });
    Ok(())
}

//! `sculptd project`: a part's shadow along a direction: area, outline, drawing.

use std::path::PathBuf;

use glam::DVec3;
use serde::Serialize;

use super::distance::{Ready, solid, timed, warn};
use super::measure::direction;
use super::{Fail, Outcome, answer};
use sculptd_geometry::grid::DistanceGrid;
use sculptd_geometry::io::write_beside;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::march::default_epsilon;
use sculptd_geometry::projection::{
    PlaneRegion, PointTest, ProjectionPlane, ProjectionSamples, area, outline_of, png, sample,
    shadow_areas, spread_directions, svg,
};

#[derive(Debug, clap::Args)]
pub struct ProjectArgs {
    /// The mesh file.
    pub mesh: PathBuf,
    /// Looked along.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, default_value = "0,0,-1")]
    #[arg(value_parser = direction)]
    pub direction: DVec3,
    /// Turns the drawing about the direction.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_hyphen_values = true)]
    pub turn: f64,
    /// `exact`: from the silhouette's edges; `sample`: random points and rays; `march`: the same
    /// through a sampled distance.
    #[arg(long, value_enum, default_value = "exact")]
    pub method: MethodArg,
    /// Random points, for `sample` and `march`.
    #[arg(long, value_name = "N", default_value_t = 25_000)]
    #[arg(value_parser = clap::value_parser!(u64).range(3..=10_000_000))]
    pub samples: u64,
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Largest circle of the alpha shape, for `sample` and `march`; 2.5 times the points' spacing
    /// unless said.
    #[arg(long, value_name = "MM")]
    pub alpha: Option<f64>,
    /// Samples along the longest side of the grid, for `march`.
    #[arg(long, value_name = "N", default_value_t = 128)]
    #[arg(value_parser = clap::value_parser!(u64).range(4..=1024))]
    pub grid: u64,
    /// A marching ray this near the surface has hit it.
    #[arg(long, value_name = "MM")]
    pub epsilon: Option<f64>,
    /// A distance saved by `sculptd distance --grid N -o F`, for `march`.
    #[arg(long, value_name = "FILE")]
    pub field: Option<PathBuf>,
    /// Instead of one direction: which of N spread ones have the smallest and the largest shadow?
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub orientations: Option<u64>,
    /// Write the random points, one a line: u, v, and `inside` or `outside`; for `sample` and
    /// `march`. The picture of `--png` then shows them too.
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// Write the outline as a drawing to scale.
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Write the outline as a picture.
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum MethodArg {
    Exact,
    Sample,
    March,
}

#[derive(Debug, Serialize)]
struct Points {
    inside: usize,
    total: usize,
}

#[derive(Debug, Serialize)]
struct Orientation {
    direction: [f64; 3],
    area: f64,
}

#[derive(Debug, Serialize)]
struct Orientations {
    smallest: Orientation,
    largest: Orientation,
    directions: usize,
}

#[derive(Debug, Serialize)]
struct ProjectAnswer {
    method: &'static str,
    area: f64,
    /// One standard deviation; zero for `exact`.
    standard_error: f64,
    /// The greatest error of the area of an exact outline; zero for the other methods.
    error_bound: f64,
    polygons: usize,
    holes: usize,
    points: Option<Points>,
    /// Area of the points' alpha shape.
    alpha_area: Option<f64>,
    orientations: Option<Orientations>,
    seconds: f64,
    warnings: Vec<String>,
}

pub fn run(args: &ProjectArgs, json: bool) -> Outcome {
    let job = Job::default();
    let cancelled = |e: Cancelled| Fail::Input(e.to_string());
    let Ready { part, solid, warnings } = solid(&args.mesh, &job)?;
    let plane = ProjectionPlane::along(args.direction, args.turn.to_radians())
        .ok_or_else(|| Fail::Usage("expected a direction that is not zero".into()))?;
    let mut out = ProjectAnswer {
        method: match args.method {
            MethodArg::Exact => "exact",
            MethodArg::Sample => "sample",
            MethodArg::March => "march",
        },
        area: 0.0,
        standard_error: 0.0,
        error_bound: 0.0,
        polygons: 0,
        holes: 0,
        points: None,
        alpha_area: None,
        orientations: None,
        seconds: 0.0,
        warnings,
    };
    if args.points.is_some() && matches!(args.method, MethodArg::Exact) {
        return Err(Fail::Usage("--points: expected --method sample or march".into()));
    }
    let mut shown: Option<ProjectionSamples> = None;
    let polygons: Vec<PlaneRegion> = if let MethodArg::Exact = args.method {
        let (shadow, seconds) = timed(|| outline_of(&solid.topology, &solid.positions(), &plane));
        let polygons = shadow.regions;
        (out.area, out.standard_error) = (area(&polygons), shadow.standard_error);
        (out.seconds, out.error_bound) = (seconds, shadow.error_bound);
        if shadow.strip > 0.0 {
            out.method = "strips";
            out.warnings.push(format!(
                "the outline crosses itself too often to be resolved: it is drawn in strips {} \
                 high",
                shadow.strip
            ));
        }
        polygons
    } else {
        let grid = match (args.method, &args.field) {
            (MethodArg::March, Some(file)) => {
                let mut grid =
                    DistanceGrid::read_npy(file).map_err(|e| Fail::Input(e.to_string()))?;
                grid.origin -= part.centre;
                Some(grid)
            }
            (MethodArg::March, None) => {
                let (lo, hi) = solid.tree.bounds();
                let layout =
                    DistanceGrid::layout((lo.as_dvec3(), hi.as_dvec3()), args.grid as usize, 1);
                Some(DistanceGrid::sample(&solid, layout, &job).map_err(cancelled)?)
            }
            _ => None,
        };
        let by = match &grid {
            Some(g) => PointTest::Marching(g, args.epsilon.unwrap_or_else(|| default_epsilon(g))),
            None => PointTest::Rays,
        };
        let (samples, seconds) =
            timed(|| sample(&solid, &plane, args.samples as usize, args.seed, by, &job));
        let samples = samples.map_err(cancelled)?;
        (out.area, out.standard_error, out.seconds) =
            (samples.area, samples.standard_error, seconds);
        out.points = Some(Points { inside: samples.inside.len(), total: args.samples as usize });
        let (polygons, alpha_area) = samples.shape(args.alpha.unwrap_or(samples.alpha));
        out.alpha_area = Some(alpha_area);
        shown = args.points.is_some().then_some(samples);
        polygons
    };
    out.polygons = polygons.len();
    out.holes = polygons.iter().map(|p| p.holes.len()).sum();
    if let Some(n) = args.orientations {
        let directions = spread_directions(n as usize);
        let areas = shadow_areas(&solid, &directions, &job).map_err(cancelled)?;
        let at = |i: usize| Orientation { direction: directions[i].to_array(), area: areas[i] };
        let by = |a: &usize, b: &usize| areas[*a].total_cmp(&areas[*b]);
        if let (Some(least), Some(most)) =
            ((0..areas.len()).min_by(by), (0..areas.len()).max_by(by))
        {
            let (smallest, largest) = (at(least), at(most));
            out.orientations = Some(Orientations { smallest, largest, directions: areas.len() });
        }
    }
    if let (Some(file), Some(samples)) = (&args.points, &shown) {
        let centre = plane.flat(part.centre);
        let write = |w: &mut dyn std::io::Write| -> std::io::Result<()> {
            for (points, name) in [(&samples.inside, "inside"), (&samples.outside, "outside")] {
                for &p in points {
                    let q = p + centre;
                    writeln!(w, "{} {} {name}", q.x, q.y)?;
                }
            }
            Ok(())
        };
        write_beside(file, write).map_err(|e| Fail::io(file, &e))?;
    }
    if let Some(file) = &args.svg {
        write_beside(file, |w| w.write_all(svg(&polygons).as_bytes()))
            .map_err(|e| Fail::io(file, &e))?;
    }
    if let Some(file) = &args.png {
        let bytes = png(&polygons, shown.as_ref(), 1200)
            .map_err(|e| Fail::Input(format!("{}: {e}", file.display())))?;
        write_beside(file, |w| w.write_all(&bytes)).map_err(|e| Fail::io(file, &e))?;
    }
    warn(&args.mesh, &out.warnings);
    answer(json, &out, |w| {
        writeln!(w, "area      {:.6} mm2 +- {:.6}", out.area, out.standard_error)?;
        if let Some(a) = out.alpha_area {
            writeln!(w, "          {a:.6} mm2 by the alpha shape")?;
        }
        writeln!(w, "outline   {} polygons, {} holes", out.polygons, out.holes)?;
        if let Some(o) = &out.orientations {
            writeln!(w, "smallest  {:.6} mm2 along {:?}", o.smallest.area, o.smallest.direction)?;
            writeln!(w, "largest   {:.6} mm2 along {:?}", o.largest.area, o.largest.direction)?;
        }
        writeln!(w, "{:.6} s", out.seconds)
    });
    Ok(())
}

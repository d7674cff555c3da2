//! `sculptd measure`: volume, area, dimensions, projected areas and thickness, as a cost estimate
//! needs them.

use std::path::PathBuf;

use glam::{DVec3, Vec3};
use sculptd_devices::Clock;
use serde::Serialize;

use super::thickness::{How, load};
use super::{Fail, Outcome, answer};
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::{overlaps, projected_area};
use sculptd_geometry::thickness::check::{ThicknessLimits, check};

#[derive(Debug, clap::Args)]
pub struct MeasureArgs {
    /// The mesh file.
    pub mesh: PathBuf,
    /// More directions to project along.
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    pub direction: Vec<DVec3>,
    #[command(flatten)]
    pub how: How,
}

#[derive(Debug, Serialize)]
struct Projected {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Debug, Serialize)]
struct Along {
    direction: [f32; 3],
    area: f64,
}

#[derive(Debug, Serialize)]
struct Statistics {
    min: Option<f32>,
    max: Option<f32>,
    mean: Option<f32>,
    median: Option<f32>,
    valid: f32,
    error_bound: f32,
}

/// Millimetres.
#[derive(Debug, Serialize)]
struct MeasureAnswer {
    /// Of a closed mesh only. Where shells overlap, the common part counts once for each.
    volume: Option<f64>,
    area: f64,
    dimensions: [f64; 3],
    centroid: Option<[f64; 3]>,
    projected_area: Projected,
    directions: Vec<Along>,
    thickness: Statistics,
    vertices: usize,
    triangles: usize,
    closed: bool,
    /// True if shells, or parts of one, overlap.
    overlapping: bool,
    warnings: Vec<String>,
}

/// Three numbers with commas between, not all zero.
pub fn direction(text: &str) -> Result<DVec3, String> {
    let numbers: Vec<f64> = text.split(',').map_while(|s| s.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, z] if text.split(',').count() == 3 => Some(DVec3::new(x, y, z)),
        _ => None,
    }
    .filter(|d| d.is_finite() && d.length_squared() > 0.0)
    .ok_or_else(|| "expected three numbers X,Y,Z, not all zero".into())
}

pub fn run(args: &MeasureArgs, json: bool) -> Outcome {
    let job = Job::default();
    let (part, notes) = load(&args.mesh, &args.how, &job)?;
    let clock = Clock::monotonic();
    let file = args.mesh.display().to_string();
    let checked = check(
        &file,
        &part.mesh,
        part.walls.as_ref(),
        &args.how.settings(),
        ThicknessLimits::default(),
        &job,
        || clock.now_us() as f64 * 1e-6,
    )
    .map_err(|e| Fail::Usage(e.to_string()))?;
    let m = part.mesh.sizes;
    let along = |d: Vec3| {
        projected_area(part.original_mesh(), d, &job).map_err(|e| Fail::Input(e.to_string()))
    };
    let s = checked.answer.summary;
    let mut warnings = notes;
    warnings.extend(checked.answer.warnings);
    let faults = checked.thickness.surface.faults;
    let closed = faults.boundary_edges == 0 && faults.crowded_edges == 0;
    let overlapping =
        closed && overlaps(part.original_mesh(), &job).map_err(|e| Fail::Input(e.to_string()))?;
    if overlapping {
        warnings.push(
            "shells overlap: volume, area and centroid count the common part once for each; \
             unite them first (sculptd boolean union, sculptd remesh)"
                .into(),
        );
    }
    if !closed {
        warnings.push("the surface is not closed: it has no volume".into());
    }
    let out = MeasureAnswer {
        volume: closed.then_some(m.volume),
        area: m.area,
        dimensions: m.dimensions,
        centroid: m.centroid.filter(|_| closed).map(|c| (c + part.mesh.centre).to_array()),
        projected_area: Projected { x: along(Vec3::X)?, y: along(Vec3::Y)?, z: along(Vec3::Z)? },
        directions: args
            .direction
            .iter()
            .map(|d| d.as_vec3())
            .map(|d| Ok(Along { direction: d.to_array(), area: along(d)? }))
            .collect::<Result<_, Fail>>()?,
        thickness: Statistics {
            min: s.min,
            max: s.max,
            mean: s.mean,
            median: s.median,
            valid: s.valid,
            error_bound: s.error_bound,
        },
        vertices: part.mesh.counts[0],
        triangles: part.mesh.counts[1],
        closed,
        overlapping,
        warnings,
    };
    for w in &out.warnings {
        eprintln!("sculptd: warning: {file}: {w}");
    }
    answer(json, &out, |w| {
        let [x, y, z] = out.dimensions;
        match out.volume {
            Some(v) => writeln!(w, "volume      {v:.4} mm3")?,
            None => writeln!(w, "volume      none: the surface is open")?,
        }
        writeln!(w, "area        {:.4} mm2", out.area)?;
        writeln!(w, "dimensions  {x:.4} x {y:.4} x {z:.4} mm")?;
        let p = &out.projected_area;
        writeln!(w, "projected   x {:.4}  y {:.4}  z {:.4} mm2", p.x, p.y, p.z)?;
        for a in &out.directions {
            writeln!(w, "  along {:?}  {:.4} mm2", a.direction, a.area)?;
        }
        let n = |v: Option<f32>| v.map_or("none".into(), |v| format!("{v:.4}"));
        let t = &out.thickness;
        writeln!(
            w,
            "thickness   min {}  median {}  mean {}  max {} mm",
            n(t.min),
            n(t.median),
            n(t.mean),
            n(t.max)
        )
    });
    Ok(())
}

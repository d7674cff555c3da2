//! `sculptd boolean`: union, intersection and differences of solids.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sculptd_devices::Clock;
use serde::Serialize;

use super::distance::warn;
use super::{Fail, Outcome, answer};
use crate::analysis::boolean::{self, Operation, Options, Solid};
use crate::analysis::cancel::Job;
use crate::mesh::io::{read_mesh, writable_format, write_mesh};
use crate::mesh::{PolyMesh, check, mend};

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum What {
    Union,
    Intersection,
    /// A minus B.
    Difference,
    /// B minus A.
    ReverseDifference,
    /// All four, from one computation.
    All,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Solve {
    /// Inside is what the surface goes around, counted with its direction.
    Winding,
}

#[derive(Debug, clap::Args)]
pub struct BooleanArgs {
    pub what: What,
    /// The operands A, B and, for a union, an intersection or a difference (A minus all others), more.
    #[arg(required = true, num_args = 2..)]
    pub meshes: Vec<PathBuf>,
    /// Where the result goes; the ending says the format. `all` puts the operation's name before the ending.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Length within which faces are in contact; 0 for what the numbers say. Otherwise taken from the operands' rounding.
    #[arg(long, value_name = "MM")]
    pub tolerance: Option<f64>,
    /// Keep faces in which the solids only touch in the intersection.
    #[arg(long)]
    pub keep_contact: bool,
    /// Make operands that are broken or cross themselves into solids first.
    #[arg(long, value_enum)]
    pub solve: Option<Solve>,
    /// Leave out the look for triangles that cross within an operand.
    #[arg(long)]
    pub trust: bool,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Answer {
    results: Vec<Made>,
    seconds: f64,
    /// Seconds by phase.
    phases: BTreeMap<String, f64>,
    tolerance: f64,
    /// Ends of the pieces of the curve in which the two surfaces meet.
    cut_segments: usize,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Made {
    name: &'static str,
    file: PathBuf,
    vertices: usize,
    faces: usize,
    volume: f64,
    area: f64,
    components: usize,
    genus: Option<i64>,
    closed: bool,
    manifold: bool,
}

impl From<boolean::Error> for Fail {
    fn from(e: boolean::Error) -> Self {
        match e {
            boolean::Error::Inconsistent(_) => Fail::Check(e.to_string()),
            _ => Fail::Input(e.to_string()),
        }
    }
}

pub fn run(args: &BooleanArgs, json: bool) -> Outcome {
    let job = Job::default();
    let clock = Clock::monotonic();
    let now = || clock.now_us() as f64 * 1e-6;
    writable_format(&args.out)?;
    if args.tolerance.is_some_and(|t| !(t >= 0.0 && t.is_finite())) {
        return Err(Fail::Usage("expected a tolerance of 0 or more".into()));
    }
    if args.meshes.len() > 2 && matches!(args.what, What::All | What::ReverseDifference) {
        return Err(Fail::Usage("more than two operands: expected union, intersection or difference".into()));
    }
    let mut out = Answer {
        results: Vec::new(),
        seconds: 0.0,
        phases: BTreeMap::new(),
        tolerance: 0.0,
        cut_segments: 0,
        warnings: Vec::new(),
    };
    let mut operands = Vec::new();
    for path in &args.meshes {
        operands.push(operand(path, args, &job, &now, &mut out)?);
    }
    let start = now();
    let options = Options { tolerance: args.tolerance, keep_contact: args.keep_contact };
    let operations = match args.what {
        What::Union => vec![Operation::Union],
        What::Intersection => vec![Operation::Intersection],
        What::Difference => vec![Operation::Difference],
        What::ReverseDifference => vec![Operation::ReverseDifference],
        What::All => Operation::ALL.to_vec(),
    };
    let mut left = operands.remove(0);
    let mut solids: Vec<Solid> = Vec::new();
    for right in &operands {
        if let Some(last) = solids.pop() {
            left = last.mesh;
        }
        let (made, report) = boolean::compute([&left, right], &operations, &options, &job, now)?;
        solids = made;
        for (name, seconds) in report.phases {
            *out.phases.entry(name.into()).or_default() += seconds;
        }
        out.tolerance = report.tolerance;
        out.cut_segments += report.cut.len();
        out.warnings.extend(report.warnings);
    }
    out.seconds = now() - start;
    for s in &solids {
        let file =
            if args.what == What::All { named(&args.out, s.operation.name()) } else { args.out.clone() };
        if s.mesh.face_count() == 0 {
            out.warnings.push(format!("the {} is empty", s.operation.name()));
        }
        write_mesh(&file, &s.mesh)?;
        let facts = check::report(&s.mesh, false, &job).map_err(|e| Fail::Input(e.to_string()))?;
        out.results.push(Made {
            name: s.operation.name(),
            file,
            vertices: s.mesh.positions.len(),
            faces: s.mesh.face_count(),
            volume: s.facts.volume,
            area: s.facts.area,
            components: s.facts.components,
            genus: facts.genus,
            closed: s.facts.closed,
            manifold: s.facts.manifold,
        });
    }
    warn(&args.out, &out.warnings);
    answer(json, &out, |w| {
        for r in &out.results {
            writeln!(
                w,
                "{}: {} vertices, {} faces, volume {}, area {}, {} components -> {}",
                r.name,
                r.vertices,
                r.faces,
                r.volume,
                r.area,
                r.components,
                r.file.display()
            )?;
        }
        writeln!(w, "{:.4} s, tolerance {:.3e}", out.seconds, out.tolerance)
    });
    Ok(())
}

/// Reads one operand, mends it where asked, and says what is wrong with it.
fn operand(
    path: &Path,
    args: &BooleanArgs,
    job: &Job,
    now: &impl Fn() -> f64,
    out: &mut Answer,
) -> Result<PolyMesh, Fail> {
    let mut lap = now();
    let mut phase = |out: &mut Answer, name: &str| {
        let t = now();
        *out.phases.entry(name.into()).or_default() += t - lap;
        lap = t;
    };
    let loaded = read_mesh(path, job)?;
    let mut mesh = loaded.mesh;
    out.warnings.extend(loaded.warnings.iter().map(|w| format!("{}: {w}", path.display())));
    phase(out, "read");
    let stop = |e: crate::analysis::cancel::Cancelled| Fail::Input(e.to_string());
    let mut facts = check::report(&mesh, !args.trust, job).map_err(stop)?;
    if !facts.closed {
        // Triangle soups (STL) say their corners anew for each triangle.
        mend::weld(&mut mesh, 0.0);
        facts = check::report(&mesh, !args.trust, job).map_err(stop)?;
    }
    let crossed = facts.self_intersections.unwrap_or(0);
    phase(out, "look");
    if args.solve.is_some() && (!facts.closed || crossed > 0 || facts.volume.is_some_and(|v| v < 0.0)) {
        let turned = mend::orient(&mut mesh);
        let holes = mend::fill_holes(&mut mesh, usize::MAX);
        let was = mesh.face_count();
        mesh = boolean::solve(&mesh, job)?;
        out.warnings.push(format!(
            "{}: solved by winding: {turned} faces turned, {holes:?}, {was} faces became {}",
            path.display(),
            mesh.face_count()
        ));
        phase(out, "solve");
    } else if crossed > 0 {
        out.warnings.push(format!(
            "{}: {crossed} pairs of triangles cross; what lies there is taken as it is (--solve winding mends it)",
            path.display()
        ));
    }
    Ok(mesh)
}

fn named(out: &Path, name: &str) -> PathBuf {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    let ending = out.extension().unwrap_or_default().to_string_lossy();
    out.with_file_name(format!("{stem}-{name}.{ending}"))
}

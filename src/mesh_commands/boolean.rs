//! `sculptd boolean`: union, intersection and differences of solids.

mod operands;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sculptd_devices::Clock;
use serde::Serialize;

use self::operands::{Operands, operand};
use super::convert::{FileFacts, ReadyMesh, write_checked, write_ready};
use super::distance::warn;
use super::info::interrupted;
use super::{Fail, Outcome, answer};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean;
use sculptd_geometry::boolean::{
    BooleanChain, BooleanOptions, BooleanReport, BooleanSolid, Contact, Operation, OwnCrossings,
    Precision, ResultFaces,
};
use sculptd_geometry::io::writable_format;
use sculptd_geometry::job::Job;
use sculptd_geometry::written::KnownFaces;

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
    /// One solid in two by `--plane`: what is above it and what is below it.
    Split,
    /// Each connected shell of one mesh, in a separate file.
    Shells,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Solve {
    /// Inside is what the surface goes around, counted with its direction.
    Winding,
}

/// Shape of a result's polygons where a face was cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Polygons {
    /// Convex polygons, which every program reads alike.
    Convex,
    /// As few polygons as possible, including concave ones.
    Any,
}

#[derive(Debug, clap::Args)]
pub struct BooleanArgs {
    pub what: What,
    /// The operands A, B and, for a union, an intersection or a difference (A minus all others),
    /// more.
    #[arg(required = true, num_args = 1..)]
    pub meshes: Vec<PathBuf>,
    /// File to write the result to; the extension decides the format. Several results get their
    /// names before the extension.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Length within which faces are in contact; 0 for what the numbers say. Without it, what the
    /// operands' coordinates can resolve: their digits, single precision, and their distance from
    /// the origin.
    #[arg(long, value_name = "MM")]
    pub tolerance: Option<f64>,
    /// Keep faces in which the solids only touch in the intersection.
    #[arg(long)]
    pub keep_contact: bool,
    /// Make operands that are broken or cross themselves into solids first.
    #[arg(long, value_enum)]
    pub solve: Option<Solve>,
    /// Write polygons where faces were cut. Without it, triangles come out where triangles went in,
    /// and convex polygons where polygons did.
    #[arg(
        long,
        value_enum,
        value_name = "SHAPE",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "convex"
    )]
    pub polygons: Option<Polygons>,
    /// Leave out the look for triangles that cross within an operand.
    #[arg(long)]
    pub trust: bool,
    /// Of `split`: the plane x*X + y*Y + z*Z = D; above is where (x, y, z) points.
    #[arg(long, value_name = "X,Y,Z,D", value_delimiter = ',', allow_hyphen_values = true)]
    pub plane: Vec<f64>,
    /// Make smaller triangles along the cut: none that has a corner there keeps an edge longer than
    /// this. The results are triangles then.
    #[arg(long, value_name = "MM")]
    pub refine_cut: Option<f64>,
    /// Say in the answer where the cut runs, and which operand's which face each face is of.
    #[arg(long)]
    pub details: bool,
}

/// What `--json` prints.
#[derive(Debug, Default, Clone, Serialize)]
struct BooleanAnswer {
    results: Vec<Made>,
    seconds: f64,
    /// Seconds by phase.
    phases: BTreeMap<String, f64>,
    /// Length within which places were taken as one; of several steps, the largest.
    tolerance: f64,
    /// The precision of the operands' coordinates, the coarsest.
    precision: Option<Precision>,
    /// Distances that the tolerance decided.
    contact: ContactAnswer,
    /// True if another tolerance may give another result.
    depends_on_tolerance: bool,
    /// The greatest error of a volume relative to the operands as given.
    volume_bound: f64,
    /// Pieces of the curve in which the surfaces meet.
    cut_segments: usize,
    /// That curve, in polylines.
    cut: Vec<Line>,
    /// Triangles added by `--refine-cut`, of all results.
    refined: usize,
    warnings: Vec<String>,
}

#[derive(Debug, Default, Clone, Serialize)]
struct ContactAnswer {
    places: usize,
    farthest: f64,
    near_misses: usize,
}

impl ContactAnswer {
    fn add(&mut self, found: Contact) {
        self.places += found.places;
        self.farthest = self.farthest.max(found.farthest);
        self.near_misses += found.near_misses;
    }
}

#[derive(Debug, Clone, Serialize)]
struct Line {
    closed: bool,
    length: f64,
    /// With `--details`.
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<[f64; 3]>>,
}

#[derive(Debug, Clone, Serialize)]
struct Made {
    name: String,
    file: PathBuf,
    vertices: usize,
    faces: usize,
    /// Of a closed result; 0 of an empty one.
    volume: Option<f64>,
    area: f64,
    components: usize,
    genus: Option<i64>,
    closed: bool,
    manifold: bool,
    /// Pairs of triangles of the file that cross; none with `--trust`.
    self_intersections: Option<usize>,
    /// With `--details`: operand (in the order of the command line, from 0) and face in it, one a
    /// face.
    #[serde(skip_serializing_if = "Option::is_none")]
    origins: Option<Vec<(usize, u32)>>,
}

impl From<boolean::BooleanError> for Fail {
    fn from(e: boolean::BooleanError) -> Self {
        match e {
            boolean::BooleanError::Inconsistent(_) => Fail::Check(e.to_string()),
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
    if args.refine_cut.is_some_and(|edge| !(edge > 0.0 && edge.is_finite())) {
        return Err(Fail::Usage("--refine-cut: expected a length above 0".into()));
    }
    if args.refine_cut.is_some() && args.what == What::Shells {
        return Err(Fail::Usage("--refine-cut: shells are not cut".into()));
    }
    let plane = match (args.what, &args.plane[..]) {
        (What::Split, &[x, y, z, d]) => Some((DVec3::new(x, y, z), d)),
        (What::Split, _) => return Err(Fail::Usage("split: expected --plane X,Y,Z,D".into())),
        (_, &[]) => None,
        _ => return Err(Fail::Usage("--plane: only for split".into())),
    };
    let fits = match args.what {
        What::Split | What::Shells => args.meshes.len() == 1,
        What::All | What::ReverseDifference => args.meshes.len() == 2,
        _ => args.meshes.len() >= 2,
    };
    if !fits {
        return Err(Fail::Usage(
            "expected one operand for split and shells, two for all and reverse-difference, else \
                two or more"
                .into(),
        ));
    }
    let mut out = BooleanAnswer::default();
    let mut operands = Operands::default();
    for path in &args.meshes {
        operands.push(operand(path, args, &job, &now, &mut out)?);
    }
    if args.what != What::Shells {
        let lap = now();
        operands.look_first(args, &job, &mut out)?;
        *out.phases.entry("look".into()).or_default() += now() - lap;
    }
    let start = now();
    let faces = match args.polygons {
        _ if args.refine_cut.is_some() => ResultFaces::Triangles,
        Some(Polygons::Any) => ResultFaces::Polygons,
        Some(Polygons::Convex) => ResultFaces::ConvexPolygons,
        None if operands.meshes.iter().any(|m| m.faces().any(|f| f.len() != 3)) => {
            ResultFaces::ConvexPolygons
        }
        None => ResultFaces::Triangles,
    };
    // These formats hold triangles only.
    let faces = match writable_format(&args.out)? {
        "stl" | "glb" | "gltf" | "3mf" => ResultFaces::Triangles,
        _ => faces,
    };
    if args.what == What::Shells {
        return shells(&operands.meshes[0], args, out, json);
    }
    // Operands that were solved by winding are solids already.
    let keep = args.trust || args.solve.is_some();
    let mut options = BooleanOptions {
        tolerance: args.tolerance,
        faces,
        keep_contact: args.keep_contact,
        own_crossings: if keep { OwnCrossings::Keep } else { OwnCrossings::Solve },
        ..BooleanOptions::default()
    };
    let (mut best, mut blank) = (None::<ResultSet>, out);
    let mut failed = None;
    for factor in SMALLER {
        let first = best.as_ref().map(|b| b.out.tolerance);
        if let Some(first) = first {
            options.tolerance = Some(first * factor);
        }
        let out = blank.clone();
        let made = ResultSet::of(&operands, args, &options, plane, out, &job, &now);
        // Whose crossings they are decides what is done about them.
        let again = made.as_ref().is_ok_and(|m| m.crossings > 0)
            && operands.look(args, &job, &mut blank)?;
        let made = match again {
            true => ResultSet::of(&operands, args, &options, plane, blank.clone(), &job, &now),
            false => made,
        };
        let mut made = match made {
            Ok(made) => made,
            Err(e) => {
                failed = Some(e);
                break;
            }
        };
        let again = made.crossings > 0 && made.out.contact.near_misses > 0;
        if best.as_ref().is_none_or(|b| made.crossings < b.crossings) {
            if let (Some(first), Some(b)) = (first, &best) {
                made.out.warnings.push(format!(
                    "tolerance {:.1e} taken instead of {first:.1e}, with which {} pairs of \
                     triangles of the results cross",
                    made.out.tolerance, b.crossings
                ));
                made.out.depends_on_tolerance = true;
            }
            best = Some(made);
        }
        if !again || args.tolerance.is_some() {
            break;
        }
    }
    if let Some(e) = failed.filter(|_| best.is_none()) {
        return Err(e);
    }
    let Some(ResultSet { mut out, solids, .. }) = best else {
        return Err(Fail::Check("no result".into()));
    };
    out.seconds = now() - start;
    for ReadySolid { name, file, solid, origins, written } in solids {
        if solid.mesh.face_count() == 0 {
            out.warnings.push(format!("the {name} is empty"));
        }
        let written = write_ready(&file, &solid.mesh, written.as_ref(), &job)?;
        out.warnings.extend(written.warnings.iter().map(|w| format!("{name}: {w}")));
        let mut made = Made::of(&name, file, &written);
        if args.details {
            let plain = || solid.origins.iter().map(|o| (o.operand as usize, o.face)).collect();
            let all = origins.unwrap_or_else(plain);
            if all.len() == made.faces {
                made.origins = Some(all);
            } else {
                out.warnings.push(format!(
                    "{name}: the file has {} faces for the result's {}: no origins are given",
                    made.faces,
                    all.len()
                ));
            }
        }
        out.results.push(made);
    }
    print_answer(args, &out, json);
    Ok(())
}

/// Factors of the default tolerance that are tried while results cross themselves and places are
/// only just not in contact: then the tolerance parts places that belong together.
const SMALLER: [f64; 3] = [1.0, 0.125, 0.0];

/// The results with one tolerance, ready to be written.
struct ResultSet {
    out: BooleanAnswer,
    solids: Vec<ReadySolid>,
    /// Pairs of triangles that cross in them once they are rounded to the format.
    crossings: usize,
}

struct ReadySolid {
    name: String,
    file: PathBuf,
    solid: BooleanSolid,
    origins: Origins,
    /// None: it is not looked at (`--trust`).
    written: Option<ReadyMesh>,
}

impl ResultSet {
    fn of(
        operands: &Operands,
        args: &BooleanArgs,
        options: &BooleanOptions,
        plane: Option<(DVec3, f64)>,
        mut out: BooleanAnswer,
        job: &Job,
        now: &impl Fn() -> f64,
    ) -> Result<ResultSet, Fail> {
        let solids: Vec<(String, BooleanSolid, Origins)> = match plane {
            Some((normal, offset)) => {
                let known_crossings = [operands.crossing[0], Some(false)];
                let options = BooleanOptions { known_crossings, ..*options };
                let (made, report) =
                    boolean::split(&operands.meshes[0], normal, offset, &options, job, now)?;
                out.note(report, args.details);
                let names = ["above", "below"].map(str::to_owned);
                let mut made: Vec<_> =
                    names.into_iter().zip(made).map(|(n, s)| (n, s, None)).collect();
                made.iter_mut().try_for_each(|(n, s, _)| out.refine(n, s, args, job))?;
                made
            }
            None => join(operands, args, options, job, now, &mut out)?,
        };
        let several = solids.len() > 1;
        let lap = now();
        let (mut ready, mut crossings) = (Vec::new(), 0);
        // Of the largest clean operand, the faces that are still there need no new comparison.
        let meshes = &operands.meshes;
        let largest = operands.largest_clean();
        for (name, solid, origins) in solids {
            let file = if several { named(&args.out, &name) } else { args.out.clone() };
            // Kept contact is a sheet with two sides, which a repair would part.
            let written = if args.trust || args.keep_contact {
                None
            } else {
                let of = |n: usize, face: u32| (Some(n) == largest).then_some(face);
                let faces: Vec<Option<u32>> = match &origins {
                    Some(all) => all.iter().map(|&(n, face)| of(n, face)).collect(),
                    None => solid.origins.iter().map(|o| of(o.operand.into(), o.face)).collect(),
                };
                let known = largest.map(|n| KnownFaces { mesh: &meshes[n], faces: &faces });
                Some(ReadyMesh::of(&file, &solid.mesh, out.tolerance, known, job)?)
            };
            crossings += written.as_ref().map_or(0, |w| w.crossings);
            ready.push(ReadySolid { name, file, solid, origins, written });
        }
        *out.phases.entry("crossings".into()).or_default() += now() - lap;
        Ok(ResultSet { out, solids: ready, crossings })
    }
}

/// Operand and face of each face, where there were more than two operands.
type Origins = Option<Vec<(usize, u32)>>;

/// The asked operations, from the left to the right.
fn join(
    operands: &Operands,
    args: &BooleanArgs,
    options: &BooleanOptions,
    job: &Job,
    now: &impl Fn() -> f64,
    out: &mut BooleanAnswer,
) -> Result<Vec<(String, BooleanSolid, Origins)>, Fail> {
    let operations = match args.what {
        What::Union => vec![Operation::Union],
        What::Intersection => vec![Operation::Intersection],
        What::Difference => vec![Operation::Difference],
        What::ReverseDifference => vec![Operation::ReverseDifference],
        _ => Operation::ALL.to_vec(),
    };
    if let (&[operation], None) = (&operations[..], args.refine_cut) {
        return chain(operands, operation, args, options, job, now, out);
    }
    let mut solids: Vec<(String, BooleanSolid, Origins)> = Vec::new();
    for (n, right) in operands.meshes.iter().enumerate().skip(1) {
        let left = solids.pop();
        let first = left.as_ref().map_or(&operands.meshes[0], |l| &l.1.mesh);
        // A result of operands that cross nothing crosses nothing.
        let known = &operands.crossing[..n];
        let left_crosses =
            if n == 1 || known.iter().all(|c| *c == Some(false)) { known[0] } else { None };
        let options =
            BooleanOptions { known_crossings: [left_crosses, operands.crossing[n]], ..*options };
        let (made, report) = boolean::compute([first, right], &operations, &options, job, now)?;
        out.note(report, args.details);
        let known = left.as_ref().and_then(|l| l.2.as_ref());
        let of = |o: &boolean::FaceOrigin| match (o.operand, known) {
            (0, Some(known)) => known[o.face as usize],
            (0, None) => (0, o.face),
            _ => (n, o.face),
        };
        solids = made
            .into_iter()
            .map(|mut s| {
                out.refine(s.operation.name(), &mut s, args, job)?;
                let origins = s.origins.iter().map(of).collect();
                Ok((s.operation.name().to_owned(), s, Some(origins)))
            })
            .collect::<Result<_, Fail>>()?;
    }
    Ok(solids)
}

/// One operation, from the left to the right, at the cost of what each operand cuts.
fn chain(
    operands: &Operands,
    operation: Operation,
    args: &BooleanArgs,
    options: &BooleanOptions,
    job: &Job,
    now: &impl Fn() -> f64,
    out: &mut BooleanAnswer,
) -> Result<Vec<(String, BooleanSolid, Origins)>, Fail> {
    let [first, tools @ ..] = &operands.meshes[..] else { return Ok(Vec::new()) };
    let options = BooleanOptions { known_crossings: [operands.crossing[0], None], ..*options };
    let mut chain = BooleanChain::new(first, tools.len(), options);
    for (tool, &crossing) in tools.iter().zip(&operands.crossing[1..]) {
        chain.step(operation, tool, crossing, job, now)?;
    }
    let (solid, report) = chain.finish(job)?;
    out.note(report, args.details);
    let origins = solid.origins.iter().map(|o| (o.operand as usize, o.face)).collect();
    let solid =
        BooleanSolid { operation, mesh: solid.mesh, origins: Vec::new(), facts: solid.facts };
    Ok(vec![(operation.name().to_owned(), solid, Some(origins))])
}

/// Each shell in its file.
fn shells(mesh: &PolyMesh, args: &BooleanArgs, mut out: BooleanAnswer, json: bool) -> Outcome {
    let job = Job::default();
    for (n, shell) in boolean::shells(mesh).iter().enumerate() {
        let name = (n + 1).to_string();
        let file = named(&args.out, &name);
        let written = write_checked(&file, shell, None, &job)?;
        out.results.push(Made::of(&name, file, &written));
    }
    print_answer(args, &out, json);
    Ok(())
}

impl BooleanAnswer {
    /// Smaller triangles along the cut, with `--refine-cut`.
    fn refine(
        &mut self,
        name: &str,
        solid: &mut BooleanSolid,
        args: &BooleanArgs,
        job: &Job,
    ) -> Result<(), Fail> {
        let Some(edge) = args.refine_cut else { return Ok(()) };
        let made = boolean::refine_cut(solid, edge, job).map_err(interrupted)?;
        self.refined += made.added;
        if !made.reached {
            self.warnings.push(format!(
                "{name}: some edges at the cut are longer than {edge}: there are {} triangles, or \
                 the coordinates know no place between their ends",
                solid.mesh.face_count()
            ));
        }
        Ok(())
    }

    fn note(&mut self, report: BooleanReport, details: bool) {
        for (name, seconds) in report.phases {
            *self.phases.entry(name.into()).or_default() += seconds;
        }
        self.tolerance = self.tolerance.max(report.tolerance);
        self.precision = self.precision.max(report.precision);
        self.contact.add(report.contact);
        self.depends_on_tolerance |= report.depends_on_tolerance;
        self.volume_bound += report.volume_bound;
        self.warnings.extend(report.warnings);
        for line in report.cut {
            self.cut_segments += line.len() - 1;
            self.cut.push(Line {
                closed: line.first() == line.last(),
                length: line.windows(2).map(|w| w[0].distance(w[1])).sum(),
                points: details.then(|| line.iter().map(|p| p.to_array()).collect()),
            });
        }
    }
}

impl Made {
    fn of(name: &str, file: PathBuf, facts: &FileFacts) -> Made {
        Made {
            name: name.to_owned(),
            file,
            vertices: facts.vertices,
            faces: facts.faces,
            volume: facts.volume,
            area: facts.area,
            components: facts.components,
            genus: facts.genus,
            closed: facts.closed,
            manifold: facts.manifold,
            self_intersections: facts.self_intersections,
            origins: None,
        }
    }
}

/// Prints the result.
fn print_answer(args: &BooleanArgs, out: &BooleanAnswer, json: bool) {
    warn(&args.out, &out.warnings);
    answer(json, out, |w| {
        for r in &out.results {
            // An open result has none.
            let volume = r.volume.map(|v| format!("volume {v}, ")).unwrap_or_default();
            writeln!(
                w,
                "{}: {} vertices, {} faces, {volume}area {}, {} components -> {}",
                r.name,
                r.vertices,
                r.faces,
                r.area,
                r.components,
                r.file.display()
            )?;
        }
        writeln!(w, "{:.4} s, tolerance {:.3e}", out.seconds, out.tolerance)
    });
}

fn named(out: &Path, name: &str) -> PathBuf {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    let ending = out.extension().unwrap_or_default().to_string_lossy();
    out.with_file_name(format!("{stem}-{name}.{ending}"))
}

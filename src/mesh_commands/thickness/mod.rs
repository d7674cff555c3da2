//! `sculptd thickness`: how thick are a part's walls, and are they thick enough?

mod at;
mod batch;
mod compare;
mod parts;
mod ply;

use std::io::Write;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sculptd_devices::Clock;
use serde::Serialize;

use super::{Fail, Outcome, answer, picture_size};
use parts::{Structure, write_skeleton};
use sculptd_geometry::CentredMesh;
use sculptd_geometry::io::{read_mesh, write_beside};
use sculptd_geometry::job::Job;
use sculptd_geometry::picture::{Camera, draw};
use sculptd_geometry::thickness::check::{CheckedPart, ThicknessAnswer, ThicknessLimits, Verdict};
use sculptd_geometry::thickness::colour::colour;
use sculptd_geometry::thickness::partition::SMOOTHING;
use sculptd_geometry::thickness::preset::Preset;
use sculptd_geometry::thickness::ready::ReadyPart;
use sculptd_geometry::thickness::report;
use sculptd_geometry::thickness::{
    Correction, EdgePolicy, MeasuredPlaces, MeasuredSide, Outliers, ThicknessMethod,
    ThicknessSettings, Weights,
};

#[derive(Debug, clap::Args)]
pub struct ThicknessArgs {
    /// The mesh file, or several for a batch.
    #[arg(required = true, value_name = "MESH")]
    pub meshes: Vec<PathBuf>,
    #[command(flatten)]
    pub how: How,
    #[command(flatten)]
    pub limits: LimitArgs,
    /// Tell the thickness at the point of the surface nearest to this one, with its rays and the
    /// ball that fits, instead of the whole part's; in the file's coordinates, millimetres. `--png`
    /// draws them.
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true)]
    pub at: Option<DVec3>,
    /// Divide the surface into parts of equal wall, each with its thickness, area and borders.
    /// `--png` shows them, and `--ply` has the number of each triangle's part.
    #[arg(long)]
    pub parts: bool,
    /// Levels of thickness of `--parts`, 1 to 16 [default: as few as the walls need, at most 8].
    #[arg(long, value_name = "N", requires = "parts")]
    pub levels: Option<usize>,
    /// With --parts: a spot of another level belongs to its surroundings if its radius is below
    /// this many walls, and a strip if its width is.
    #[arg(long, value_name = "WALLS", default_value_t = SMOOTHING)]
    pub smoothing: f32,
    /// Write the lines along the middle of the part's limbs as an OBJ file, and tell their length
    /// and thickness. `--png` draws them.
    #[arg(long, value_name = "FILE")]
    pub skeleton: Option<PathBuf>,
    /// Compare with this later version of the part, in the same position: where walls became
    /// thinner or thicker. The limits judge the later version; `--ply` and `--png` have the
    /// differences.
    #[arg(long, value_name = "LATER")]
    #[arg(conflicts_with_all = ["at", "parts", "skeleton", "junit", "out"])]
    pub compare: Option<PathBuf>,
    /// Write the values as a PLY file: the mesh, a colour and a `thickness` at each vertex, and a
    /// `thickness` of each face, measured at its middle.
    #[arg(long, value_name = "FILE")]
    pub ply: Option<PathBuf>,
    /// Write a picture of the coloured part; with `--at`, of the rays, the face that is measured
    /// from (blue) and the one that is met (orange).
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
    /// Pixels of the picture.
    #[arg(long, value_name = "WxH", value_parser = picture_size, default_value = "1200x900")]
    pub size: (u32, u32),
    /// Write the report: one HTML page that needs nothing else.
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Write the outcome as JUnit XML.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Folder for a batch's reports and summary page; an interrupted batch is resumed.
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
}

/// The definition and the settings of the measurement.
#[derive(Debug, Clone, clap::Args)]
pub struct How {
    /// Rays of a cone, 1 to 1000 [default: 25]. More than one means `--method cone`.
    #[arg(long, value_name = "N")]
    pub rays: Option<usize>,
    /// The definition of thickness [default: ray].
    #[arg(long, value_enum)]
    pub method: Option<DefinitionArg>,
    /// The cone's full angle, degrees, 0 to 120.
    #[arg(long, value_name = "DEGREES", default_value_t = 60.0)]
    pub opening: f32,
    /// Correction of the length of each ray of a cone: none, the hit face's angle, or the chord's
    /// (no bias on bent walls).
    #[arg(long, value_enum, default_value = "chord")]
    pub correction: CorrectionArg,
    /// Rays of a cone that do not count: keep, within:0.1-0.9 (of the range of the values),
    /// range:0.1 to range:0.9, sigma-mean, sigma-median
    #[arg(long, value_name = "RULE", default_value = "sigma-median", value_parser = outliers)]
    pub outliers: Outliers,
    /// Weight of a ray in the mean.
    #[arg(long, value_enum, default_value = "plain")]
    pub weights: WeightsArg,
    /// `wall`: behind the surface; `gap`: the clearance in front of it.
    #[arg(long, value_enum, default_value = "wall")]
    pub side: SideArg,
    /// Value of vertices on sharp edges.
    #[arg(long, value_enum, default_value = "extrapolate")]
    pub edges: EdgesArg,
    /// An edge that turns by more than this is sharp.
    #[arg(long, value_name = "DEGREES", default_value_t = 40.0)]
    pub crease: f32,
    /// Longest edge between two places to measure at; a part of large flat faces gets some by
    /// itself, 0 forbids it.
    #[arg(long, value_name = "MM")]
    pub spacing: Option<f32>,
    /// The file's unit of length.
    #[arg(long, value_enum, default_value = "mm")]
    pub unit: Unit,
}

#[derive(Debug, Clone, clap::Args)]
pub struct LimitArgs {
    /// Limits by process or material: fdm, sla, sls, abs, pc, pp, pa, pom, or a preset file.
    #[arg(long, value_name = "P")]
    pub preset: Option<String>,
    /// Thinner than this fails: exit code 1.
    #[arg(long, value_name = "MM")]
    pub fail_below: Option<f32>,
    /// Thinner than this is worth a warning.
    #[arg(long, value_name = "MM")]
    pub warn_below: Option<f32>,
    /// Thicker than this fails: exit code 1.
    #[arg(long, value_name = "MM")]
    pub fail_above: Option<f32>,
    /// Neighbouring walls that differ by more than this ratio are worth a warning.
    #[arg(long, value_name = "RATIO")]
    pub neighbour_ratio: Option<f32>,
    /// Thin regions smaller than this are no defects.
    #[arg(long, value_name = "MM2", default_value_t = 0.0)]
    pub minimum_area: f64,
}

macro_rules! choice {
    ($arg:ident -> $to:ident { $($name:ident),+ }) => {
        #[derive(Debug, Clone, Copy, clap::ValueEnum)]
        pub enum $arg { $($name),+ }
        impl From<$arg> for $to {
            fn from(a: $arg) -> $to { match a { $($arg::$name => $to::$name),+ } }
        }
    };
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum DefinitionArg {
    /// Length of one ray along the normal. The least wall is proven.
    Ray,
    /// Mean of a cone of rays (shape diameter function): smooths what is narrower than the cone.
    Cone,
    /// Diameter of the largest ball between the place and the side opposite.
    Sphere,
}

choice!(CorrectionArg -> Correction { None, Angle, Chord });
choice!(WeightsArg -> Weights { Plain, InverseAngle });
choice!(SideArg -> MeasuredSide { Wall, Gap });
choice!(EdgesArg -> EdgePolicy { Raw, Extrapolate, Sphere, Neutral });

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum Unit {
    Um,
    Mm,
    Cm,
    M,
    In,
}

impl Unit {
    /// Millimetres.
    pub fn scale(self) -> f64 {
        match self {
            Unit::Um => 0.001,
            Unit::Mm => 1.0,
            Unit::Cm => 10.0,
            Unit::M => 1000.0,
            Unit::In => 25.4,
        }
    }
}

fn outliers(text: &str) -> Result<Outliers, String> {
    match text {
        "keep" => Ok(Outliers::Keep),
        "sigma-mean" => Ok(Outliers::SigmaMean),
        "sigma-median" => Ok(Outliers::SigmaMedian),
        _ if text.starts_with("within:") => {
            let shares = text["within:".len()..].split_once('-');
            shares
                .and_then(|(low, high)| Some((low.parse().ok()?, high.parse().ok()?)))
                .filter(|&(low, high): &(f32, f32)| 0.0 <= low && low < high && high <= 1.0)
                .map(|(low, high)| Outliers::Within(low, high))
                .ok_or_else(|| "expected two shares of the range, such as within:0.1-0.9".into())
        }
        _ => text
            .strip_prefix("range:")
            .and_then(|s| s.parse().ok())
            .filter(|s| (0.1..=0.9).contains(s))
            .map(Outliers::Range)
            .ok_or_else(|| {
                "expected keep, within:0.1-0.9, range:0.1 to range:0.9, sigma-mean or sigma-median"
                    .into()
            }),
    }
}

impl How {
    pub fn settings(&self) -> ThicknessSettings {
        let many = self.rays.is_some_and(|r| r > 1);
        let method = match self.method {
            Some(DefinitionArg::Sphere) => ThicknessMethod::Sphere,
            Some(DefinitionArg::Cone) => ThicknessMethod::Cone,
            // Older scripts ask for a cone by its number of rays.
            _ if many => ThicknessMethod::Cone,
            _ => ThicknessMethod::Ray,
        };
        ThicknessSettings {
            method,
            side: self.side.into(),
            rays: self.rays.unwrap_or(ThicknessSettings::default().rays),
            opening: self.opening,
            correction: self.correction.into(),
            outliers: self.outliers,
            weights: self.weights.into(),
            edges: self.edges.into(),
            crease: self.crease,
            at: MeasuredPlaces::Vertices,
        }
    }
}

impl LimitArgs {
    /// Returns the preset's limits, each replaced by its option if given; `presets` are the ones
    /// available by name.
    pub fn limits(&self, presets: &[Preset]) -> Result<ThicknessLimits, Fail> {
        let mut limits = ThicknessLimits::default();
        if let Some(name) = &self.preset {
            limits = if name.ends_with(".toml") {
                let text =
                    std::fs::read_to_string(name).map_err(|e| Fail::io(Path::new(name), &e))?;
                let own = Preset::read(name, &text).map_err(|e| Fail::Config(e.to_string()))?;
                ThicknessLimits::from(&own)
            } else {
                let found = Preset::named(name, presets);
                ThicknessLimits::from(found.map_err(|e| Fail::Usage(e.to_string()))?)
            };
        }
        let limits = limits.replaced_by(ThicknessLimits {
            warn_below: self.warn_below,
            fail_below: self.fail_below,
            fail_above: self.fail_above,
            neighbour_ratio: self.neighbour_ratio,
            minimum_area: self.minimum_area,
        });
        if !limits.is_valid() {
            return Err(Fail::Usage("limits must be numbers above 0".into()));
        }
        Ok(limits)
    }
}

/// Reads a part and makes it ready; the sentences are warnings about its file.
pub fn load(path: &Path, how: &How, job: &Job) -> Result<(ReadyPart, Vec<String>), Fail> {
    let loaded = read_mesh(path, job)?;
    if loaded.mesh.face_count() == 0 {
        return Err(Fail::Input(format!("{}: expected faces, found none", path.display())));
    }
    let mut warnings = loaded.warnings;
    let scale = how.unit.scale();
    let part = ReadyPart::new(&loaded.mesh, scale, how.spacing, how.crease, job).map_err(|e| {
        Fail::Input(format!(
            "{}: the shells overlap, and their union failed ({e}). Unite them with \
             `sculptd boolean union` and measure the result.",
            path.display()
        ))
    })?;
    if part.united {
        warnings.push("the shells overlap: measured on their union".into());
    }
    Ok((part, warnings))
}

/// Three numbers with commas between.
fn place(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|s| s.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if x.is_finite() && y.is_finite() && z.is_finite() => {
            Ok(DVec3::new(x, y, z))
        }
        _ => Err("expected three numbers X,Y,Z".into()),
    }
}

pub fn run(args: &ThicknessArgs, presets: &[Preset], json: bool) -> Outcome {
    let limits = args.limits.limits(presets)?;
    let job = Job::default();
    if let Some(at) = args.at {
        let others = [&args.ply, &args.report, &args.junit, &args.out, &args.skeleton];
        if args.parts || others.iter().any(|o| o.is_some()) {
            return Err(Fail::Usage(
                "--at tells one place, and draws it with --png: --ply, --report, --junit, --out, \
                 --parts and --skeleton are of the whole part"
                    .into(),
            ));
        }
        return match &args.meshes[..] {
            [path] => at::tell(path, args, at, &job, json),
            _ => Err(Fail::Usage("--at: expected one mesh".into())),
        };
    }
    let path = match &args.meshes[..] {
        [path] if args.out.is_none() => path,
        _ if args.compare.is_some() => {
            return Err(Fail::Usage("--compare: expected one mesh and its later version".into()));
        }
        _ => return batch::run(args, limits, json),
    };
    if let Some(later) = &args.compare {
        return compare::run(path, later, args, limits, json);
    }
    let (part, checked) = one(path, args, limits, &job)?;
    for w in &checked.answer.warnings {
        eprintln!("sculptd: warning: {}: {w}", path.display());
    }
    let found = Structure::find(args, &part, &checked.thickness, &job)?;
    if let Some(out) = &args.ply {
        let parts = found.partition.as_ref().map(|p| &p.of[..]);
        write_beside(out, |w| ply::write(w, &part, &checked.thickness, parts))
            .map_err(|e| Fail::io(out, &e))?;
    }
    if let Some(out) = &args.skeleton {
        write_skeleton(out, &found)?;
    }
    if let Some(out) = &args.png {
        let colours = checked.thickness.colours(checked.thickness.scale());
        let (width, height) = args.size;
        let camera = Camera::from_corner(&part.mesh, width as f32 / height as f32);
        let (width, height) = (width as usize, height as usize);
        let mut picture = draw(&part.mesh, Some(&colours), &camera, width, height);
        let (low, high) = checked.thickness.scale();
        if !args.parts {
            picture.legend(low, high, |v| colour(v, low, high));
        }
        found.draw(&part, &camera, &mut picture);
        let png = picture.png().map_err(|e| Fail::Input(format!("{}: {e}", out.display())))?;
        write_beside(out, |w| w.write_all(&png)).map_err(|e| Fail::io(out, &e))?;
    }
    if let Some(out) = &args.report {
        write_report(out, path, &part, &checked)?;
    }
    if let Some(out) = &args.junit {
        let why = judge(&checked.answer).err().map(|e| e.to_string());
        let verdict = if why.is_some() { "fail" } else { "pass" };
        let row =
            batch::Row::single(checked.answer.file.clone(), verdict, checked.answer.seconds, why);
        write_beside(out, |w| w.write_all(batch::junit(&[row]).as_bytes()))
            .map_err(|e| Fail::io(out, &e))?;
    }
    let whole = WholeAnswer { checked: &checked.answer, found: &found };
    answer(json, &whole, |w| text(w, &checked.answer, &found));
    judge(&checked.answer)
}

/// The answer for one file.
#[derive(Serialize)]
struct WholeAnswer<'a> {
    #[serde(flatten)]
    checked: &'a ThicknessAnswer,
    #[serde(flatten)]
    found: &'a Structure,
}

/// Reads and checks one file.
fn one(
    path: &Path,
    args: &ThicknessArgs,
    limits: ThicknessLimits,
    job: &Job,
) -> Result<(CentredMesh, CheckedPart), Fail> {
    let (part, notes) = load(path, &args.how, job)?;
    let clock = Clock::monotonic();
    let seconds = || clock.now_us() as f64 * 1e-6;
    let mut settings = args.how.settings();
    if args.ply.is_some() || args.parts {
        settings.at = MeasuredPlaces::VerticesAndFaces;
    }
    let mut checked = part
        .judge(&path.display().to_string(), &settings, limits, job, seconds)
        .map_err(|e| Fail::Usage(e.to_string()))?;
    checked.answer.warnings.splice(0..0, notes);
    Ok((part.mesh, checked))
}

/// The origin of a report on a file of these bytes.
fn origin(bytes: &[u8]) -> report::ReportOrigin<'static> {
    let program = concat!("sculptd ", env!("CARGO_PKG_VERSION"));
    report::ReportOrigin { hash: report::fnv(bytes), bytes: bytes.len() as u64, program }
}

/// The report of a checked part to `out`.
fn write_report(out: &Path, path: &Path, part: &CentredMesh, checked: &CheckedPart) -> Outcome {
    let bytes = std::fs::read(path).map_err(|e| Fail::io(path, &e))?;
    let page = report::html(part, checked, origin(&bytes))
        .map_err(|e| Fail::Input(format!("{}: {e}", out.display())))?;
    write_beside(out, |w| w.write_all(page.as_bytes())).map_err(|e| Fail::io(out, &e))
}

fn judge(a: &ThicknessAnswer) -> Outcome {
    if !matches!(a.verdict, Verdict::Fail | Verdict::Undecided) {
        return Ok(());
    }
    let mut why = Vec::new();
    if a.limits.fail_below.is_some() {
        let place = a.least.filter(|l| a.limits.fail_below.is_some_and(|m| l.upper < f64::from(m)));
        match (place, a.verdict, a.limits.fail_below, a.summary.min) {
            (_, Verdict::Undecided, ..) => why.push(a.statement.clone()),
            (Some(_), _, Some(limit), _) => {
                why.push(format!("{}, below the limit of {limit} mm", a.statement));
            }
            (None, _, Some(limit), Some(min)) if a.least.is_none() && min < limit => {
                why.push(format!("the part measures {min:.4} mm, below the limit of {limit} mm"));
            }
            _ => {}
        }
    }
    if let (Some(limit), Some(max)) = (a.limits.fail_above, a.summary.max)
        && max > limit
    {
        why.push(format!("the thickest wall is {max:.4} mm, above the limit of {limit} mm"));
    }
    Err(Fail::Check(format!("{}: {}", a.file, why.join("; "))))
}

fn text(w: &mut dyn Write, a: &ThicknessAnswer, found: &Structure) -> std::io::Result<()> {
    let n = |v: Option<f32>| v.map_or("none".into(), |v| format!("{v:.4}"));
    let s = &a.summary;
    writeln!(
        w,
        "{}: {} vertices, {} triangles, measured at {} places",
        a.file, a.vertices, a.triangles, a.places
    )?;
    writeln!(
        w,
        "  thickness  min {}  median {}  mean {}  max {} mm",
        n(s.min),
        n(s.median),
        n(s.mean),
        n(s.max)
    )?;
    writeln!(w, "  method     {}", method_name(a))?;
    writeln!(w, "  least      {}", a.statement)?;
    if let Some(usual) = s.most_frequent {
        writeln!(w, "  usual      {usual:.4} mm (the class with the largest area)")?;
    }
    writeln!(w, "  valid      {:.2} %   error bound {:.2e} mm", s.valid * 100.0, s.error_bound)?;
    for (name, beyond) in [("below", a.below), ("above", a.above)] {
        if let Some(b) = beyond {
            writeln!(
                w,
                "  {name:9}  {:.3} +- {:.3} % of the area is {name} {} mm",
                b.area_percent, b.error_percent, b.limit
            )?;
        }
    }
    if let Some(n) = a.uneven {
        writeln!(w, "  uneven     {n} vertices differ from a neighbour by more than the ratio")?;
    }
    for (i, x) in a.worst.iter().enumerate() {
        let [px, py, pz] = x.position;
        writeln!(
            w,
            "  spot {:2}    {:.4} mm at ({px:.3}, {py:.3}, {pz:.3}), {:.3} mm2",
            i + 1,
            x.thickness,
            x.area
        )?;
    }
    found.text(w)?;
    writeln!(w, "  verdict    {}", verdict(a.verdict))?;
    writeln!(w, "  {:.3} s, {:.2} million rays a second", a.seconds, a.rays_per_second * 1e-6)
}

/// The definition in words.
fn method_name(a: &ThicknessAnswer) -> String {
    match a.method {
        ThicknessMethod::Ray => "ray along the normal".into(),
        ThicknessMethod::Cone => format!("cone of {} rays", a.rays),
        ThicknessMethod::Sphere => "sphere".into(),
    }
}

/// As people read it.
pub fn verdict(v: Verdict) -> &'static str {
    match v {
        Verdict::Unjudged => "no limit given",
        Verdict::Pass => "pass",
        Verdict::Warn => "warn",
        Verdict::Fail => "fail",
        Verdict::Undecided => "undecided",
    }
}

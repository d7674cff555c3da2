//! `sculptd check`: is a part ready to be printed or moulded, and how should it stand?

mod batch;

use std::io::Write;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sculptd_check::orientation::{Orientation, turn_upright};
use sculptd_check::preset::{CheckPreset, MaterialPreset, PrinterPreset, ProcessPreset};
use sculptd_check::report::html;
use sculptd_check::{
    CheckAnswer, CheckRequest, CheckSettings, CheckedSolid, PresetLibrary, Severity, check_part,
};
use sculptd_devices::Clock;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::{read_mesh, writable_format, write_beside, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::report::{ReportOrigin, fnv};
use serde::Serialize;

use super::distance::warn;
use super::info::interrupted;
use super::many_files::{TestCase, TestOutcome, junit};
use super::measure::direction;
use super::thickness::Unit;
use super::{Fail, Outcome, answer};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  sculptd check part.stl
  sculptd check part.stl --process sla --printer sla-145 --report check.html
  sculptd check part.stl --process moulding --material pp --up 0,1,0 --json
  sculptd check part.stl --orient turned.stl
  sculptd check parts/ --out checked --shard 1/4")]
pub struct CheckArgs {
    /// The mesh file, or several; with --out also folders of mesh files.
    #[arg(value_name = "PART", required_unless_present = "merge")]
    pub parts: Vec<PathBuf>,
    #[command(flatten)]
    pub how: CheckHow,
    /// Search for the best build direction; write the part turned to it, where a file is given.
    #[arg(long, value_name = "FILE")]
    pub orient: Option<Option<PathBuf>>,
    /// Write the report: one HTML page that needs nothing else.
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Write the outcome as JUnit XML.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Folder for a batch's rows, reports and tables; an interrupted batch is resumed.
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Check only each N-th part of a batch, from the I-th on: I/N, such as 1/4.
    #[arg(long, value_name = "I/N", value_parser = shard, requires = "out")]
    pub shard: Option<(usize, usize)>,
    /// Most threads of a batch.
    #[arg(long, value_name = "N", requires = "out")]
    pub jobs: Option<usize>,
    /// Make the tables of all rows that are in the folder of --out, without checking anything.
    #[arg(long, requires = "out", conflicts_with = "parts")]
    pub merge: bool,
}

/// The limits, and how the part stands.
#[derive(Debug, Clone, clap::Args)]
pub struct CheckHow {
    /// The process: fdm, sla, sls, moulding, or a preset file [default: the printer's, or fdm].
    #[arg(long, value_name = "P")]
    pub process: Option<String>,
    /// The printer or moulding machine: a name or a preset file.
    #[arg(long, value_name = "P")]
    pub printer: Option<String>,
    /// The material: a name or a preset file [default: the process's].
    #[arg(long, value_name = "M")]
    pub material: Option<String>,
    /// The build direction, away from the plate; the pull direction of a mould.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, default_value = "0,0,1")]
    #[arg(value_parser = direction)]
    pub up: DVec3,
    /// The file's unit of length.
    #[arg(long, value_enum, default_value = "mm")]
    pub unit: Unit,
}

fn shard(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    numbers
        .filter(|&(i, n): &(usize, usize)| 1 <= i && i <= n)
        .ok_or_else(|| "expected I/N with I from 1 to N, such as 1/4".into())
}

impl CheckHow {
    /// Puts the settings together; `library` are the presets available by name.
    pub fn settings(&self, library: &PresetLibrary) -> Result<CheckSettings, Fail> {
        let printer: Option<PrinterPreset> = match &self.printer {
            None => None,
            Some(name) => Some(match file(name)? {
                Some(CheckPreset::Printer(p)) => *p,
                Some(_) => return Err(other(name, "printer")),
                None => library.printer(name).map_err(|e| Fail::Usage(e.to_string()))?.clone(),
            }),
        };
        let usual = printer.as_ref().map_or("fdm", |p| p.process.as_str());
        let name = self.process.as_deref().unwrap_or(usual);
        let process: ProcessPreset = match file(name)? {
            Some(CheckPreset::Process(p)) => *p,
            Some(_) => return Err(other(name, "process")),
            None => library.process(name).map_err(|e| Fail::Usage(e.to_string()))?.clone(),
        };
        let material: Option<MaterialPreset> = match &self.material {
            None => None,
            Some(name) => Some(match file(name)? {
                Some(CheckPreset::Material(m)) => *m,
                Some(_) => return Err(other(name, "material")),
                None => library.material(name).map_err(|e| Fail::Usage(e.to_string()))?.clone(),
            }),
        };
        // A thickness preset of a person's own, beside the ones that are built in.
        let mut library = library.clone();
        let names = [process.walls.as_ref(), material.as_ref().and_then(|m| m.walls.as_ref())];
        for path in names.into_iter().flatten().filter(|n| n.ends_with(".toml")) {
            let text = read(path)?;
            let mut own = sculptd_geometry::thickness::preset::Preset::read(path, &text)
                .map_err(|e| Fail::Config(e.to_string()))?;
            own.name.clone_from(path);
            library.walls.push(own);
        }
        CheckSettings::new(&library, &process, printer.as_ref(), material.as_ref(), self.up)
            .map_err(|e| Fail::Usage(e.to_string()))
    }
}

fn read(path: &str) -> Result<String, Fail> {
    std::fs::read_to_string(path).map_err(|e| Fail::io(Path::new(path), &e))
}

/// The preset in a file, where `name` is one.
fn file(name: &str) -> Result<Option<CheckPreset>, Fail> {
    if !name.ends_with(".toml") {
        return Ok(None);
    }
    CheckPreset::read(name, &read(name)?).map(Some).map_err(|e| Fail::Config(e.to_string()))
}

fn other(name: &str, kind: &str) -> Fail {
    Fail::Config(format!("{name}: expected kind = \"{kind}\""))
}

/// A part that was checked, with its mesh and the bytes of its file.
struct CheckedFile {
    checked: CheckedSolid,
    mesh: PolyMesh,
    hash: u64,
    bytes: u64,
}

/// Reads and checks one file.
fn one(
    path: &Path,
    how: &CheckHow,
    settings: &CheckSettings,
    orient: bool,
) -> Result<CheckedFile, Fail> {
    let job = Job::default();
    let loaded = read_mesh(path, &job)?;
    if loaded.mesh.face_count() == 0 {
        return Err(Fail::Input(format!("{}: expected faces, found none", path.display())));
    }
    let clock = Clock::monotonic();
    let seconds = || clock.now_us() as f64 * 1e-6;
    let name = path.display().to_string();
    let request = CheckRequest { orient, ..Default::default() };
    let scale = how.unit.scale();
    let mut checked = check_part(&name, &loaded.mesh, scale, settings, request, &job, seconds)
        .map_err(interrupted)?;
    checked.answer.warnings.splice(0..0, loaded.warnings);
    let bytes = std::fs::read(path).map_err(|e| Fail::io(path, &e))?;
    let (hash, bytes) = (fnv(&bytes), bytes.len() as u64);
    Ok(CheckedFile { checked, mesh: loaded.mesh, hash, bytes })
}

fn write_report(out: &Path, done: &CheckedFile, settings: &CheckSettings) -> Outcome {
    let program = concat!("sculptd ", env!("CARGO_PKG_VERSION"));
    let origin = ReportOrigin { hash: done.hash, bytes: done.bytes, program };
    let page = html(&done.checked, settings, origin)
        .map_err(|e| Fail::Input(format!("{}: {e}", out.display())))?;
    write_beside(out, |w| w.write_all(page.as_bytes())).map_err(|e| Fail::io(out, &e))
}

/// Several parts: one object all the same.
#[derive(Debug, Serialize)]
struct ManyParts {
    ok: bool,
    parts: Vec<CheckAnswer>,
    seconds: f64,
}

/// Runs the command; `library` are the presets available by name.
pub fn run(args: &CheckArgs, library: &PresetLibrary, json: bool) -> Outcome {
    let settings = args.how.settings(library)?;
    if args.out.is_some() {
        return batch::run(args, &settings, json);
    }
    let turned = args.orient.as_ref().and_then(Option::as_ref);
    if args.parts.len() > 1 && (args.report.is_some() || turned.is_some()) {
        return Err(Fail::Usage(
            "--report and a file for --orient are for a single part; several parts take --out \
             FOLDER"
                .into(),
        ));
    }
    if let Some(folder) = args.parts.iter().find(|p| p.is_dir()) {
        let folder = folder.display();
        return Err(Fail::Usage(format!("{folder}: a folder of parts needs --out FOLDER")));
    }
    if let Some(file) = turned {
        writable_format(file)?;
        if args.parts.contains(file) {
            let file = file.display();
            return Err(Fail::Usage(format!("--orient: {file} would replace the part itself")));
        }
    }
    let mut answers = Vec::new();
    for path in &args.parts {
        let mut done = one(path, &args.how, &settings, args.orient.is_some())?;
        if let (Some(file), Some(best)) = (turned, done.checked.answer.orientations.first()) {
            let mesh = turned_part(&done.mesh, best);
            write_mesh(file, &mesh)?;
            let what = format!("{}: the part turned to the first orientation", file.display());
            done.checked.answer.warnings.push(what);
        }
        warn(path, &done.checked.answer.warnings);
        if let Some(out) = &args.report {
            write_report(out, &done, &settings)?;
        }
        answers.push(done.checked.answer);
    }
    if let Some(out) = &args.junit {
        let why: Vec<String> = answers.iter().map(why).collect();
        let cases: Vec<TestCase> = answers
            .iter()
            .zip(&why)
            .map(|(a, why)| TestCase {
                name: &a.file,
                seconds: a.seconds,
                outcome: if a.ok { TestOutcome::Passed } else { TestOutcome::Failed },
                why,
            })
            .collect();
        let page = junit("check", "check", &cases);
        write_beside(out, |w| w.write_all(page.as_bytes())).map_err(|e| Fail::io(out, &e))?;
    }
    let failed: Vec<String> =
        answers.iter().filter(|a| !a.ok).map(|a| format!("{}: {}", a.file, why(a))).collect();
    match &answers[..] {
        [only] => answer(json, only, |w| text(w, only)),
        _ => {
            let seconds = answers.iter().map(|a| a.seconds).sum();
            let many = ManyParts { ok: failed.is_empty(), parts: answers, seconds };
            answer(json, &many, |w| many.parts.iter().try_for_each(|a| text(w, a)));
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(Fail::Check(failed.join("; "))) }
}

/// The part in its file's unit, turned so that the direction is the z axis, on z = 0.
fn turned_part(mesh: &PolyMesh, best: &Orientation) -> PolyMesh {
    let turn = turn_upright(DVec3::from(best.direction));
    let mut out = mesh.clone();
    out.positions.iter_mut().for_each(|p| *p = turn * *p);
    let used = out.corners.iter().map(|&c| out.positions[c as usize].z);
    let low = used.fold(f64::INFINITY, f64::min);
    if low.is_finite() {
        out.positions.iter_mut().for_each(|p| p.z -= low);
    }
    out
}

/// Why a part fails, in one sentence.
fn why(a: &CheckAnswer) -> String {
    let errors: Vec<&str> = a
        .findings
        .iter()
        .filter(|f| f.severity == Severity::Error)
        .map(|f| f.kind.name())
        .collect();
    let mut parts: Vec<String> = Vec::new();
    for group in errors.chunk_by(|a, b| a == b) {
        parts.push(match group.len() {
            1 => group[0].to_string(),
            n => format!("{n} x {}", group[0]),
        });
    }
    parts.join(", ")
}

fn text(w: &mut dyn Write, a: &CheckAnswer) -> std::io::Result<()> {
    let verdict = if a.ok { "ok" } else { "not ready" };
    writeln!(w, "{}: {verdict} for {} in {}", a.file, a.process, a.material)?;
    for f in &a.findings {
        let word = if f.severity == Severity::Error { "error" } else { "warning" };
        let place =
            f.position.map_or(String::new(), |[x, y, z]| format!(" at ({x:.3}, {y:.3}, {z:.3})"));
        writeln!(w, "  {word:7}  {:16}  {}{place}", f.kind.name(), f.message)?;
    }
    let n =
        |what: &str, value: Option<f64>, unit: &str| value.map(|v| format!("{what} {v:.3} {unit}"));
    let facts = &a.facts;
    let line: Vec<String> = [
        n("volume", facts.volume, "mm3"),
        n("weight", facts.weight, "g"),
        n("support", facts.support_volume, "mm3"),
        n("first layer", facts.contact_area, "mm2"),
        n("build time", facts.build_time.map(|s| s / 60.0), "min"),
        n("thickest wall", facts.thickest_wall, "mm"),
        n("cooling time", facts.cooling_time, "s"),
        n("projected area", facts.projected_area, "mm2"),
        n("clamping force", facts.clamping_force, "kN"),
    ]
    .into_iter()
    .flatten()
    .collect();
    writeln!(w, "  {}", line.join("  "))?;
    for (i, o) in a.orientations.iter().enumerate() {
        let [x, y, z] = o.direction;
        writeln!(
            w,
            "  direction {:2}  ({x:.4}, {y:.4}, {z:.4})  support {:.1} mm3  overhang {:.1} mm2  \
             islands {}  height {:.2} mm  first layer {:.1} mm2",
            i + 1,
            o.support_volume,
            o.overhang_area,
            o.islands,
            o.height,
            o.contact_area
        )?;
    }
    if !a.reasons.is_empty() {
        writeln!(w, "  the first direction is better: {}", a.reasons.join("; "))?;
    }
    let ran = a.checks.iter().filter(|c| c.ran).count();
    writeln!(w, "  {ran} of {} checks ran in {:.3} s", a.checks.len(), a.seconds)
}

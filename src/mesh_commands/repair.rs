//! `sculptd repair`: a flat base, a split with pegs, drain holes, vents, draft, thicker walls,
//! text. The file that was written is read and checked again, and the answer says what is left.

use std::io::Write;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sculptd_check::preset::BuildMethod;
use sculptd_check::repair::flat_base::base_tool;
use sculptd_check::repair::holes::{HoleSettings, SealedKind, plan_holes};
use sculptd_check::repair::lettering::{Lettering, plan_lettering};
use sculptd_check::repair::split::{PegSettings, SplitPlane, split_part};
use sculptd_check::repair::thickening::{thicken, thin_regions};
use sculptd_check::repair::wall_draft::add_draft;
use sculptd_check::repair::{RepairError, ReshapedPart, combined, remaining, solid_of};
use sculptd_check::{
    CheckRequest, CheckSettings, Finding, FindingKind, PresetLibrary, Severity, check_part,
};
use sculptd_devices::Clock;
use sculptd_geometry::boolean::{Operation, default_tolerance};
use sculptd_geometry::io::{read_mesh, writable_format};
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::{PolyMesh, repair};
use serde::Serialize;

use super::check::CheckHow;
use super::convert::write_checked;
use super::distance::warn;
use super::info::interrupted;
use super::{Fail, Outcome, answer};

#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true)))]
#[command(after_help = "Examples:
  sculptd repair part.stl flat.stl --base 0.5
  sculptd repair part.stl halves.stl --split 0,0,20,0,0,1 --pegs 3 --clearance 0.15
  sculptd repair hollow.stl drained.stl --drain 3 --inlet --process sla
  sculptd repair lid.stl drafted.stl --draft 1.5 --process moulding
  sculptd repair lid.stl thicker.stl --thicken 1.2
  sculptd repair lid.stl marked.stl --text Left --at 20,10,5 --letter-height 6 --relief -0.4
  sculptd repair cup.stl vented.stl --vent 2 --process sla --up 0,1,0 --json")]
pub struct RepairArgs {
    /// The mesh file.
    #[arg(value_name = "PART")]
    pub part: PathBuf,
    /// File to write the result to; the extension decides the format. A split writes two, with
    /// `below` and `above` before the extension.
    #[arg(value_name = "OUT")]
    pub out: PathBuf,
    /// Cut a flat base at this height above the lowest point.
    #[arg(long, value_name = "MM", group = "what")]
    pub base: Option<f64>,
    /// Split by the plane through X,Y,Z with the normal NX,NY,NZ.
    #[arg(long, value_name = "X,Y,Z,NX,NY,NZ", allow_hyphen_values = true, group = "what")]
    #[arg(value_parser = plane)]
    pub split: Option<SplitPlane>,
    /// Drill a hole of this diameter out of each cavity at its lowest point.
    #[arg(long, value_name = "DIAMETER", group = "what")]
    pub drain: Option<f64>,
    /// Drill a hole of this diameter into each suction cup where it begins.
    #[arg(long, value_name = "DIAMETER", group = "what")]
    pub vent: Option<f64>,
    /// Give walls with less draft along --up this draft.
    #[arg(long, value_name = "DEGREES", group = "what")]
    pub draft: Option<f64>,
    /// Thicken walls below this.
    #[arg(long, value_name = "MM", group = "what")]
    pub thicken: Option<f64>,
    /// Raise or engrave this text; `\n` begins a line.
    #[arg(long, group = "what", requires = "at")]
    pub text: Option<String>,
    /// Of --text: its middle; the nearest place of the surface is taken.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "text")]
    #[arg(value_parser = point)]
    pub at: Option<DVec3>,
    /// Of --text: the height of a capital letter.
    #[arg(long, value_name = "MM", requires = "text", default_value_t = 5.0)]
    pub letter_height: f64,
    /// Of --text: how far it rises; below 0 how deep it is engraved.
    #[arg(long, value_name = "MM", allow_hyphen_values = true, requires = "text")]
    #[arg(default_value_t = 0.6)]
    pub relief: f64,
    /// Of --split: most pegs, 0 to 16.
    #[arg(long, value_name = "N", requires = "split", default_value_t = 4)]
    pub pegs: usize,
    /// Of --split: the radius of a peg.
    #[arg(long, value_name = "MM", requires = "split", default_value_t = 2.0)]
    pub peg_radius: f64,
    /// Of --split: the length of a peg beyond the plane.
    #[arg(long, value_name = "MM", requires = "split", default_value_t = 5.0)]
    pub peg_length: f64,
    /// Of --split: the least distance between a peg and its socket.
    #[arg(long, value_name = "MM", requires = "split", default_value_t = 0.2)]
    pub clearance: f64,
    /// Of --drain: drill a second hole at the highest point, through which air comes in.
    #[arg(long, requires = "drain")]
    pub inlet: bool,
    #[command(flatten)]
    pub how: CheckHow,
}

/// The plane of a split, in millimetres.
fn plane(text: &str) -> Result<SplitPlane, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|s| s.trim().parse().ok()).collect();
    let numbers = numbers.filter(|n| n.iter().all(|x| x.is_finite()));
    match numbers.as_deref() {
        Some(&[x, y, z, u, v, w]) if u != 0.0 || v != 0.0 || w != 0.0 => {
            Ok(SplitPlane { point: DVec3::new(x, y, z), normal: DVec3::new(u, v, w) })
        }
        _ => Err("expected six numbers X,Y,Z,NX,NY,NZ, the last three not all zero".into()),
    }
}

/// A place, in millimetres.
fn point(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|s| s.trim().parse().ok()).collect();
    let numbers = numbers.filter(|n| n.iter().all(|x| x.is_finite()));
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err("expected three numbers X,Y,Z".into()),
    }
}

impl From<RepairError> for Fail {
    fn from(e: RepairError) -> Self {
        match e {
            RepairError::Boolean(e) => Fail::from(e),
            RepairError::Cancelled(e) => interrupted(e),
            RepairError::OutOfRange { .. }
            | RepairError::BesidePart { .. }
            | RepairError::Text(_)
            | RepairError::NoRoom { .. } => Fail::Usage(e.to_string()),
            _ => Fail::Check(e.to_string()),
        }
    }
}

/// A hole of the answer, in millimetres.
#[derive(Debug, Clone, Serialize)]
struct HoleAnswer {
    from: [f64; 3],
    to: [f64; 3],
    inlet: bool,
    sealed_by_plate: bool,
}

/// A file that was written, as it was read back and checked.
#[derive(Debug, Clone, Serialize)]
struct RepairedPart {
    file: String,
    vertices: usize,
    faces: usize,
    /// mm3.
    volume: Option<f64>,
    /// mm2.
    area: f64,
    components: usize,
    closed: bool,
    manifold: bool,
    self_intersections: Option<usize>,
    /// The flat area on the plate, mm2.
    base_area: f64,
    /// Findings of the process's check.
    findings: Vec<Finding>,
}

/// What `--json` prints. Lengths are in millimetres.
#[derive(Debug, Clone, Serialize)]
struct RepairAnswer {
    repair: &'static str,
    /// True if the check of the file no longer finds what was repaired, and the file is one solid.
    repaired: bool,
    parts: Vec<RepairedPart>,
    holes: Vec<HoleAnswer>,
    pegs: Vec<[f64; 3]>,
    /// Findings that the repair left, one sentence each.
    left: Vec<String>,
    warnings: Vec<String>,
    seconds: f64,
}

/// The result before it is written: files and meshes, and what to say of it.
#[derive(Default)]
struct RepairOutput {
    files: Vec<(PathBuf, PolyMesh)>,
    holes: Vec<HoleAnswer>,
    pegs: Vec<[f64; 3]>,
    warnings: Vec<String>,
    /// The least change of the volume, in the mesh's unit; below 0 for what is taken away.
    change: Option<f64>,
    /// The findings that must be gone.
    gone: Vec<FindingKind>,
    name: &'static str,
}

/// Reads a mesh with shared corners.
fn welded(path: &Path, job: &Job) -> Result<(PolyMesh, Vec<String>), Fail> {
    let loaded = read_mesh(path, job)?;
    let mut mesh = loaded.mesh;
    if mesh.face_count() == 0 {
        return Err(Fail::Input(format!("{}: expected faces, found none", path.display())));
    }
    repair::weld(&mut mesh, 0.0);
    Ok((mesh, loaded.warnings))
}

/// The name of one of two files.
fn beside(out: &Path, name: &str) -> PathBuf {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    let end = out.extension().unwrap_or_default().to_string_lossy();
    out.with_file_name(format!("{stem}-{name}.{end}"))
}

/// Runs the command; `library` are the presets available by name.
pub fn run(args: &RepairArgs, library: &PresetLibrary, json: bool) -> Outcome {
    let clock = Clock::monotonic();
    let seconds = || clock.now_us() as f64 * 1e-6;
    let begun = seconds();
    let job = Job::default();
    let settings = args.how.settings(library)?;
    writable_format(&args.out)?;
    let scale = args.how.unit.scale();
    let (mesh, mut warnings) = welded(&args.part, &job)?;
    let solid = solid_of(&mesh, &job)?;
    let made = repaired(args, &solid, &settings, scale, &job)?;
    if made.files.iter().any(|f| f.0 == args.part) {
        let file = args.part.display();
        return Err(Fail::Usage(format!("{file} would replace the part itself")));
    }
    warnings.extend(made.warnings);
    let (mut parts, mut left) = (Vec::new(), Vec::new());
    for (file, mesh) in &made.files {
        let tolerance = default_tolerance([mesh, mesh]).tolerance;
        let written = write_checked(file, mesh, Some(tolerance), &job)?;
        warnings.extend(written.warnings);
        let name = file.display().to_string();
        let (again, _) = welded(file, &job)?;
        let request = CheckRequest::default();
        let checked = check_part(&name, &again, scale, &settings, request, &job, seconds);
        let findings = checked.map_err(interrupted)?.answer.findings;
        let plate = settings.process.method == BuildMethod::Layers;
        let layer = settings.layer() / scale;
        let base_area =
            remaining(&again, settings.up, layer, plate, &job).map_or(0.0, |r| r.base_area);
        left.extend(
            findings.iter().filter(|f| made.gone.contains(&f.kind)).map(|f| f.message.clone()),
        );
        if let Some(wall) = args.thicken {
            let count = thin_regions(&again, wall / scale, &job)?;
            let text = format!("{count} walls are thinner than {wall} mm");
            left.extend((count > 0).then_some(text));
        }
        if !(written.closed && written.manifold && written.self_intersections == Some(0)) {
            left.push(format!("{name} is not one solid"));
        }
        parts.push(RepairedPart {
            file: name,
            vertices: written.vertices,
            faces: written.faces,
            volume: written.volume.map(|v| v * scale.powi(3)),
            area: written.area * scale.powi(2),
            components: written.components,
            closed: written.closed,
            manifold: written.manifold,
            self_intersections: written.self_intersections,
            base_area: base_area * scale.powi(2),
            findings,
        });
    }
    if let Some((change, part)) = made.change.zip(parts.first()) {
        let by =
            part.volume.unwrap_or(0.0) - measures(&solid.triangulate().0).volume * scale.powi(3);
        let least = change * scale.powi(3);
        if by / least < 0.99 {
            left.push(format!(
                "the volume changed by {by:.3} mm3, and the letters have {least:.3}"
            ));
        }
    }
    if args.base.is_some() && parts.iter().all(|p| p.base_area <= 0.0) {
        left.push("the part does not stand flat".into());
    }
    let out = RepairAnswer {
        repair: made.name,
        repaired: left.is_empty(),
        parts,
        holes: made.holes,
        pegs: made.pegs,
        left,
        warnings,
        seconds: seconds() - begun,
    };
    warn(&args.part, &out.warnings);
    answer(json, &out, |w| text(w, &out));
    if out.repaired { Ok(()) } else { Err(Fail::Check(format!("left: {}", out.left.join("; ")))) }
}

/// The output of a repair that moves corners.
fn reshaped(
    args: &RepairArgs,
    made: ReshapedPart,
    name: &'static str,
    gone: Vec<FindingKind>,
) -> RepairOutput {
    let (files, warnings) = (vec![(args.out.clone(), made.mesh)], made.notes);
    RepairOutput { files, warnings, gone, name, ..RepairOutput::default() }
}

/// Plans and carries out the repair. Lengths of the arguments are millimetres, those of the mesh
/// its file's unit.
fn repaired(
    args: &RepairArgs,
    solid: &PolyMesh,
    settings: &CheckSettings,
    scale: f64,
    job: &Job,
) -> Result<RepairOutput, Fail> {
    let up = settings.up;
    if let Some(height) = args.base {
        let tool = base_tool(solid, up, height / scale)?;
        let (mesh, warnings) = combined(solid, &tool, Operation::Difference, job)?;
        let (files, gone) = (vec![(args.out.clone(), mesh)], vec![FindingKind::Contact]);
        return Ok(RepairOutput { files, warnings, gone, name: "base", ..RepairOutput::default() });
    }
    if let Some(plane) = args.split {
        let pegs = PegSettings {
            radius: args.peg_radius,
            length: args.peg_length,
            clearance: args.clearance,
            most: args.pegs,
        };
        let plane = SplitPlane { point: plane.point / scale, ..plane };
        let parts = split_part(solid, plane, pegs.scaled(1.0 / scale), job)?;
        let files = vec![
            (beside(&args.out, "below"), parts.below),
            (beside(&args.out, "above"), parts.above),
        ];
        let pegs = parts.pegs.iter().map(|p| (*p * scale).to_array()).collect();
        return Ok(RepairOutput {
            files,
            pegs,
            warnings: parts.notes,
            name: "split",
            ..RepairOutput::default()
        });
    }
    if let Some(angle) = args.draft {
        let made = add_draft(solid, up, angle, job)?;
        return Ok(reshaped(args, made, "draft", vec![FindingKind::Draft]));
    }
    if let Some(wall) = args.thicken {
        let made = thicken(solid, wall / scale, job)?;
        return Ok(reshaped(args, made, "thicken", Vec::new()));
    }
    if let Some((text, at)) = args.text.as_ref().zip(args.at) {
        let (height, relief) = (args.letter_height / scale, args.relief / scale);
        let (text, at) = (text.replace("\\n", "\n"), at / scale);
        let asked = Lettering { text, at, along: None, upright: up, height, relief };
        let plan = plan_lettering(solid, &asked, job)?;
        let (mesh, warnings) = combined(solid, &plan.tool, plan.operation, job)?;
        return Ok(RepairOutput {
            files: vec![(args.out.clone(), mesh)],
            warnings: [plan.notes, warnings].concat(),
            change: Some(plan.area * relief),
            name: "text",
            ..RepairOutput::default()
        });
    }
    let process = &settings.process;
    let (kind, diameter, least, finding, name) = match (args.drain, args.vent) {
        (Some(d), _) => {
            (SealedKind::Trapped, d, process.trapped, FindingKind::TrappedVolume, "drain")
        }
        (None, Some(d)) => (SealedKind::Cup, d, process.cup, FindingKind::SuctionCup, "vent"),
        (None, None) => {
            return Err(Fail::Usage(
                "expected --base, --split, --drain, --vent, --draft, --thicken or --text".into(),
            ));
        }
    };
    let Some(least) = least else {
        let (process, what) = (&process.name, kind.name());
        return Err(Fail::Usage(format!(
            "--{name}: the process \"{process}\" has no limit for a {what}; give another \
             --process, such as sla"
        )));
    };
    let asked = HoleSettings {
        kind,
        diameter: diameter / scale,
        inlet: args.inlet,
        least: least / scale.powi(3),
        pocket: process.cup,
        near: None,
        up,
        layer: settings.layer() / scale,
        plate: process.method == BuildMethod::Layers,
    };
    let plan = plan_holes(solid, &asked, job)?;
    let (mesh, mut warnings) = combined(solid, &plan.tool, Operation::Difference, job)?;
    warnings.splice(0..0, plan.notes);
    let holes = plan.holes.iter().map(|h| HoleAnswer {
        from: (h.from * scale).to_array(),
        to: (h.to * scale).to_array(),
        inlet: h.inlet,
        sealed_by_plate: h.sealed,
    });
    Ok(RepairOutput {
        files: vec![(args.out.clone(), mesh)],
        holes: holes.collect(),
        warnings,
        gone: vec![finding],
        name,
        ..RepairOutput::default()
    })
}

fn text(w: &mut dyn Write, a: &RepairAnswer) -> std::io::Result<()> {
    for p in &a.parts {
        let volume = p.volume.map_or("none".into(), |v| format!("{v:.3} mm3"));
        writeln!(w, "{}: volume {volume}, base {:.3} mm2", p.file, p.base_area)?;
        for f in &p.findings {
            let word = if f.severity == Severity::Error { "error" } else { "warning" };
            writeln!(w, "  {word:7}  {:16}  {}", f.kind.name(), f.message)?;
        }
    }
    let place = |[x, y, z]: [f64; 3]| format!("({x:.3}, {y:.3}, {z:.3})");
    for h in &a.holes {
        let what = if h.inlet { "air inlet" } else { "hole" };
        writeln!(w, "{what} from {} to {}", place(h.from), place(h.to))?;
    }
    for p in &a.pegs {
        writeln!(w, "peg at {}", place(*p))?;
    }
    let verdict = if a.repaired { "repaired" } else { "not repaired" };
    writeln!(w, "{verdict} in {:.3} s", a.seconds)
}

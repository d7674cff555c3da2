//! The operands of `sculptd boolean`: read, mended where asked, and solved where they cross
//! themselves.

use std::path::Path;

use super::{BooleanAnswer, BooleanArgs, Fail};
use sculptd_geometry::boolean::{self, BooleanError};
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, check, repair};

/// The operands in their order.
#[derive(Default)]
pub(super) struct Operands {
    pub meshes: Vec<PolyMesh>,
    /// Of each, whether it is known to be closed and manifold, without triangles that cross.
    pub clean: Vec<bool>,
    /// Of each, whether it has triangles that cross, where that is known.
    pub crossing: Vec<Option<bool>>,
}

/// One operand, as it goes into [`Operands`].
pub(super) struct Operand {
    mesh: PolyMesh,
    clean: bool,
    crossing: Option<bool>,
}

impl Operands {
    pub fn push(&mut self, operand: Operand) {
        self.meshes.push(operand.mesh);
        self.clean.push(operand.clean);
        self.crossing.push(operand.crossing);
    }
}

/// Reads one operand, repairs it if asked, and warns of its faults.
pub(super) fn operand(
    path: &Path,
    args: &BooleanArgs,
    job: &Job,
    now: &impl Fn() -> f64,
    out: &mut BooleanAnswer,
) -> Result<Operand, Fail> {
    let mut lap = now();
    let mut phase = |out: &mut BooleanAnswer, name: &str| {
        let t = now();
        *out.phases.entry(name.into()).or_default() += t - lap;
        lap = t;
    };
    let loaded = read_mesh(path, job)?;
    let mut mesh = loaded.mesh;
    out.warnings.extend(loaded.warnings.iter().map(|w| format!("{}: {w}", path.display())));
    phase(out, "read");
    let stop = |e: sculptd_geometry::job::Cancelled| Fail::Input(e.to_string());
    let mut facts = check::report(&mesh, !args.trust, job).map_err(stop)?;
    if !facts.closed {
        // Triangle soups (STL) say their corners anew for each triangle.
        repair::weld(&mut mesh, 0.0);
        facts = check::report(&mesh, !args.trust, job).map_err(stop)?;
    }
    if args.solve.is_none() && !facts.closed {
        // Said here, where the file's name is known and what helps.
        if let Err(BooleanError::Open { edges, .. }) = boolean::check(&mesh, "", job) {
            let first = args.meshes.first().is_some_and(|m| m == path);
            return Err(Fail::Input(format!(
                "{}: {} is open: {edges} edges lack a partner (--solve winding closes holes first)",
                path.display(),
                boolean::NAMES[usize::from(!first)]
            )));
        }
    }
    let crossed = facts.self_intersections.unwrap_or(0);
    let mut crossing = facts.self_intersections.map(|pairs| pairs > 0);
    let mut clean = facts.closed && facts.manifold && facts.self_intersections == Some(0);
    phase(out, "look");
    // Whether the faces' directions say what is inside.
    let directed = facts.closed && facts.oriented && facts.volume.is_some_and(|v| v > 0.0);
    if args.solve.is_some() && (!directed || crossed > 0 || args.trust || facts.components > 1) {
        let oriented = if directed { Default::default() } else { repair::orient_shells(&mut mesh) };
        let turned = oriented.turned;
        if oriented.guessed > 0 && oriented.crossing > 0 {
            out.warnings.push(format!(
                "{}: the direction of {} shells was guessed (outwards where shells cross)",
                path.display(),
                oriented.guessed
            ));
        }
        let filled = repair::fill_holes(&mut mesh, usize::MAX);
        let was = mesh.face_count();
        mesh = boolean::solve(&mesh, job)?;
        (clean, crossing) = (false, None);
        let steps = [
            (turned, "faces turned"),
            (filled.holes, "holes closed"),
            (filled.left, "open edges left"),
        ];
        let steps = steps.iter().filter(|s| s.0 > 0).map(|(n, what)| format!("{n} {what}, "));
        out.warnings.push(format!(
            "{}: solved by winding: {}{was} faces became {}",
            path.display(),
            steps.collect::<String>(),
            mesh.face_count()
        ));
        phase(out, "solve");
    } else if crossed > 0 {
        out.warnings.push(format!(
            "{}: {crossed} pairs of triangles cross; what lies there is taken as it is unless the \
             results cross there too (--solve winding mends it)",
            path.display()
        ));
    }
    Ok(Operand { mesh, clean, crossing })
}

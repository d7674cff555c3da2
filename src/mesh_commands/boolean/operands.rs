//! The operands of `sculptd boolean`: read, mended where asked, and solved where they cross
//! themselves.

use std::path::Path;

use super::{BooleanAnswer, BooleanArgs, Fail};
use sculptd_geometry::boolean::{self, BooleanError};
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, check, repair};

/// Operands of which at least one was solved by winding.
pub(super) struct SolvedOperands {
    /// All operands, in their order.
    pub meshes: Vec<PolyMesh>,
    /// A warning for each that was solved.
    pub warnings: Vec<String>,
}

/// Replaces each operand that is not clean by the solid that its surface encloses. Returns `None`
/// if no operand could be replaced.
pub(super) fn solved(
    operands: &[PolyMesh],
    clean: &[bool],
    args: &BooleanArgs,
    job: &Job,
) -> Result<Option<SolvedOperands>, Fail> {
    let (mut meshes, mut warnings) = (operands.to_vec(), Vec::new());
    for (n, mesh) in meshes.iter_mut().enumerate().filter(|(n, _)| !clean[*n]) {
        match boolean::solve(mesh, job) {
            Ok(solid) => *mesh = solid,
            Err(BooleanError::Inconsistent(_)) => continue,
            Err(e) => return Err(e.into()),
        }
        warnings.push(format!(
            "{}: solved by winding, because it crosses itself, and so did the result without that",
            args.meshes[n].display()
        ));
    }
    Ok((!warnings.is_empty()).then_some(SolvedOperands { meshes, warnings }))
}

/// Reads one operand, repairs it if asked, and warns of its faults. The second value is true if it
/// is known to be closed and manifold, without triangles that cross.
pub(super) fn operand(
    path: &Path,
    args: &BooleanArgs,
    job: &Job,
    now: &impl Fn() -> f64,
    out: &mut BooleanAnswer,
) -> Result<(PolyMesh, bool), Fail> {
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
        clean = false;
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
            "{}: {crossed} pairs of triangles cross; what lies there is taken as it is (--solve \
                winding mends it)",
            path.display()
        ));
    }
    Ok((mesh, clean))
}

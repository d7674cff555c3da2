//! The operands of `sculptd boolean`: read, mended where asked, and solved where they cross
//! themselves.

use std::path::Path;

use super::{BooleanAnswer, BooleanArgs, Fail};
use sculptd_geometry::boolean::{self, BooleanError};
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, check, repair, self_intersection};

/// The operands in their order.
#[derive(Default)]
pub(super) struct Operands {
    pub meshes: Vec<PolyMesh>,
    /// Of each, whether it is known to be closed and manifold.
    solid: Vec<bool>,
    /// Of each, whether it has triangles that cross, where that is known.
    pub crossing: Vec<Option<bool>>,
}

/// One operand, as it goes into [`Operands`].
pub(super) struct Operand {
    mesh: PolyMesh,
    solid: bool,
    crossing: Option<bool>,
}

impl Operands {
    /// The largest operand that is known to be closed and manifold, without triangles that cross.
    pub fn largest_clean(&self) -> Option<usize> {
        let clean = |&n: &usize| self.solid[n] && self.crossing[n] == Some(false);
        (0..self.meshes.len()).filter(clean).max_by_key(|&n| self.size(n))
    }

    fn size(&self, n: usize) -> (usize, usize) {
        (self.meshes[n].face_count(), self.meshes.len() - n)
    }

    /// Looks for triangles that cross within an operand that has most of the faces: of those that
    /// are still in the results none needs another look. If some cross, all operands are looked at.
    pub fn look_first(
        &mut self,
        args: &BooleanArgs,
        job: &Job,
        out: &mut BooleanAnswer,
    ) -> Result<(), Fail> {
        let all: usize = self.meshes.iter().map(PolyMesh::face_count).sum();
        let most = (0..self.meshes.len()).find(|&n| 3 * self.meshes[n].face_count() > 2 * all);
        if let Some(n) = most
            && self.look_at(n, args, job, out)?
        {
            self.look(args, job, out)?;
        }
        Ok(())
    }

    /// Looks for triangles that cross within the operands, where that was not done yet. Returns
    /// whether there are any that were not known before.
    ///
    /// Results without crossings need no look at the operands, which takes longer than the Boolean.
    pub fn look(
        &mut self,
        args: &BooleanArgs,
        job: &Job,
        out: &mut BooleanAnswer,
    ) -> Result<bool, Fail> {
        let mut found = false;
        for n in 0..self.meshes.len() {
            found |= self.look_at(n, args, job, out)?;
        }
        Ok(found)
    }

    fn look_at(
        &mut self,
        n: usize,
        args: &BooleanArgs,
        job: &Job,
        out: &mut BooleanAnswer,
    ) -> Result<bool, Fail> {
        if args.trust || args.solve.is_some() || self.crossing[n].is_some() {
            return Ok(false);
        }
        let mesh = &self.meshes[n];
        let pairs = self_intersection::pairs(&mesh.positions, &mesh.triangles().0, job);
        let crossed = pairs.map_err(|e| Fail::Input(e.to_string()))?.len();
        self.crossing[n] = Some(crossed > 0);
        if crossed > 0 {
            out.warnings.push(warning(&args.meshes[n], crossed));
        }
        Ok(crossed > 0)
    }

    pub fn push(&mut self, operand: Operand) {
        self.meshes.push(operand.mesh);
        self.solid.push(operand.solid);
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
    // What crosses within an operand and matters is seen in the results: see `Operands::look`.
    let look = !args.trust && (args.solve.is_some() || args.keep_contact);
    let loaded = read_mesh(path, job)?;
    let mut mesh = loaded.mesh;
    out.warnings.extend(loaded.warnings.iter().map(|w| format!("{}: {w}", path.display())));
    phase(out, "read");
    let stop = |e: sculptd_geometry::job::Cancelled| Fail::Input(e.to_string());
    let mut facts = check::report(&mesh, look, job).map_err(stop)?;
    if !facts.closed {
        // Triangle soups (STL) say their corners anew for each triangle.
        repair::weld(&mut mesh, 0.0);
        facts = check::report(&mesh, look, job).map_err(stop)?;
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
    let mut solid = facts.closed && facts.manifold;
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
        (solid, crossing) = (false, None);
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
        out.warnings.push(warning(path, crossed));
    }
    Ok(Operand { mesh, solid, crossing })
}

fn warning(path: &Path, crossed: usize) -> String {
    format!(
        "{}: {crossed} pairs of triangles cross; what lies there is taken as it is unless the \
         results cross there too (--solve winding mends it)",
        path.display()
    )
}

//! Booleans one after another on one solid: `part - tool - tool - ...`, or the union of a list.
//!
//! The solid keeps its search trees from step to step, and each operand is checked once. Unions and
//! differences cost what their tool cuts (`local`): they cut only the faces that reach the tool's
//! box, with the same arrangement as [`super::compute`]. A step that this cannot decide, an
//! intersection, and a chain of one step go through [`super::compute`] as a whole.
//!
//! Checked at each local step: the border of what is replaced stays the same, edge by edge; every
//! edge has two faces and every vertex one fan; samples on both surfaces agree with the winding
//! number of the other; and the volume grows or shrinks by no more than that of the tool. At the
//! end the whole is checked again: closed, manifold, and of the volume that the steps add up to.

mod kept;
mod local;
mod state;
#[cfg(test)]
mod tests;

use std::borrow::Cow;

use super::box_tree::Span;
use super::operand::crosses_itself;
use super::parts::shells_may_meet;
use super::points::Contact;
use super::precision::{OperandScale, Precision, tolerance_of};
use super::task::note_contact;
use super::{
    BooleanError, BooleanFacts, BooleanOptions, BooleanReport, NAMES, Operation, OwnCrossings,
    ResultFaces, check, compute, emit,
};
use crate::PolyMesh;
use crate::job::Job;
pub use kept::ChainOrigin;
use kept::KeptSurface;
use local::LocalStep;
pub use state::SolidState;

/// The solid at the end of a chain.
#[derive(Debug, Clone)]
pub struct ChainSolid {
    /// The result; an empty solid has no faces.
    pub mesh: PolyMesh,
    /// One a face.
    pub origins: Vec<ChainOrigin>,
    /// Volume, area and topology of `mesh`.
    pub facts: BooleanFacts,
}

/// A solid that Booleans change one after another.
///
/// ```
/// use glam::DVec3;
/// use sculptd_geometry::boolean::{BooleanChain, BooleanOptions, Operation};
/// use sculptd_geometry::job::Job;
/// use sculptd_geometry::shapes::cuboid;
///
/// let (job, options) = (Job::default(), BooleanOptions::default());
/// let block = cuboid(DVec3::ZERO, DVec3::splat(4.0));
/// let mut chain = BooleanChain::new(&block, 2, options);
/// for x in [1.0, 2.5] {
///     let drill = cuboid(DVec3::new(x, 1.0, -1.0), DVec3::new(x + 0.5, 2.0, 5.0));
///     chain.step(Operation::Difference, &drill, None, &job, || 0.0)?;
/// }
/// let (solid, _) = chain.finish(&job)?;
/// assert!((solid.facts.volume - 60.0).abs() < 1e-12);
/// # Ok::<(), sculptd_geometry::boolean::BooleanError>(())
/// ```
#[derive(Debug)]
pub struct BooleanChain<'a> {
    state: State<'a>,
    options: BooleanOptions,
    /// Of the solid, a box that may be larger; the coarsest resolution of the operands so far.
    scale: OperandScale,
    /// The volume, and the greatest error of it.
    volume: f64,
    volume_bound: f64,
    /// Whether the solid has triangles that cross, where that is known.
    crossing: Option<bool>,
    /// Operands so far.
    operands: u32,
    /// Steps that are still to come, as far as is known.
    coming: usize,
    report: BooleanReport,
    /// Steps that cost only what their tools cut.
    local: usize,
    /// Distances that the tolerance decided in local steps, and the rounding there.
    contact: Contact,
    floor: f64,
}

#[derive(Debug)]
enum State<'a> {
    /// As a mesh, with the origins of its faces unless it is the first operand, and its facts where
    /// they are known.
    Whole(Cow<'a, PolyMesh>, Option<Vec<ChainOrigin>>, Option<BooleanFacts>),
    Kept(Box<KeptSurface>),
}

impl<'a> BooleanChain<'a> {
    /// Begins with a solid that `steps` operations are to change; the number is only an estimate.
    /// Of `known_crossings`, the first entry says whether the solid crosses itself.
    pub fn new(first: &'a PolyMesh, steps: usize, options: BooleanOptions) -> BooleanChain<'a> {
        BooleanChain {
            state: State::Whole(Cow::Borrowed(first), None, None),
            scale: OperandScale::of(first),
            volume: f64::NAN,
            volume_bound: 0.0,
            crossing: options.known_crossings[0],
            options,
            operands: 1,
            coming: steps,
            report: BooleanReport::default(),
            local: 0,
            contact: Contact::default(),
            floor: 0.0,
        }
    }

    /// Applies one operation with the solid as A and `tool` as B. `crossing`: whether the tool has
    /// triangles that cross, where the caller knows.
    ///
    /// # Errors
    /// As [`compute`]. The chain is then as it was before the step; drop it where the job was
    /// cancelled.
    pub fn step(
        &mut self,
        operation: Operation,
        tool: &PolyMesh,
        crossing: Option<bool>,
        job: &Job,
        now: impl Fn() -> f64,
    ) -> Result<(), BooleanError> {
        let before = self.operands as usize - 1;
        job.part(before, before.saturating_add(self.coming));
        let made = self.step_anyhow(operation, tool, crossing, job, now);
        job.part(0, 1);
        made
    }

    /// As [`BooleanChain::step`], whatever a step is a part of.
    fn step_anyhow(
        &mut self,
        operation: Operation,
        tool: &PolyMesh,
        crossing: Option<bool>,
        job: &Job,
        now: impl Fn() -> f64,
    ) -> Result<(), BooleanError> {
        let (done, crossing) = self.step_if_local(operation, tool, crossing, job, &now)?;
        if !done {
            self.step_as_a_whole(operation, tool, crossing, job, now)?;
            self.note_step(tool, crossing);
        }
        job.progress(1.0);
        Ok(())
    }

    /// As [`BooleanChain::step`], only where that costs what the tool cuts. Returns whether it
    /// does, and whether the tool has triangles that cross, where that is known by now.
    fn step_if_local(
        &mut self,
        operation: Operation,
        tool: &PolyMesh,
        crossing: Option<bool>,
        job: &Job,
        now: &impl Fn() -> f64,
    ) -> Result<(bool, Option<bool>), BooleanError> {
        let mut clock = now();
        let mut laps: Vec<(&'static str, f64)> = Vec::new();
        let mut lap = |name| {
            let t = now();
            laps.push((name, t - clock));
            clock = t;
        };
        let mut crossing = crossing;
        let kept = matches!(operation, Operation::Union | Operation::Difference)
            && local::pays(self.face_count(), tool.face_count())
            && self.keep(job, &mut lap)?;
        let done = kept && {
            let volume = check(tool, NAMES[1], job)?;
            let (clean, found) = self.clean(tool, crossing, job)?;
            crossing = found;
            lap("check");
            clean && self.step_locally(operation, tool, volume, job, &mut lap)?
        };
        for (name, seconds) in laps {
            self.lap(name, seconds);
        }
        if done {
            self.note_step(tool, crossing);
        }
        Ok((done, crossing))
    }

    /// Notes that a step with a tool was made.
    fn note_step(&mut self, tool: &PolyMesh, crossing: Option<bool>) {
        self.scale.resolution = coarser(self.scale, OperandScale::of(tool));
        let clean = [self.crossing, crossing] == [Some(false); 2];
        self.crossing = clean.then_some(false);
        self.operands += 1;
        self.coming = self.coming.saturating_sub(1);
    }

    /// The number of faces of the solid.
    fn face_count(&self) -> usize {
        match &self.state {
            State::Whole(mesh, ..) => mesh.face_count(),
            State::Kept(surface) => surface.face_count(),
        }
    }

    /// The number of steps so far that cost only what their tools cut.
    pub fn local_steps(&self) -> usize {
        self.local
    }

    /// Returns the solid and the report on all steps.
    ///
    /// # Errors
    /// [`BooleanError::Inconsistent`] if it is not closed, or its volume is not what the steps add
    /// up to.
    pub fn finish(self, job: &Job) -> Result<(ChainSolid, BooleanReport), BooleanError> {
        let (mut mesh, origins, facts) = match self.state {
            State::Whole(mesh, origins, facts) => {
                let origins = origins.unwrap_or_else(|| first_origins(&mesh));
                (mesh.into_owned(), origins, facts)
            }
            State::Kept(surface) => {
                let (mesh, origins) = surface.to_mesh();
                (mesh, origins, None)
            }
        };
        let facts = match facts {
            Some(facts) => facts,
            None => {
                let at = std::mem::take(&mut mesh.positions);
                emit::finish(&mut mesh, &at, job)?
            }
        };
        if !facts.closed {
            return Err(BooleanError::Inconsistent("the chain's result is not closed".into()));
        }
        let reach = self.scale.span;
        let rounding = facts.area * self.scale.reach() * 2f64.powi(-49)
            + (reach.hi - reach.lo).length().max(0.0).powi(3) * 1e-15;
        let off = (facts.volume - self.volume).abs();
        // A solid that no step has changed was not measured before.
        if off > self.volume_bound + rounding {
            let why = format!("the volume of the chain's result is off by {off:.3e}");
            return Err(BooleanError::Inconsistent(why));
        }
        let report =
            reported(self.report, self.contact, self.floor, self.scale.resolution.precision);
        Ok((ChainSolid { mesh, origins, facts }, report))
    }

    /// Returns whether an operand crosses itself nowhere, or is to be taken as if it did not, and
    /// whether it has triangles that cross, where that is known by now.
    fn clean(
        &self,
        mesh: &PolyMesh,
        crossing: Option<bool>,
        job: &Job,
    ) -> Result<(bool, Option<bool>), BooleanError> {
        Ok(match (self.options.own_crossings, crossing) {
            (OwnCrossings::Keep, _) => (true, crossing),
            (OwnCrossings::Solve, Some(known)) => (!known, crossing),
            (OwnCrossings::Solve, None) if shells_may_meet(mesh) => {
                let found = crosses_itself(mesh, job)?;
                (!found, Some(found))
            }
            (OwnCrossings::Solve, None) => (true, None),
        })
    }

    /// The chain with all that it owns, once it has search trees.
    fn owned(self) -> Option<BooleanChain<'static>> {
        let State::Kept(surface) = self.state else { return None };
        Some(BooleanChain {
            state: State::Kept(surface),
            options: self.options,
            scale: self.scale,
            volume: self.volume,
            volume_bound: self.volume_bound,
            crossing: self.crossing,
            operands: self.operands,
            coming: self.coming,
            report: self.report,
            local: self.local,
            contact: self.contact,
            floor: self.floor,
        })
    }

    /// Makes the search trees, where more than one step needs them. Returns whether there are any.
    fn keep(&mut self, job: &Job, lap: &mut dyn FnMut(&'static str)) -> Result<bool, BooleanError> {
        if let State::Kept(surface) = &self.state {
            if surface.mostly_gone() {
                let (mesh, origins) = surface.to_mesh();
                let again = KeptSurface::new(&mesh, &origins, false, job)?;
                self.state = State::Kept(Box::new(again));
            }
            return Ok(true);
        }
        let State::Whole(mesh, origins, _) = &self.state else { return Ok(false) };
        if self.operands == 1 && self.coming <= 1 {
            return Ok(false);
        }
        let volume = check(mesh, NAMES[0], job)?;
        let (clean, crossing) = self.clean(mesh, self.crossing, job)?;
        self.crossing = crossing;
        lap("check");
        if !clean {
            return Ok(false);
        }
        let first = origins.is_none().then(|| first_origins(mesh));
        let origins = first.as_deref().or(origins.as_deref()).unwrap_or_default();
        let triangles = self.options.faces == ResultFaces::Triangles;
        let kept = KeptSurface::new(mesh, origins, triangles, job)?;
        self.state = State::Kept(Box::new(kept));
        (self.volume, self.volume_bound) = (volume, 0.0);
        lap("keep");
        Ok(true)
    }

    /// Returns whether the step was made.
    fn step_locally(
        &mut self,
        operation: Operation,
        tool: &PolyMesh,
        volume: f64,
        job: &Job,
        lap: &mut dyn FnMut(&'static str),
    ) -> Result<bool, BooleanError> {
        let State::Kept(surface) = &mut self.state else { return Ok(false) };
        let scale = OperandScale::of(tool);
        let default = tolerance_of([self.scale, scale]);
        let floor = self.scale.reach().max(scale.reach()) * 2f64.powi(-49);
        let wanted = self.options.tolerance.unwrap_or(default.tolerance);
        let eps = wanted.max(floor).max(f64::MIN_POSITIVE);
        let step = LocalStep {
            tool,
            number: self.operands,
            volume,
            span: scale.span,
            operation,
            options: &self.options,
            eps,
            floor,
        };
        let made = match step.change(surface, job, lap)? {
            Ok(made) => made,
            Err(_) => return Ok(false),
        };
        surface.apply(&made.change, job)?;
        lap("graft");
        self.scale.span = surface.span;
        self.local += 1;
        self.volume += made.volume;
        self.volume_bound += made.volume_bound;
        self.contact.add(made.contact);
        self.floor = self.floor.max(floor);
        self.report.precision = self.report.precision.max(Some(default.precision));
        self.report.tolerance = self.report.tolerance.max(eps);
        self.report.volume_bound += made.volume_bound;
        self.report.cut.extend(made.cut);
        Ok(true)
    }

    /// The same by [`compute`].
    fn step_as_a_whole(
        &mut self,
        operation: Operation,
        tool: &PolyMesh,
        crossing: Option<bool>,
        job: &Job,
        now: impl Fn() -> f64,
    ) -> Result<(), BooleanError> {
        let kept = match &self.state {
            State::Kept(surface) => Some(surface.to_mesh()),
            State::Whole(..) => None,
        };
        let (mesh, known) = match (&kept, &self.state) {
            (Some((mesh, origins)), _) => (mesh, Some(origins)),
            (None, State::Whole(mesh, origins, _)) => (mesh.as_ref(), origins.as_ref()),
            (None, State::Kept(_)) => return Ok(()),
        };
        let options = BooleanOptions { known_crossings: [self.crossing, crossing], ..self.options };
        let (made, report) = compute([mesh, tool], &[operation], &options, job, now)?;
        let Some(solid) = made.into_iter().next() else { return Ok(()) };
        let number = self.operands;
        let of = |o: &emit::FaceOrigin| match (o.operand, known) {
            (0, Some(known)) => known[o.face as usize],
            (operand, _) => {
                ChainOrigin { operand: if operand == 0 { 0 } else { number }, face: o.face }
            }
        };
        let origins = solid.origins.iter().map(of).collect();
        self.scale.span = Span::of(solid.mesh.positions.iter().copied());
        self.volume = solid.facts.volume;
        self.volume_bound = report.volume_bound;
        self.state = State::Whole(Cow::Owned(solid.mesh), Some(origins), Some(solid.facts));
        self.note(report);
        Ok(())
    }

    fn lap(&mut self, name: &'static str, seconds: f64) {
        match self.report.phases.iter_mut().find(|p| p.0 == name) {
            Some(phase) => phase.1 += seconds,
            None => self.report.phases.push((name, seconds)),
        }
    }

    /// Adds the report on one step.
    fn note(&mut self, step: BooleanReport) {
        for (name, seconds) in step.phases {
            self.lap(name, seconds);
        }
        let sum = &mut self.report;
        sum.tolerance = sum.tolerance.max(step.tolerance);
        sum.precision = sum.precision.max(step.precision);
        sum.contact.add(step.contact);
        sum.depends_on_tolerance |= step.depends_on_tolerance;
        sum.same_surface = step.same_surface;
        sum.volume_bound += step.volume_bound;
        sum.warnings.extend(step.warnings);
        sum.cut.extend(step.cut);
    }
}

/// The report with what the tolerance decided in local steps.
fn reported(
    mut report: BooleanReport,
    contact: Contact,
    floor: f64,
    precision: Precision,
) -> BooleanReport {
    let depends = report.depends_on_tolerance;
    note_contact(&mut report, contact, floor, precision);
    report.depends_on_tolerance |= depends;
    report.contact.add(contact);
    report
}

/// The coarser resolution of two operands.
fn coarser(a: OperandScale, b: OperandScale) -> super::Resolution {
    let key = |s: &OperandScale| (s.resolution.precision, s.resolution.error);
    match key(&a).partial_cmp(&key(&b)) {
        Some(std::cmp::Ordering::Less) => b.resolution,
        _ => a.resolution,
    }
}

/// Each face from the same face of the first operand.
fn first_origins(mesh: &PolyMesh) -> Vec<ChainOrigin> {
    (0..mesh.face_count() as u32).map(|face| ChainOrigin { operand: 0, face }).collect()
}

//! Repairs of the active object, computed in the caller's thread: a flat base, a split with pegs
//! and sockets, drain holes and vents. Each is one step of undo. After it the result is checked
//! again, and the answer says what is left.

use std::sync::Arc;

use glam::DVec3;

use crate::boolean_jobs;
use crate::operations::{self, Computed, OperationError, Target};
use crate::published::Published;
use crate::scene_jobs::{Combined, built, operand};
use sculptd_check::repair::flat_base::base_tool;
use sculptd_check::repair::holes::{HoleSettings, PlannedHole, SealedKind, plan_holes};
use sculptd_check::repair::split::{PegSettings, SplitPlane, split_part};
use sculptd_check::repair::{Remaining, remaining, solid_of};
use sculptd_clay::Snapshot;
use sculptd_engine::scene::{
    Exchange, NewObject, ObjectId, ObjectSource, ObjectTransform, SceneEvent,
};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;

/// The height of a layer that the check of a result takes, mm: that of fine resin prints.
const LAYER: f64 = 0.05;

/// The repair of an object. Lengths and places are in the world's unit and frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WantedRepair {
    /// A flat base at this height above the lowest point.
    Base(f64),
    /// Two objects, split by a plane.
    Split(SplitPlane, PegSettings),
    /// Holes out of cavities or cups.
    Holes {
        /// The kind of void that gets a hole.
        kind: SealedKind,
        /// Of a hole.
        diameter: f64,
        /// A second hole at the highest point.
        inlet: bool,
        /// Voids of at most this volume get no hole.
        least: f64,
        /// Only the one that is nearest to this place.
        near: Option<DVec3>,
    },
}

/// A repair, and how the object is built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RepairRequest {
    pub repair: WantedRepair,
    /// The build direction; of any length above 0.
    pub up: DVec3,
    /// True if the object is built on a plate, which seals what leads down to it.
    pub plate: bool,
}

/// The outcome of a repair.
#[derive(Debug, Clone, PartialEq)]
pub struct RepairDone {
    /// True if the check no longer finds what was repaired, and every result is one solid.
    pub repaired: bool,
    /// The results, each with the result of its check.
    pub objects: Vec<(ObjectId, Remaining)>,
    pub holes: Vec<PlannedHole>,
    /// The centre of each peg.
    pub pegs: Vec<DVec3>,
    /// Findings that the repair left, and remarks on how it was carried out, one sentence each.
    pub notes: Vec<String>,
}

/// Facts of a repair that are known before the loop installs it.
#[derive(Debug, Clone, Default)]
struct RepairPlan {
    holes: Vec<PlannedHole>,
    pegs: Vec<DVec3>,
    notes: Vec<String>,
    /// Number of cavities or cups that got no hole.
    most_left: usize,
}

/// Repairs the active object, waits for the loop to install the result, and checks it.
///
/// # Errors
/// Why nothing was changed.
pub fn carry_out(
    to: Target<'_>,
    request: &RepairRequest,
    job: &Job,
) -> Result<RepairDone, OperationError> {
    let before: Vec<ObjectId> = ids(&to.published.load());
    let done = operations::carry_out(to, job, |now| match request.repair {
        WantedRepair::Split(plane, pegs) => split(now, plane, pegs, job),
        _ => cut(now, request, job),
    })?;
    let note = done.note();
    let RepairPlan { holes, pegs, mut notes, most_left } = done.made;
    notes.extend(note);
    let now = to.published.load_full();
    let active = now.scene.active().map(|o| o.id);
    let is_split = matches!(request.repair, WantedRepair::Split(..));
    let made = |id: &ObjectId| match is_split {
        true => !before.contains(id),
        false => Some(*id) == active,
    };
    let mut objects = Vec::new();
    // It is in place: what is cancelled now is only its check.
    let unseen = Job::default();
    for (object, clay) in now.scene.each(&now.mesh).filter(|(o, _)| made(&o.id)) {
        let mesh = in_world(clay, &object.settings.transform);
        match remaining(&mesh, request.up, LAYER, request.plate, &unseen) {
            Ok(left) => objects.push((object.id, left)),
            Err(e) => notes.push(format!("the result was not checked: {e}")),
        }
    }
    let mut repaired = objects.len() == if is_split { 2 } else { 1 };
    for (id, left) in &objects {
        if !(left.closed && left.manifold && left.crossings == 0) {
            repaired = false;
            notes.push(format!("object {id} is not one solid"));
        }
        let least = match request.repair {
            WantedRepair::Base(_) if left.base_area <= 0.0 => {
                repaired = false;
                notes.push("the object does not stand flat".into());
                continue;
            }
            WantedRepair::Holes { least, .. } => least,
            _ => continue,
        };
        let kind = match request.repair {
            WantedRepair::Holes { kind, .. } => kind,
            _ => continue,
        };
        let all = if kind == SealedKind::Trapped { &left.trapped } else { &left.cups };
        let count = all.iter().filter(|v| v.volume > least).count();
        if count > most_left {
            repaired = false;
            notes.push(format!("{count} of kind {} are left", kind.name()));
        }
    }
    Ok(RepairDone { repaired, objects, holes, pegs, notes })
}

fn ids(now: &Published) -> Vec<ObjectId> {
    now.scene.each(&now.mesh).map(|(o, _)| o.id).collect()
}

/// The mesh of an object in the world's frame.
fn in_world(clay: &Snapshot, transform: &ObjectTransform) -> PolyMesh {
    let mut mesh = clay.to_tri().to_poly();
    if !transform.is_none() {
        mesh.positions.iter_mut().for_each(|p| *p = transform.apply(*p));
    }
    mesh
}

/// A repair that subtracts a tool.
fn cut(
    now: &Published,
    request: &RepairRequest,
    job: &Job,
) -> Result<Computed<RepairPlan>, OperationError> {
    let mesh = in_world(&now.mesh, &now.transform());
    let (tool, plan) = match request.repair {
        WantedRepair::Holes { kind, diameter, inlet, least, near } => {
            let RepairRequest { up, plate, .. } = *request;
            let asked =
                HoleSettings { kind, diameter, inlet, least, near, up, layer: LAYER, plate };
            let solid = solid_of(&mesh, job)?;
            let plan = plan_holes(&solid, &asked, job)?;
            let most_left = plan.found - plan.voids;
            let (holes, notes) = (plan.holes, plan.notes);
            (plan.tool, RepairPlan { holes, notes, most_left, ..RepairPlan::default() })
        }
        WantedRepair::Base(height) => {
            (base_tool(&mesh, request.up, height)?, RepairPlan::default())
        }
        WantedRepair::Split(plane, pegs) => return split(now, plane, pegs, job),
    };
    let Computed { edit, then, basis, .. } =
        boolean_jobs::join(now, tool, false, Operation::Difference, job)?;
    Ok(Computed { edit, then, made: plan, basis })
}

/// A split of the active object into two.
fn split(
    now: &Published,
    plane: SplitPlane,
    pegs: PegSettings,
    job: &Job,
) -> Result<Computed<RepairPlan>, OperationError> {
    let active = now.scene.active().ok_or(OperationError::Nothing)?;
    let (object, clay, of) = operand(now, active.id)?;
    let transform = object.settings.transform;
    // In the object's own frame no coordinate is rounded again.
    let own = transform.inverse();
    let point = own.apply(plane.point);
    let normal = own.apply(plane.point + plane.normal) - point;
    let mesh = clay.to_tri().to_poly();
    let solid = solid_of(&mesh, job)?;
    let parts =
        split_part(&solid, SplitPlane { point, normal }, pegs.scaled(1.0 / transform.scale), job)?;
    let (mut add, mut clays) = (Vec::new(), Vec::new());
    for (k, part) in [parts.below, parts.above].into_iter().enumerate() {
        let plain = part.triangulate().0;
        clays.push(built(&plain, job)?);
        let name = format!("{} {}", object.settings.name, k + 1);
        let name: String = name.chars().take(sculptd_engine::scene::MAX_NAME).collect();
        add.push(NewObject::new(&name, ObjectSource::Mesh(Arc::new(plain)), transform));
    }
    let (from, remove) = (vec![of], vec![object.id]);
    let exchange = Exchange { event: SceneEvent::Split, from, remove, hide: Vec::new(), add };
    let pegs = parts.pegs.iter().map(|p| transform.apply(*p)).collect();
    let plan = RepairPlan { pegs, notes: parts.notes, ..RepairPlan::default() };
    Ok(Computed::of_combined(now, Combined { exchange, clays, live: None }, plan))
}

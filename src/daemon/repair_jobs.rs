//! Repairs of the active object, computed in the caller's thread: a flat base, a split with pegs
//! and sockets, drain holes, vents, and draft. Each is one step of undo. After it the result is
//! checked again, and the answer says what is left.

use std::sync::Arc;

use glam::DVec3;

use crate::boolean_jobs;
use crate::operations::basis::{Basis, Placing};
use crate::operations::{self, Computed, OperationError, Target, in_place};
use crate::published::Published;
use crate::scene_jobs::{Combined, built, operand};
use sculptd_check::repair::flat_base::base_tool;
use sculptd_check::repair::holes::{HoleSettings, PlannedHole, SealedKind, plan_holes};
use sculptd_check::repair::split::{PegSettings, SplitPlane, split_part};
use sculptd_check::repair::wall_draft::{add_draft, walls_below};
use sculptd_check::repair::{Remaining, RepairError, remaining, solid_of};
use sculptd_clay::Snapshot;
use sculptd_engine::scene::{
    Exchange, NewObject, ObjectId, ObjectSource, ObjectTransform, SceneEvent,
};
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, TriMesh};

/// The height of a layer that the check of a result takes, mm: that of fine resin prints.
const LAYER: f64 = 0.05;

/// Volume of a pocket of a drained cavity above which it gets a hole too, mm3: the limit of the
/// process sla for cups.
const POCKET: f64 = 100.0;

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
    /// Draft for the walls that have less than this many degrees.
    Draft(f64),
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
    /// Number of cavities or cups that got no hole, or of walls without draft that stayed.
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
        WantedRepair::Draft(angle) => drafted(now, request.up, angle, job),
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
    let (mut objects, mut left) = (Vec::new(), Vec::new());
    // It is in place: what is cancelled now is only its check.
    let unseen = Job::default();
    for (object, clay) in now.scene.each(&now.mesh).filter(|(o, _)| made(&o.id)) {
        let mesh = in_world(clay, &object.settings.transform);
        if let WantedRepair::Draft(angle) = request.repair {
            let count = walls_below(&mesh, request.up, angle, &unseen).unwrap_or(usize::MAX);
            let text = format!("walls have less draft than {angle} degrees");
            left.extend((count > most_left).then_some(text));
        }
        match remaining(&mesh, request.up, LAYER, request.plate, &unseen) {
            Ok(found) => objects.push((object.id, found)),
            Err(e) => notes.push(format!("the result was not checked: {e}")),
        }
    }
    for (id, found) in &objects {
        left.extend(
            failing(&request.repair, most_left, found).map(|why| format!("object {id} {why}")),
        );
    }
    let repaired = left.is_empty() && objects.len() == if is_split { 2 } else { 1 };
    notes.splice(0..0, left);
    Ok(RepairDone { repaired, objects, holes, pegs, notes })
}

/// Why a repaired object still has what was repaired, or is no solid; `None` if it passes.
/// `most_left` is the number of voids that got no hole.
fn failing(repair: &WantedRepair, most_left: usize, found: &Remaining) -> Option<String> {
    if !(found.closed && found.manifold && found.crossings == 0) {
        return Some("is not one solid".into());
    }
    match *repair {
        WantedRepair::Base(_) if found.base_area <= 0.0 => Some("has no flat base".into()),
        WantedRepair::Base(_) | WantedRepair::Split(..) | WantedRepair::Draft(_) => None,

        WantedRepair::Holes { kind, least, .. } => {
            let all = match kind {
                SealedKind::Trapped => &found.trapped,
                SealedKind::Cup => &found.cups,
            };
            let count = all.iter().filter(|v| v.volume > least).count();
            let name = kind.name();
            (count > most_left).then(|| format!("still has what was repaired ({name}: {count})"))
        }
    }
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
            let pocket = plate.then_some(POCKET);
            let layer = LAYER;
            let asked =
                HoleSettings { kind, diameter, inlet, least, pocket, near, up, layer, plate };
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
        WantedRepair::Draft(angle) => return drafted(now, request.up, angle, job),
    };
    let Computed { edit, then, basis, .. } =
        boolean_jobs::join(now, tool, false, Operation::Difference, job)?;
    Ok(Computed { edit, then, made: plan, basis })
}

/// Draft for the walls of the active object, whose triangles stay.
fn drafted(
    now: &Published,
    up: DVec3,
    angle: f64,
    job: &Job,
) -> Result<Computed<RepairPlan>, OperationError> {
    let own = now.transform().inverse();
    let pull = own.apply(up) - own.apply(DVec3::ZERO);
    let mesh = now.mesh.to_tri();
    let solid = mesh.to_poly();
    if solid_of(&solid, job)?.positions != solid.positions {
        let why = "it crosses itself; unite it with a remesh first".into();
        return Err(RepairError::NotSolid(why).into());
    }
    let made = add_draft(&solid, pull, angle, job)?;
    let positions = made.mesh.positions.iter().map(|p| p.as_vec3()).collect();
    let new = TriMesh { positions, ..mesh };
    let queued = in_place(Arc::new(new), now.mesh.masks(), None, job)?;
    let plan = RepairPlan { notes: made.notes, most_left: made.kept, ..RepairPlan::default() };
    let basis = Basis::of_active(now, Placing::Nearest);
    Ok(Computed::of_clay(now, queued, plan).following(basis))
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

//! Repairs of the active object, computed in the caller's thread: a flat base, a split with pegs
//! and sockets, drain holes, vents, draft, thicker walls, and text. Each is one step of undo. After
//! it the result is checked again, and the answer says what is left.

use std::sync::Arc;

use glam::DVec3;

use crate::boolean_jobs;
use crate::operations::basis::{Basis, Placing};
use crate::operations::{self, Computed, OperationError, Target, in_place};
use crate::published::Published;
use crate::scene_jobs::{Combined, built, operand};
use sculptd_check::repair::flat_base::base_tool;
use sculptd_check::repair::holes::{HoleSettings, PlannedHole, SealedKind, plan_holes};
use sculptd_check::repair::lettering::{Lettering, plan_lettering};
use sculptd_check::repair::split::{PegSettings, SplitPlane, split_part};
use sculptd_check::repair::thickening::{thicken, thin_regions};
use sculptd_check::repair::wall_draft::{add_draft, walls_below};
use sculptd_check::repair::{Remaining, RepairError, ReshapedPart, remaining, solid_of};
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
#[derive(Debug, Clone, PartialEq)]
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
    /// Thickness for the walls that have less than this.
    Thicken(f64),
    /// A text, raised or engraved.
    Text(Lettering),
}

/// A repair, and how the object is built.
#[derive(Debug, Clone, PartialEq)]
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
    /// Number of cavities or cups that got no hole, or of walls that stayed as they are.
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
    let up = request.up;
    let done = operations::carry_out(to, job, |now| match &request.repair {
        WantedRepair::Split(plane, pegs) => split(now, *plane, *pegs, job),
        WantedRepair::Base(height) => cut(now, Operation::Difference, job, |mesh| {
            Ok((base_tool(mesh, up, *height)?, RepairPlan::default()))
        }),
        &WantedRepair::Holes { kind, diameter, inlet, least, near } => {
            let plate = request.plate;
            let (pocket, layer) = (plate.then_some(POCKET), LAYER);
            let asked =
                HoleSettings { kind, diameter, inlet, least, pocket, near, up, layer, plate };
            cut(now, Operation::Difference, job, |mesh| {
                let plan = plan_holes(&*solid_of(mesh, job)?, &asked, job)?;
                let most_left = plan.found - plan.voids;
                let (holes, notes) = (plan.holes, plan.notes);
                Ok((plan.tool, RepairPlan { holes, notes, most_left, ..RepairPlan::default() }))
            })
        }
        &WantedRepair::Draft(angle) => reshaped(now, job, |solid, own| {
            add_draft(solid, own.apply(up) - own.apply(DVec3::ZERO), angle, job)
        }),
        WantedRepair::Text(asked) => {
            let raised = asked.relief > 0.0;
            let operation = if raised { Operation::Union } else { Operation::Difference };
            cut(now, operation, job, |mesh| {
                let plan = plan_lettering(&*solid_of(mesh, job)?, asked, job)?;
                Ok((plan.tool, RepairPlan { notes: plan.notes, ..RepairPlan::default() }))
            })
        }
        &WantedRepair::Thicken(wall) => reshaped(now, job, |solid, own| {
            let made = thicken(solid, wall * own.scale, job)?;
            // They are in the object's frame; the check says what is left.
            Ok(ReshapedPart { notes: Vec::new(), ..made })
        }),
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
    // A thin wall that stayed is left; a wall that no mould reaches needs no draft.
    let allowed = if matches!(request.repair, WantedRepair::Thicken(_)) { 0 } else { most_left };
    // It is in place: what is cancelled now is only its check.
    let unseen = Job::default();
    for (object, clay) in now.scene.each(&now.mesh).filter(|(o, _)| made(&o.id)) {
        let mesh = in_world(clay, &object.settings.transform);
        let (count, text) = match request.repair {
            WantedRepair::Draft(angle) => (
                walls_below(&mesh, request.up, angle, &unseen),
                format!("walls have less draft than {angle} degrees"),
            ),
            WantedRepair::Thicken(wall) => {
                (thin_regions(&mesh, wall, &unseen), format!("walls are thinner than {wall}"))
            }
            _ => (Ok(0), String::new()),
        };
        left.extend((count.unwrap_or(usize::MAX) > allowed).then_some(text));
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
        WantedRepair::Base(_)
        | WantedRepair::Split(..)
        | WantedRepair::Draft(_)
        | WantedRepair::Thicken(_)
        | WantedRepair::Text(_) => None,
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

/// A repair that adds or subtracts a tool, planned on the active object in the world's frame.
fn cut(
    now: &Published,
    operation: Operation,
    job: &Job,
    planned: impl Fn(&PolyMesh) -> Result<(PolyMesh, RepairPlan), RepairError>,
) -> Result<Computed<RepairPlan>, OperationError> {
    let (tool, plan) = planned(&in_world(&now.mesh, &now.transform()))?;
    let Computed { edit, then, basis, .. } = boolean_jobs::join(now, tool, false, operation, job)?;
    Ok(Computed { edit, then, made: plan, basis })
}

/// A repair that moves corners of the active object, whose triangles stay. `moved` gets it in its
/// own frame, and the way into that frame.
fn reshaped(
    now: &Published,
    job: &Job,
    moved: impl Fn(&PolyMesh, &ObjectTransform) -> Result<ReshapedPart, RepairError>,
) -> Result<Computed<RepairPlan>, OperationError> {
    let mesh = now.mesh.to_tri();
    let solid = mesh.to_poly();
    if solid_of(&solid, job)?.positions != solid.positions {
        let why = "it crosses itself; unite it with a remesh first".into();
        return Err(RepairError::NotSolid(why).into());
    }
    let made = moved(&solid, &now.transform().inverse())?;
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

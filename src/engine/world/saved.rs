//! What the world keeps for others: the history entries of a tick, and its whole state while it is
//! at rest.
//!
//! Laws kept here:
//! * A world made of a saved state goes on, to the bit, as the one that was saved: it holds all but
//!   undo, which a session file keeps.
//! * A history entry costs what its step changed: it holds a snapshot, not a copy.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{PenSlot, World, WorldOptions};
use crate::camera::Camera;
use crate::command::Jump;
use crate::desktop_layout::DesktopLayout;
use crate::hand::{HandTools, HeldObject, Similarity};
use crate::old_layout::{FieldCounts, from_bytes};
use crate::payload::Payload;
use sculptd_clay::brush::{BrushSettings, Picture};
use sculptd_clay::{Clay, Levels, ObjectState, Snapshot, Workers};
use sculptd_devices::Hands;
use sculptd_geometry::TriMesh;

/// What was done to the object as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HistoryEvent {
    /// A stroke, a mask, a cut: one step of undo.
    Step,
    /// A step was taken back.
    Undo,
    /// A step was done again.
    Redo,
    /// Another object took its place.
    Replace,
    /// Another person began: nothing before it can be taken back.
    Begin,
    /// To this node of the history.
    Jump(u64),
}

/// What was done, and the clay right after it.
#[derive(Debug, Clone)]
pub struct HistoryEntry {
    /// What was done.
    pub deed: HistoryEvent,
    /// The clay right after it.
    pub work: Snapshot,
    /// The centre of the object's bounding box when it was put in place.
    pub middle: glam::Vec3,
    /// The bounding radius of the object then.
    pub extent: f32,
}

/// Large things that seldom change, kept beside the state and named by it.
#[derive(Debug, Clone)]
pub enum SideData {
    /// What the hands hold.
    HeldObject(Arc<TriMesh>),
    /// The picture of heights of the alpha `picture`.
    Picture(Arc<Picture>),
    /// The multiresolution levels that are not shown.
    Levels(Arc<Levels>),
}

/// A world at rest.
#[derive(Debug, Clone)]
pub struct Saved {
    /// The tick after which it was saved.
    pub tick: u64,
    /// What the clay is besides its pages.
    pub rest: ObjectState,
    /// Everything small, as bytes.
    pub core: Vec<u8>,
    /// What the hands hold; its place is in `core`.
    pub thing: Option<Arc<TriMesh>>,
    /// The picture of heights of the alpha `picture`.
    pub picture: Option<Arc<Picture>>,
    /// The multiresolution levels that are not shown.
    pub levels: Option<Arc<Levels>>,
    /// Steps that could be taken back and done again then; a world made of this has none.
    pub steps: (u32, u32),
    /// Of each struct in `core`, the number of fields that it had when it was written; empty: as
    /// many as today. See [`crate::old_layout`].
    pub field_counts: &'static FieldCounts,
}

/// The bytes are not those of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the bytes are not those of a world's state")]
pub struct BadState;

#[derive(Serialize)]
struct CoreRef<'a> {
    brush: &'a BrushSettings,
    camera: &'a Camera,
    middle: glam::Vec3,
    extent: f32,
    pens: &'a [PenSlot],
    strokes: u32,
    hands: &'a HandTools,
    last_hands: &'a Option<Hands>,
    place: Option<Similarity>,
    lineages: u32,
    desktop: &'a DesktopLayout,
    kept_brushes: &'a [BrushSettings],
}

#[derive(Deserialize)]
struct Core {
    brush: BrushSettings,
    camera: Camera,
    middle: glam::Vec3,
    extent: f32,
    pens: Vec<PenSlot>,
    strokes: u32,
    hands: HandTools,
    last_hands: Option<Hands>,
    place: Option<Similarity>,
    lineages: u32,
    #[serde(default)]
    desktop: DesktopLayout,
    #[serde(default)]
    kept_brushes: Vec<BrushSettings>,
}

impl World {
    /// From now on the history entries of every tick are kept until the next one.
    pub fn keep_moments(&mut self) {
        self.moments.get_or_insert_with(|| Vec::with_capacity(16));
    }

    /// The history entries of the last tick, in order.
    pub fn moments(&self) -> &[HistoryEntry] {
        self.moments.as_deref().unwrap_or_default()
    }

    /// The clay as it is, as a history entry: what a history begins with.
    pub fn moment(&mut self, deed: HistoryEvent) -> HistoryEntry {
        HistoryEntry { deed, work: self.mesh.snapshot(), middle: self.middle, extent: self.extent }
    }

    pub(super) fn note(&mut self, deed: HistoryEvent) {
        if self.moments.is_some() {
            let moment = self.moment(deed);
            self.moments.as_mut().into_iter().for_each(|all| all.push(moment.clone()));
        }
    }

    /// Nothing can be taken back or done again.
    pub(super) fn forget_steps(&mut self) {
        self.works.forget(&self.garbage);
        self.mesh.jump(&[]);
    }

    pub(super) fn jump(&mut self, jump: &Jump) {
        if jump.from != (self.mesh.object_id(), self.mesh.revision()) {
            return;
        }
        let Some(payload) = self.payloads.take(jump.payload_id()) else { return };
        self.lift_all();
        // A stroke that ended here has changed the work after all.
        if jump.from != (self.mesh.object_id(), self.mesh.revision()) {
            self.garbage.discard_owned(payload);
            return;
        }
        match (payload, &jump.other) {
            (Payload::Pages(pages), None) if self.mesh.jump(&pages) => {
                self.works.forget(&self.garbage);
            }
            (Payload::Clay(mut mesh), Some(other)) => {
                self.forget_steps();
                mesh.set_garbage_sink(self.garbage.clone());
                mesh.set_page_supply(self.pages.clone());
                mesh.set_undo_bytes(self.options.undo_bytes);
                self.garbage.discard_owned(std::mem::replace(&mut self.mesh, *mesh));
                (self.middle, self.extent) = (other.middle, other.extent);
                self.hands.lay(self.middle, self.extent, self.camera.yaw);
            }
            (other, _) => {
                self.garbage.discard_owned(other);
                return;
            }
        }
        self.report.jumps += 1;
        self.note(HistoryEvent::Jump(jump.node));
    }

    /// Whether nothing is under way: no stroke, nothing that waits, no open step.
    pub fn is_at_rest(&self) -> bool {
        !self.mesh.is_in_step()
            && !self.report.paused
            && self.pens.iter().all(|s| !s.track.is_open() && s.track.is_idle())
    }

    /// The whole state; only at rest.
    pub fn save(&self) -> Option<Saved> {
        if !self.is_at_rest() {
            return None;
        }
        let core = CoreRef {
            brush: &self.brush,
            camera: &self.camera,
            middle: self.middle,
            extent: self.extent,
            pens: &self.pens,
            strokes: self.strokes,
            hands: &self.hands,
            last_hands: &self.last_hands,
            place: self.thing.as_ref().map(|t| t.place),
            lineages: self.lineages,
            desktop: &self.desktop,
            kept_brushes: &self.kept_brushes,
        };
        Some(Saved {
            tick: self.tick,
            rest: self.mesh.rest(),
            core: postcard::to_stdvec(&core).ok()?,
            thing: self.thing.as_ref().map(|t| t.plain.clone()),
            picture: self.scratch.picture.clone(),
            levels: self.mesh.levels().cloned(),
            steps: (self.undo_steps() as u32, self.redo_steps() as u32),
            field_counts: &[],
        })
    }

    /// The world that was saved, around its clay.
    ///
    /// # Errors
    /// [`BadState`] where the bytes are not those of a state.
    pub fn restore(
        mut mesh: Clay,
        saved: Saved,
        workers: Workers,
        options: WorldOptions,
    ) -> Result<World, BadState> {
        let core: Core = from_bytes(&saved.core, saved.field_counts).map_err(|_| BadState)?;
        if !core.camera.is_sane() || core.place.is_some() != saved.thing.is_some() {
            return Err(BadState);
        }
        mesh.set_levels(saved.levels);
        let mut world = World::new(mesh, core.camera, core.brush, workers, options);
        world.tick = saved.tick;
        world.camera = core.camera;
        (world.middle, world.extent) = (core.middle, core.extent);
        world.pens = core.pens;
        world.strokes = core.strokes;
        world.hands = core.hands;
        world.last_hands = core.last_hands;
        world.thing = saved.thing.zip(core.place).map(|(plain, place)| HeldObject { plain, place });
        world.scratch.picture = saved.picture;
        world.lineages = core.lineages;
        world.desktop = core.desktop;
        world.kept_brushes = Arc::new(core.kept_brushes);
        Ok(world)
    }
}

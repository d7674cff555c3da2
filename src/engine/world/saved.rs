//! What the world keeps for others: the history entries of a tick, and its whole state while it is
//! at rest.
//!
//! Laws kept here:
//! * A world made of a saved state goes on, to the bit, as the one that was saved: it holds all but
//!   undo, which a session file keeps.
//! * A history entry costs what its step changed: it holds a snapshot, not a copy.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::in_hand::{ObjectsInHand, SavedHolding};
use super::people::People;
use super::{PenSlot, World, WorldOptions};
use crate::answer::{Answer, CommandResult};
use crate::camera::Camera;
use crate::command::Jump;
use crate::desktop_layout::DesktopLayout;
use crate::hand::{Gates, HandTools, HeldObject, Similarity};
use crate::old_layout::{FieldCounts, take_from_bytes};
use crate::payload::Payload;
use crate::scene::{Object, ObjectId, ObjectSettings, Scene, SceneError, SceneEvent, SceneView};
use sculptd_clay::brush::{BrushSettings, Picture};
use sculptd_clay::{Clay, Levels, ObjectState, Snapshot, Workers};
use sculptd_devices::Hands;
use sculptd_geometry::TriMesh;

/// Change to the object as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HistoryEvent {
    /// A stroke, a mask, a cut: one step of undo.
    Step,
    /// A step was undone.
    Undo,
    /// A step was redone.
    Redo,
    /// Another object took its place.
    Replace,
    /// Another person began: no step before it can be undone.
    Begin,
    /// To this node of the history.
    Jump(u64),
    /// An object was added, removed, moved, made active.
    Scene(SceneEvent),
}

/// A change, and the scene right after it.
#[derive(Debug, Clone)]
pub struct HistoryEntry {
    /// Kind of the change.
    pub deed: HistoryEvent,
    /// The active object's clay right after it.
    pub work: Snapshot,
    /// The centre of the active object's bounding box when it was put in place, own frame.
    pub middle: glam::Vec3,
    /// The bounding radius of the active object then, own frame.
    pub extent: f32,
    /// All objects; the same list as of the entry before, where none was changed as a whole.
    pub scene: Arc<SceneView>,
}

/// Large things that seldom change, kept beside the state and named by it.
#[derive(Debug, Clone)]
pub enum SideData {
    /// Mesh held by the hands.
    HeldObject(Arc<TriMesh>),
    /// The picture of heights of the alpha `picture`.
    Picture(Arc<Picture>),
    /// The multiresolution levels that are not shown.
    Levels(Arc<Levels>),
}

impl SideData {
    /// Returns whether both are the same piece of memory.
    pub fn is_same(&self, other: &SideData) -> bool {
        match (self, other) {
            (SideData::HeldObject(a), SideData::HeldObject(b)) => Arc::ptr_eq(a, b),
            (SideData::Picture(a), SideData::Picture(b)) => Arc::ptr_eq(a, b),
            (SideData::Levels(a), SideData::Levels(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// A world at rest.
#[derive(Debug, Clone)]
pub struct Saved {
    /// The tick after which it was saved.
    pub tick: u64,
    /// State of the clay besides its pages.
    pub rest: ObjectState,
    /// Everything small, as bytes; in a scene of several objects the list of them behind it, see
    /// [`Saved::scene`].
    pub core: Vec<u8>,
    /// Mesh held by the hands; its place is in `core`.
    pub thing: Option<Arc<TriMesh>>,
    /// The picture of heights of the alpha `picture`.
    pub picture: Option<Arc<Picture>>,
    /// The multiresolution levels that are not shown.
    pub levels: Option<Arc<Levels>>,
    /// Numbers of steps to undo and to redo at that time; a restored world has none.
    pub steps: (u32, u32),
    /// Of each struct in `core`, the number of fields that it had when it was written; empty: as
    /// many as today. See [`crate::old_layout`].
    pub field_counts: &'static FieldCounts,
}

/// The bytes are not those of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the bytes are not those of a world's state")]
pub struct BadState;

/// The list of objects of a world at rest. Stands behind the rest of the state, in a scene that is
/// more than one object as a session begins with it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SavedScene {
    /// In their order.
    pub objects: Vec<SavedObject>,
    /// The place of the active one.
    pub active: u32,
    /// The next object's id.
    pub next_id: u32,
}

/// An object of a world at rest, without its pages.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SavedObject {
    /// Its id.
    pub id: ObjectId,
    /// Everything but its clay.
    pub settings: ObjectSettings,
    /// As [`Object::middle`].
    pub middle: glam::Vec3,
    /// As [`Object::extent`].
    pub extent: f32,
    /// State of its clay besides its pages.
    pub rest: ObjectState,
}

/// The parts after the list of objects. Each is written only if it or a later part is not empty.
#[derive(Default)]
struct SavedRest {
    people: People,
    holding: SavedHolding,
    /// `None`: the state is older than this part, or no gate knew a hand.
    gates: Option<Gates>,
}

/// Returns the next part, or `None` if there are no more.
fn next_part<T: serde::de::DeserializeOwned>(bytes: &mut &[u8]) -> Result<Option<T>, BadState> {
    if bytes.is_empty() {
        return Ok(None);
    }
    let (part, rest) = postcard::take_from_bytes(bytes).map_err(|_| BadState)?;
    *bytes = rest;
    Ok(Some(part))
}

impl SavedScene {
    fn of(scene: &Scene) -> SavedScene {
        let of = |o: &Object| SavedObject {
            id: o.id,
            settings: o.settings.clone(),
            middle: o.middle,
            extent: o.extent,
            rest: o.clay.rest(),
        };
        SavedScene {
            objects: scene.objects().iter().map(of).collect(),
            active: scene.active_index() as u32,
            next_id: scene.next_id(),
        }
    }

    /// Reads the data that follows the main part of a state; `None` if there is none.
    fn read(bytes: &[u8]) -> Result<Option<(SavedScene, SavedRest)>, BadState> {
        if bytes.is_empty() {
            return Ok(None);
        }
        let (scene, mut bytes) = postcard::take_from_bytes(bytes).map_err(|_| BadState)?;
        let people = next_part(&mut bytes)?.unwrap_or_default();
        let holding = next_part(&mut bytes)?.unwrap_or_default();
        let gates = next_part(&mut bytes)?;
        Ok(Some((scene, SavedRest { people, holding, gates })))
    }

    fn around(self, clays: &mut dyn Iterator<Item = Clay>) -> Result<Scene, BadState> {
        let mut objects = Vec::with_capacity(self.objects.len());
        for o in self.objects {
            let clay = clays.next().filter(|c| c.rest() == o.rest).ok_or(BadState)?;
            let SavedObject { id, settings, middle, extent, .. } = o;
            objects.push(Object { id, settings, clay, middle, extent });
        }
        Scene::restored(objects, self.active as usize, self.next_id).ok_or(BadState)
    }
}

impl Saved {
    /// The list of objects; `None`: there is one, as a session begins with it.
    ///
    /// # Errors
    /// [`BadState`] where the bytes are not those of a state.
    pub fn scene(&self) -> Result<Option<SavedScene>, BadState> {
        let (_, rest): (Core, _) =
            take_from_bytes(&self.core, self.field_counts).map_err(|_| BadState)?;
        Ok(SavedScene::read(rest)?.map(|(scene, _)| scene))
    }
}

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
        let scene = self.scene_view();
        let active = self.scene.active_mut();
        let (middle, extent) = (active.middle, active.extent);
        HistoryEntry { deed, work: active.clay.snapshot(), middle, extent, scene }
    }

    /// Lets the entries of the last tick go.
    pub(super) fn let_entries_go(&mut self) {
        let Some(entries) = self.moments.as_mut().filter(|m| !m.is_empty()) else { return };
        let (active, garbage) = (self.scene.active().clay.object_id(), &self.garbage);
        for entry in entries.drain(..) {
            // It may be the last that holds the pages of an object that was replaced or removed.
            if entry.work.object_id() != active || Arc::strong_count(&entry.scene) == 1 {
                garbage.discard_owned(entry);
            }
        }
    }

    pub(super) fn note(&mut self, deed: HistoryEvent) {
        if self.moments.is_some() {
            let moment = self.moment(deed);
            self.moments.as_mut().into_iter().for_each(|all| all.push(moment.clone()));
        }
    }

    /// Discards all steps to undo and redo.
    pub(super) fn forget_steps(&mut self) {
        let World { timeline, scene, garbage, .. } = self;
        timeline.forget(scene, garbage);
        // The revision goes on, as by a jump.
        scene.active_mut().clay.jump(&[]);
    }

    pub(super) fn jump(&mut self, jump: &Jump) -> CommandResult {
        let from = |world: &World| {
            let clay = &world.scene.active().clay;
            (clay.object_id(), clay.revision())
        };
        if jump.from != from(self) {
            return Err(SceneError::Stale);
        }
        let Some(payload) = self.payloads.take(jump.payload_id()) else {
            self.report.jumps_missing += 1;
            return Err(SceneError::NotInHistory);
        };
        self.lift_all();
        // A stroke that ended here has changed the work after all.
        if jump.from != from(self) {
            self.garbage.discard_owned(payload);
            return Err(SceneError::Stale);
        }
        match (payload, &jump.other) {
            (Payload::Pages(pages), None) if self.scene.active_mut().clay.jump(&pages) => {
                let World { timeline, scene, garbage, .. } = self;
                timeline.forget(scene, garbage);
            }
            // The scene has changed since: another object has this clay now.
            (Payload::Clay(clay), Some(_)) if self.has_clay_beside(clay.object_id()) => {
                self.garbage.discard_owned(clay);
                return Err(SceneError::Stale);
            }
            (Payload::Clay(clay), Some(other)) => {
                self.forget_steps();
                let clay = self.adopted(*clay);
                let object = self.scene.active_mut();
                (object.middle, object.extent) = (other.middle, other.extent);
                let old = std::mem::replace(&mut object.clay, clay);
                self.garbage.discard_owned(old);
                self.scene.touch();
                self.lay_hands();
            }
            (other, _) => {
                self.garbage.discard_owned(other);
                return Err(SceneError::NotInHistory);
            }
        }
        self.report.jumps += 1;
        self.note(HistoryEvent::Jump(jump.node));
        Ok(Answer::Done)
    }

    /// Returns true if an object other than the active one has the clay with this id.
    fn has_clay_beside(&self, object_id: u32) -> bool {
        let active = self.scene.active().id;
        self.scene.objects().iter().any(|o| o.id != active && o.clay.object_id() == object_id)
    }

    /// Returns true if nothing is under way: no stroke, no waiting work, no open step.
    pub fn is_at_rest(&self) -> bool {
        !self.scene.active().clay.is_in_step()
            && !self.layers.is_edit()
            && !self.surface.is_under_way()
            && !self.report.paused
            && !self.in_hand.is_held()
            && self.pens.iter().all(|s| !s.track.is_open() && s.track.is_idle())
    }

    /// The whole state; only at rest.
    pub fn save(&self) -> Option<Saved> {
        if !self.is_at_rest() {
            return None;
        }
        let active = self.scene.active();
        let core = CoreRef {
            brush: &self.brush,
            camera: &self.camera,
            middle: active.middle,
            extent: active.extent,
            pens: &self.pens,
            strokes: self.strokes,
            hands: &self.hands,
            last_hands: &self.last_hands,
            place: self.thing.as_ref().map(|t| t.place),
            lineages: self.lineages,
            desktop: &self.desktop,
            kept_brushes: &self.kept_brushes,
        };
        let mut core = postcard::to_stdvec(&core).ok()?;
        let (alone, holding) = (self.people.is_nobody(), self.in_hand.saved());
        let gates = self.hands.gates();
        let holds = holding.picking || gates.is_some();
        if !self.scene.is_plain() || !alone || holds {
            core = postcard::to_extend(&SavedScene::of(&self.scene), core).ok()?;
        }
        if !alone || holds {
            // Behind the list of objects; a world of one person has nothing there.
            core = postcard::to_extend(&self.people, core).ok()?;
        }
        if holds {
            core = postcard::to_extend(&holding, core).ok()?;
        }
        if let Some(gates) = gates {
            core = postcard::to_extend(gates, core).ok()?;
        }
        Some(Saved {
            tick: self.tick,
            rest: active.clay.rest(),
            core,
            thing: self.thing.as_ref().map(|t| t.plain.clone()),
            picture: self.scratch.picture.clone(),
            levels: active.clay.levels().cloned(),
            steps: (self.timeline.past() as u32, self.timeline.future() as u32),
            field_counts: &[],
        })
    }

    /// The world that was saved, around the clays of its objects in their order, see
    /// [`Saved::scene`]; one clay, where there is no list of objects.
    ///
    /// # Errors
    /// [`BadState`] where the bytes are not those of a state, or the clays are not those of its
    /// objects.
    pub fn restore(
        clays: Vec<Clay>,
        saved: Saved,
        workers: Workers,
        options: WorldOptions,
    ) -> Result<World, BadState> {
        let (core, rest): (Core, _) =
            take_from_bytes(&saved.core, saved.field_counts).map_err(|_| BadState)?;
        if !core.camera.is_sane() || core.place.is_some() != saved.thing.is_some() {
            return Err(BadState);
        }
        let (list, rest) = match SavedScene::read(rest)? {
            Some((list, rest)) => (Some(list), rest),
            None => Default::default(),
        };
        let mut clays = clays.into_iter();
        let mut scene = match list {
            None => {
                let mut scene = Scene::new(clays.next().ok_or(BadState)?);
                let active = scene.active_mut();
                (active.middle, active.extent) = (core.middle, core.extent);
                scene
            }
            Some(list) => list.around(&mut clays)?,
        };
        if clays.next().is_some() {
            return Err(BadState);
        }
        scene.active_mut().clay.set_levels(saved.levels);
        let mut world = World::around(scene, core.camera, core.brush, workers, options);
        world.tick = saved.tick;
        world.camera = core.camera;
        world.pens = core.pens;
        world.strokes = core.strokes;
        world.hands = core.hands;
        rest.gates.into_iter().for_each(|gates| world.hands.set_gates(gates));
        world.last_hands = core.last_hands;
        world.thing = saved.thing.zip(core.place).map(|(plain, place)| HeldObject { plain, place });
        world.in_hand = ObjectsInHand::restored(rest.holding);
        world.scratch.picture = saved.picture;
        world.lineages = core.lineages;
        world.desktop = core.desktop;
        world.kept_brushes = Arc::new(core.kept_brushes);
        world.people = rest.people;
        Ok(world)
    }
}

//! The scene: a list of objects, of which one is active, and one undo timeline over all of them.
//!
//! Laws kept here:
//! * There is always an active object: the last one cannot be removed.
//! * The cost of a tick does not depend on the number of objects or the size of untouched ones.
//!   Strokes know only the active object, and the published list ([`SceneView`]) is rebuilt only
//!   when it changes.
//! * An object keeps its clay in its own frame. A transform changes no vertex, and strokes are made
//!   in the object's frame.
//! * Ids are never reused, so that a name in a journal or a history means one object.
//!
//! Read first: [`SceneCommand`] (the requests), then [`Object`].

mod commands;
mod object;
mod object_settings;
mod operand;
mod own_steps;
mod primitive;
mod snap;
mod timeline;
mod transform;
mod view;

use std::sync::Arc;

pub use commands::{
    Exchange, FlushPlacing, MAX_OBJECTS, NewObject, ObjectSource, Recomputed, SceneCommand,
    SceneError, SceneEvent,
};
pub use object::{MAX_NAME, Object, clean_name};
pub use object_settings::ObjectSettings;
pub use operand::{LiveBoolean, ObjectId, Operand};
pub(crate) use own_steps::OwnStep;
pub use primitive::{BadPrimitive, Primitive, PrimitiveShape};
pub use snap::{FaceAlignment, FlatFace, flush};
pub(crate) use timeline::{Presence, ReplacedClay, SceneStep, Timeline};
pub use transform::ObjectTransform;
pub(crate) use view::combined_hash;
pub use view::{KnownHashes, ObjectView, SceneView};

use sculptd_clay::{Clay, Garbage, GarbageSink};

/// Objects, one of them active.
#[derive(Debug)]
pub struct Scene {
    objects: Vec<Object>,
    active: usize,
    /// The next object's id.
    next_id: u32,
    /// The published list of objects; `stale` marks it out of date.
    view: Arc<SceneView>,
    stale: bool,
}

impl Scene {
    /// A scene of one object around this clay, as a session begins.
    pub fn new(clay: Clay) -> Scene {
        let object = Object::new(ObjectId(0), ObjectSettings::default(), clay);
        Scene { objects: vec![object], active: 0, next_id: 1, view: Arc::default(), stale: true }
    }

    /// Puts a saved scene together: the objects in their order, the active one's place, and the
    /// next id. `None` where that is no scene.
    pub(crate) fn restored(objects: Vec<Object>, active: usize, next_id: u32) -> Option<Scene> {
        let fine = active < objects.len()
            && objects.iter().all(|o| o.id.0 < next_id)
            && objects
                .iter()
                .enumerate()
                .all(|(i, o)| objects[..i].iter().all(|before| !before.is_as(o)));
        fine.then(|| Scene { objects, active, next_id, view: Arc::default(), stale: true })
    }

    /// The objects in their order.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The object that strokes, masks and Booleans act on.
    pub fn active(&self) -> &Object {
        &self.objects[self.active]
    }

    /// The place of the active object in the list.
    pub fn active_index(&self) -> usize {
        self.active
    }

    /// An object by its id.
    pub fn object(&self, id: ObjectId) -> Option<&Object> {
        self.objects.iter().find(|o| o.id == id)
    }

    /// The id that the next object gets.
    pub(crate) fn next_id(&self) -> u32 {
        self.next_id
    }

    pub(crate) fn active_mut(&mut self) -> &mut Object {
        &mut self.objects[self.active]
    }

    pub(crate) fn objects_mut(&mut self) -> &mut [Object] {
        &mut self.objects
    }

    pub(crate) fn object_mut(&mut self, id: ObjectId) -> Option<&mut Object> {
        self.objects.iter_mut().find(|o| o.id == id)
    }

    /// The clay in the scene with this number; the active one is found at once.
    pub(crate) fn clay_by_name(&mut self, name: u32) -> Option<&mut Clay> {
        if self.objects[self.active].clay.object_id() == name {
            return Some(&mut self.objects[self.active].clay);
        }
        self.objects.iter_mut().map(|o| &mut o.clay).find(|c| c.object_id() == name)
    }

    /// An id that no object has had.
    pub(crate) fn fresh_id(&mut self) -> ObjectId {
        self.next_id += 1;
        ObjectId(self.next_id - 1)
    }

    pub(crate) fn index_of(&self, id: ObjectId) -> Option<usize> {
        self.objects.iter().position(|o| o.id == id)
    }

    /// Puts an object at this place of the list; which one is active stays.
    pub(crate) fn insert(&mut self, index: usize, object: Object) {
        let index = index.min(self.objects.len());
        self.objects.insert(index, object);
        self.active += usize::from(index <= self.active && self.objects.len() > 1);
        self.stale = true;
    }

    /// Takes an object out of the list, never the last one. Where it was active, a neighbour is.
    pub(crate) fn take(&mut self, id: ObjectId) -> Option<Object> {
        let index = self.index_of(id).filter(|_| self.objects.len() > 1)?;
        let object = self.objects.remove(index);
        self.active = (self.active - usize::from(index < self.active)).min(self.objects.len() - 1);
        self.stale = true;
        Some(object)
    }

    /// Puts an object at another place of the list; which one is active stays. The place that it
    /// had; `None`: there is no such one.
    pub(crate) fn move_to(&mut self, id: ObjectId, place: usize) -> Option<usize> {
        let from = self.index_of(id)?;
        let active = self.active().id;
        let object = self.objects.remove(from);
        self.objects.insert(place.min(self.objects.len()), object);
        self.activate(active);
        Some(from)
    }

    /// Makes an object active. False: there is no such one.
    pub(crate) fn activate(&mut self, id: ObjectId) -> bool {
        let Some(index) = self.index_of(id) else { return false };
        self.active = index;
        self.stale = true;
        true
    }

    /// Something that others see has changed.
    pub(crate) fn touch(&mut self) {
        self.stale = true;
    }

    /// Returns the published list of objects. Rebuilds it, at a cost proportional to the number of
    /// objects, if it has changed since the last call; otherwise returns the same reference.
    pub fn view(&mut self, garbage: &GarbageSink) -> Arc<SceneView> {
        if self.stale {
            self.stale = false;
            let active = self.active;
            let of = |(i, o): (usize, &mut Object)| ObjectView {
                id: o.id,
                settings: o.settings.clone(),
                middle: o.middle,
                extent: o.extent,
                clay: (i != active).then(|| o.clay.snapshot()),
            };
            let objects = self.objects.iter_mut().enumerate().map(of).collect();
            let view = Arc::new(SceneView { objects, active });
            // It may be the last that holds the pages of an object that was removed.
            let old = std::mem::replace(&mut self.view, view);
            garbage.discard(Garbage::Shared(old));
        }
        self.view.clone()
    }

    /// Returns true if the scene is the single object that a session begins with.
    pub fn is_plain(&self) -> bool {
        matches!(&self.objects[..], [one] if one.settings == ObjectSettings::default())
            && self.next_id == 1
    }

    /// One number for the state of all objects; costs as much as they are large. That of one object
    /// that stands where it is, is that of its clay.
    pub fn hash(&self) -> u64 {
        let all = self.objects.iter().map(|o| (&o.settings, o.clay.hash()));
        combined_hash(all, self.active)
    }

    /// Checks everything that must hold. Costs as much as all objects are large.
    ///
    /// # Errors
    /// Says what does not hold.
    pub fn verify_invariants(&self) -> Result<(), String> {
        if self.active >= self.objects.len() {
            return Err(format!("object {} of {} is active", self.active, self.objects.len()));
        }
        for (i, o) in self.objects.iter().enumerate() {
            let id = o.id;
            if id.0 >= self.next_id {
                return Err(format!("object {id}: the next id is {}", self.next_id));
            }
            if self.objects[..i].iter().any(|before| before.is_as(o)) {
                return Err(format!("object {id}: its id or its clay's is there twice"));
            }
            if !o.settings.transform.is_sane() {
                return Err(format!("object {id}: {:?}", o.settings.transform));
            }
            if i != self.active && o.clay.is_in_step() {
                return Err(format!("object {id} is not active, and a step is open in it"));
            }
            o.clay.verify_invariants().map_err(|e| format!("object {id}: {e}"))?;
        }
        Ok(())
    }
}

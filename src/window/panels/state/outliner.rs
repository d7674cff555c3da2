//! What the outliner holds between frames.

use glam::DVec3;

use sculptd_engine::scene::{ObjectId, ObjectTransform, Primitive, SceneView};
use sculptd_geometry::boolean::Operation;

/// Unfinished input of the outliner.
#[derive(Debug, Default)]
pub struct Outliner {
    /// The name that is being typed.
    pub renaming: Option<(ObjectId, String)>,
    /// The place that is being dragged to.
    pub place: Option<(ObjectId, ObjectTransform)>,
    /// The numbers of a primitive that are being dragged.
    pub primitive: Option<(ObjectId, Primitive)>,
    /// The name of a group that is being typed for objects.
    pub grouping: Option<(Vec<ObjectId>, String)>,
    /// Objects that are chosen beside the active one.
    pub chosen: Vec<ObjectId>,
    /// Names of the groups whose members are not listed.
    pub folded: Vec<String>,
    /// Booleans of two objects follow their operands.
    pub live: bool,
    /// The gizmo of the active object is shown.
    pub gizmo: bool,
    /// Two faces are being picked, to lay the first on the second.
    pub snapping: Option<SnapPicks>,
}

impl Outliner {
    /// Forgets what is no longer there.
    pub fn keep_to(&mut self, scene: &SceneView) {
        self.chosen.retain(|id| scene.objects.iter().any(|o| o.id == *id));
    }

    /// The objects that are meant by a press on one: all that are chosen, if it is among them.
    pub fn with(&self, id: ObjectId) -> Vec<ObjectId> {
        if self.chosen.contains(&id) { self.chosen.clone() } else { vec![id] }
    }

    /// Takes a press on the name of an object: alone it is chosen by itself, with `one_more` added
    /// or taken away, with `range` all from the active one to it. True: it becomes the active one.
    pub fn choose(&mut self, id: ObjectId, scene: &SceneView, one_more: bool, range: bool) -> bool {
        let place = |of: ObjectId| scene.objects.iter().position(|o| o.id == of);
        let active = scene.active().map(|o| o.id);
        if range && let (Some(from), Some(to)) = (active.and_then(place), place(id)) {
            let all = &scene.objects[from.min(to)..=from.max(to)];
            self.chosen = all.iter().map(|o| o.id).collect();
            return false;
        }
        if !one_more {
            self.chosen.clear();
            return true;
        }
        match self.chosen.iter().position(|c| *c == id) {
            Some(at) => drop(self.chosen.remove(at)),
            None => {
                let first = active.filter(|a| !self.chosen.contains(a));
                self.chosen.extend(first.into_iter().chain([id]));
            }
        }
        false
    }
}

/// Faces that were picked for laying one on the other.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SnapPicks {
    /// The object that is to be moved, and a point at its face, in the world.
    pub moved: Option<(ObjectId, DVec3)>,
}

impl SnapPicks {
    /// Takes a press on an object. Both picks, once the second is on another object.
    pub fn pick(&mut self, id: ObjectId, at: DVec3) -> Option<[(ObjectId, DVec3); 2]> {
        match self.moved {
            Some(moved) if moved.0 != id => Some([moved, (id, at)]),
            _ => {
                self.moved = Some((id, at));
                None
            }
        }
    }
}

/// A Boolean of the active object, the first operand, and another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pairing {
    pub operation: Operation,
    pub with: ObjectId,
    /// The operands stay, hidden, and the result follows them.
    pub live: bool,
    /// All four results, the named one first.
    pub all: bool,
}

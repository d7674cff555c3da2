//! What the outliner holds between frames.

use glam::DVec3;

use sculptd_engine::scene::{ObjectId, ObjectTransform, Primitive};
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
    /// The name of a group that is being typed for an object.
    pub grouping: Option<(ObjectId, String)>,
    /// Booleans of two objects follow their operands.
    pub live: bool,
    /// The gizmo of the active object is shown.
    pub gizmo: bool,
    /// Two faces are being picked, to lay the first on the second.
    pub snapping: Option<SnapPicks>,
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

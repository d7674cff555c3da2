//! What hands hold of the scene, as data: during a tick and in a checkpoint.

use serde::{Deserialize, Serialize};

use crate::scene::{ObjectId, ObjectSettings};

/// Objects of the scene handled by hands.
#[derive(Debug, Default)]
pub(super) struct ObjectsInHand {
    /// True if hands carry objects and not clay.
    pub(super) picking: bool,
    /// The object that is held, or was held last.
    pub(super) object: Option<ObjectId>,
    /// While a hand holds it: what it was before.
    pub(super) before: Option<ObjectSettings>,
}

/// The part of it that outlives a checkpoint; at rest nothing is held.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct SavedHolding {
    pub(super) picking: bool,
    pub(super) object: Option<ObjectId>,
}

impl ObjectsInHand {
    pub(super) fn saved(&self) -> SavedHolding {
        SavedHolding { picking: self.picking, object: self.object }
    }

    pub(super) fn restored(saved: SavedHolding) -> ObjectsInHand {
        ObjectsInHand { picking: saved.picking, object: saved.object, before: None }
    }

    /// Returns true while a hand holds an object.
    pub(super) fn is_held(&self) -> bool {
        self.before.is_some()
    }
}

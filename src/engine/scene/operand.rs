//! What names an object, and what it was when something was computed from it.

use serde::{Deserialize, Serialize};

use super::ObjectTransform;
use sculptd_geometry::boolean::Operation;

/// Names an object of a scene, for as long as the session lasts: no two objects ever have the same,
/// and one that comes back by undo has the one that it had.
#[derive(
    Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct ObjectId(pub u32);

impl std::fmt::Display for ObjectId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// An object as it was when something was computed from it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Operand {
    /// The object.
    pub id: ObjectId,
    /// The number of its clay, [`sculptd_clay::Clay::object_id`].
    pub clay: u32,
    /// The revision of its clay.
    pub revision: u64,
    /// Its transform at that time.
    pub transform: ObjectTransform,
}

/// A Boolean whose result is computed again when an operand has changed, until the result itself is
/// changed or the Boolean is applied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LiveBoolean {
    /// Operation that combines the two.
    pub operation: Operation,
    /// The operands as they were when the result was computed.
    pub operands: [Operand; 2],
    /// Faces in which the two only touch belong to an intersection too.
    pub keep_contact: bool,
    /// Length in the world within which places are one; `None`: what the vertices resolve.
    pub tolerance: Option<f64>,
    /// The number of the result's clay: another clay is another's work.
    pub result: u32,
}

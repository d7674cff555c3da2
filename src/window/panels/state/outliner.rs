//! What the outliner holds between frames.

use sculptd_engine::scene::{ObjectId, ObjectTransform, Primitive};
use sculptd_geometry::boolean::Operation;

/// What a person has begun in the outliner and not finished.
#[derive(Debug, Default)]
pub struct Outliner {
    /// The name that is being typed.
    pub renaming: Option<(ObjectId, String)>,
    /// The place that is being dragged to.
    pub place: Option<(ObjectId, ObjectTransform)>,
    /// The numbers of a primitive that are being dragged.
    pub primitive: Option<(ObjectId, Primitive)>,
}

/// A Boolean of the active object, the first operand, and another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pairing {
    pub operation: Operation,
    pub with: ObjectId,
}

//! The form that the clay is compared with.

use std::sync::Arc;

use sculptd_clay::Snapshot;
use sculptd_engine::hand::{HeldObject, Similarity};
use sculptd_geometry::TriMesh;

/// Reference of distances and of walls.
#[derive(Debug, Clone)]
pub enum DistanceReference {
    Before(Snapshot),
    HeldObject(HeldObject),
    /// The goal of an exhibit, in the world.
    Goal(Arc<TriMesh>),
}

impl DistanceReference {
    /// The same form, wherever it is.
    pub(super) fn same(&self, other: &DistanceReference) -> bool {
        match (self, other) {
            (DistanceReference::Before(a), DistanceReference::Before(b)) => {
                (a.object_id(), a.revision()) == (b.object_id(), b.revision())
            }
            (DistanceReference::HeldObject(a), DistanceReference::HeldObject(b)) => {
                Arc::ptr_eq(&a.plain, &b.plain)
            }
            (DistanceReference::Goal(a), DistanceReference::Goal(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }

    /// The form, in its own frame.
    pub(super) fn in_own_frame(&self) -> Arc<TriMesh> {
        match self {
            DistanceReference::Before(before) => Arc::new(before.to_tri()),
            DistanceReference::HeldObject(thing) => thing.plain.clone(),
            DistanceReference::Goal(plain) => plain.clone(),
        }
    }

    pub(super) fn place(&self) -> Similarity {
        match self {
            DistanceReference::Before(_) | DistanceReference::Goal(_) => Similarity::NONE,
            DistanceReference::HeldObject(thing) => thing.place,
        }
    }
}

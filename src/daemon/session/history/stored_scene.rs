//! The list of objects at a node of the history.
//!
//! A node has a list if it differs from that of the previous node: an object was added, removed,
//! changed, or made active. The nodes themselves contain the active object's pages. The list names
//! all pages of the other objects, which no stroke reaches.

use std::sync::Arc;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::page_name::{NOTHING, Name};
use sculptd_clay::{Page, Snapshot};
use sculptd_engine::scene::{ObjectId, ObjectSettings, ObjectView, SceneView};

/// The objects at a node, in their order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredScene {
    pub objects: Vec<StoredObject>,
    /// The place of the active one.
    pub active: u32,
}

/// An object at a node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredObject {
    pub id: ObjectId,
    pub settings: ObjectSettings,
    /// `None` of the active object.
    pub clay: Option<StoredClay>,
}

/// The clay of an object that is not active.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredClay {
    /// As [`sculptd_clay::Clay::object_id`].
    pub number: u32,
    /// Every page and its revision.
    pub pages: Arc<Vec<(u32, u64)>>,
    pub middle: Vec3,
    pub extent: f32,
    /// Numbers that the next new vertex and triangle get.
    pub next: [u32; 2],
    pub levels: Option<u64>,
}

impl StoredScene {
    /// One object, as a session begins.
    pub fn one_object() -> StoredScene {
        let settings = ObjectSettings::default();
        StoredScene {
            objects: vec![StoredObject { id: ObjectId(0), settings, clay: None }],
            active: 0,
        }
    }

    /// The names of all pages that the list names.
    pub fn names(&self) -> impl Iterator<Item = Name> + '_ {
        self.objects.iter().filter_map(|o| o.clay.as_ref()).flat_map(|clay| {
            clay.pages.iter().filter(|p| p.1 != NOTHING).map(|p| (clay.number, p.0, p.1))
        })
    }

    /// The levels that the list names.
    pub fn levels(&self) -> impl Iterator<Item = u64> + '_ {
        self.objects.iter().filter_map(|o| o.clay.as_ref()?.levels)
    }

    /// An object by its id.
    pub fn object(&self, id: ObjectId) -> Option<&StoredObject> {
        self.objects.iter().find(|o| o.id == id)
    }

    /// Returns true if both are the same state, ignoring numbers that only increase.
    fn same_as(&self, other: &StoredScene) -> bool {
        let one = |a: &StoredObject, b: &StoredObject| {
            a.id == b.id
                && a.settings == b.settings
                && match (&a.clay, &b.clay) {
                    (None, None) => true,
                    (Some(a), Some(b)) => a.number == b.number && a.pages == b.pages,
                    _ => false,
                }
        };
        self.active == other.active
            && self.objects.len() == other.objects.len()
            && self.objects.iter().zip(&other.objects).all(|(a, b)| one(a, b))
    }
}

/// Returns true if two nodes have the same objects. No list means one object, as at the start of a
/// session.
pub fn same_scene(a: Option<&Arc<StoredScene>>, b: Option<&Arc<StoredScene>>) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a.same_as(b),
        (Some(one), None) | (None, Some(one)) => one.same_as(&StoredScene::one_object()),
    }
}

/// Returns the version of a page, by which it is named.
pub fn version(page: &Page) -> u64 {
    if page.own() == 0 && page.revision() == 0 { NOTHING } else { page.revision() }
}

/// Returns every page of a clay with its version.
pub fn versions_of(clay: &Snapshot) -> Vec<(u32, u64)> {
    (0u32..).zip(clay.pages()).map(|(i, page)| (i, version(page))).collect()
}

/// The clay of an object as the list `before` has it, where `view` shows the same.
pub fn unchanged<'a>(
    object: &ObjectView,
    view: &SceneView,
    before: Option<&'a StoredScene>,
) -> Option<&'a StoredClay> {
    let (now, then) = (object.clay.as_ref()?, view.object(object.id)?.clay.as_ref()?);
    let same = now.object_id() == then.object_id() && now.revision() == then.revision();
    before?.object(object.id)?.clay.as_ref().filter(|c| same && c.number == now.object_id())
}

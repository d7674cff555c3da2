//! The scene as others see it, immutable.

use std::collections::BTreeMap;

use glam::Vec3;

use super::{LiveBoolean, ObjectId, ObjectSettings};
use sculptd_clay::{PageHashes, Snapshot};

/// One object as others see it.
#[derive(Debug, Clone)]
pub struct ObjectView {
    /// Its name for programs.
    pub id: ObjectId,
    /// Everything but its clay.
    pub settings: ObjectSettings,
    /// As [`super::Object::middle`].
    pub middle: Vec3,
    /// As [`super::Object::extent`].
    pub extent: f32,
    /// Its clay; `None` for the active object, whose newest snapshot is kept beside the view. The
    /// view stays valid until an object is added, removed or set; strokes do not change it.
    pub clay: Option<Snapshot>,
}

impl ObjectView {
    /// As [`super::Object::live`], with the clay that [`SceneView::each`] gives.
    pub fn live(&self, clay: &Snapshot) -> Option<&LiveBoolean> {
        let computed = |l: &&LiveBoolean| l.result == clay.object_id();
        self.settings.live.as_deref().filter(computed).filter(|_| clay.revision() == 0)
    }
}

/// The list of objects, and the active one. Rebuilt only when an object is added, removed, set or
/// made active; strokes do not change it.
#[derive(Debug, Clone, Default)]
pub struct SceneView {
    /// In the order of the scene.
    pub objects: Vec<ObjectView>,
    /// The place of the active object in the list.
    pub active: usize,
}

impl SceneView {
    /// The active object. `None` only of a view that was never filled.
    pub fn active(&self) -> Option<&ObjectView> {
        self.objects.get(self.active)
    }

    /// An object by its id.
    pub fn object(&self, id: ObjectId) -> Option<&ObjectView> {
        self.objects.iter().find(|o| o.id == id)
    }

    /// Every object with its clay. `active`: the newest snapshot of the active object.
    pub fn each<'a>(
        &'a self,
        active: &'a Snapshot,
    ) -> impl Iterator<Item = (&'a ObjectView, &'a Snapshot)> {
        self.objects.iter().map(move |o| (o, o.clay.as_ref().unwrap_or(active)))
    }

    /// Returns true if the scene is one object with default settings, as every world was before
    /// scenes existed.
    pub fn is_plain(&self) -> bool {
        matches!(&self.objects[..], [one] if one.settings == ObjectSettings::default())
    }

    /// One number for the state of all objects; costs as much as they are large.
    pub fn hash(&self, active: &Snapshot) -> u64 {
        combined_hash(self.each(active).map(|(o, clay)| (&o.settings, clay.hash())), self.active)
    }

    /// Returns one number for the state of all objects, equal for scenes whose clays have the same
    /// pages: see [`PageHashes::hash`]. Costs as much as what changed since `known` was used last.
    pub fn page_hash(&self, active: &Snapshot, known: &mut KnownHashes) -> u64 {
        known.objects.retain(|id, _| self.object(*id).is_some());
        let all = self
            .each(active)
            .map(|(o, clay)| (&o.settings, known.objects.entry(o.id).or_default().hash(clay)));
        combined_hash(all, self.active)
    }
}

/// The page hashes of each object that was hashed before.
#[derive(Debug, Default)]
pub struct KnownHashes {
    objects: BTreeMap<ObjectId, PageHashes>,
}

/// The hash of one object that stands where it is, is that of its clay. Else FNV-1a over the clay,
/// the transform, the name and the flags of each, and which is active.
pub(crate) fn combined_hash<'a>(
    objects: impl Iterator<Item = (&'a ObjectSettings, u64)>,
    active: usize,
) -> u64 {
    let mut h = 0xcbf2_9ce4_8422_2325u64;
    let (mut count, mut first, mut plain) = (0usize, 0, true);
    let mut eat = |bits: u64| h = (h ^ bits).wrapping_mul(0x0000_0100_0000_01b3);
    for (settings, clay) in objects {
        count += 1;
        first = clay;
        plain &= count == 1 && settings.transform.is_none();
        eat(clay);
        settings.transform.bits().into_iter().for_each(&mut eat);
        settings.name.bytes().for_each(|b| eat(u64::from(b)));
        eat(u64::from(settings.visible) | u64::from(settings.locked) << 1);
        settings.group.bytes().for_each(|b| eat(u64::from(b)));
        for (set, name) in &settings.set_names {
            eat(u64::from(*set));
            name.bytes().for_each(|b| eat(u64::from(b)));
        }
        if let Some(live) = &settings.live {
            live.operands.iter().for_each(|o| eat(u64::from(o.id.0) << 32 | u64::from(o.clay)));
        }
    }
    eat(active as u64);
    if plain { first } else { h }
}

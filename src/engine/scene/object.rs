//! One object of the scene.

use super::{LiveBoolean, ObjectId, ObjectSettings};
use glam::Vec3;
use sculptd_clay::Clay;

/// Characters of a name, at most.
pub const MAX_NAME: usize = 128;

/// A name without control characters and blanks at its ends, of 1 to [`MAX_NAME`] characters.
pub fn clean_name(name: &str) -> Option<String> {
    let kept: String = name.chars().filter(|c| !c.is_control()).collect();
    let kept = kept.trim();
    (1..=MAX_NAME).contains(&kept.chars().count()).then(|| kept.into())
}

/// An object: a form with a name and a place.
#[derive(Debug)]
pub struct Object {
    /// Its name for programs.
    pub id: ObjectId,
    /// Everything but its clay.
    pub settings: ObjectSettings,
    /// Its form, in its own frame.
    pub clay: Clay,
    /// Centre of its bounding box when it was put in place, own frame: where mirrors stand.
    pub middle: Vec3,
    /// Its bounding radius then, own frame, > 0: the measure of brushes, mirrors and hands.
    pub extent: f32,
}

impl Object {
    /// Returns true if the other has the same id or the same clay: no scene holds both.
    pub(super) fn is_as(&self, other: &Object) -> bool {
        self.id == other.id || self.clay.object_id() == other.clay.object_id()
    }

    /// An object around this clay, measured.
    pub fn new(id: ObjectId, settings: ObjectSettings, clay: Clay) -> Object {
        let mut object = Object { id, settings, clay, middle: Vec3::ZERO, extent: 1.0 };
        object.measure();
        object
    }

    /// Takes middle and extent from the clay as it is.
    pub fn measure(&mut self) {
        let (lo, hi) = self.clay.bounds();
        let (lo, hi) = if lo.cmple(hi).all() { (lo, hi) } else { (Vec3::splat(-1.0), Vec3::ONE) };
        self.middle = (lo + hi) * 0.5;
        self.extent = ((hi - lo).length() * 0.5).max(1e-12);
    }

    /// Returns true if strokes reach it: it is visible and not locked.
    pub fn is_editable(&self) -> bool {
        self.settings.visible && !self.settings.locked
    }

    /// Returns true if strokes reach it and change its active part: the base, or a layer that is
    /// visible and whose intensity is not near 0.
    pub fn takes_strokes(&self) -> bool {
        self.is_editable() && self.clay.takes_strokes()
    }

    /// The Boolean whose result it is, where it still follows its operands: nothing has changed its
    /// clay since it was computed.
    pub fn live(&self) -> Option<&LiveBoolean> {
        let computed = |l: &&LiveBoolean| l.result == self.clay.object_id();
        self.settings.live.as_deref().filter(computed).filter(|_| self.clay.revision() == 0)
    }

    /// Centre of its bounding box when it was put in place, in the world.
    pub fn world_middle(&self) -> Vec3 {
        self.settings.transform.point(self.middle)
    }

    /// Its bounding radius then, world units.
    pub fn world_extent(&self) -> f32 {
        if self.settings.transform.is_none() {
            return self.extent;
        }
        (f64::from(self.extent) * self.settings.transform.scale) as f32
    }
}

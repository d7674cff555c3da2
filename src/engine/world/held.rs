//! Objects of the scene that hands pick up, carry and put down.
//!
//! A pinch picks up the object that it is at; carrying changes the object's transform and nothing
//! else; opening the pinch puts it down, which is one step of undo. The object that was held last
//! stays in hand for the menu: it can be joined with another. Whether it is laid flush on a face
//! near it is for a worker to find, see [`StepReport::put_down`](super::StepReport::put_down).

use glam::Vec3;

use super::in_hand::ObjectsInHand;
use super::{HistoryEvent, World};
use crate::hand::Similarity;
use crate::scene::{Object, ObjectId, ObjectTransform, SceneEvent};

/// Greatest distance from an object at which a pinch picks it up, in mm of the hand.
const REACH_MM: f32 = 60.0;

/// Returns the distance of a point from an object's world box, and the volume of that box.
fn apart(object: &Object, p: Vec3) -> (f32, f32) {
    let (lo, hi) = object.settings.transform.bounds(object.clay.bounds());
    ((p - p.clamp(lo.min(hi), hi.max(lo))).length(), (hi - lo).element_product())
}

impl World {
    /// Returns true if hands carry objects of the scene.
    pub fn is_picking(&self) -> bool {
        self.in_hand.picking
    }

    /// The object of the scene that hands hold, or held last and have not put away.
    pub fn object_in_hand(&self) -> Option<ObjectId> {
        self.in_hand.object.filter(|id| self.scene.object(*id).is_some())
    }

    /// From now on a pinch picks up objects.
    pub(super) fn begin_picking(&mut self) {
        self.put_down();
        self.in_hand.picking = true;
        self.hands.carrying = true;
    }

    /// Pinches act on clay again; the object stays where it is.
    pub(super) fn end_picking(&mut self) {
        self.let_go();
        self.in_hand = ObjectsInHand::default();
    }

    /// The visible, unlocked object that is nearest to a point, the smallest of those around it.
    fn nearest_object(&self, p: Vec3) -> Option<ObjectId> {
        let near = REACH_MM * self.hands.volume().scale;
        let of = |o: &Object| (apart(o, p), o.id);
        let open = self.scene.objects().iter().filter(|o| o.is_editable()).map(of);
        let best = open
            .filter(|((off, _), _)| *off <= near)
            .min_by(|(a, _), (b, _)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        best.map(|(_, id)| id)
    }

    /// A hand that pinches at `grip` moves on: the object that it is at goes along.
    pub(super) fn carry_object(&mut self, by: &Similarity) {
        if !self.in_hand.is_held() {
            let Some(id) = self.hands.grip_point().and_then(|p| self.nearest_object(p)) else {
                return;
            };
            self.in_hand.object = Some(id);
            self.in_hand.before = self.scene.object(id).map(|o| o.settings.clone());
        }
        let Some(object) = self.in_hand.object.and_then(|id| self.scene.object_mut(id)) else {
            return;
        };
        if object.settings.locked {
            return;
        }
        let now = object.settings.transform;
        // Parts keep their size: two hands that draw apart move the middle and turn about it.
        let middle = now.apply(object.middle.as_dvec3());
        let turn = by.turn.as_dquat().normalize();
        let to = by.shift.as_dvec3() + turn * (middle * f64::from(by.scale));
        let way = ObjectTransform { shift: to - turn * middle, turn, scale: 1.0 };
        let next = now.then(&way);
        if next.is_sane() {
            object.settings.transform = next;
            self.scene.touch();
        }
    }

    /// Puts the object down once no hand holds it: one step of undo.
    pub(super) fn let_go_of_what_no_hand_holds(&mut self) {
        if self.in_hand.is_held() && !self.hands.is_gripping() && !self.hands.has_waiting() {
            self.report.put_down = self.in_hand.object;
            self.let_go();
        }
    }

    /// Ends carrying where it is.
    pub(super) fn let_go(&mut self) {
        let Some((id, before)) = self.in_hand.object.zip(self.in_hand.before.take()) else {
            return;
        };
        if self.scene.object(id).is_some_and(|o| o.settings != before) {
            self.push_settings(id, before);
            self.note(HistoryEvent::Scene(SceneEvent::Transform));
        }
    }
}

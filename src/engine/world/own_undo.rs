//! Undo and redo in a world of several people: which strokes they end, and what they report.

use super::people::UndoRefusal;
use super::{HistoryEvent, PenSlot, World};
use crate::scene::OwnStep;

impl World {
    /// The strokes of whoever acts now end, and are a step. Those of others go on, unless they
    /// cannot be told apart from these: then all end. Whether they go on.
    pub(super) fn lift_own(&mut self) -> bool {
        let person = self.person();
        let hands = self.hands.is_touching() || self.in_hand.is_held();
        let edits = self.surface.is_under_way() || self.layers.is_edit();
        let alone = |w: &World| w.surface_alone() && !hands && !edits;
        let Some(person) = person.filter(|_| alone(self)) else {
            self.lift_all();
            return false;
        };
        self.author(None);
        self.own_pens().for_each(|s| s.track.lift());
        self.advance_strokes(u64::MAX);
        let World { timeline, scene, garbage, options, topology, .. } = self;
        if topology.is_empty()
            && timeline.end_steps_of(|p| p == person, scene, options.undo_bytes, garbage)
        {
            self.note(HistoryEvent::Step);
        }
        let apart = self.surface_alone() && !self.scene.active().clay.is_step_of(person);
        if !apart {
            self.lift_all();
        }
        self.author(Some(person));
        apart
    }

    /// The same before an undo or a redo: where that is of something else than a stroke, all end.
    pub(super) fn lift_for_undo(&mut self, redo: bool) {
        let stroke = |w: &World| w.person().is_some_and(|p| w.timeline.next_is_stroke(p, redo));
        if self.lift_own() && !stroke(self) {
            self.lift_all();
        }
    }

    /// While somebody's strokes go on: closes the steps of people whose own have ended in this
    /// tick, where they changed nothing in common with those who go on.
    pub(super) fn close_ended(&mut self) {
        if self.people.is_nobody() {
            return;
        }
        let mut now = std::mem::take(&mut self.people.sculpted);
        now.clear();
        let going_on = self.pens.iter().filter(|s| s.track.is_open() || !s.track.is_idle());
        now.extend(going_on.map(|s| self.people.of_device(s.device)));
        now.extend(self.hands.is_touching().then_some(self.people.hands));
        self.people.sculpted = std::mem::replace(&mut self.people.sculpt, now);
        let alone = self.surface_alone() && self.scene.active().clay.is_in_step();
        let World { timeline, scene, garbage, options, people, .. } = self;
        let goes_on = |p: u8| people.sculpt.contains(&p);
        let some_ended = people.sculpted.iter().any(|p| !goes_on(*p));
        if some_ended
            && alone
            && timeline.end_steps_of(|p| !goes_on(p), scene, options.undo_bytes, garbage)
        {
            self.note(HistoryEvent::Step);
        }
    }

    /// A stroke of this pen has ended and the next waits: what the pen's person has done is a step,
    /// unless others of the person go on, or cannot be told apart from it.
    pub(super) fn close_between_strokes(&mut self, pen: usize) {
        let hands = self.hands.is_touching() || self.in_hand.is_held();
        if hands || self.surface.is_under_way() || self.layers.is_edit() {
            return;
        }
        self.author(None);
        if !self.pens.iter().any(|s| s.track.is_open()) {
            self.topology.finish(&mut self.scene.active_mut().clay, &self.workers);
            self.close();
            return;
        }
        let person = self.people.of_device(self.pens[pen].device);
        let own = |s: &PenSlot| self.people.of_device(s.device) == person;
        if self.people.is_nobody() || self.pens.iter().any(|s| s.track.is_open() && own(s)) {
            return;
        }
        let alone = self.surface_alone() && self.scene.active().clay.is_in_step();
        let World { timeline, scene, garbage, options, .. } = self;
        if alone && timeline.end_steps_of(|p| p == person, scene, options.undo_bytes, garbage) {
            self.note(HistoryEvent::Step);
        }
    }

    /// Nobody's strokes go on.
    pub(super) fn all_ended(&mut self) {
        self.people.sculpt.clear();
    }

    /// Strokes change the surface of pages and nothing else, and nothing follows them.
    pub(super) fn surface_alone(&self) -> bool {
        self.topology.is_empty() && self.scene.active().clay.layer_count() == 0
    }

    /// Records the result of an undo or a redo. Returns false if it changed nothing.
    pub(super) fn record_undo(&mut self, way: OwnStep, redo: bool) -> bool {
        if let OwnStep::InTheWay(by) = way {
            let tick = self.tick;
            self.people.refuse(UndoRefusal { tick, redo, by });
        }
        way == OwnStep::Done
    }

    /// The newest undo or redo of the person that the world is shown to that was refused.
    pub fn undo_refused(&self) -> Option<UndoRefusal> {
        self.people.refused()
    }
}

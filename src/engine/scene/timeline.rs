//! One undo timeline over all objects. Undo by several people: [`super::own_steps`].
//!
//! Laws kept here:
//! * A step names the objects that it changed and holds their previous state. The history of an
//!   object's clay holds the pages of a stroke; the timeline holds the order of the steps.
//! * Undo of everything restores the initial bits.
//! * The memory bound covers all objects: the oldest steps are dropped first, whichever object they
//!   belong to.
//! * Discarded data goes to the garbage sink whole; nothing large is freed here.

use std::collections::VecDeque;

use glam::Vec3;

use super::{Object, ObjectId, ObjectSettings, Scene};
use sculptd_clay::{Clay, GarbageSink};

/// Steps remembered at most, whatever they weigh: fewer than the history of a clay holds, so that
/// none goes there by itself.
const STEPS: usize = 1000;

/// Content of a step. Undo exchanges it with the state of the scene, so that the same step can be
/// redone.
#[derive(Debug)]
pub(crate) enum SceneStep {
    /// The newest step in the history of the clay with this number ([`Clay::object_id`]).
    Clay(u32),
    /// An object's clay was exchanged: the one that is not in place.
    Replaced(ObjectId, Box<ReplacedClay>),
    /// An object was renamed, moved, shown or locked: as it is not now.
    Set(ObjectId, Box<ObjectSettings>),
    /// An object was added or removed.
    Present(Box<Presence>),
    /// Another object was made active: the one that is not.
    Active(ObjectId),
    /// An object was put at another place of the list: the place that it does not have.
    Moved(ObjectId, usize),
    /// Several in one, in order.
    Group(Vec<SceneStep>),
}

/// The clay of an object that is not in place, and how large the object is with it.
#[derive(Debug)]
pub(crate) struct ReplacedClay {
    pub(crate) clay: Clay,
    pub(crate) middle: Vec3,
    pub(crate) extent: f32,
}

impl ReplacedClay {
    /// Exchanges the clay and the size of an object for these.
    pub(crate) fn exchange(&mut self, object: &mut Object) {
        std::mem::swap(&mut self.clay, &mut object.clay);
        std::mem::swap(&mut self.middle, &mut object.middle);
        std::mem::swap(&mut self.extent, &mut object.extent);
    }
}

/// An object that is in the scene on one side of a step and not on the other.
#[derive(Debug)]
pub(crate) struct Presence {
    pub(crate) id: ObjectId,
    /// Its place in the list.
    pub(crate) index: usize,
    /// The object while it is not in the scene.
    pub(crate) object: Option<Object>,
    /// Object that is active on the other side.
    pub(crate) other_active: ObjectId,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Direction {
    Back,
    Forth,
}

impl SceneStep {
    /// Every clay that the step holds.
    fn each_clay(&mut self, visit: &mut dyn FnMut(&mut Clay)) {
        match self {
            SceneStep::Replaced(_, other) => visit(&mut other.clay),
            SceneStep::Present(p) => p.object.iter_mut().for_each(|o| visit(&mut o.clay)),
            SceneStep::Group(all) => all.iter_mut().for_each(|s| s.each_clay(visit)),
            SceneStep::Clay(_)
            | SceneStep::Set(..)
            | SceneStep::Active(_)
            | SceneStep::Moved(..) => {}
        }
    }

    pub(super) fn each_name(&self, visit: &mut dyn FnMut(u32)) {
        match self {
            SceneStep::Clay(name) => visit(*name),
            SceneStep::Group(all) => all.iter().for_each(|s| s.each_name(visit)),
            _ => {}
        }
    }

    /// Exchanges what the step holds with what is in the scene.
    fn travel(&mut self, scene: &mut Scene, to: Direction) {
        match self {
            SceneStep::Clay(name) => {
                let Some(clay) = scene.clay_by_name(*name) else { return };
                match to {
                    Direction::Back => clay.undo(),
                    Direction::Forth => clay.redo(),
                };
            }
            SceneStep::Replaced(id, other) => {
                if let Some(object) = scene.object_mut(*id) {
                    other.exchange(object);
                }
            }
            SceneStep::Set(id, settings) => {
                if let Some(object) = scene.object_mut(*id) {
                    std::mem::swap(&mut object.settings, settings);
                }
            }
            SceneStep::Present(presence) => {
                let active = scene.active().id;
                match presence.object.take() {
                    Some(object) => scene.insert(presence.index, object),
                    None => presence.object = scene.take(presence.id),
                }
                scene.activate(presence.other_active);
                presence.other_active = active;
            }
            SceneStep::Active(other) => {
                let active = scene.active().id;
                scene.activate(*other);
                *other = active;
            }
            SceneStep::Moved(id, place) => {
                if let Some(from) = scene.move_to(*id, *place) {
                    *place = from;
                }
            }
            SceneStep::Group(all) => match to {
                Direction::Back => all.iter_mut().rev().for_each(|s| s.travel(scene, to)),
                Direction::Forth => all.iter_mut().for_each(|s| s.travel(scene, to)),
            },
        }
    }

    /// Sends its content to the garbage sink, each clay separately.
    pub(super) fn discard(self, garbage: &GarbageSink) {
        match self {
            SceneStep::Replaced(_, other) => garbage.discard_owned(other.clay),
            SceneStep::Present(mut presence) => {
                if let Some(object) = presence.object.take() {
                    garbage.discard_owned(object.clay);
                }
            }
            SceneStep::Group(all) => all.into_iter().for_each(|s| s.discard(garbage)),
            SceneStep::Clay(_)
            | SceneStep::Set(..)
            | SceneStep::Active(_)
            | SceneStep::Moved(..) => {}
        }
    }
}

/// A step of the timeline, and whose it is.
#[derive(Debug)]
pub(super) struct TimelineEntry {
    pub(super) step: SceneStep,
    /// Counts the steps that were ever made, from 1.
    pub(super) id: u64,
    /// Ascending; empty in a world of one person.
    pub(super) owners: Vec<u8>,
    /// Of an undone step: the steps that have since changed the same data, by being made, undone or
    /// redone, with an owner of each.
    pub(super) blocks: Vec<(u64, u8)>,
}

/// Steps to undo and to redo.
#[derive(Debug)]
pub(crate) struct Timeline {
    pub(super) past: VecDeque<TimelineEntry>,
    pub(super) future: Vec<TimelineEntry>,
    /// Bytes that the steps of all clays but the active one hold, in the scene and in steps:
    /// strokes change those of the active one alone.
    other_bytes: u64,
    /// Number of steps ever made.
    made: u64,
    /// Whose the next steps are; `None`: the world is of one person.
    pub(super) person: Option<u8>,
}

impl Timeline {
    /// Returns an empty timeline with its full capacity reserved.
    pub(crate) fn new() -> Timeline {
        let past = VecDeque::with_capacity(STEPS + 1);
        Timeline { past, future: Vec::new(), other_bytes: 0, made: 0, person: None }
    }

    /// Closes the active clay's open step; true if there is one more. Then what could be done again
    /// no longer can.
    pub(crate) fn end_step(
        &mut self,
        scene: &mut Scene,
        limit: u64,
        garbage: &GarbageSink,
    ) -> bool {
        if self.person.is_some() {
            return self.end_steps_of(|_| true, scene, limit, garbage);
        }
        let clay = &mut scene.active_mut().clay;
        let (more, name) = (clay.end_step(), clay.object_id());
        if more {
            self.push(SceneStep::Clay(name), scene, limit, garbage);
        }
        more
    }

    /// The same for several people: closes the steps of those whose strokes have `ended`.
    pub(crate) fn end_steps_of(
        &mut self,
        ended: impl Fn(u8) -> bool,
        scene: &mut Scene,
        limit: u64,
        garbage: &GarbageSink,
    ) -> bool {
        let clay = &mut scene.active_mut().clay;
        let name = clay.object_id();
        let parts = clay.end_step_of_people(ended);
        if parts.is_empty() {
            return false;
        }
        let step = |owners| (SceneStep::Clay(name), owners);
        self.push_all(parts.into_iter().map(step), scene, limit, garbage);
        true
    }

    /// Adds a new step. Discards the steps to redo, and drops the oldest steps if there are too
    /// many or they hold more than `limit` bytes.
    pub(crate) fn push(
        &mut self,
        step: SceneStep,
        scene: &mut Scene,
        limit: u64,
        garbage: &GarbageSink,
    ) {
        self.push_all([(step, Vec::new())].into_iter(), scene, limit, garbage);
    }

    /// The same for several steps, with the owners of each: none, where that is whoever acts now.
    fn push_all(
        &mut self,
        steps: impl Iterator<Item = (SceneStep, Vec<u8>)>,
        scene: &mut Scene,
        limit: u64,
        garbage: &GarbageSink,
    ) {
        let (mut strokes, first) = (true, self.made + 1);
        for (step, mut owners) in steps {
            if owners.is_empty() {
                owners.extend(self.person);
            }
            strokes &= matches!(step, SceneStep::Clay(_));
            self.made += 1;
            self.past.push_back(TimelineEntry { step, id: self.made, owners, blocks: Vec::new() });
        }
        match self.person {
            None => self.forget_future(scene, garbage),
            Some(_) => self.forget_future_of(first, strokes, scene, garbage),
        }
        if !strokes {
            self.recount(scene);
            self.bound_clays(scene, limit, garbage);
        }
        let held =
            |all: &Timeline, scene: &Scene| all.other_bytes + scene.active().clay.undo_bytes();
        if held(self, scene) > limit {
            self.forget_future(scene, garbage);
        }
        while !self.past.is_empty() && (self.past.len() > STEPS || held(self, scene) > limit) {
            self.forget_oldest(scene, garbage);
        }
    }

    /// Joins a change to the newest step: undo covers both. Keeps the steps to redo. Without any
    /// step the change becomes a separate one.
    pub(crate) fn follow(
        &mut self,
        step: SceneStep,
        scene: &mut Scene,
        limit: u64,
        garbage: &GarbageSink,
    ) {
        let Some(newest) = self.past.back_mut() else {
            return self.push(step, scene, limit, garbage);
        };
        match &mut newest.step {
            SceneStep::Group(all) => all.push(step),
            one => {
                let first = std::mem::replace(one, SceneStep::Group(Vec::new()));
                *one = SceneStep::Group(vec![first, step]);
            }
        }
        self.block_by_newest(scene);
        self.recount(scene);
        self.bound_clays(scene, limit, garbage);
    }

    fn recount(&mut self, scene: &Scene) {
        let active = scene.active().id;
        let others = scene.objects().iter().filter(|o| o.id != active);
        self.other_bytes = others.map(|o| o.clay.undo_bytes()).sum();
        for entry in self.past.iter_mut().chain(&mut self.future) {
            entry.step.each_clay(&mut |clay| self.other_bytes += clay.undo_bytes());
        }
    }

    /// Clays that are not in place: all within the bytes that undo may take.
    fn bound_clays(&mut self, scene: &mut Scene, limit: u64, garbage: &GarbageSink) {
        // Not what the allocator happened to give: a replay must forget the same clay.
        let weigh = |entry: &mut TimelineEntry| {
            let mut sum = 0;
            entry.step.each_clay(&mut |clay| sum += clay.weight() as u64);
            sum
        };
        let mut bytes: u64 = self.past.iter_mut().map(weigh).sum();
        while bytes > limit {
            let Some(oldest) = self.past.front_mut() else { return };
            bytes -= weigh(oldest);
            self.forget_oldest(scene, garbage);
        }
    }

    fn forget_oldest(&mut self, scene: &mut Scene, garbage: &GarbageSink) {
        let Some(TimelineEntry { step: oldest, .. }) = self.past.pop_front() else { return };
        let stroke = matches!(oldest, SceneStep::Clay(name)
            if name == scene.active().clay.object_id());
        let past = &mut self.past;
        oldest.each_name(&mut |name| match scene.clay_by_name(name) {
            Some(clay) => clay.forget_oldest_step(),
            // It is of a clay that a later step holds.
            None => past.iter_mut().for_each(|entry| {
                entry.step.each_clay(&mut |clay| {
                    if clay.object_id() == name {
                        clay.forget_oldest_step();
                    }
                });
            }),
        });
        oldest.discard(garbage);
        if !stroke {
            self.recount(scene);
        }
    }

    /// Nothing can be done again.
    pub(crate) fn forget_future(&mut self, scene: &mut Scene, garbage: &GarbageSink) {
        if self.future.is_empty() {
            return;
        }
        for TimelineEntry { step, .. } in self.future.drain(..) {
            step.each_name(&mut |name| {
                if let Some(clay) = scene.clay_by_name(name) {
                    clay.forget_redo();
                }
            });
            step.discard(garbage);
        }
        self.recount(scene);
    }

    /// Takes the newest step back. False: there is none.
    pub(crate) fn undo(&mut self, scene: &mut Scene) -> bool {
        let Some(mut entry) = self.past.pop_back() else { return false };
        entry.step.travel(scene, Direction::Back);
        self.travelled(&entry.step, scene);
        self.future.push(entry);
        true
    }

    /// Redoes the step that was undone last. Returns false if there is none.
    pub(crate) fn redo(&mut self, scene: &mut Scene) -> bool {
        let Some(mut entry) = self.future.pop() else { return false };
        entry.step.travel(scene, Direction::Forth);
        self.travelled(&entry.step, scene);
        self.past.push_back(entry);
        true
    }

    fn travelled(&mut self, step: &SceneStep, scene: &mut Scene) {
        // One of several people may be of an object that is no longer the active one.
        if !matches!(step, SceneStep::Clay(name) if *name == scene.active().clay.object_id()) {
            scene.touch();
            self.recount(scene);
        }
    }

    /// Discards all steps to undo and redo; the clays in the scene keep no steps either.
    pub(crate) fn forget(&mut self, scene: &mut Scene, garbage: &GarbageSink) {
        for entry in self.past.drain(..).chain(self.future.drain(..)) {
            entry.step.discard(garbage);
        }
        scene.objects_mut().iter_mut().for_each(|o| o.clay.forget_steps());
        self.other_bytes = 0;
    }

    /// Returns the id of the newest step, if it is not undone, not followed by another, and of the
    /// person who acts now.
    pub(crate) fn newest_step(&self) -> Option<u64> {
        let own = |e: &&TimelineEntry| self.person.is_none_or(|p| e.owners.contains(&p));
        let newest = self.past.back().filter(|e| e.id == self.made);
        newest.filter(own).map(|e| e.id)
    }

    /// Returns the number of steps that undo can reach.
    pub(crate) fn past(&self) -> usize {
        self.past.len()
    }

    /// Returns the number of steps that redo can reach.
    pub(crate) fn future(&self) -> usize {
        self.future.len()
    }
}

//! One undo timeline over all objects.
//!
//! Laws kept here:
//! * A step names the objects that it changed and holds what they were. A stroke's pages lie in the
//!   history of its object's clay; the timeline says whose turn it is.
//! * Undo of everything gives the start's bits, whatever lay between.
//! * The bound is one over all objects: the oldest steps go first, whichever object they are of.
//! * What goes to the garbage sink is handed over whole; nothing large is freed here.

use std::collections::VecDeque;

use glam::Vec3;

use super::{Object, ObjectId, ObjectSettings, Scene};
use sculptd_clay::{Clay, GarbageSink};

/// Steps remembered at most, whatever they weigh: fewer than the history of a clay holds, so that
/// none goes there by itself.
const STEPS: usize = 1000;

/// What a step holds. Taking it back exchanges that with what is in the scene, so that the same
/// step can be done again.
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
    /// What is active on the other side.
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

    fn each_name(&self, visit: &mut dyn FnMut(u32)) {
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

    /// Hands over what it holds, each clay on its own.
    fn discard(self, garbage: &GarbageSink) {
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

/// Steps that can be taken back and done again.
#[derive(Debug)]
pub(crate) struct Timeline {
    past: VecDeque<SceneStep>,
    future: Vec<SceneStep>,
    /// Bytes that the steps of all clays but the active one hold, in the scene and in steps:
    /// strokes change those of the active one alone.
    other_bytes: u64,
    /// How many steps were ever made.
    made: u64,
}

impl Timeline {
    /// Nothing to take back; there is room for all that may be.
    pub(crate) fn new() -> Timeline {
        let past = VecDeque::with_capacity(STEPS + 1);
        Timeline { past, future: Vec::new(), other_bytes: 0, made: 0 }
    }

    /// Closes the active clay's open step; true if there is one more. Then what could be done again
    /// no longer can.
    pub(crate) fn end_step(
        &mut self,
        scene: &mut Scene,
        limit: u64,
        garbage: &GarbageSink,
    ) -> bool {
        let clay = &mut scene.active_mut().clay;
        let (more, name) = (clay.end_step(), clay.object_id());
        if more {
            self.push(SceneStep::Clay(name), scene, limit, garbage);
        }
        more
    }

    /// A step was made. What could be done again no longer can, and the oldest steps go where there
    /// are too many or hold more than `limit` bytes.
    pub(crate) fn push(
        &mut self,
        step: SceneStep,
        scene: &mut Scene,
        limit: u64,
        garbage: &GarbageSink,
    ) {
        self.forget_future(scene, garbage);
        let stroke = matches!(step, SceneStep::Clay(_));
        self.past.push_back(step);
        self.made += 1;
        if !stroke {
            self.recount(scene);
            self.bound_clays(scene, limit, garbage);
        }
        let held =
            |all: &Timeline, scene: &Scene| all.other_bytes + scene.active().clay.undo_bytes();
        while !self.past.is_empty() && (self.past.len() > STEPS || held(self, scene) > limit) {
            self.forget_oldest(scene, garbage);
        }
    }

    /// A change that follows from the newest step: both are taken back as one. What could be done
    /// again still can. Without any step it is one of its own.
    pub(crate) fn follow(
        &mut self,
        step: SceneStep,
        scene: &mut Scene,
        limit: u64,
        garbage: &GarbageSink,
    ) {
        let newest = match self.past.pop_back() {
            None => return self.push(step, scene, limit, garbage),
            Some(SceneStep::Group(mut all)) => {
                all.push(step);
                SceneStep::Group(all)
            }
            Some(one) => SceneStep::Group(vec![one, step]),
        };
        self.past.push_back(newest);
        self.recount(scene);
        self.bound_clays(scene, limit, garbage);
    }

    fn recount(&mut self, scene: &Scene) {
        let active = scene.active().id;
        let others = scene.objects().iter().filter(|o| o.id != active);
        self.other_bytes = others.map(|o| o.clay.undo_bytes()).sum();
        for step in self.past.iter_mut().chain(&mut self.future) {
            step.each_clay(&mut |clay| self.other_bytes += clay.undo_bytes());
        }
    }

    /// Clays that are not in place: all within the bytes that undo may take.
    fn bound_clays(&mut self, scene: &mut Scene, limit: u64, garbage: &GarbageSink) {
        // Not what the allocator happened to give: a replay must forget the same clay.
        let weigh = |step: &mut SceneStep| {
            let mut sum = 0;
            step.each_clay(&mut |clay| sum += clay.weight() as u64);
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
        let Some(oldest) = self.past.pop_front() else { return };
        let stroke = matches!(oldest, SceneStep::Clay(name)
            if name == scene.active().clay.object_id());
        let past = &mut self.past;
        oldest.each_name(&mut |name| match scene.clay_by_name(name) {
            Some(clay) => clay.forget_oldest_step(),
            // It is of a clay that a later step holds.
            None => past.iter_mut().for_each(|step| {
                step.each_clay(&mut |clay| {
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
        for step in self.future.drain(..) {
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
        let Some(mut step) = self.past.pop_back() else { return false };
        step.travel(scene, Direction::Back);
        self.travelled(&step, scene);
        self.future.push(step);
        true
    }

    /// Does the step again that was taken back last. False: there is none.
    pub(crate) fn redo(&mut self, scene: &mut Scene) -> bool {
        let Some(mut step) = self.future.pop() else { return false };
        step.travel(scene, Direction::Forth);
        self.travelled(&step, scene);
        self.past.push_back(step);
        true
    }

    fn travelled(&mut self, step: &SceneStep, scene: &mut Scene) {
        if !matches!(step, SceneStep::Clay(_)) {
            scene.touch();
            self.recount(scene);
        }
    }

    /// Nothing can be taken back or done again; the clays in the scene keep no steps either.
    pub(crate) fn forget(&mut self, scene: &mut Scene, garbage: &GarbageSink) {
        for step in self.past.drain(..).chain(self.future.drain(..)) {
            step.discard(garbage);
        }
        scene.objects_mut().iter_mut().for_each(|o| o.clay.forget_steps());
        self.other_bytes = 0;
    }

    /// Names the newest step, as long as it is neither taken back nor followed by another.
    pub(crate) fn newest_step(&self) -> Option<u64> {
        (self.future.is_empty() && !self.past.is_empty()).then_some(self.made)
    }

    /// Steps that undo can take back.
    pub(crate) fn past(&self) -> usize {
        self.past.len()
    }

    /// Steps that redo can do again.
    pub(crate) fn future(&self) -> usize {
        self.future.len()
    }
}

//! Undo of a person's own steps, if several people share the timeline.
//!
//! Laws kept here:
//! * A person undoes their newest step, whatever others did since, as long as no later step shares
//!   a change with it. Then the two commute: the step is moved behind the others and undone there.
//!   So every page that the step changed gets the bits that it had before the step, and all else
//!   stays as it is, to the bit.
//! * If a later step of somebody else shares a change, undo is refused, with the owner of the
//!   newest of those: it must be undone first. So the newest step of all can always be undone by
//!   its owner.
//! * An undone step can be redone as long as all that it changed is as the undo left it. A step of
//!   somebody else that shares a change blocks it until that one is undone too. A new step of the
//!   same person discards it, as in a world of one person.
//! * Strokes of others that are under way go on. One that shares a change blocks like a step.
//! * Only the steps decide which changes are shared, so every replica answers alike.

use super::timeline::{SceneStep, Timeline, TimelineEntry};
use super::{ObjectId, Scene};
use sculptd_clay::{GarbageSink, StepPages, StepPlace};

/// The two ends of a timeline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Past,
    Future,
}

/// Something that a step changed.
#[derive(Debug)]
enum Changed {
    /// Pages of the clay with this number; `None`: all of them.
    Pages(u32, Option<StepPages>),
    /// The settings of an object.
    Settings(ObjectId),
    /// Exchange of an object's clay between these two.
    Clay(ObjectId, [u32; 2]),
    /// Presence of an object, with its clay.
    Presence(ObjectId, u32),
    /// The choice of the active object.
    Active,
    /// The order of the objects.
    Order,
}

impl Changed {
    /// Returns true if two steps with these changes do not commute.
    fn shares(&self, other: &Changed) -> bool {
        use Changed::{Active, Clay, Order, Pages, Presence, Settings};
        match (self, other) {
            (Pages(a, some), Pages(b, others)) => {
                a == b && some.as_ref().zip(others.as_ref()).is_none_or(|(s, o)| s.shares(o))
            }
            (Pages(name, _), Clay(_, names)) | (Clay(_, names), Pages(name, _)) => {
                names.contains(name)
            }
            (Pages(a, _), Presence(_, b)) | (Presence(_, b), Pages(a, _)) => a == b,
            (
                Settings(a) | Clay(a, _) | Presence(a, _),
                Settings(b) | Clay(b, _) | Presence(b, _),
            ) => {
                a == b
                    && !matches!((self, other), (Settings(_), Clay(..)) | (Clay(..), Settings(_)))
            }
            (Active, Active) | (Order, Order) => true,
            _ => false,
        }
    }
}

fn share(a: &[Changed], b: &[Changed]) -> bool {
    a.iter().any(|x| b.iter().any(|y| x.shares(y)))
}

/// The places of a clay's steps, counted from the newest.
#[derive(Debug, Default)]
struct PlaceCount(Vec<(u32, usize)>);

impl PlaceCount {
    /// The place of the next older step of a clay.
    fn next(&mut self, name: u32) -> usize {
        let at = self.0.iter().position(|c| c.0 == name).unwrap_or_else(|| {
            self.0.push((name, 0));
            self.0.len() - 1
        });
        let place = self.0[at].1;
        self.0[at].1 += 1;
        place
    }
}

impl SceneStep {
    /// Appends the changes of the step to `out`, newest first.
    fn changed(&self, scene: &Scene, side: Side, counted: &mut PlaceCount, out: &mut Vec<Changed>) {
        let in_place = |id: ObjectId| scene.object(id).map_or(u32::MAX, |o| o.clay.object_id());
        match self {
            SceneStep::Clay(name) => {
                let place = counted.next(*name);
                let place = match side {
                    Side::Past => StepPlace::Undo(place),
                    Side::Future => StepPlace::Redo(place),
                };
                let clay = scene.objects().iter().find(|o| o.clay.object_id() == *name);
                out.push(Changed::Pages(*name, clay.and_then(|o| o.clay.step_pages(place))));
            }
            SceneStep::Replaced(id, other) => {
                out.push(Changed::Clay(*id, [in_place(*id), other.clay.object_id()]));
            }
            SceneStep::Set(id, _) => out.push(Changed::Settings(*id)),
            SceneStep::Present(p) => {
                let name = p.object.as_ref().map_or(in_place(p.id), |o| o.clay.object_id());
                out.extend([Changed::Presence(p.id, name), Changed::Active, Changed::Order]);
            }
            SceneStep::Active(_) => out.push(Changed::Active),
            SceneStep::Moved(..) => out.push(Changed::Order),
            SceneStep::Group(all) => {
                all.iter().rev().for_each(|s| s.changed(scene, side, counted, out));
            }
        }
    }
}

/// Result of a person's undo or redo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OwnStep {
    /// The step was undone or redone.
    Done,
    /// The person has no step to undo or redo.
    Nothing,
    /// A step of this person blocks it.
    InTheWay(u8),
}

impl Timeline {
    /// Whose the next steps are; `None`: the world is of one person.
    pub(crate) fn set_person(&mut self, person: Option<u8>) {
        self.person = person;
    }

    /// Returns the numbers of a person's steps to undo and to redo, blocked or not.
    pub(crate) fn steps_of(&self, person: u8) -> (usize, usize) {
        let own = |e: &&TimelineEntry| e.owners.contains(&person);
        (self.past.iter().filter(own).count(), self.future.iter().filter(own).count())
    }

    fn entries(&self, side: Side) -> Vec<&TimelineEntry> {
        match side {
            Side::Past => self.past.iter().collect(),
            Side::Future => self.future.iter().collect(),
        }
    }

    /// Returns the changes of each step from the newest back to `last`, newest first.
    fn changed_down_to(&self, scene: &Scene, side: Side, last: usize) -> Vec<Vec<Changed>> {
        let mut counted = PlaceCount::default();
        let newest_first = self.entries(side).into_iter().skip(last).rev();
        let of = |entry: &TimelineEntry| {
            let mut out = Vec::new();
            entry.step.changed(scene, side, &mut counted, &mut out);
            out
        };
        newest_first.map(of).collect()
    }

    /// Puts a step after all that came later, with which it shares nothing.
    fn raise(&mut self, side: Side, at: usize, scene: &mut Scene) {
        let (mut later, mut own) = (PlaceCount::default(), Vec::new());
        let entries = self.entries(side);
        for entry in entries.iter().skip(at + 1) {
            entry.step.each_name(&mut |name| {
                later.next(name);
            });
        }
        entries[at].step.each_name(&mut |name| own.push(name));
        for name in &own {
            let above = later.0.iter().find(|c| c.0 == *name).map_or(0, |c| c.1);
            // Several of one clay: the oldest of them lies deepest, and they keep their order.
            let several = own.iter().filter(|n| *n == name).count();
            let deep = above + several - 1;
            let place = match side {
                Side::Past => StepPlace::Undo(deep),
                Side::Future => StepPlace::Redo(deep),
            };
            if let Some(clay) = scene.clay_by_name(*name) {
                clay.raise_step(place);
            }
        }
        match side {
            Side::Past => {
                let entry = self.past.remove(at);
                self.past.extend(entry);
            }
            Side::Future => {
                let entry = self.future.remove(at);
                self.future.push(entry);
            }
        }
    }

    /// Returns true if a person's next step to undo, or to redo, is a stroke, or if there is none.
    pub(crate) fn next_is_stroke(&self, person: u8, redo: bool) -> bool {
        let own = |e: &&TimelineEntry| e.owners.contains(&person);
        let next = match redo {
            false => self.past.iter().rev().find(own),
            true => self.future.iter().rev().find(own),
        };
        next.is_none_or(|e| matches!(e.step, SceneStep::Clay(_)))
    }

    /// Whose strokes are under way where a step changed something.
    fn under_way(scene: &Scene, step: &[Changed]) -> Option<u8> {
        let clay = &scene.active().clay;
        let (pages, person) = clay.open_step()?;
        share(&[Changed::Pages(clay.object_id(), Some(pages))], step).then_some(person)
    }

    /// Takes the newest step of a person back.
    pub(crate) fn undo_own(&mut self, person: u8, scene: &mut Scene) -> OwnStep {
        let own = |e: &TimelineEntry| e.owners.contains(&person);
        let Some(at) = self.past.iter().rposition(own) else { return OwnStep::Nothing };
        let changed = self.changed_down_to(scene, Side::Past, at);
        let Some((step, later)) = changed.split_last() else { return OwnStep::Nothing };
        if let Some(person) = Timeline::under_way(scene, step) {
            return OwnStep::InTheWay(person);
        }
        if let Some(k) = later.iter().position(|l| share(l, step)) {
            let entry = &self.past[self.past.len() - 1 - k];
            return OwnStep::InTheWay(entry.owners.first().copied().unwrap_or_default());
        }
        self.raise(Side::Past, at, scene);
        self.undo(scene);
        let mut changed = self.changed_down_to(scene, Side::Future, self.future.len() - 1);
        self.turn_blocks(&changed.pop().unwrap_or_default(), Side::Future, scene);
        OwnStep::Done
    }

    /// Does the step of a person again that the person took back last.
    pub(crate) fn redo_own(&mut self, person: u8, scene: &mut Scene) -> OwnStep {
        let own = |e: &TimelineEntry| e.owners.contains(&person);
        let Some(at) = self.future.iter().rposition(own) else { return OwnStep::Nothing };
        if let Some((_, owner)) = self.future[at].blocks.last() {
            return OwnStep::InTheWay(*owner);
        }
        let changed = self.changed_down_to(scene, Side::Future, at);
        if let Some(person) = changed.last().and_then(|step| Timeline::under_way(scene, step)) {
            return OwnStep::InTheWay(person);
        }
        self.raise(Side::Future, at, scene);
        self.redo(scene);
        let mut changed = self.changed_down_to(scene, Side::Past, self.past.len() - 1);
        self.turn_blocks(&changed.pop().unwrap_or_default(), Side::Past, scene);
        OwnStep::Done
    }

    /// Updates the blocks of undone steps after the newest step of a side was made, undone or
    /// redone. Each undone step that shares a change with it gains a block or loses one.
    fn turn_blocks(&mut self, changed: &[Changed], side: Side, scene: &Scene) {
        let newest = match side {
            Side::Past => self.past.back(),
            Side::Future => self.future.last(),
        };
        let Some((id, owners)) = newest.map(|e| (e.id, &e.owners)) else { return };
        let block = (id, owners.first().copied().unwrap_or_default());
        let others = self.changed_down_to(scene, Side::Future, 0);
        for (entry, other) in self.future.iter_mut().rev().zip(others) {
            if entry.id != id && share(&other, changed) {
                match entry.blocks.iter().position(|b| b.0 == id) {
                    Some(at) => drop(entry.blocks.remove(at)),
                    None => entry.blocks.push(block),
                }
            }
        }
    }

    /// The newest step has changed more.
    pub(super) fn block_by_newest(&mut self, scene: &Scene) {
        if self.person.is_none() || self.future.is_empty() {
            return;
        }
        let Some(newest) = self.past.len().checked_sub(1) else { return };
        let changed = self.changed_down_to(scene, Side::Past, newest).pop().unwrap_or_default();
        let block = (self.past[newest].id, self.past[newest].owners.first().copied());
        let others = self.changed_down_to(scene, Side::Future, 0);
        for (entry, other) in self.future.iter_mut().rev().zip(others) {
            if share(&other, &changed) && !entry.blocks.iter().any(|b| b.0 == block.0) {
                entry.blocks.push((block.0, block.1.unwrap_or_default()));
            }
        }
    }

    /// Steps from the one named `first` on were made. Their owners can do nothing again; others
    /// still can, where these and theirs are `strokes` on other pages.
    pub(super) fn forget_future_of(
        &mut self,
        first: u64,
        strokes: bool,
        scene: &mut Scene,
        garbage: &GarbageSink,
    ) {
        if self.future.is_empty() {
            return;
        }
        let made = self.past.iter().rev().take_while(|e| e.id >= first);
        let owners: Vec<u8> = made.flat_map(|e| e.owners.iter().copied()).collect();
        let count = self.past.iter().rev().take_while(|e| e.id >= first).count();
        let mut counted = PlaceCount::default();
        let mut at = self.future.len();
        while at > 0 {
            at -= 1;
            let entry = &self.future[at];
            let stays = strokes
                && matches!(entry.step, SceneStep::Clay(_))
                && !entry.owners.iter().any(|o| owners.contains(o));
            if stays {
                entry.step.each_name(&mut |name| {
                    counted.next(name);
                });
                continue;
            }
            let entry = self.future.remove(at);
            entry.step.each_name(&mut |name| {
                let above = counted.0.iter().find(|c| c.0 == name).map_or(0, |c| c.1);
                if let Some(clay) = scene.clay_by_name(name) {
                    clay.forget_one_redo(above);
                }
            });
            entry.step.discard(garbage);
        }
        // The remaining steps are blocked by the new steps on the same pages.
        let new = self.changed_down_to(scene, Side::Past, self.past.len() - count);
        let others = self.changed_down_to(scene, Side::Future, 0);
        let made = self.past.iter().rev().map(|e| (e.id, e.owners.first().copied()));
        let made: Vec<(u64, Option<u8>)> = made.take(count).collect();
        for (entry, other) in self.future.iter_mut().rev().zip(others) {
            for ((id, owner), changed) in made.iter().zip(&new) {
                if share(&other, changed) {
                    entry.blocks.push((*id, owner.unwrap_or_default()));
                }
            }
        }
    }
}

//! Clay that was replaced: a Boolean's result takes the place of the object, and undo brings the
//! old one back whole.
//!
//! The newest few are kept, and within the bytes that undo may take; the others go to the garbage
//! sink.

use sculptd_clay::{Clay, GarbageSink};

/// Replaced clay kept on either side.
const KEPT: usize = 8;

/// The clay before and after the one in place.
#[derive(Debug, Default)]
pub struct ReplacedClay {
    past: Vec<Clay>,
    future: Vec<Clay>,
}

impl ReplacedClay {
    /// `new` takes the place of `now`. What could be done again no longer can.
    pub fn replace(&mut self, now: &mut Clay, new: Clay, bytes: u64, garbage: &GarbageSink) {
        self.forget_future(garbage);
        now.end_step();
        now.forget_redo();
        self.past.push(std::mem::replace(now, new));
        // Not what the allocator happened to give: a replay must forget the same clay.
        let size = |m: &Clay| m.weight() as u64;
        while self.past.len() > KEPT || self.past.iter().map(size).sum::<u64>() > bytes {
            garbage.discard_owned(self.past.remove(0));
        }
    }

    /// Brings the clay before back. False when there is none.
    pub fn back(&mut self, now: &mut Clay) -> bool {
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(now, before));
        true
    }

    /// Brings the clay after back. False when there is none.
    pub fn forth(&mut self, now: &mut Clay) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(now, after));
        true
    }

    /// The clay in place was changed: there is nothing to redo.
    pub fn forget_future(&mut self, garbage: &GarbageSink) {
        self.future.drain(..).for_each(|clay| garbage.discard_owned(clay));
    }

    /// Everything is forgotten: another person begins.
    pub fn forget(&mut self, garbage: &GarbageSink) {
        self.past.drain(..).for_each(|clay| garbage.discard_owned(clay));
        self.forget_future(garbage);
    }

    /// How many can be brought back by undo.
    pub fn past(&self) -> usize {
        self.past.len()
    }

    /// How many can be brought back by redo.
    pub fn future(&self) -> usize {
        self.future.len()
    }
}

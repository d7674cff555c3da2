//! Works that were replaced: a Boolean's result takes the place of the work, and undo brings the
//! old one back whole.
//!
//! The newest few are kept, and within the bytes that undo may take; what falls out is handed to
//! somebody else to drop.

use sculptd_clay::Clay;

/// Replaced works kept on either side.
const KEPT: usize = 8;

/// The works before and after the one in place.
#[derive(Debug, Default)]
pub struct ReplacedClay {
    past: Vec<Clay>,
    future: Vec<Clay>,
}

impl ReplacedClay {
    /// `new` takes the place of `now`. What could be done again no longer can. Gives what is to be
    /// dropped.
    pub fn replace(&mut self, now: &mut Clay, new: Clay, bytes: u64, mut drop: impl FnMut(Clay)) {
        self.forget_future(&mut drop);
        now.end_step();
        now.forget_redo();
        self.past.push(std::mem::replace(now, new));
        // Not what the allocator happened to give: a replay must forget the same works.
        let size = |m: &Clay| m.weight() as u64;
        while self.past.len() > KEPT || self.past.iter().map(size).sum::<u64>() > bytes {
            drop(self.past.remove(0));
        }
    }

    /// Brings the work before back. False when there is none.
    pub fn back(&mut self, now: &mut Clay) -> bool {
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(now, before));
        true
    }

    /// And the work after.
    pub fn forth(&mut self, now: &mut Clay) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(now, after));
        true
    }

    /// The work in place was changed: there is nothing to go forth to.
    pub fn forget_future(&mut self, drop: impl FnMut(Clay)) {
        self.future.drain(..).for_each(drop);
    }

    /// Everything is forgotten: another person's work begins.
    pub fn forget(&mut self, mut drop: impl FnMut(Clay)) {
        self.past.drain(..).for_each(&mut drop);
        self.future.drain(..).for_each(&mut drop);
    }

    pub fn past(&self) -> usize {
        self.past.len()
    }

    pub fn future(&self) -> usize {
        self.future.len()
    }
}

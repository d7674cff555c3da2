//! The checkpoint that a host gives to those who join, from when its first bytes are made.

use std::collections::BTreeMap;

use crate::core::{Core, DOWN, To};
use crate::host_limits::RECENT;
use crate::host_members::JoinedMember;
use crate::wire::frame::Arrival;
use crate::wire::message::{Address, CHUNK, FromHost};

/// A checkpoint, or as much of it as is made.
#[derive(Debug)]
pub struct HeldCheckpoint {
    /// The frame right after which it was taken.
    pub index: u64,
    /// Everybody, and the last batch of each then.
    pub people: Vec<(Arrival, u64)>,
    bytes: Vec<u8>,
    whole: bool,
}

impl HeldCheckpoint {
    /// Nothing of it yet.
    pub fn new(index: u64, people: Vec<(Arrival, u64)>) -> HeldCheckpoint {
        HeldCheckpoint { index, people, bytes: Vec::new(), whole: false }
    }

    /// Takes what was made next; `last`: nothing follows.
    pub fn push(&mut self, part: &[u8], last: bool) {
        self.bytes.extend_from_slice(part);
        self.whole |= last;
    }

    /// A chunk, and whether it is the last; `None`: it is not made yet, or there is none.
    pub fn chunk(&self, number: u32) -> Option<(&[u8], bool)> {
        let first = number as usize * CHUNK;
        let end = first + CHUNK;
        match self.bytes.get(first..end) {
            Some(chunk) if end < self.bytes.len() => Some((chunk, false)),
            // A full chunk is known to be the last only once more bytes or the end arrive.
            Some(chunk) => self.whole.then_some((chunk, true)),
            None if self.whole => {
                self.bytes.get(first..).filter(|c| !c.is_empty()).map(|c| (c, true))
            }
            None => None,
        }
    }

    /// Sends the chunks that a member wants, as far as they are made.
    pub fn send(&self, core: &mut Core, to: Address, member: &mut JoinedMember) {
        while let Some(number) = member.wanted.first().copied()
            && let Some((bytes, last)) = self.chunk(number)
        {
            member.wanted.pop_first();
            let (index, bytes) = (self.index, bytes.to_vec());
            let chunk = FromHost::Chunk { index, number, last, bytes };
            let sealed = member.down.seal(&chunk.to_bytes());
            core.send(To::Bulk(to), DOWN, chunk.kind(), &sealed);
        }
    }

    /// The same for all who fetch it.
    pub fn send_to(&self, core: &mut Core, members: &mut BTreeMap<Address, JoinedMember>) {
        let fetches = |m: &JoinedMember| m.first == self.index && !m.wanted.is_empty();
        for (to, member) in members.iter_mut().filter(|m| fetches(m.1)) {
            self.send(core, *to, member);
        }
    }
}

/// Returns true if a joining station may start with this checkpoint.
pub fn is_recent(core: &Core, held: &HeldCheckpoint) -> bool {
    core.log.from(held.index + 1, 1).is_some() && core.log.last() < held.index + RECENT
}

/// Lets checkpoints go that nobody fetches, but the newest as long as it serves.
pub fn drop_old(all: &mut Vec<HeldCheckpoint>, core: &Core, fetched: impl Fn(u64) -> bool) {
    let newest = all.last().map(|held| held.index);
    all.retain(|held| {
        let serves = newest == Some(held.index) && (!held.whole || is_recent(core, held));
        serves || fetched(held.index)
    });
}

/// Everybody, and the last batch of each, as the log was after a frame.
pub fn people_at(core: &Core, index: u64) -> Vec<(Arrival, u64)> {
    let mut people = core.log.people();
    let after = core.log.from(index + 1, usize::MAX).unwrap_or_default();
    for (person, applied) in &mut people {
        let first = after.iter().flat_map(|f| &f.batches).find(|b| b.person == person.person);
        if let Some(first) = first {
            *applied = first.number - 1;
        }
    }
    people
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_given_as_soon_as_they_are_made_and_the_last_one_is_told() {
        let mut held = HeldCheckpoint::new(7, Vec::new());
        assert!(held.chunk(0).is_none());
        held.push(&[1; CHUNK], false);
        assert!(held.chunk(0).is_none(), "nobody knows whether it is the last");
        held.push(&[2; 5], false);
        assert_eq!(held.chunk(0).map(|(c, last)| (c.len(), last)), Some((CHUNK, false)));
        assert!(held.chunk(1).is_none());
        held.push(&[], true);
        assert_eq!(held.chunk(1), Some((&[2; 5][..], true)));
        assert!(held.chunk(2).is_none());
        let mut even = HeldCheckpoint::new(7, Vec::new());
        even.push(&[1; CHUNK], true);
        assert_eq!(even.chunk(0).map(|(c, last)| (c.len(), last)), Some((CHUNK, true)));
        assert!(even.chunk(1).is_none());
    }
}

//! The checkpoint that a host gives to those who join, from when its first bytes are made.

use crate::wire::frame::Arrival;
use crate::wire::message::CHUNK;

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

    /// Whether nothing more is made.
    pub fn is_whole(&self) -> bool {
        self.whole
    }

    /// A chunk, and whether it is the last; `None`: it is not made yet, or there is none.
    pub fn chunk(&self, number: u32) -> Option<(&[u8], bool)> {
        let first = number as usize * CHUNK;
        let end = first + CHUNK;
        match self.bytes.get(first..end) {
            Some(chunk) if end < self.bytes.len() => Some((chunk, false)),
            // Whether a full chunk is the last is known when something follows it, or nothing does.
            Some(chunk) => self.whole.then_some((chunk, true)),
            None if self.whole => {
                self.bytes.get(first..).filter(|c| !c.is_empty()).map(|c| (c, true))
            }
            None => None,
        }
    }
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

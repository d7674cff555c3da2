//! The hashes of all replicas against the host's, frame by frame.

use std::collections::BTreeMap;

use crate::wire::message::Address;

/// Greatest number of local hashes kept, then of remote hashes that wait for the local one.
const KEPT: usize = 64;
const EARLY: usize = 256;

/// Hashes of the compared frames.
#[derive(Debug, Default)]
pub struct HashComparison {
    own: BTreeMap<u64, u64>,
    early: Vec<(u64, Address, u64)>,
}

impl HashComparison {
    /// Takes a member's hash after a frame. Returns the local hash if they differ.
    pub fn take(&mut self, index: u64, from: Address, hash: u64) -> Option<u64> {
        match self.own.get(&index) {
            Some(own) => (*own != hash).then_some(*own),
            None => {
                if self.early.len() < EARLY {
                    self.early.push((index, from, hash));
                }
                None
            }
        }
    }

    /// The own hash after a frame; the members that have told another one.
    pub fn take_own(&mut self, index: u64, hash: u64) -> Vec<Address> {
        self.own.insert(index, hash);
        while self.own.len() > KEPT {
            self.own.pop_first();
        }
        let differs = |e: &&(u64, Address, u64)| e.0 == index && e.2 != hash;
        let found = self.early.iter().filter(differs).map(|e| e.1).collect();
        self.early.retain(|e| e.0 > index);
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_differs_is_found_whoever_is_first() {
        let mut all = HashComparison::default();
        assert_eq!(all.take(5, 1, 70), None, "not known yet");
        assert_eq!(all.take(5, 2, 71), None);
        assert_eq!(all.take_own(5, 70), [2]);
        assert_eq!(all.take(5, 3, 70), None);
        assert_eq!(all.take(5, 4, 9), Some(70));
        (0..1000).for_each(|k| assert_eq!(all.take(100 + k, 1, 1), None));
        assert!(all.early.len() <= EARLY && all.own.len() <= KEPT);
    }
}

//! Which batches a replica has too.

use std::collections::{BTreeMap, VecDeque};

use crate::wire::frame::PersonId;

/// The batches of all frames, until a replica has them.
#[derive(Debug, Default)]
pub struct Acknowledgements {
    /// Frame, person, batch.
    waiting: VecDeque<(u64, PersonId, u64)>,
    acknowledged: BTreeMap<PersonId, u64>,
}

impl Acknowledgements {
    /// A batch is in a frame.
    pub fn expect(&mut self, frame: u64, person: PersonId, batch: u64) {
        self.waiting.push_back((frame, person, batch));
    }

    /// A replica has all frames up to this one.
    pub fn reach(&mut self, frame: u64) {
        while let Some((_, person, batch)) = self.waiting.front().copied().filter(|w| w.0 <= frame)
        {
            self.waiting.pop_front();
            let last = self.acknowledged.entry(person).or_default();
            *last = batch.max(*last);
        }
    }

    /// The last batch of a person that a replica has.
    pub fn of(&self, person: PersonId) -> u64 {
        self.acknowledged.get(&person).copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_batch_is_acknowledged_with_its_frame_and_not_before() {
        let mut all = Acknowledgements::default();
        all.expect(1, 1, 7);
        all.expect(2, 2, 1);
        all.expect(2, 1, 8);
        all.reach(0);
        assert_eq!((all.of(1), all.of(2)), (0, 0));
        all.reach(1);
        assert_eq!((all.of(1), all.of(2)), (7, 0));
        all.reach(5);
        assert_eq!((all.of(1), all.of(2)), (8, 1));
    }
}

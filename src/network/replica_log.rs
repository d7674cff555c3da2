//! The log of ordered input as one replica holds it: the newest frames, the turns of the hosts, and
//! how far each person's batches are in it.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use crate::wire::frame::{Arrival, Batch, Frame, PersonId};
use crate::wire::frame_codec::KnownFrames;
use crate::wire::message::{Reached, Term};

/// Frames that are kept for those who lag behind: at 120 a second the last two minutes.
pub const KEPT: usize = 14_400;

/// The log.
#[derive(Debug, Clone, Default)]
pub struct ReplicaLog {
    frames: VecDeque<Arc<Frame>>,
    /// The index and the tick of the last frame, kept or not.
    last: u64,
    tick: u64,
    /// The turns, and the first frame of each.
    turns: Vec<(Term, u64)>,
    /// Everybody who ever came, and the last batch of each.
    people: BTreeMap<PersonId, (Arrival, u64)>,
}

impl ReplicaLog {
    /// A log whose frames up to `last` are in a checkpoint.
    pub fn at(last: u64, tick: u64, turns: Vec<(Term, u64)>, people: Vec<(Arrival, u64)>) -> Self {
        let people = people.into_iter().map(|p| (p.0.person, p)).collect();
        ReplicaLog { frames: VecDeque::new(), last, tick, turns, people }
    }

    /// The index of the last frame.
    pub fn last(&self) -> u64 {
        self.last
    }

    /// The tick of the last frame.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Returns the term and index of the log's end.
    pub fn reached(&self) -> Reached {
        (self.turn_of(self.last), self.last)
    }

    /// The world of a checkpoint is at this tick: the next frame is after it.
    pub fn begin_at(&mut self, tick: u64) {
        self.tick = self.tick.max(tick);
    }

    /// The turn in which a frame was made.
    fn turn_of(&self, index: u64) -> Term {
        let turn = self.turns.iter().rev().find(|t| t.1 <= index);
        turn.or(self.turns.first()).map(|t| t.0).unwrap_or_default()
    }

    /// The turns, and the first frame of each.
    pub fn turns(&self) -> &[(Term, u64)] {
        &self.turns
    }

    /// The turns as a host tells them whose log this one is the beginning of.
    pub fn set_turns(&mut self, turns: Vec<(Term, u64)>) {
        self.turns = turns;
    }

    /// A new host's turn begins with the next frame.
    pub fn begin_turn(&mut self, term: Term) {
        self.turns.push((term, self.last + 1));
    }

    /// Everybody who ever came, and the last batch of each.
    pub fn people(&self) -> Vec<(Arrival, u64)> {
        self.people.values().cloned().collect()
    }

    /// The name of a person.
    pub fn name(&self, person: PersonId) -> &str {
        self.people.get(&person).map_or("?", |p| &p.0.name)
    }

    /// The number of a person of this name, or the next free one; `None`: there are 254.
    pub fn number(&self, name: &str) -> Option<PersonId> {
        let known = self.people.values().find(|p| p.0.name == name).map(|p| p.0.person);
        known.or_else(|| (1..=254).find(|n| !self.people.contains_key(n)))
    }

    /// Returns the newest arrival of a person.
    pub fn person(&self, person: PersonId) -> Option<&Arrival> {
        self.people.get(&person).map(|p| &p.0)
    }

    /// Those who are connected as far as the log tells.
    pub fn here(&self) -> impl Iterator<Item = &Arrival> {
        self.people.values().map(|p| &p.0).filter(|a| a.here)
    }

    /// The last batch of a person.
    pub fn applied(&self, person: PersonId) -> u64 {
        self.people.get(&person).map_or(0, |p| p.1)
    }

    /// Appends the next frame. False, and nothing done, where it is not the next.
    pub fn append(&mut self, frame: &Arc<Frame>) -> bool {
        if frame.index != self.last + 1 || frame.tick < self.tick {
            return false;
        }
        for arrival in &frame.arrivals {
            let entry = self.people.entry(arrival.person);
            entry.or_insert_with(|| (arrival.clone(), 0)).0 = arrival.clone();
        }
        for Batch { person, number, .. } in &frame.batches {
            if let Some(known) = self.people.get_mut(person) {
                known.1 = known.1.max(*number);
            }
        }
        (self.last, self.tick) = (frame.index, frame.tick);
        self.frames.push_back(frame.clone());
        true
    }

    /// Lets old frames go, but none after `needed`.
    pub fn trim(&mut self, needed: u64) {
        while self.frames.len() > KEPT && self.frames.front().is_some_and(|f| f.index <= needed) {
            self.frames.pop_front();
        }
    }

    /// The frames from an index on, at most `most`; `None` where the first is not kept.
    pub fn from(&self, index: u64, most: usize) -> Option<Vec<Arc<Frame>>> {
        if index > self.last {
            return Some(Vec::new());
        }
        let first = self.frames.front()?.index;
        let at = index.checked_sub(first)? as usize;
        Some(self.frames.iter().skip(at).take(most).cloned().collect())
    }

    /// Returns true if a log with this end is a prefix of this one, and the frames after it are
    /// kept.
    pub fn continues(&self, reached: Reached) -> bool {
        let (term, index) = reached;
        index <= self.last
            && self.turn_of(index) == term
            && (index == self.last || self.frames.front().is_some_and(|f| f.index <= index + 1))
    }
}

impl KnownFrames for ReplicaLog {
    fn last_index(&self) -> u64 {
        self.last
    }

    fn frames_from(&self, first: u64, most: usize) -> Option<Vec<Arc<Frame>>> {
        self.from(first, most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_continues_what_is_its_beginning_and_nothing_else() {
        let first = Term { number: 1, base: 0, host: 5 };
        let second = Term { number: 2, base: 20, host: 6 };
        let mut log = ReplicaLog::default();
        log.begin_turn(first);
        let frame = |index| Arc::new(Frame { index, tick: index * 2, ..Frame::default() });
        (1..=20).for_each(|k| assert!(log.append(&frame(k))));
        log.begin_turn(second);
        (21..=30).for_each(|k| assert!(log.append(&frame(k))));
        assert!(!log.append(&frame(32)), "a gap");
        assert!(!log.append(&frame(30)), "again");
        assert!(log.continues((first, 20)) && log.continues((second, 30)));
        // The old host went on alone: its frames are not those of the new turn.
        assert!(!log.continues((first, 21)) && !log.continues((second, 31)));
        assert_eq!(log.reached(), (second, 30));
        assert_eq!(log.from(29, 9).map(|f| f.len()), Some(2));
    }
}

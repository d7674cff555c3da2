//! The list of a fleet: the newest state of each installation, and whether it is online.
//!
//! A tag says who made a state, not when: anybody on the network can record one and send it again.
//! Therefore a run is believed once it has answered a question that this list drew
//! ([`super::requester`]), and each of its states once. An installation is online while its
//! publications arrive. One that is silent for [`LOST_US`] is lost, and its run is asked again when
//! it returns. No other message ends it, because anybody on the network could send that. Nothing
//! has to be caught up, because each publication is complete.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use super::LOST_US;
use super::state::InstallationState;

/// Installations of one fleet.
pub const MAX_INSTALLATIONS: usize = 10_000;

/// State of an installation in the list.
#[derive(Debug, Clone)]
pub struct RegistryEntry {
    /// Its newest state.
    pub state: Arc<InstallationState>,
    /// Time of its arrival, in microseconds; 0: it is remembered from an earlier list.
    pub heard_us: u64,
    /// Time since which it is online or lost, in microseconds.
    pub since_us: u64,
    here: bool,
}

impl RegistryEntry {
    /// Returns true if it is online.
    pub fn is_here(&self) -> bool {
        self.here
    }
}

/// Change of the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FleetChange {
    /// An installation came online.
    Came(String),
    /// It is lost.
    Lost(String),
    /// Its state says something else.
    Changed(String),
}

/// The list.
#[derive(Debug, Default)]
pub struct FleetRegistry {
    entries: BTreeMap<String, RegistryEntry>,
    /// The run of each installation that has answered since it was lost last.
    proved: BTreeMap<String, String>,
    /// The newest state of each installation whose run has not answered.
    doubted: BTreeMap<String, Arc<InstallationState>>,
    changes: VecDeque<FleetChange>,
    /// Nobody is lost before.
    look_us: u64,
    /// States that came a second time, or of one installation too many.
    pub refused: u64,
}

impl FleetRegistry {
    /// A list whose installations were known earlier: all of them are lost until they are heard.
    pub fn remembering(states: impl IntoIterator<Item = InstallationState>) -> FleetRegistry {
        let mut registry = FleetRegistry::default();
        for state in states {
            let entry =
                RegistryEntry { state: Arc::new(state), heard_us: 0, since_us: 0, here: false };
            registry.entries.insert(entry.state.name.clone(), entry);
        }
        registry
    }

    /// Takes a state whose tag is right. False: it is not believed, or not yet.
    pub fn observe(&mut self, state: Arc<InstallationState>, now_us: u64) -> bool {
        let name = &state.name;
        if self.proved.get(name) != Some(&state.run) {
            let is_full = self.entries.len() + self.doubted.len() >= MAX_INSTALLATIONS;
            let is_known = self.entries.contains_key(name) || self.doubted.contains_key(name);
            match is_known || !is_full {
                true => drop(self.doubted.insert(name.clone(), state)),
                false => self.refused += 1,
            }
            return false;
        }
        let old = self.entries.get(name);
        if old.is_some_and(|old| old.state.run == state.run && old.state.sequence >= state.sequence)
        {
            self.refused += 1;
            return false;
        }
        let came = old.is_none_or(|old| !old.here);
        let since_us = old.filter(|_| !came).map_or(now_us, |old| old.since_us);
        let change: fn(String) -> FleetChange = match came {
            true => FleetChange::Came,
            false => FleetChange::Changed,
        };
        if came || old.is_some_and(|old| !state.says_the_same_as(&old.state)) {
            self.changes.push_back(change(name.clone()));
        }
        self.look_us = self.look_us.min(now_us + LOST_US);
        let entry = RegistryEntry { heard_us: now_us, since_us, here: true, state };
        self.entries.insert(entry.state.name.clone(), entry);
        true
    }

    /// Takes a run's answer to a question that this list drew: it is running now.
    pub fn prove(&mut self, name: &str, run: &str, now_us: u64) {
        self.proved.insert(name.into(), run.into());
        if let Some(state) = self.doubted.remove(name).filter(|state| state.run == run) {
            self.observe(state, now_us);
        }
    }

    /// The installations that must be asked which run is running.
    pub fn doubted(&self) -> impl Iterator<Item = &str> {
        self.doubted.keys().map(String::as_str)
    }

    /// Passes time: who has been silent for too long is lost.
    pub fn advance(&mut self, now_us: u64) {
        if now_us < self.look_us {
            return;
        }
        self.look_us = u64::MAX;
        for (name, entry) in self.entries.iter_mut().filter(|(_, e)| e.here) {
            if now_us >= entry.heard_us + LOST_US {
                (entry.here, entry.since_us) = (false, now_us);
                self.proved.remove(name);
                self.changes.push_back(FleetChange::Lost(name.clone()));
            } else {
                self.look_us = self.look_us.min(entry.heard_us + LOST_US);
            }
        }
    }

    /// Returns the entry of an installation.
    pub fn get(&self, name: &str) -> Option<&RegistryEntry> {
        self.entries.get(name)
    }

    /// All that are known, by name.
    pub fn all(&self) -> impl Iterator<Item = (&str, &RegistryEntry)> {
        self.entries.iter().map(|(name, entry)| (name.as_str(), entry))
    }

    /// The next change, in the order in which they came.
    pub fn take_change(&mut self) -> Option<FleetChange> {
        self.changes.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(run: &str, sequence: u64) -> Arc<InstallationState> {
        let (name, run) = ("hall".to_owned(), run.to_owned());
        Arc::new(InstallationState { name, run, sequence, ..Default::default() })
    }

    #[test]
    fn a_state_that_was_recorded_is_not_believed_again() {
        let mut list = FleetRegistry::default();
        assert!(!list.observe(state("a", 1), 0), "its run has not answered");
        assert_eq!(list.doubted().collect::<Vec<_>>(), ["hall"]);
        list.prove("hall", "a", 1);
        assert!(list.get("hall").is_some_and(|e| e.is_here() && e.state.sequence == 1));
        assert!(list.doubted().next().is_none() && list.observe(state("a", 3), 1));
        assert!(!list.observe(state("a", 3), 2) && !list.observe(state("a", 2), 2));
        assert_eq!(list.refused, 2);
        assert!(!list.observe(state("b", 1), 3));
        list.prove("hall", "b", 3);
        // Runs that ended: one that was heard, and one that nobody heard.
        for old in ["a", "0"] {
            assert!(!list.observe(state(old, 9), 4));
            list.prove("hall", "b", 4);
        }
        assert!(list.get("hall").is_some_and(|e| e.state.run == "b"));
        // Publications held back while the installation was lost show nobody.
        list.advance(LOST_US + 3);
        assert!(!list.observe(state("b", 2), LOST_US + 4));
        assert!(list.get("hall").is_some_and(|e| !e.is_here()));
    }

    #[test]
    fn a_list_that_restarts_believes_no_recorded_state() {
        let known = InstallationState::clone(&state("b", 5));
        let mut list = FleetRegistry::remembering([known]);
        for (run, sequence) in [("b", 6), ("a", 9), ("0", 1)] {
            assert!(!list.observe(state(run, sequence), 1));
            list.advance(2);
            assert!(list.get("hall").is_some_and(|e| !e.is_here() && e.state.sequence == 5));
        }
        // The run that is there answers, though somebody sends an old one's state before.
        list.prove("hall", "c", 3);
        assert!(!list.observe(state("a", 10), 4));
        assert!(list.observe(state("c", 1), 5));
        assert!(list.get("hall").is_some_and(|e| e.is_here() && e.state.run == "c"));
    }

    #[test]
    fn silence_is_told_once_and_the_next_word_too() {
        let mut list = FleetRegistry::default();
        list.observe(state("a", 1), 0);
        list.prove("hall", "a", 0);
        list.advance(LOST_US - 1);
        assert_eq!(list.take_change(), Some(FleetChange::Came("hall".into())));
        assert_eq!(list.take_change(), None);
        list.advance(LOST_US);
        list.advance(LOST_US * 2);
        assert_eq!(list.take_change(), Some(FleetChange::Lost("hall".into())));
        list.observe(state("a", 2), LOST_US * 3);
        assert_eq!(list.take_change(), None);
        list.prove("hall", "a", LOST_US * 3);
        assert_eq!(list.take_change(), Some(FleetChange::Came("hall".into())));
        list.advance(LOST_US * 4);
        assert_eq!(list.take_change(), Some(FleetChange::Lost("hall".into())));
        assert_eq!(list.take_change(), None);
    }
}

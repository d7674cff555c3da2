//! The list of a fleet: the newest state of each installation, and whether it is online.
//!
//! An installation is online while its publications arrive. One that is silent for [`LOST_US`] is
//! lost. No other message ends it, because anybody on the network could send that. A returning one
//! is online with its
//! next publication: nothing has to be caught up, because each publication is complete.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use super::LOST_US;
use super::state::InstallationState;

/// Runs of an installation that are remembered, so that their states are not believed again.
const PAST_RUNS: usize = 32;
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
    past_runs: VecDeque<String>,
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
    changes: VecDeque<FleetChange>,
    /// Nobody is lost before.
    look_us: u64,
    /// States that were not believed: older than what is known, or of one installation too many.
    pub refused: u64,
}

impl FleetRegistry {
    /// A list whose installations were known earlier: all of them are lost until they are heard.
    pub fn remembering(states: impl IntoIterator<Item = InstallationState>) -> FleetRegistry {
        let mut registry = FleetRegistry::default();
        for state in states {
            let entry = RegistryEntry {
                state: Arc::new(state),
                heard_us: 0,
                since_us: 0,
                here: false,
                past_runs: VecDeque::new(),
            };
            registry.entries.insert(entry.state.name.clone(), entry);
        }
        registry
    }

    /// Takes a state whose tag is right. False: it is older than what is known.
    pub fn observe(&mut self, state: Arc<InstallationState>, now_us: u64) -> bool {
        let Some(entry) = self.entries.get_mut(&state.name) else {
            if self.entries.len() >= MAX_INSTALLATIONS {
                self.refused += 1;
                return false;
            }
            let name = state.name.clone();
            self.changes.push_back(FleetChange::Came(name.clone()));
            let past_runs = VecDeque::new();
            let (heard_us, since_us) = (now_us, now_us);
            let entry = RegistryEntry { state, heard_us, since_us, here: true, past_runs };
            self.entries.insert(name, entry);
            self.look_us = self.look_us.min(now_us + LOST_US);
            return true;
        };
        let old = &entry.state;
        let newer = if state.run == old.run {
            state.sequence > old.sequence
        } else {
            // The clock of an installation may have been set back; a lost one may restart.
            (state.started_s >= old.started_s || !entry.here)
                && !entry.past_runs.contains(&state.run)
        };
        if !newer {
            self.refused += 1;
            return false;
        }
        if state.run != old.run {
            if entry.past_runs.len() >= PAST_RUNS {
                entry.past_runs.pop_front();
            }
            entry.past_runs.push_back(old.run.clone());
        }
        if !entry.here {
            (entry.here, entry.since_us) = (true, now_us);
            self.changes.push_back(FleetChange::Came(state.name.clone()));
            self.look_us = self.look_us.min(now_us + LOST_US);
        } else if !state.says_the_same_as(old) {
            self.changes.push_back(FleetChange::Changed(state.name.clone()));
        }
        (entry.state, entry.heard_us) = (state, now_us);
        true
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

    /// Returns true if the run that an installation publishes started after this one.
    pub fn is_newer(&self, name: &str, run: &str) -> bool {
        self.get(name).is_some_and(|e| e.state.run != run && e.past_runs.iter().any(|r| r == run))
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

    fn state(run: &str, started_s: u64, sequence: u64) -> Arc<InstallationState> {
        let name = "hall".to_owned();
        let run = run.to_owned();
        Arc::new(InstallationState { name, run, started_s, sequence, ..Default::default() })
    }

    #[test]
    fn a_state_that_was_recorded_is_not_believed_again() {
        let mut list = FleetRegistry::default();
        assert!(list.observe(state("a", 100, 1), 0) && list.observe(state("a", 100, 3), 1));
        assert!(!list.observe(state("a", 100, 3), 2) && !list.observe(state("a", 100, 2), 2));
        assert!(list.observe(state("b", 200, 1), 3));
        assert!(!list.observe(state("a", 100, 9), 4), "the run before");
        assert!(!list.observe(state("0", 50, 9), 4), "one before that, which nobody heard");
        assert_eq!(list.refused, 4);
        // A lost installation restarts with a clock that was set back; an old run stays an old run.
        list.advance(LOST_US + 3);
        let later = LOST_US + 4;
        assert!(!list.observe(state("a", 100, 10), later));
        assert!(list.observe(state("c", 50, 1), later));
    }

    #[test]
    fn silence_is_told_once_and_the_next_word_too() {
        let mut list = FleetRegistry::default();
        list.observe(state("a", 1, 1), 0);
        list.advance(LOST_US - 1);
        assert_eq!(list.take_change(), Some(FleetChange::Came("hall".into())));
        assert_eq!(list.take_change(), None);
        list.advance(LOST_US);
        list.advance(LOST_US * 2);
        assert_eq!(list.take_change(), Some(FleetChange::Lost("hall".into())));
        list.observe(state("a", 1, 2), LOST_US * 3);
        assert_eq!(list.take_change(), Some(FleetChange::Came("hall".into())));
        list.advance(LOST_US * 4);
        assert_eq!(list.take_change(), Some(FleetChange::Lost("hall".into())));
        assert_eq!(list.take_change(), None);
    }
}

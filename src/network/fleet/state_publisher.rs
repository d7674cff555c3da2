//! When an installation publishes: at once where something has changed, though not too often, and
//! every [`PERIOD_US`] in any case.

use super::state::{InstallationState, SCHEMA_VERSION};
use super::{PERIOD_US, SPACING_US};

/// Numbers and times the publications of a run.
#[derive(Debug)]
pub struct StatePublisher {
    name: String,
    run: String,
    started_s: u64,
    begun_us: u64,
    sequence: u64,
    last: Option<(InstallationState, u64)>,
}

impl StatePublisher {
    /// For a run that begins now: `started_s` by the wall's clock.
    pub fn new(name: &str, run: &str, started_s: u64, now_us: u64) -> StatePublisher {
        let (name, run) = (name.to_owned(), run.to_owned());
        StatePublisher { name, run, started_s, begun_us: now_us, sequence: 0, last: None }
    }

    /// When [`StatePublisher::publish`] gives a state whether or not it has changed.
    pub fn due_us(&self) -> u64 {
        self.last.as_ref().map_or(self.begun_us, |(_, at)| at + PERIOD_US)
    }

    /// The state to be published now, made of what was measured; `None`: nothing is due. The fields
    /// that name the run and count its publications are filled in.
    pub fn publish(
        &mut self,
        mut measured: InstallationState,
        now_us: u64,
    ) -> Option<InstallationState> {
        (measured.schema, measured.started_s) = (SCHEMA_VERSION, self.started_s);
        measured.name.clone_from(&self.name);
        measured.run.clone_from(&self.run);
        if let Some((last, at)) = &self.last {
            let changed = !measured.says_the_same_as(last);
            if now_us < at + if changed { SPACING_US } else { PERIOD_US } {
                return None;
            }
        }
        self.sequence += 1;
        measured.sequence = self.sequence;
        measured.uptime_s = now_us.saturating_sub(self.begun_us) / 1_000_000;
        self.last = Some((measured.clone(), now_us));
        Some(measured)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_published_soon_and_the_same_again_every_two_seconds() {
        let mut publisher = StatePublisher::new("hall", "r", 7, 0);
        let state = InstallationState::default;
        let first = publisher.publish(state(), 0).expect("the first");
        assert_eq!((first.sequence, first.name.as_str(), first.started_s), (1, "hall", 7));
        assert_eq!(publisher.publish(state(), PERIOD_US - 1), None);
        let again = publisher.publish(state(), PERIOD_US).expect("again");
        assert_eq!((again.sequence, again.uptime_s), (2, PERIOD_US / 1_000_000));
        let mut other = state();
        other.visit.visits = 1;
        assert_eq!(publisher.publish(other.clone(), PERIOD_US + SPACING_US - 1), None);
        assert!(publisher.publish(other, PERIOD_US + SPACING_US).is_some());
        assert_eq!(publisher.due_us(), PERIOD_US + SPACING_US + PERIOD_US);
    }
}

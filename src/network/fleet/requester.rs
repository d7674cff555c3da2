//! The staff's end of requests: each is sent until it is answered or its time is over.

use std::collections::{BTreeMap, VecDeque};

use super::registry::FleetRegistry;
use super::request::{FleetAction, FleetAnswer, FleetOutcome, FleetRequest};

/// A request without an answer is sent again after so long, microseconds.
pub const AGAIN_US: u64 = 1_000_000;

/// End of a request, for its sender.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RequestEnd {
    /// The installation answered.
    Answered(FleetOutcome),
    /// It did not, within the given time.
    Silent,
}

#[derive(Debug)]
struct PendingRequest {
    installation: String,
    action: FleetAction,
    /// As it was sent last: the run and the sequence.
    named: Option<(String, u64)>,
    next_us: u64,
    until_us: u64,
}

/// Requests on their way.
#[derive(Debug, Default)]
pub struct Requester {
    pending: BTreeMap<String, PendingRequest>,
    /// The highest sequence of each installation's run that is known to be used.
    used: BTreeMap<String, (String, u64)>,
    ended: VecDeque<(String, RequestEnd)>,
}

impl Requester {
    /// Asks an installation for something. `id`: 16 hexadecimal digits, drawn for this request.
    pub fn ask(&mut self, id: String, installation: &str, action: FleetAction, until_us: u64) {
        let installation = installation.to_owned();
        let pending = PendingRequest { installation, action, named: None, next_us: 0, until_us };
        self.pending.insert(id, pending);
    }

    /// Returns the requests to send now, each with its receiver. A request to an offline
    /// installation waits until it is online.
    pub fn advance(
        &mut self,
        registry: &FleetRegistry,
        now_us: u64,
    ) -> Vec<(String, FleetRequest)> {
        let mut out = Vec::new();
        let (pending, ended) = (&mut self.pending, &mut self.ended);
        pending.retain(|id, request| {
            let waits = now_us < request.until_us;
            if !waits {
                ended.push_back((id.clone(), RequestEnd::Silent));
            }
            waits
        });
        for (id, request) in pending.iter_mut() {
            if now_us < request.next_us {
                continue;
            }
            let Some(entry) = registry.get(&request.installation).filter(|e| e.is_here()) else {
                continue;
            };
            request.next_us = now_us + AGAIN_US;
            let used = self.used.entry(request.installation.clone()).or_default();
            // An answer of an installation is newer than its earlier publications.
            if used.0.is_empty() || used.0 == entry.state.run {
                let most = used.1.max(entry.state.accepted);
                *used = (entry.state.run.clone(), most);
            } else if registry.is_newer(&request.installation, &used.0) {
                *used = (entry.state.run.clone(), entry.state.accepted);
            }
            let same = request.named.as_ref().is_some_and(|(run, _)| *run == used.0);
            if !same {
                used.1 += 1;
                request.named = Some(used.clone());
            }
            let Some((run, sequence)) = request.named.clone() else { continue };
            let (id, action) = (id.clone(), request.action.clone());
            let asked = FleetRequest { id, run, sequence, action };
            out.push((request.installation.clone(), asked));
        }
        out
    }

    /// Takes an answer that was sealed with the key of the installation.
    pub fn answer(&mut self, installation: &str, answer: FleetAnswer) {
        let Some(request) = self.pending.get_mut(&answer.id) else { return };
        if request.installation != installation {
            return;
        }
        if let FleetOutcome::Stale { run, accepted } = answer.outcome {
            let used = self.used.entry(installation.to_owned()).or_default();
            let most = if used.0 == run { used.1.max(accepted) } else { accepted };
            *used = (run, most);
            (request.named, request.next_us) = (None, 0);
            return;
        }
        self.pending.remove(&answer.id);
        self.ended.push_back((answer.id, RequestEnd::Answered(answer.outcome)));
    }

    /// The next request that has ended.
    pub fn take_ended(&mut self) -> Option<(String, RequestEnd)> {
        self.ended.pop_front()
    }

    /// Returns true while requests are pending.
    pub fn is_busy(&self) -> bool {
        !self.pending.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::super::request_guard::{Admission, RequestGuard};
    use super::super::state::InstallationState;
    use super::*;

    fn state(run: &str, sequence: u64) -> InstallationState {
        let (name, run) = ("hall".to_owned(), run.to_owned());
        InstallationState { name, run, sequence, ..InstallationState::default() }
    }

    #[test]
    fn a_request_is_sent_until_it_is_answered_and_to_the_run_that_is_there() {
        let (mut registry, mut requester) = (FleetRegistry::default(), Requester::default());
        requester.ask("a".into(), "hall", FleetAction::RestartVisit, 20_000_000);
        assert!(requester.advance(&registry, 1).is_empty(), "nobody is there");
        registry.observe(state("one", 1).into(), 2);
        let first = requester.advance(&registry, 2);
        assert_eq!(first.len(), 1);
        assert!(requester.advance(&registry, 3).is_empty(), "not at once");
        let again = requester.advance(&registry, 2 + AGAIN_US);
        assert_eq!(again, first, "the same again");
        // Another run took its place before it came.
        let mut guard = RequestGuard::new("two".into());
        let (_, request) = again.into_iter().next().expect("one");
        let Admission::Answer(stale) = guard.admit(request) else { panic!("it is stale") };
        requester.answer("foyer", stale.clone());
        requester.answer("hall", stale);
        let anew = requester.advance(&registry, 3 + AGAIN_US);
        let (_, request) = anew.into_iter().next().expect("at once");
        assert_eq!((request.run.as_str(), request.sequence), ("two", 1));
        assert!(matches!(guard.admit(request), Admission::CarryOut(_)));
        let outcome = FleetOutcome::Done { note: "done".into() };
        requester.answer("hall", FleetAnswer { id: "a".into(), outcome: outcome.clone() });
        let end = ("a".to_owned(), RequestEnd::Answered(outcome));
        assert_eq!(requester.take_ended(), Some(end));
        assert!(!requester.is_busy());
        requester.ask("b".into(), "hall", FleetAction::RestartVisit, 30_000_000);
        assert!(!requester.advance(&registry, 4 + AGAIN_US).is_empty());
        requester.advance(&registry, 30_000_000);
        assert_eq!(requester.take_ended(), Some(("b".into(), RequestEnd::Silent)));
    }
}

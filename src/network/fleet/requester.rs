//! The staff's end of requests: each is sent until it is answered or its time is over. And of the
//! question which run of an installation is running: a request that names no run, which every
//! installation answers with the name of the present run.

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

/// The question which run is running.
#[derive(Debug)]
struct Probe {
    /// `None`: it is answered.
    id: Option<String>,
    next_us: u64,
}

/// Requests on their way.
#[derive(Debug)]
pub struct Requester {
    /// The next probe's id: no other request that was ever sent has it.
    next_probe: u64,
    /// The last probe of each installation. Answers to earlier ones do not count.
    probes: BTreeMap<String, Probe>,
    pending: BTreeMap<String, PendingRequest>,
    /// The highest sequence of each installation's run that is known to be used.
    used: BTreeMap<String, (String, u64)>,
    ended: VecDeque<(String, RequestEnd)>,
}

impl Requester {
    /// No requests. `first_probe`: drawn at random, so that nobody has recorded an answer.
    pub fn new(first_probe: u64) -> Requester {
        Requester {
            next_probe: first_probe,
            probes: BTreeMap::new(),
            pending: BTreeMap::new(),
            used: BTreeMap::new(),
            ended: VecDeque::new(),
        }
    }

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
        let mut out = self.probes(registry, now_us);
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
            if used.0 != entry.state.run {
                *used = (entry.state.run.clone(), 0);
            }
            used.1 = used.1.max(entry.state.accepted);
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

    /// The questions to send now, each with its receiver.
    fn probes(&mut self, registry: &FleetRegistry, now_us: u64) -> Vec<(String, FleetRequest)> {
        let mut out = Vec::new();
        for name in registry.doubted() {
            if self.probes.get(name).is_some_and(|probe| now_us < probe.next_us) {
                continue;
            }
            let id = format!("{:016x}", self.next_probe);
            self.next_probe = self.next_probe.wrapping_add(1);
            let probe = Probe { id: Some(id.clone()), next_us: now_us + AGAIN_US };
            self.probes.insert(name.into(), probe);
            // It is never carried out: no run has this name.
            let action = FleetAction::Logs { lines: 1 };
            out.push((name.into(), FleetRequest { id, run: String::new(), sequence: 0, action }));
        }
        out
    }

    /// Takes an answer that was sealed with the key of the installation. Returns the run that is
    /// running, if the answer proves it: pass it to [`FleetRegistry::prove`].
    pub fn answer(&mut self, installation: &str, answer: FleetAnswer) -> Option<String> {
        let probe = self.probes.get_mut(installation);
        if let Some(probe) = probe.filter(|probe| probe.id.as_ref() == Some(&answer.id)) {
            probe.id = None;
            let FleetOutcome::Stale { run, .. } = answer.outcome else { return None };
            return Some(run);
        }
        self.answer_of_request(installation, answer);
        None
    }

    fn answer_of_request(&mut self, installation: &str, answer: FleetAnswer) {
        let Some(request) = self.pending.get_mut(&answer.id) else { return };
        if request.installation != installation {
            return;
        }
        if let FleetOutcome::Stale { run, accepted } = answer.outcome {
            // Another run than the list's: the list is about to hear of it.
            let used = self.used.get_mut(installation).filter(|used| used.0 == run);
            if let Some(used) = used {
                used.1 = used.1.max(accepted);
                (request.named, request.next_us) = (None, 0);
            }
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

    /// A run publishes, is asked, and answers.
    fn show(registry: &mut FleetRegistry, requester: &mut Requester, run: &str, now_us: u64) {
        registry.observe(state(run, 1).into(), now_us);
        let (to, probe) = requester.advance(registry, now_us).pop().expect("it is asked");
        let answer = RequestGuard::new(run.into()).admit(probe);
        let Admission::Answer(answer) = answer else { panic!("it names no run") };
        let run = requester.answer(&to, answer).expect("the answer proves it");
        registry.prove(&to, &run, now_us);
    }

    #[test]
    fn only_the_answer_to_the_last_question_proves_a_run() {
        let (mut registry, mut requester) = (FleetRegistry::default(), Requester::new(7));
        registry.observe(state("one", 1).into(), 1);
        let mut ask = |now_us| requester.advance(&registry, now_us).pop().map(|(_, probe)| probe);
        let first = ask(1).expect("it is asked");
        assert_eq!(ask(2), None, "not at once");
        let second = ask(1 + AGAIN_US).expect("asked again");
        let answer = |probe: FleetRequest| match RequestGuard::new("one".into()).admit(probe) {
            Admission::Answer(answer) => answer,
            other => panic!("{other:?}"),
        };
        let (first, second) = (answer(first), answer(second));
        assert_eq!(requester.answer("hall", first), None, "the answer to an earlier one");
        assert_eq!(requester.answer("foyer", second.clone()), None);
        assert_eq!(requester.answer("hall", second.clone()).as_deref(), Some("one"));
        assert_eq!(requester.answer("hall", second), None, "a second time");
    }

    #[test]
    fn a_request_is_sent_until_it_is_answered_and_to_the_run_that_is_there() {
        let (mut registry, mut requester) = (FleetRegistry::default(), Requester::new(7));
        requester.ask("a".into(), "hall", FleetAction::RestartVisit, 20_000_000);
        assert!(requester.advance(&registry, 1).is_empty(), "nobody is there");
        show(&mut registry, &mut requester, "one", 2);
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
        show(&mut registry, &mut requester, "two", 3 + AGAIN_US);
        let anew = requester.advance(&registry, 3 + 2 * AGAIN_US);
        let (_, request) = anew.into_iter().next().expect("to the run that is there");
        assert_eq!((request.run.as_str(), request.sequence), ("two", 1));
        assert!(matches!(guard.admit(request), Admission::CarryOut(_)));
        let outcome = FleetOutcome::Done { note: "done".into() };
        requester.answer("hall", FleetAnswer { id: "a".into(), outcome: outcome.clone() });
        let end = ("a".to_owned(), RequestEnd::Answered(outcome));
        assert_eq!(requester.take_ended(), Some(end));
        assert!(!requester.is_busy());
        requester.ask("b".into(), "hall", FleetAction::RestartVisit, 30_000_000);
        assert!(!requester.advance(&registry, 4 + 2 * AGAIN_US).is_empty());
        requester.advance(&registry, 30_000_000);
        assert_eq!(requester.take_ended(), Some(("b".into(), RequestEnd::Silent)));
    }
}

//! An installation's end of requests: each is carried out once, whatever the network repeats, and
//! an old one that somebody has kept is carried out never.

use std::collections::VecDeque;

use super::request::{FleetAnswer, FleetOutcome, FleetRequest};

/// Requests whose answers are kept for who asks again.
const REMEMBERED: usize = 64;

/// Decision about a received request.
#[derive(Debug, PartialEq, Eq)]
pub enum Admission {
    /// Carry it out, and pass the result to [`RequestGuard::answered`].
    CarryOut(FleetRequest),
    /// This is the answer.
    Answer(FleetAnswer),
    /// It is being carried out.
    UnderWay,
}

/// Requests that a run has accepted.
#[derive(Debug)]
pub struct RequestGuard {
    run: String,
    accepted: u64,
    known: VecDeque<(String, Option<FleetAnswer>)>,
}

impl RequestGuard {
    /// For a run.
    pub fn new(run: String) -> RequestGuard {
        RequestGuard { run, accepted: 0, known: VecDeque::new() }
    }

    /// The highest sequence that was taken.
    pub fn accepted(&self) -> u64 {
        self.accepted
    }

    /// Takes a request that was sealed with the right key.
    pub fn admit(&mut self, request: FleetRequest) -> Admission {
        let answer = |outcome| FleetAnswer { id: request.id.clone(), outcome };
        if let Some((_, known)) = self.known.iter().find(|(id, _)| *id == request.id) {
            return known.clone().map_or(Admission::UnderWay, Admission::Answer);
        }
        if request.run != self.run || request.sequence <= self.accepted {
            let (run, accepted) = (self.run.clone(), self.accepted);
            return Admission::Answer(answer(FleetOutcome::Stale { run, accepted }));
        }
        self.accepted = request.sequence;
        if let Err(why) = request.action.check() {
            let refused = answer(FleetOutcome::Refused { why });
            self.remember(request.id, Some(refused.clone()));
            return Admission::Answer(refused);
        }
        self.remember(request.id.clone(), None);
        Admission::CarryOut(request)
    }

    /// The answer to a request that was carried out.
    pub fn answered(&mut self, answer: &FleetAnswer) {
        if let Some(known) = self.known.iter_mut().find(|(id, _)| *id == answer.id) {
            known.1 = Some(answer.clone());
        }
    }

    fn remember(&mut self, id: String, answer: Option<FleetAnswer>) {
        if self.known.len() >= REMEMBERED {
            self.known.pop_front();
        }
        self.known.push_back((id, answer));
    }
}

#[cfg(test)]
mod tests {
    use super::super::request::FleetAction;
    use super::*;

    fn request(id: &str, run: &str, sequence: u64) -> FleetRequest {
        let action = FleetAction::RestartVisit;
        FleetRequest { id: id.into(), run: run.into(), sequence, action }
    }

    #[test]
    fn a_request_is_carried_out_once_and_an_old_one_never() {
        let mut guard = RequestGuard::new("r".into());
        let first = request("a", "r", 1);
        assert_eq!(guard.admit(first.clone()), Admission::CarryOut(first.clone()));
        assert_eq!(guard.admit(first.clone()), Admission::UnderWay);
        let outcome = FleetOutcome::Done { note: String::new() };
        let answer = FleetAnswer { id: "a".into(), outcome };
        guard.answered(&answer);
        assert_eq!(guard.admit(first.clone()), Admission::Answer(answer));
        // So many follow that it is forgotten: its sequence is used up all the same.
        for k in 2..200 {
            let next = request(&format!("{k}"), "r", k);
            assert!(matches!(guard.admit(next), Admission::CarryOut(_)));
        }
        let stale = FleetOutcome::Stale { run: "r".into(), accepted: 199 };
        let answer = FleetAnswer { id: "a".into(), outcome: stale };
        assert_eq!(guard.admit(first), Admission::Answer(answer));
        let other = guard.admit(request("b", "the run before", 1000));
        assert!(matches!(other, Admission::Answer(a) if matches!(a.outcome,
            FleetOutcome::Stale { accepted: 199, .. })));
    }

    #[test]
    fn what_is_out_of_bounds_is_refused_and_used_up() {
        let mut guard = RequestGuard::new("r".into());
        let bad = FleetRequest { action: FleetAction::Logs { lines: 0 }, ..request("a", "r", 5) };
        for _ in 0..2 {
            let said = guard.admit(bad.clone());
            assert!(matches!(said, Admission::Answer(a) if matches!(a.outcome,
                FleetOutcome::Refused { .. })));
        }
        assert_eq!(guard.accepted(), 5);
    }
}

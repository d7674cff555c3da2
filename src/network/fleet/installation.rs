//! An installation's end of the fleet as a state machine: requests come in and are carried out by
//! whoever runs it, states come out. It has no clock, no IO and no threads.

use super::access::{FleetSeal, FleetWay, open_sealed};
use super::request::{FleetAction, FleetAnswer, FleetOutcome, StaffOrder, from_json, to_json};
use super::request_guard::{Admission, RequestGuard};
use super::settings_files::TrialStart;
use super::state::InstallationState;
use super::state_publisher::StatePublisher;
use crate::keyring::Entropy;
use crate::rate_limit::RateLimit;
use crate::seal::Secret;

/// Requests that are looked at at once, and a second, whoever sends them.
const REQUESTS: (f64, f64) = (64.0, 16.0);

/// Actions that carry out the requests of staff.
pub trait InstallationPort {
    /// Shows a text to the staff on the spot; an empty one: nothing more.
    ///
    /// # Errors
    /// Why it cannot be shown.
    fn show(&mut self, text: &str) -> Result<String, String>;
    /// Ends the visit and puts everything back.
    ///
    /// # Errors
    /// Why not.
    fn restart_visit(&mut self) -> Result<String, String>;
    /// Presses a button of the staff page.
    ///
    /// # Errors
    /// Why not.
    fn staff(&mut self, order: StaffOrder) -> Result<String, String>;
    /// The newest lines of the log, the oldest first.
    fn log_lines(&mut self, most: usize) -> Vec<String>;
    /// Puts settings in place, on trial. `Ok(false)`: they are in place already.
    ///
    /// # Errors
    /// Why they are not taken; nothing has changed.
    fn try_settings(&mut self, text: &str, trial_s: u32) -> Result<bool, String>;
    /// Ends the trial: the settings stay.
    ///
    /// # Errors
    /// Why not.
    fn keep_settings(&mut self, revision: &str) -> Result<(), String>;
    /// Brings the settings before these back. `Ok(false)`: another revision is in place.
    ///
    /// # Errors
    /// Why not.
    fn take_back_settings(&mut self, revision: Option<&str>) -> Result<bool, String>;
}

/// Who an installation is, for a start.
#[derive(Debug)]
pub struct InstallationIdentity {
    /// Its name in the fleet.
    pub name: String,
    /// Its key.
    pub secret: Secret,
    /// Names the run: 16 hexadecimal digits.
    pub run: String,
    /// Start of the run, in seconds since 1970 (UTC).
    pub started_s: u64,
}

/// One installation's part in a fleet, for one run of the program.
#[derive(Debug)]
pub struct Installation {
    secret: Secret,
    seal: FleetSeal,
    publisher: StatePublisher,
    guard: RequestGuard,
    limit: RateLimit,
    /// Time at which settings on trial are reverted.
    trial_until_us: Option<u64>,
    restarts: bool,
    /// Requests that nobody with the key can have sent, and those beyond the bound.
    pub refused: u64,
}

impl Installation {
    /// Begins a run. `trial`: what the start found.
    pub fn new(
        identity: InstallationIdentity,
        trial: &TrialStart,
        entropy: &mut Entropy,
        now_us: u64,
    ) -> Installation {
        let InstallationIdentity { name, secret, run, started_s } = identity;
        let trial_until_us = match trial {
            TrialStart::OnTrial { trial_s } => Some(now_us + u64::from(*trial_s) * 1_000_000),
            _ => None,
        };
        Installation {
            seal: FleetSeal::new(&secret, FleetWay::Answer, entropy),
            publisher: StatePublisher::new(&name, &run, started_s, now_us),
            guard: RequestGuard::new(run),
            limit: RateLimit::new(REQUESTS.0, REQUESTS.1, now_us),
            secret,
            trial_until_us,
            restarts: false,
            refused: 0,
        }
    }

    /// Returns true if the program must start a new run with the settings now in place.
    pub fn restarts(&self) -> bool {
        self.restarts
    }

    /// Returns the time at which a state is due even without a change, in microseconds.
    pub fn due_us(&self) -> u64 {
        self.publisher.due_us()
    }

    /// Takes a sealed request, whatever its bytes are; the answer, sealed.
    pub fn receive(
        &mut self,
        sealed: &[u8],
        port: &mut dyn InstallationPort,
        now_us: u64,
    ) -> Option<Vec<u8>> {
        let plain = match self.limit.take(1.0, now_us) {
            true => open_sealed(&self.secret, FleetWay::Request, sealed),
            false => None,
        };
        let Some(Ok(request)) = plain.as_deref().map(from_json) else {
            self.refused += 1;
            return None;
        };
        let answer = match self.guard.admit(request) {
            Admission::UnderWay => return None,
            Admission::Answer(answer) => answer,
            Admission::CarryOut(request) => {
                let outcome = self.carry_out(request.action, port);
                let answer = FleetAnswer { id: request.id, outcome };
                self.guard.answered(&answer);
                answer
            }
        };
        Some(self.seal.seal(&to_json(&answer)))
    }

    fn carry_out(&mut self, action: FleetAction, port: &mut dyn InstallationPort) -> FleetOutcome {
        let done = match action {
            FleetAction::Message { text } => port.show(&text),
            FleetAction::RestartVisit => port.restart_visit(),
            FleetAction::Staff { order } => port.staff(order),
            FleetAction::Logs { lines } => {
                return FleetOutcome::Logs { lines: port.log_lines(lines as usize) };
            }
            FleetAction::TrySettings { text, trial_s } => {
                let tried = port.try_settings(&text, trial_s);
                tried.map(|new| {
                    self.restarts |= new;
                    let what = if new { "begins anew with them" } else { "has them already" };
                    what.to_owned()
                })
            }
            FleetAction::KeepSettings { revision } => port.keep_settings(&revision).map(|()| {
                self.trial_until_us = None;
                "keeps them".to_owned()
            }),
            FleetAction::TakeBackSettings { revision } => {
                port.take_back_settings(revision.as_deref()).map(|taken| {
                    self.restarts |= taken;
                    let what = if taken { "begins anew with those before" } else { "has others" };
                    what.to_owned()
                })
            }
        };
        match done {
            Ok(note) => FleetOutcome::Done { note },
            Err(why) => FleetOutcome::Refused { why },
        }
    }

    /// Passes time: returns the state to publish, if one is due, built from the measurements.
    /// Reverts settings that nobody has kept by the end of their trial.
    pub fn advance(
        &mut self,
        mut measured: InstallationState,
        port: &mut dyn InstallationPort,
        now_us: u64,
    ) -> Option<InstallationState> {
        if self.trial_until_us.is_some_and(|until| now_us >= until) {
            self.trial_until_us = None;
            match port.take_back_settings(None) {
                Ok(taken) => self.restarts |= taken,
                Err(why) => tracing::error!("settings on trial were not taken back: {why}"),
            }
        }
        measured.accepted = self.guard.accepted();
        self.publisher.publish(measured, now_us)
    }
}

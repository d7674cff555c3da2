//! The staff's end of a fleet at work: the list and the requests over a link, for a command that
//! looks for a while and goes.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use super::access::{FleetKey, FleetSeal, FleetWay, is_tagged, open_sealed};
use super::fleet_link::{StaffLink, StaffMessage};
use super::registry::FleetRegistry;
use super::request::{FleetAction, from_json, to_json};
use super::requester::{RequestEnd, Requester};
use super::state::InstallationState;
use crate::keyring::Entropy;
use sculptd_devices::Clock;

/// Interval at which requests are checked.
const LOOK: Duration = Duration::from_millis(50);

/// The staff's end.
pub struct FleetConsole {
    link: StaffLink,
    key: FleetKey,
    clock: Clock,
    entropy: Entropy,
    /// The list.
    pub registry: FleetRegistry,
    requester: Requester,
    seals: BTreeMap<String, FleetSeal>,
    /// States and answers that nobody with the key can have made.
    pub forged: u64,
}

impl std::fmt::Debug for FleetConsole {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FleetConsole").field("link", &self.link).finish_non_exhaustive()
    }
}

impl FleetConsole {
    /// A console whose list begins with what was known earlier.
    pub fn new(
        link: StaffLink,
        key: FleetKey,
        known: Vec<InstallationState>,
        mut entropy: Entropy,
    ) -> FleetConsole {
        let mut first_probe = [0; 8];
        entropy(&mut first_probe);
        FleetConsole {
            link,
            key,
            clock: Clock::monotonic(),
            entropy,
            registry: FleetRegistry::remembering(known),
            requester: Requester::new(u64::from_le_bytes(first_probe)),
            seals: BTreeMap::new(),
            forged: 0,
        }
    }

    /// Now, on the console's clock, microseconds.
    pub fn now_us(&self) -> u64 {
        self.clock.now_us()
    }

    /// Asks an installation for something; the request's name. It ends, answered or not, within
    /// `patience`.
    pub fn ask(&mut self, name: &str, action: FleetAction, patience: Duration) -> String {
        let mut id = [0; 8];
        (self.entropy)(&mut id);
        let id: String = id.iter().map(|b| format!("{b:02x}")).collect();
        let until_us = self.now_us() + patience.as_micros() as u64;
        self.requester.ask(id.clone(), name, action, until_us);
        id
    }

    /// Takes what comes within a moment, and sends what is due.
    pub fn advance(&mut self) {
        let now_us = self.now_us();
        for (name, request) in self.requester.advance(&self.registry, now_us) {
            let Some(secret) = self.key.secret_of(&name) else { continue };
            let entropy = &mut self.entropy;
            let seal = self
                .seals
                .entry(name.clone())
                .or_insert_with(|| FleetSeal::new(&secret, FleetWay::Request, entropy));
            self.link.request(&name, seal.seal(&to_json(&request)));
        }
        if let Ok(first) = self.link.incoming.recv_timeout(LOOK) {
            self.take(first);
            while let Ok(next) = self.link.incoming.try_recv() {
                self.take(next);
            }
        }
        self.registry.advance(self.now_us());
    }

    /// Passes so much time, or until `enough`.
    pub fn advance_for(&mut self, time: Duration, enough: impl Fn(&FleetRegistry) -> bool) {
        let until_us = self.now_us() + time.as_micros() as u64;
        while self.now_us() < until_us && !enough(&self.registry) {
            self.advance();
        }
    }

    /// The next request that has ended.
    pub fn take_ended(&mut self) -> Option<(String, RequestEnd)> {
        self.requester.take_ended()
    }

    fn take(&mut self, message: StaffMessage) {
        let now_us = self.now_us();
        match message {
            StaffMessage::State { name, json, tag } => {
                let secret = self.key.secret_of(&name);
                let state = InstallationState::from_json(&json);
                match state {
                    Ok(state)
                        if state.name == name
                            && secret.is_some_and(|s| is_tagged(&s, &json, &tag)) =>
                    {
                        self.registry.observe(Arc::new(state), now_us);
                    }
                    _ => self.forged += 1,
                }
            }
            StaffMessage::Answer { name, sealed } => {
                let secret = self.key.secret_of(&name);
                let plain = secret.and_then(|s| open_sealed(&s, FleetWay::Answer, &sealed));
                match plain.as_deref().map(from_json) {
                    Some(Ok(answer)) => {
                        if let Some(run) = self.requester.answer(&name, answer) {
                            self.registry.prove(&name, &run, now_us);
                        }
                    }
                    _ => self.forged += 1,
                }
            }
        }
    }
}

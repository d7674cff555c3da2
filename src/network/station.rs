//! A station: one daemon's part in a shared sculpture, as a state machine. Datagrams, time and the
//! local input go in; datagrams and events come out. It has no clock, no IO, no threads, and its
//! random bytes come from outside, so that a test can run many of them on a simulated network.
//!
//! **When the host is silent** for [`LOST_US`], the possible successors exchange the ends of their
//! logs. After [`DECIDE_US`] the one with the longest log (of equals, the one with the lowest
//! address) hosts in a new term. The others greet it. A host that hears of a greater term becomes a
//! member again. If the network is split, each part goes on. When it heals, the smaller term's
//! stations join the greater's, and repeat their input that it lacks.

use crate::core::{Core, DOWN, Event, GREETING, HEIRS, HeirsSeal, LOST_US, To, UP};
use crate::host::Host;
use crate::keyring::{Entropy, Invitation, Keyring, fresh};
use crate::member::Member;
use crate::outbox::Outbox;
use crate::replica_log::ReplicaLog;
use crate::seal::Secret;
use crate::wire::frame::{PersonId, Role};
use crate::wire::message::{Address, AmongHeirs, Greeting, Reached, Term};
use sculptd_devices::Sample;
use sculptd_engine::command::Command;

/// After the host was found to be gone, candidates are collected for so long.
pub const DECIDE_US: u64 = 450_000;
/// Between two words of a candidate.
const CANDIDATE_US: u64 = 60_000;
/// A winner that is not heard of by then did not win.
const AGAIN_US: u64 = 1_500_000;

/// Who somebody is, for a start.
pub struct Identity {
    /// As the person wants to be called.
    pub name: String,
    /// Role that the person requests.
    pub role: Role,
    /// The key that the station greets with. A host greets with it once it is no longer the host.
    pub invitation: Invitation,
    /// Random bytes; the station's address is the first that it draws.
    pub entropy: Entropy,
}

impl std::fmt::Debug for Identity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Identity").field("name", &self.name).field("role", &self.role).finish()
    }
}

#[derive(Debug)]
enum StationPhase {
    Hosts(Box<Host>),
    Follows(Box<Member>),
}

/// The search for a successor.
#[derive(Debug)]
struct Election {
    until_us: u64,
    next_us: u64,
    /// The own word was the best: this station hosts when the time is over.
    best: (Reached, Address),
    decided: bool,
}

/// One daemon's part in a shared sculpture.
#[derive(Debug)]
pub struct Station {
    core: Core,
    phase: StationPhase,
    invitation: Invitation,
    election: Option<Election>,
    heirs: Option<HeirsSeal>,
    known: u32,
    heard_host_us: u64,
    ended: bool,
}

impl Station {
    fn core(identity: Identity, rate_hz: u32) -> (Core, Invitation) {
        let Identity { name, role, invitation, mut entropy } = identity;
        let mut address = [0; 8];
        entropy(&mut address);
        let core = Core {
            address: u64::from_le_bytes(address),
            name,
            role,
            person: 0,
            rate_hz,
            log: ReplicaLog::default(),
            outbox: Outbox::default(),
            outgoing: Default::default(),
            events: Default::default(),
            entropy,
        };
        (core, invitation)
    }

    /// The first host of a sculpture, whose world is at `tick`.
    pub fn host(
        identity: Identity,
        keyring: Keyring,
        rate_hz: u32,
        tick: u64,
        now_us: u64,
    ) -> Station {
        let (mut core, invitation) = Station::core(identity, rate_hz);
        core.log = ReplicaLog::at(0, tick, Vec::new(), Vec::new());
        let group = fresh(&mut core.entropy);
        let term = Term { number: 1, base: 0, host: core.address };
        let host = Host::new(&mut core, keyring, group, term, now_us);
        Station::of(core, StationPhase::Hosts(Box::new(host)), invitation)
    }

    /// Somebody who joins whoever hosts.
    pub fn join(identity: Identity, now_us: u64) -> Station {
        let (mut core, invitation) = Station::core(identity, 1);
        let member = Member::new(&mut core, invitation.clone(), now_us);
        Station::of(core, StationPhase::Follows(Box::new(member)), invitation)
    }

    fn of(core: Core, phase: StationPhase, invitation: Invitation) -> Station {
        let (election, heirs) = (None, None);
        Station {
            core,
            phase,
            invitation,
            election,
            heirs,
            known: 1,
            heard_host_us: 0,
            ended: false,
        }
    }

    /// The own name on the network.
    pub fn address(&self) -> Address {
        self.core.address
    }

    /// The own number; 0 before the first entry.
    pub fn person(&self) -> PersonId {
        self.core.person
    }

    /// Ticks a second, as the host has them.
    pub fn rate_hz(&self) -> u32 {
        self.core.rate_hz
    }

    /// Returns true if this station hosts.
    pub fn hosts(&self) -> bool {
        matches!(self.phase, StationPhase::Hosts(_))
    }

    /// Returns true if this station follows a host.
    pub fn follows(&self) -> bool {
        matches!(&self.phase, StationPhase::Follows(m) if m.follows())
    }

    /// The ordered input as this station has it.
    pub fn log(&self) -> &ReplicaLog {
        &self.core.log
    }

    /// The own input that is not acknowledged.
    pub fn outbox(&self) -> &Outbox {
        &self.core.outbox
    }

    /// Takes the local input of a tick: rounded samples whose devices are numbered from 0, and
    /// commands that may be shared ([`crate::policy`]). Input before the first entry, and that of a
    /// viewer, is dropped.
    pub fn submit(&mut self, samples: Vec<Sample>, commands: Vec<Command>, now_us: u64) {
        if self.core.person == 0 || self.core.role == Role::Viewer {
            return;
        }
        self.core.outbox.push(samples, commands);
        if let StationPhase::Follows(member) = &mut self.phase {
            member.hurry(now_us);
        }
    }

    /// Takes a datagram; whatever its bytes are.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) {
        let Some((kind, rest)) = bytes.split_first() else { return };
        let Some((from, body)) = rest.split_first_chunk::<8>() else { return };
        let from = Address::from_le_bytes(*from);
        if from == self.core.address || self.ended {
            return;
        }
        match (*kind, &mut self.phase) {
            (GREETING, phase) => {
                let Ok(greeting) = Greeting::from_bytes(body) else { return };
                match phase {
                    StationPhase::Hosts(host) => {
                        host.greeting(&mut self.core, from, &greeting, now_us)
                    }
                    StationPhase::Follows(m) => m.greeting(&mut self.core, from, &greeting, now_us),
                }
            }
            (UP, StationPhase::Hosts(host)) => host.receive(&mut self.core, from, body, now_us),
            (DOWN, StationPhase::Follows(member)) => {
                member.receive(&mut self.core, from, body, now_us)
            }
            (HEIRS, _) => self.among_heirs(body, now_us),
            _ => {}
        }
        let refused = |e: &Event| matches!(e, Event::Refused(_));
        self.ended |= self.core.events.back().is_some_and(refused);
    }

    fn group(&self) -> Option<(Keyring, Secret)> {
        match &self.phase {
            StationPhase::Hosts(host) => Some(host.succession()),
            StationPhase::Follows(member) => member.succession.clone(),
        }
    }

    fn among_heirs(&mut self, sealed: &[u8], now_us: u64) {
        let Some((_, group)) = self.group() else { return };
        let opened = sealed.split_first_chunk::<8>().and_then(|(stream, sealed)| {
            group.heirs_seal(u64::from_le_bytes(*stream)).open(sealed)
        });
        let Some(Ok(message)) = opened.map(|p| AmongHeirs::from_bytes(&p)) else { return };
        match message {
            AmongHeirs::Host { term } => {
                self.known = self.known.max(term.number);
                match &mut self.phase {
                    StationPhase::Hosts(host) if term > host.term => {
                        self.core.note("another host has a later turn: joining it");
                        self.core.events.push_back(Event::Hosting(false));
                        let mut member =
                            Member::new(&mut self.core, self.invitation.clone(), now_us);
                        (member.level, member.term) = (true, term);
                        member.succession = Some(host.succession());
                        self.phase = StationPhase::Follows(Box::new(member));
                        self.election = None;
                    }
                    StationPhase::Follows(member) if term >= member.term => {
                        self.heard_host_us = now_us;
                        member.vouched(now_us);
                        if term > member.term && (member.follows() || self.election.is_some()) {
                            member.greet(&mut self.core, now_us);
                        }
                        self.election = None;
                    }
                    _ => {}
                }
            }
            AmongHeirs::Candidate { known, reached, by } => {
                self.known = self.known.max(known);
                match &mut self.phase {
                    StationPhase::Hosts(host) => host.present(),
                    // One way of several stands still: who hears the host vouches for it.
                    StationPhase::Follows(member) if member.hears_host(now_us) => {
                        let term = member.term;
                        let core = &mut self.core;
                        let heirs = self.heirs.get_or_insert_with(|| HeirsSeal::new(&group, core));
                        core.among_heirs(heirs, AmongHeirs::Host { term });
                    }
                    StationPhase::Follows(_) => {}
                }
                if let Some(election) = self.election.as_mut().filter(|e| !e.decided)
                    && better((reached, by), election.best)
                {
                    election.best = (reached, by);
                }
            }
        }
    }

    /// Passes time: frames are made, datagrams sent, a silent host is replaced.
    pub fn advance(&mut self, now_us: u64) {
        if self.ended {
            return;
        }
        match &mut self.phase {
            StationPhase::Hosts(host) => host.advance(&mut self.core, now_us),
            StationPhase::Follows(member) => {
                member.advance(&mut self.core, now_us);
                let may = member.level && member.succession.is_some();
                if member.lost && self.core.role != Role::Sculptor {
                    member.greet(&mut self.core, now_us);
                    member.lost = false;
                    self.core.note("the host is silent: looking for another");
                } else if member.lost && may && self.election.is_none() {
                    // It is followed on: it may be heard again before a successor is found.
                    self.core.note("the host is silent: looking for who takes over");
                    self.begin_election(now_us);
                } else if member.follows() && !member.lost && self.election.is_some() {
                    self.core.note("the host is heard again");
                    self.election = None;
                } else if may
                    && self.election.is_none()
                    && !member.follows()
                    && now_us >= self.heard_host_us + AGAIN_US
                {
                    // It was greeted, and did not answer.
                    self.begin_election(now_us);
                }
            }
        }
        self.elect(now_us);
    }

    fn begin_election(&mut self, now_us: u64) {
        let best = (self.core.log.reached(), self.core.address);
        let until_us = now_us + DECIDE_US;
        self.heard_host_us = now_us;
        self.election = Some(Election { until_us, next_us: now_us, best, decided: false });
    }

    fn elect(&mut self, now_us: u64) {
        let Some((keyring, group)) = self.group() else { return };
        let Some(election) = &mut self.election else { return };
        if now_us >= election.next_us && !election.decided {
            election.next_us = now_us + CANDIDATE_US;
            let address = self.core.address;
            let core = &mut self.core;
            let heirs = self.heirs.get_or_insert_with(|| HeirsSeal::new(&group, core));
            let (known, reached) = (self.known, core.log.reached());
            core.among_heirs(heirs, AmongHeirs::Candidate { known, reached, by: address });
        }
        if now_us < election.until_us {
            return;
        }
        if election.decided {
            self.election = None;
            return;
        }
        if election.best.1 != self.core.address {
            // The best one is about to announce itself.
            (election.decided, election.until_us) = (true, now_us + AGAIN_US);
            return;
        }
        self.election = None;
        self.known += 1;
        let (number, base) = (self.known, self.core.log.last());
        let term = Term { number, base, host: self.core.address };
        self.core.note(format!("takes over as the host of turn {number}, after frame {base}"));
        let host = Host::new(&mut self.core, keyring, group, term, now_us);
        self.phase = StationPhase::Hosts(Box::new(host));
        if let StationPhase::Hosts(host) = &mut self.phase {
            host.advance(&mut self.core, now_us);
        }
    }

    /// The next datagram to be sent, and whom it is for.
    pub fn take_outgoing(&mut self) -> Option<(To, Vec<u8>)> {
        self.core.outgoing.pop_front()
    }

    /// The next event.
    pub fn take_event(&mut self) -> Option<Event> {
        self.core.events.pop_front()
    }

    /// Takes the hash of the local world after a frame with the mark.
    pub fn own_hash(&mut self, index: u64, hash: u64) {
        match &mut self.phase {
            StationPhase::Hosts(host) => host.own_hash(&mut self.core, index, hash),
            StationPhase::Follows(member) => member.own_hash(&mut self.core, index, hash),
        }
    }

    /// Takes the next bytes of the local world's checkpoint after a frame with the mark; `last`:
    /// nothing follows them. Only a host needs them.
    pub fn checkpoint_part(&mut self, index: u64, part: &[u8], last: bool) {
        if let StationPhase::Hosts(host) = &mut self.phase {
            host.checkpoint_part(&mut self.core, index, part, last);
        }
    }

    /// The world was not at rest after all: another checkpoint is tried.
    pub fn checkpoint_failed(&mut self, index: u64, now_us: u64) {
        if let StationPhase::Hosts(host) = &mut self.phase {
            host.checkpoint_failed(index, now_us);
        }
    }

    /// The own world could not be made of a checkpoint: another is asked for.
    pub fn restore_failed(&mut self, now_us: u64) {
        if let StationPhase::Follows(member) = &mut self.phase {
            member.level = false;
            member.greet(&mut self.core, now_us);
        }
    }

    /// Notes whether nothing was under way in the local world after the last stepped frame.
    pub fn after_step(&mut self, at_rest: bool) {
        if let StationPhase::Hosts(host) = &mut self.phase {
            host.after_step(at_rest);
        }
    }

    /// Goes; what is to be sent is still to be taken.
    pub fn leave(&mut self) {
        if let StationPhase::Follows(member) = &mut self.phase {
            member.leave(&mut self.core);
        }
    }

    /// When [`Station::advance`] is to be called next, where nothing comes in between.
    pub fn next_us(&self, now_us: u64) -> u64 {
        let tick = 1_000_000 / u64::from(self.core.rate_hz.max(30));
        match self.phase {
            StationPhase::Hosts(_) if !self.core.outbox.is_empty() => now_us + tick,
            _ => now_us + (LOST_US / 50).min(2 * tick),
        }
    }
}

/// Returns true if candidate `a` is better: it has more of the log; of equals, the lower address.
fn better(a: (Reached, Address), b: (Reached, Address)) -> bool {
    a.0 > b.0 || a.0 == b.0 && a.1 < b.1
}

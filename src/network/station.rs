//! A station: one daemon's part in a shared sculpture, as a state machine. Datagrams, time and the
//! local input go in; datagrams and events come out. It has no clock, no IO, no threads, and its
//! random bytes come from outside, so that a test can run many of them on a simulated network.
//!
//! **When the host is silent** for [`LOST_US`], the possible successors exchange the ends of their
//! logs. After [`DECIDE_US`] the one with the longest log (of equals, the one with the lowest
//! address) hosts in a new term. The others greet it. If the network is split, each part goes on.
//! When it heals, the hosts find each other, as each greets whoever hosts: one stays
//! ([`crate::door`]), the stations of the other join it and repeat their input that it lacks.
//!
//! **A word among the successors counts if it answers the receiver's own challenge.** A recorded
//! one neither stops an election nor wins one.

use crate::core::{Core, DOWN, Event, GREETING, HEIRS, LOST_US, OtherSculpture, Outgoing, UP};
use crate::handshake::is_genuine;
use crate::heirs::{Among, Election, better};
use crate::host::Host;
use crate::host_search::HostSearch;
use crate::keyring::{Entropy, Invitation};
use crate::member::Member;
use crate::membership::SignedMembership;
use crate::outbox::Outbox;
use crate::replica_log::ReplicaLog;
use crate::wire::frame::{Batch, Frame, PersonId, Role};
use crate::wire::greeting::Greeting;
use crate::wire::message::{Address, AmongHeirs, HeirsWord, Term};
use sculptd_devices::Sample;
use sculptd_engine::command::Command;

/// After the host was found to be gone, candidates are collected for so long; over a long way
/// longer, as each has to answer the others' challenges.
pub const DECIDE_US: (u64, u64) = (450_000, 620_000);
/// Between two words of a candidate.
const CANDIDATE_US: u64 = 60_000;
/// A winner that is not heard of by then did not win.
const AGAIN_US: u64 = 1_500_000;
/// Between two questions who hosts.
const ASK_US: u64 = 200_000;

/// Who somebody is, for a start.
pub struct Identity {
    /// As the person wants to be called.
    pub name: String,
    /// Role that the person requests.
    pub role: Role,
    /// The key that the station greets and hosts with.
    pub invitation: Invitation,
    /// Seconds since 1970 at time 0 of the station.
    pub epoch_s: u64,
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

/// One daemon's part in a shared sculpture.
#[derive(Debug)]
pub struct Station {
    core: Core,
    phase: StationPhase,
    election: Option<Election>,
    among: Among,
    look: Option<HostSearch>,
    known: u32,
    heard_host_us: u64,
}

impl Station {
    fn of(identity: Identity, now_us: u64) -> Station {
        let Identity { name, role, invitation, epoch_s, entropy } = identity;
        let mut core = Core {
            address: 0,
            name,
            role,
            person: 0,
            invitation,
            members: None,
            group: None,
            sculpture: 0,
            begun_s: 0,
            epoch_s,
            host: 0,
            others: Vec::new(),
            rate_hz: 1,
            log: ReplicaLog::default(),
            outbox: Outbox::default(),
            outgoing: Default::default(),
            events: Default::default(),
            entropy,
            ended: false,
        };
        core.address = core.draw();
        let member = Member::new(&mut core, now_us);
        Station {
            core,
            phase: StationPhase::Follows(Box::new(member)),
            election: None,
            among: Among::default(),
            look: None,
            known: 1,
            heard_host_us: 0,
        }
    }

    /// The first host of a sculpture, whose world is at `tick`.
    pub fn host(
        identity: Identity,
        members: SignedMembership,
        rate_hz: u32,
        tick: u64,
        now_us: u64,
    ) -> Station {
        let mut station = Station::of(identity, now_us);
        station.begin_to_host(members, rate_hz, tick, now_us);
        station
    }

    /// Somebody who joins whoever hosts. `sculpture`: which, where several have one name.
    pub fn join(identity: Identity, sculpture: Option<u32>, now_us: u64) -> Station {
        let mut station = Station::of(identity, now_us);
        if let StationPhase::Follows(member) = &mut station.phase {
            member.wanted = sculpture;
        }
        station
    }

    /// A station of the owner: it joins the host. If there is none, it reports
    /// [`Event::NobodyHosts`], and [`Station::begin_to_host`] may follow.
    pub fn join_or_host(identity: Identity, now_us: u64) -> Station {
        let mut station = Station::of(identity, now_us);
        station.look = Some(HostSearch::begin(now_us));
        station
    }

    /// Begins to share a sculpture, whose world is at `tick`.
    pub fn begin_to_host(
        &mut self,
        members: SignedMembership,
        rate_hz: u32,
        tick: u64,
        now_us: u64,
    ) {
        self.look = None;
        let core = &mut self.core;
        core.take_members(members);
        (core.rate_hz, core.sculpture, core.begun_s) = (rate_hz, core.draw(), core.now_s(now_us));
        core.log = ReplicaLog::at(0, tick, Vec::new(), Vec::new());
        let term = Term { number: 1, base: 0, host: core.address };
        self.phase = StationPhase::Hosts(Box::new(Host::new(core, term, now_us)));
    }

    /// Takes a list of members from its owner, and sees that the host has it.
    pub fn take_members(&mut self, members: SignedMembership, now_us: u64) {
        match &mut self.phase {
            StationPhase::Hosts(host) => host.take_members(&mut self.core, members, now_us),
            StationPhase::Follows(_) => {
                self.core.take_members(members);
            }
        }
    }

    /// Other sculptures that are shared under the same name.
    pub fn others(&self) -> &[OtherSculpture] {
        &self.core.others
    }

    /// The number of the sculpture; 0: not known yet.
    pub fn sculpture(&self) -> u64 {
        self.core.sculpture
    }

    /// Returns true if greetings to whoever hosts are for this station too.
    pub fn hears_greetings(&self) -> bool {
        self.hosts() || self.look.is_some()
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
        let first = self.core.outbox.next_command();
        self.submit_numbered(samples, commands, first, now_us);
    }

    /// As [`Station::submit`]; the commands are numbered from `first` on.
    pub fn submit_numbered(
        &mut self,
        samples: Vec<Sample>,
        commands: Vec<Command>,
        first: u64,
        now_us: u64,
    ) {
        if self.core.person == 0 || self.core.role == Role::Viewer {
            return;
        }
        self.core.outbox.push(samples, commands, first);
        if let StationPhase::Follows(member) = &mut self.phase {
            member.hurry(now_us);
        }
    }

    /// Returns the numbers of the local commands in a frame that is about to be stepped, and of
    /// those that the host refused.
    pub fn own_commands(&mut self, frame: &Frame) -> (Vec<u64>, Vec<u64>) {
        let (mut own, mut refused) = (Vec::new(), Vec::new());
        for batch in frame.batches.iter().filter(|b| b.person == self.core.person) {
            let numbers = self.core.outbox.take_numbers(batch.number);
            let is_whole = numbers.end - numbers.start == batch.commands.len() as u64;
            if is_whole { &mut own } else { &mut refused }.extend(numbers);
        }
        (own, refused)
    }

    /// Own commands with lower numbers are stepped, or lost.
    pub fn waiting_from(&mut self) -> u64 {
        let applied = self.core.log.applied(self.core.person);
        self.core.outbox.waiting_from(applied)
    }

    /// The last local batch that the others have. A device sees no order: the host's word counts.
    fn delivered(&self) -> u64 {
        let acknowledged = self.core.outbox.acknowledged();
        match &self.phase {
            StationPhase::Follows(m) if self.core.role == Role::Device => m.received(),
            _ => self.core.log.applied(self.core.person).max(acknowledged),
        }
    }

    /// The number of local batches that the others are not known to have.
    pub fn waiting(&self) -> u64 {
        self.core.outbox.count_after(self.delivered()) as u64
    }

    /// Takes the local batches that are not in the own world, each with the number of its first
    /// command.
    pub fn take_unstepped(&mut self) -> Vec<(Batch, u64)> {
        let stepped = match self.core.role {
            Role::Device => self.core.outbox.last(),
            _ => self.core.log.applied(self.core.person),
        };
        self.core.outbox.take_after(stepped)
    }

    /// The person whose daemon hosts; 0: unknown.
    pub fn host_person(&self) -> PersonId {
        self.core.host
    }

    /// Returns true if the station was sent away.
    pub fn has_ended(&self) -> bool {
        self.core.ended
    }

    /// Returns true if the host is heard.
    pub fn hears_host(&self) -> bool {
        matches!(&self.phase, StationPhase::Follows(m) if m.follows() && !m.lost)
    }

    /// Takes a datagram; whatever its bytes are.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) {
        let Some((kind, rest)) = bytes.split_first() else { return };
        let Some((from, body)) = rest.split_first_chunk::<8>() else { return };
        let from = Address::from_le_bytes(*from);
        if from == self.core.address || self.core.ended {
            return;
        }
        match (*kind, &mut self.phase) {
            (GREETING, phase) => {
                let Ok(greeting) = Greeting::from_bytes(body) else { return };
                match phase {
                    StationPhase::Hosts(host) => {
                        if host.greeting(&mut self.core, from, &greeting, now_us) {
                            self.step_down(now_us);
                        }
                    }
                    StationPhase::Follows(m) => {
                        m.greeting(&mut self.core, from, &greeting, now_us);
                        self.greeted_while_looking(from, &greeting, now_us);
                    }
                }
            }
            (UP, StationPhase::Hosts(host)) => host.receive(&mut self.core, from, body, now_us),
            (DOWN, StationPhase::Follows(member)) => {
                member.receive(&mut self.core, from, body, now_us)
            }
            (HEIRS, _) => self.among_heirs(body, now_us),
            _ => {}
        }
    }

    /// Another host of the same sculpture stays: this one joins it, and sends its members there.
    fn step_down(&mut self, now_us: u64) {
        let core = &mut self.core;
        core.note("another host of this sculpture stays: joining it");
        if let StationPhase::Hosts(host) = &mut self.phase {
            host.step_down(core);
        }
        core.events.push_back(Event::Hosting(false));
        let mut member = Member::new(core, now_us);
        member.level = true;
        self.phase = StationPhase::Follows(Box::new(member));
        self.election = None;
    }

    /// Who looks for a host hears of another who does: one of them hosts.
    fn greeted_while_looking(&mut self, from: Address, greeting: &Greeting, now_us: u64) {
        let StationPhase::Follows(member) = &self.phase else { return };
        let (Some(look), core) = (&mut self.look, &mut self.core) else { return };
        match greeting {
            Greeting::Hello(hello) if !look.claimed => {
                let own = Invitation::member_key(&core.invitation);
                let is_own = hello.key == own.key.name() && is_genuine(hello, from, &own);
                if is_own && (hello.claims || from < core.address) {
                    look.sees_a_sign(now_us);
                }
            }
            Greeting::Refused(refusal) if member.is_in_no_list(core, from, refusal, now_us) => {
                core.end(
                    "this sculpture is shared on this network already, and its host says that the \
                     key in the folder was withdrawn: ask its owner for an invitation",
                );
            }
            Greeting::Refused(_) => look.is_refused(),
            _ => {}
        }
    }

    fn among_heirs(&mut self, sealed: &[u8], now_us: u64) {
        let Some(group) = &self.core.group else {
            // Not for this station yet, but somebody hosts, or is about to take over.
            self.look.iter_mut().for_each(|look| look.sees_a_sign(now_us));
            return;
        };
        let opened = sealed.split_first_chunk::<8>().and_then(|(stream, sealed)| {
            group.heirs_seal(u64::from_le_bytes(*stream)).open(sealed)
        });
        let Some(Ok(message)) = opened.map(|p| AmongHeirs::from_bytes(&p)) else { return };
        self.among.heard.take(message.challenge, now_us);
        let own = self.among.challenge;
        let is_answer = own != 0 && message.heard.contains(&own);
        let core = &mut self.core;
        match (message.word, &mut self.phase) {
            (HeirsWord::Candidate { .. } | HeirsWord::Who, StationPhase::Hosts(host)) => {
                host.present(message.challenge, now_us);
            }
            (HeirsWord::Host { .. }, StationPhase::Hosts(_)) => {}
            (HeirsWord::Host { term }, StationPhase::Follows(member)) => {
                if !is_answer {
                    // It may be a recorded one: it is asked.
                    let is_news = self.election.is_some() || term > member.term;
                    if is_news && now_us >= self.among.asked_us + ASK_US {
                        self.among.asked_us = now_us;
                        if self.election.is_none() {
                            self.among.challenge = core.draw();
                        }
                        self.among.say(core, HeirsWord::Who, now_us);
                    }
                    return;
                }
                self.known = self.known.max(term.number);
                if term >= member.term {
                    self.heard_host_us = now_us;
                    member.vouched(now_us);
                    if term > member.term && (member.follows() || self.election.is_some()) {
                        member.greet(core, now_us);
                    }
                    self.election = None;
                }
            }
            (HeirsWord::Who, StationPhase::Follows(_)) => {}
            (HeirsWord::Candidate { known, reached, by }, StationPhase::Follows(member)) => {
                // One way of several stands still: who hears the host vouches for it.
                if member.hears_host(now_us) {
                    let term = member.term;
                    self.among.say(core, HeirsWord::Host { term }, now_us);
                }
                if !is_answer {
                    return;
                }
                self.known = self.known.max(known);
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
        if self.core.ended {
            return;
        }
        self.look_for_host(now_us);
        match &mut self.phase {
            StationPhase::Hosts(host) => host.advance(&mut self.core, now_us),
            StationPhase::Follows(member) => {
                member.advance(&mut self.core, now_us);
                let may = member.level && self.core.group.is_some() && self.core.members.is_some();
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

    /// Who looks for a host and finds none may host.
    fn look_for_host(&mut self, now_us: u64) {
        let (Some(look), StationPhase::Follows(member)) = (&mut self.look, &mut self.phase) else {
            return;
        };
        if !member.is_unanswered() {
            if self.core.person != 0 {
                self.look = None;
                self.core.events.push_back(Event::Hosting(false));
            }
        } else if look.ends(now_us) {
            member.claim(&mut self.core, now_us);
            self.core.events.push_back(Event::NobodyHosts);
        }
    }

    fn begin_election(&mut self, now_us: u64) {
        let best = (self.core.log.reached(), self.core.address);
        let mut is_long = false;
        if let StationPhase::Follows(member) = &self.phase {
            is_long = member.is_far();
            self.known = self.known.max(member.term.number);
        }
        let until_us = now_us + if is_long { DECIDE_US.1 } else { DECIDE_US.0 };
        self.heard_host_us = now_us;
        self.among.challenge = self.core.draw();
        self.election = Some(Election { until_us, next_us: now_us, best, decided: false });
    }

    fn elect(&mut self, now_us: u64) {
        let Some(election) = &mut self.election else { return };
        if now_us >= election.next_us && !election.decided {
            election.next_us = now_us + CANDIDATE_US;
            let (known, reached) = (self.known, self.core.log.reached());
            let word = HeirsWord::Candidate { known, reached, by: self.core.address };
            self.among.say(&mut self.core, word, now_us);
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
        let host = Host::new(&mut self.core, term, now_us);
        self.phase = StationPhase::Hosts(Box::new(host));
        if let StationPhase::Hosts(host) = &mut self.phase {
            host.advance(&mut self.core, now_us);
        }
    }

    /// The next datagram to be sent, and whom it is for.
    pub fn take_outgoing(&mut self) -> Option<Outgoing> {
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

    /// The own world was made of a checkpoint, and is at this tick.
    pub fn restored(&mut self, tick: u64) {
        self.core.log.begin_at(tick);
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

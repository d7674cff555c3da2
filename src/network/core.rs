//! State of a station in every phase: its log, its batches, and the waiting messages and events.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::keyring::{Entropy, Invitation};
use crate::membership::SignedMembership;
use crate::outbox::Outbox;
use crate::replica_log::ReplicaLog;
use crate::seal::Secret;
use crate::wire::frame::{Arrival, Frame, PersonId, Role};
use crate::wire::greeting::Greeting;
use crate::wire::message::{Address, AmongHeirs, FromHost, FromMember, Nonce};

/// Microseconds between two messages to one receiver while something happens.
pub const SEND_US: u64 = 50_000;
/// The same while nothing does.
pub const IDLE_US: u64 = 250_000;
/// After so long without a word from the host it is gone, where nobody else hears it.
pub const LOST_US: u64 = 1_000_000;

/// Whom a datagram is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum To {
    /// Whoever hosts.
    Host,
    /// All who may take over.
    Heirs,
    /// One process.
    Peer(Address),
    /// One process, behind all that is not so: much of it may wait.
    Bulk(Address),
}

/// A datagram on its way.
#[derive(Debug, Clone)]
pub struct Outgoing {
    /// Whom it is for.
    pub to: To,
    /// Kind of its message, for the log: the network sees only sealed bytes.
    pub kind: &'static str,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// Events that a station reports to its caller.
#[derive(Debug, Clone)]
pub enum Event {
    /// The next frame to be stepped.
    Frame(Arc<Frame>),
    /// The next bytes of a checkpoint, as [`sculptd_engine::checkpoint::Captured::write`] made
    /// them.
    RestorePart {
        /// True for the first part: earlier bytes belong to another checkpoint.
        first: bool,
        /// The bytes.
        bytes: Vec<u8>,
    },
    /// Rebuild the world from the received checkpoint; frames from the one after `index` follow.
    Restore {
        /// The frame of the checkpoint.
        index: u64,
    },
    /// The station's person has this number, and the loop this rate.
    Entered {
        /// The number.
        person: PersonId,
        /// Ticks a second.
        rate_hz: u32,
    },
    /// This station hosts from now on, or no longer.
    Hosting(bool),
    /// This station looked for a host, and there is none: it may host.
    NobodyHosts,
    /// The own world differs from the host's after a frame; a checkpoint will follow.
    Differs {
        /// The frame.
        index: u64,
        /// The own hash and the host's.
        hashes: (u64, u64),
    },
    /// For the log, and for a person.
    Note(String),
    /// The host lets this station in no more; nothing follows.
    Refused(String),
}

/// Another sculpture of the same name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OtherSculpture {
    /// Its number.
    pub sculpture: u64,
    /// Number of people who are connected.
    pub here: u8,
    /// Seconds since it was first shared.
    pub age_s: u32,
}

impl std::fmt::Display for OtherSculpture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (people, minutes) = (self.here, self.age_s / 60);
        let people = if people == 1 { "1 person".into() } else { format!("{people} people") };
        write!(f, "{:08x} ({people}, since {minutes} min)", short_number(self.sculpture))
    }
}

/// The number of a sculpture as a person sees and types it.
pub fn short_number(sculpture: u64) -> u32 {
    (sculpture >> 32) as u32
}

/// The parts that all phases share.
pub struct Core {
    /// The own name on the network.
    pub address: Address,
    /// As the person wants to be called.
    pub name: String,
    /// Role of the person.
    pub role: Role,
    /// The own number; 0 before the first entry.
    pub person: PersonId,
    /// The key with which the station greets and hosts.
    pub invitation: Invitation,
    /// The newest list of members that the station knows.
    pub members: Option<SignedMembership>,
    /// For those who may take over: the key of the group.
    pub group: Option<Secret>,
    /// The sculpture; 0: not known yet.
    pub sculpture: u64,
    /// Time at which the sculpture was first shared, in seconds since 1970.
    pub begun_s: u64,
    /// Seconds since 1970 at time 0.
    pub epoch_s: u64,
    /// The person whose daemon hosts; 0: unknown.
    pub host: PersonId,
    /// Other sculptures that are shared under the same name.
    pub others: Vec<OtherSculpture>,
    /// Ticks a second.
    pub rate_hz: u32,
    /// The ordered input.
    pub log: ReplicaLog,
    /// The own input.
    pub outbox: Outbox,
    /// Messages to send, in order.
    pub outgoing: VecDeque<Outgoing>,
    /// Events to report, in order.
    pub events: VecDeque<Event>,
    /// Random bytes.
    pub entropy: Entropy,
    /// The station was sent away: nothing follows.
    pub ended: bool,
}

impl std::fmt::Debug for Core {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Core").field("name", &self.name).field("log", &self.log.reached()).finish()
    }
}

/// Reason for sending away a person whose invitation was withdrawn.
pub const ENDED: &str = "the invitation was withdrawn";

/// Seals messages among the possible successors, under a separate key, so that no two messages of
/// the group share a nonce.
#[derive(Debug)]
pub struct HeirsSeal {
    stream: u64,
    seal: crate::seal::Seal,
}

impl HeirsSeal {
    /// A seal with a key that is drawn for it.
    pub fn new(group: &Secret, core: &mut Core) -> HeirsSeal {
        let stream = core.draw();
        HeirsSeal { stream, seal: group.heirs_seal(stream) }
    }
}

/// The first byte of a datagram; the sender's address follows it.
pub const GREETING: u8 = 0;
/// See [`GREETING`].
pub const UP: u8 = 1;
/// See [`GREETING`].
pub const DOWN: u8 = 2;
/// See [`GREETING`].
pub const HEIRS: u8 = 3;

impl Core {
    /// Tells something to the log.
    pub fn note(&mut self, text: impl Into<String>) {
        self.events.push_back(Event::Note(text.into()));
    }

    /// Ends the station's part: it is let in no more.
    pub fn end(&mut self, why: impl Into<String>) {
        self.ended = true;
        self.events.push_back(Event::Refused(why.into()));
    }

    /// The arrival of the station's person.
    pub fn arrival(&self) -> Arrival {
        let (person, name, role) = (self.person, self.name.clone(), self.role);
        Arrival { person, name, role, here: true }
    }

    /// Seconds since 1970.
    pub fn now_s(&self, now_us: u64) -> u64 {
        self.epoch_s + now_us / 1_000_000
    }

    /// Draws a number that is not 0.
    pub fn draw(&mut self) -> u64 {
        let mut bytes = [0; 8];
        (self.entropy)(&mut bytes);
        u64::from_le_bytes(bytes).max(1)
    }

    /// Takes a list of members if it is newer than what is known.
    pub fn take_members(&mut self, members: SignedMembership) -> bool {
        let is_newer = members.list().version > self.members_version();
        if is_newer {
            self.members = Some(members);
        }
        is_newer
    }

    /// Checks that the list admits the key of this name for a person and a role now.
    ///
    /// # Errors
    /// The text gives the reason.
    pub fn admits(&self, key: &[u8; 8], name: &str, role: Role, now_us: u64) -> Result<(), String> {
        let found = self.members.as_ref().and_then(|m| m.list().find(key));
        let member_key = found.ok_or_else(|| ENDED.to_owned())?;
        member_key.allows(name, role, self.now_s(now_us))
    }

    /// The version of the newest list of members that is known; 0: none.
    pub fn members_version(&self) -> u64 {
        self.members.as_ref().map_or(0, |m| m.list().version)
    }

    /// A number that is used once.
    pub fn nonce(&mut self) -> Nonce {
        let mut nonce = [0; 16];
        (self.entropy)(&mut nonce);
        nonce
    }

    /// Sends bytes with their head. `kind`: see [`Outgoing`].
    pub fn send(&mut self, to: To, head: u8, kind: &'static str, bytes: &[u8]) {
        let mut out = Vec::with_capacity(bytes.len() + 9);
        out.push(head);
        out.extend(self.address.to_le_bytes());
        out.extend(bytes);
        self.outgoing.push_back(Outgoing { to, kind, bytes: out });
    }

    /// Sends in the clear.
    pub fn greet(&mut self, to: To, greeting: &Greeting) {
        self.send(to, GREETING, greeting.kind(), &greeting.to_bytes());
    }

    /// Sends to the host.
    pub fn up(&mut self, host: Address, seal: &mut crate::seal::Seal, message: &FromMember) {
        let sealed = seal.seal(&message.to_bytes());
        self.send(To::Peer(host), UP, message.kind(), &sealed);
    }

    /// Sends to a member.
    pub fn down(&mut self, member: Address, seal: &mut crate::seal::Seal, message: &FromHost) {
        let sealed = seal.seal(&message.to_bytes());
        self.send(To::Peer(member), DOWN, message.kind(), &sealed);
    }

    /// Sends to all who may take over.
    pub fn among_heirs(&mut self, heirs: &mut HeirsSeal, message: &AmongHeirs) {
        let mut bytes = heirs.stream.to_le_bytes().to_vec();
        bytes.extend(heirs.seal.seal(&message.to_bytes()));
        self.send(To::Heirs, HEIRS, message.word.kind(), &bytes);
    }

    /// Appends a frame to the log and hands it over to be stepped.
    pub fn append(&mut self, frame: Arc<Frame>) -> bool {
        let next = self.log.append(&frame);
        if next {
            self.events.push_back(Event::Frame(frame));
        }
        next
    }
}

/// The clock as messages carry it.
pub fn ms(now_us: u64) -> u32 {
    (now_us / 1000) as u32
}

/// Follows the other side's clock, and how long a message and its answer take.
#[derive(Debug, Clone, Copy, Default)]
pub struct RoundTrip {
    theirs_ms: u32,
    at_us: u64,
    smooth_us: f64,
}

impl RoundTrip {
    /// Takes the clocks of a message.
    pub fn take(&mut self, sent_ms: u32, echo_ms: u32, now_us: u64) {
        if self.at_us == 0 || sent_ms.wrapping_sub(self.theirs_ms) < 1 << 31 {
            (self.theirs_ms, self.at_us) = (sent_ms, now_us);
        }
        let took = ms(now_us).wrapping_sub(echo_ms);
        if echo_ms != 0 && took < 10_000 {
            let took = f64::from(took) * 1e3;
            self.smooth_us = match self.smooth_us {
                s if s > 0.0 => s * 0.9 + took * 0.1,
                _ => took,
            };
        }
    }

    /// The other side's clock as it is now: comes back to it as an echo. 0: never heard.
    pub fn echo_ms(&self, now_us: u64) -> u32 {
        match self.at_us {
            0 => 0,
            at => self.theirs_ms.wrapping_add(ms(now_us.saturating_sub(at))),
        }
    }

    /// Returns true if a message and its answer take longer than a fifth of the silence after which
    /// a host counts as lost.
    pub fn is_long(&self) -> bool {
        self.smooth_us > LOST_US as f64 / 5.0
    }

    /// Returns the time without a confirmation after which a message is sent again, in
    /// microseconds.
    pub fn patience_us(&self) -> u64 {
        // Both sides send at intervals: a confirmation waits for the next message.
        (self.smooth_us * 1.5) as u64 + 2 * SEND_US + 60_000
    }
}

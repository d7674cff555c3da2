//! A member: greets, is admitted, fetches a checkpoint if it needs one, then follows the host's
//! frames and sends its input.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::core::{Core, Event, IDLE_US, LOST_US, RoundTrip, SEND_US, ms, short_number};
use crate::door::NOT_IN_LIST;
use crate::handshake::{HostOffer, OwnHello};
use crate::host_limits::{BYTES, HERE_ALREADY, LARGE_SHARE, MEMBERS_US};
use crate::membership::SignedMembership;
use crate::rate_limit::RateLimit;
use crate::replica_log::ReplicaLog;
use crate::seal::{Seal, Secret};
use crate::wire::frame::{Frame, Role};
use crate::wire::frame_codec::frames_from_bytes;
use crate::wire::greeting::{Greeting, Refusal};
use crate::wire::message::{Address, Entry, FromHost, FromMember, NOT_ENTERED, Term};

/// Between two greetings.
const GREET_US: u64 = 200_000;
/// Who joins for the first time waits so long for the answers of other hosts after the first one.
const COLLECT_US: u64 = 300_000;
/// Hosts whose answers are kept.
const MAX_OFFERS: usize = 16;
/// Chunks that are on their way at once: 8 MiB.
const WINDOW: u32 = 256;
/// While a checkpoint comes, a word at least so often, and silence for so long is an end: what
/// carries it may stand still for a while, and what is asked for again then comes twice.
const FETCHING_US: (u64, u64) = (1_000_000, 12_000_000);
/// Silence after which a host is greeted again although others vouch for it, in microseconds.
const UNHEARD_US: u64 = 5 * LOST_US;
/// Greatest number of gaps requested again at once.
const MAX_GAPS: usize = 16;
/// Time without any chunk after which missing ones are requested again, in microseconds. The
/// transport loses none unless it is reconnected, and pauses now and then.
const CHUNK_US: u64 = 10_000_000;
/// Frames that wait for one before them.
const MAX_EARLY: usize = 4096;

/// Progress of a member.
#[derive(Debug)]
enum MemberPhase {
    /// Says hello to whoever hosts.
    Greets { hello: Box<OwnHello>, next_us: u64, offers: Vec<HostOffer>, decide_us: u64 },
    /// Asks to be let in.
    Joins { next_us: u64, tries: u32 },
    /// Fetches a checkpoint.
    Fetches(Box<Fetch>),
    /// Follows.
    Follows,
}

impl MemberPhase {
    fn greets(core: &mut Core, claims: bool, now_us: u64) -> MemberPhase {
        let hello = Box::new(OwnHello::draw(core, claims));
        MemberPhase::Greets { hello, next_us: now_us, offers: Vec::new(), decide_us: u64::MAX }
    }
}

/// A checkpoint on its way.
#[derive(Debug)]
struct Fetch {
    entry: Entry,
    index: u64,
    /// The first chunk that is not here; those before it were handed on.
    next: u32,
    early: BTreeMap<u32, Vec<u8>>,
    /// Chunks up to this one were asked for.
    asked: u32,
    /// The last one, once it is known.
    last: Option<u32>,
    /// Time of the last arrival or repeated request.
    progress_us: u64,
    /// Time of the last message to the host.
    spoke_us: u64,
}

/// A member's state.
#[derive(Debug)]
pub struct Member {
    phase: MemberPhase,
    /// The sculpture that is wanted, as [`short_number`] names it, where several have one name.
    pub wanted: Option<u32>,
    /// It hosts unless somebody does.
    pub claims: bool,
    /// The version of the host's list of members, and when it was sent a newer one.
    host_knows: (u64, u64),
    /// Bytes that the host takes of what is large.
    budget: RateLimit,
    host: Address,
    /// The host's turn.
    pub term: Term,
    seals: Option<(Seal, Seal)>,
    heard_us: u64,
    /// Time at which another member reported that this host is alive.
    vouched_us: u64,
    early: BTreeMap<u64, Arc<Frame>>,
    /// A checkpoint that was broken off: it goes on where the host has it still.
    broken_off: Option<Box<Fetch>>,
    received: u64,
    trip: RoundTrip,
    next_us: u64,
    /// The own world is that of the log: it may be continued, and may take over.
    pub level: bool,
    hashes: BTreeMap<u64, u64>,
    begun_us: u64,
    /// The host has been silent for too long.
    pub lost: bool,
    told: Option<String>,
}

impl Member {
    /// A member that greets at once.
    pub fn new(core: &mut Core, now_us: u64) -> Member {
        Member {
            phase: MemberPhase::greets(core, false, now_us),
            wanted: None,
            claims: false,
            host_knows: (0, 0),
            budget: budget(now_us),
            host: 0,
            term: Term::default(),
            seals: None,
            heard_us: now_us,
            vouched_us: 0,
            early: BTreeMap::new(),
            broken_off: None,
            received: 0,
            trip: RoundTrip::default(),
            next_us: now_us,
            level: false,
            hashes: BTreeMap::new(),
            begun_us: now_us,
            lost: false,
            told: None,
        }
    }

    /// Returns true if it follows a host.
    pub fn follows(&self) -> bool {
        matches!(self.phase, MemberPhase::Follows)
    }

    /// All local batches up to this one have reached the host.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// Returns true if a message to the host and its answer take long.
    pub fn is_far(&self) -> bool {
        self.trip.is_long()
    }

    /// Returns true if a host, known by its key, refuses the present greeting because its key is
    /// in no list.
    pub fn is_in_no_list(&self, core: &Core, from: Address, said: &Refusal, now_us: u64) -> bool {
        let MemberPhase::Greets { hello, .. } = &self.phase else { return false };
        said.reason == NOT_IN_LIST && hello.is_refused(core, from, said, now_us)
    }

    /// Returns true if nobody has answered its greetings.
    pub fn is_unanswered(&self) -> bool {
        matches!(&self.phase, MemberPhase::Greets { offers, .. } if offers.is_empty())
    }

    /// From now on its greetings say that it is about to host.
    pub fn claim(&mut self, core: &mut Core, now_us: u64) {
        self.claims = true;
        self.greet(core, now_us);
    }

    /// Returns true if the host is alive for certain: it was heard just now.
    pub fn hears_host(&self, now_us: u64) -> bool {
        self.follows() && now_us < self.heard_us + LOST_US / 2
    }

    /// Notes that another member still hears this host: only the local connection is stalled.
    pub fn vouched(&mut self, now_us: u64) {
        self.vouched_us = now_us;
        self.lost = false;
    }

    /// Restarts with a greeting.
    pub fn greet(&mut self, core: &mut Core, now_us: u64) {
        let greets = MemberPhase::greets(core, self.claims, now_us);
        if let MemberPhase::Fetches(fetch) = std::mem::replace(&mut self.phase, greets) {
            self.broken_off = Some(fetch);
        }
        self.seals = None;
        self.early.clear();
        self.heard_us = now_us;
    }

    /// Takes an answer to a greeting.
    pub fn greeting(&mut self, core: &mut Core, from: Address, greeting: &Greeting, now_us: u64) {
        let MemberPhase::Greets { hello, offers, decide_us, .. } = &mut self.phase else { return };
        match greeting {
            Greeting::Challenge(answer) => {
                let Some(offer) = hello.check(core, from, answer, now_us) else { return };
                let is_known = offers.iter().any(|o| o.from == from);
                if is_known || offers.len() >= MAX_OFFERS {
                    return;
                }
                let version = offer.members.list().version;
                let own = core.sculpture != 0 && core.sculpture == offer.about.sculpture;
                // Its own sculpture, as far as it knows it or further.
                let continues = own && (version, offer.term) >= (self.host_knows.0, self.term);
                if own && !continues {
                    return;
                }
                offers.push(offer);
                *decide_us = if continues { 0 } else { (*decide_us).min(now_us + COLLECT_US) };
                self.decide(core, now_us);
            }
            // Anybody may have said it, so the greetings go on.
            Greeting::Refused(refusal) if hello.is_answered_by(&refusal.to) => {
                self.not_let_in(core, &refusal.reason);
            }
            _ => {}
        }
    }

    /// Joins one of the hosts that have answered, once it was waited for others.
    fn decide(&mut self, core: &mut Core, now_us: u64) {
        let MemberPhase::Greets { offers, decide_us, .. } = &self.phase else { return };
        if now_us < *decide_us || offers.is_empty() {
            return;
        }
        let wanted = |o: &&HostOffer| match (core.sculpture, self.wanted) {
            (0, None) => true,
            (0, Some(number)) => short_number(o.about.sculpture) == number,
            (own, _) => o.about.sculpture == own,
        };
        let fits: Vec<&HostOffer> = offers.iter().filter(wanted).collect();
        let Some(first) = fits.first() else {
            let why = match self.wanted.filter(|_| core.sculpture == 0) {
                Some(number) => format!("there is no sculpture {number:08x} of this name"),
                None => "the sculpture that is shared under this name now is another one".into(),
            };
            self.not_let_in(core, &why);
            return self.greet(core, now_us);
        };
        if fits.iter().any(|o| o.about.sculpture != first.about.sculpture) {
            let mut all: Vec<String> = fits.iter().map(|o| o.about.to_string()).collect();
            all.sort();
            all.dedup();
            return core.end(format!(
                "{} sculptures are shared under this name: {}. Name one with --sculpture NUMBER",
                all.len(),
                all.join(", ")
            ));
        }
        let best = fits.into_iter().max_by_key(|o| (o.members.list().version, o.term)).cloned();
        let greets = MemberPhase::Joins { next_us: now_us, tries: 0 };
        let MemberPhase::Greets { hello, .. } = std::mem::replace(&mut self.phase, greets) else {
            return;
        };
        let Some((offer, seals)) = best.and_then(|o| Some((o.clone(), hello.accept(&o)?))) else {
            return self.greet(core, now_us);
        };
        self.seals = Some(seals);
        (self.host, self.term) = (offer.from, offer.term);
        self.host_knows = (offer.members.list().version, 0);
        if core.sculpture == 0 {
            core.sculpture = offer.about.sculpture;
            core.begun_s = core.now_s(now_us).saturating_sub(u64::from(offer.about.age_s));
        }
        core.take_members(offer.members);
        self.heard_us = now_us;
        self.claims = false;
        self.advance(core, now_us);
    }

    /// Tells a reason once.
    fn not_let_in(&mut self, core: &mut Core, reason: &str) {
        if self.told.as_deref() != Some(reason) {
            core.note(format!("not let in: {reason}"));
            self.told = Some(reason.into());
        }
    }

    /// Takes a sealed message of the host.
    pub fn receive(&mut self, core: &mut Core, from: Address, sealed: &[u8], now_us: u64) {
        let Some((_, down)) = self.seals.as_mut().filter(|_| from == self.host) else { return };
        let Some(plain) = down.open(sealed) else { return };
        let Ok(message) = FromHost::from_bytes(&plain) else {
            return core.note("the host sends what is no message; it is ignored");
        };
        (self.heard_us, self.lost) = (now_us, false);
        match message {
            FromHost::Entry(entry) => self.enter(core, entry, now_us),
            FromHost::Refused(why) => {
                if why.ends_with("join again") {
                    self.level = false;
                    return self.greet(core, now_us);
                }
                // Somebody who was here a moment ago is back before that was noticed.
                let soon = core.person == 0 && now_us < self.begun_us + 3 * LOST_US;
                if soon && why.ends_with(HERE_ALREADY) {
                    self.not_let_in(core, &why);
                    return self.greet(core, now_us);
                }
                core.end(why);
            }
            FromHost::Members { members, group } => {
                let owner = core.invitation.owner;
                let Ok(members) = SignedMembership::from_bytes(&members, &owner) else { return };
                let version = members.list().version;
                if version < self.host_knows.0 {
                    return;
                }
                self.host_knows = (version, 0);
                core.take_members(members);
                core.group = group.map(Secret);
                if let Some((up, _)) = &mut self.seals {
                    core.up(self.host, up, &FromMember::KnowsMembers(version));
                }
            }
            FromHost::Down { received, acknowledged, sent_ms, echo_ms, frames } => {
                self.trip.take(sent_ms, echo_ms, now_us);
                if self.follows() {
                    self.received = self.received.max(received);
                    core.outbox.acknowledge(acknowledged);
                    match frames_from_bytes(&frames, &core.log) {
                        Ok(Some(frames)) => frames.into_iter().for_each(|frame| {
                            self.take_frame(core, Arc::new(frame));
                        }),
                        // The frames that these build on were lost, and are sent again.
                        Ok(None) => {}
                        Err(_) => core.note("the host sends what are no frames; it is ignored"),
                    }
                }
            }
            FromHost::Chunk { index, number, last, bytes } => {
                self.chunk(core, index, (number, last), bytes, now_us)
            }
            FromHost::Differs { index, hash } => {
                let own = self.hashes.get(&index).copied().unwrap_or_default();
                core.events.push_back(Event::Differs { index, hashes: (own, hash) });
                self.level = false;
                self.greet(core, now_us);
            }
        }
    }

    fn enter(&mut self, core: &mut Core, entry: Box<Entry>, now_us: u64) {
        if !matches!(self.phase, MemberPhase::Joins { .. }) {
            return;
        }
        self.told = None;
        core.rate_hz = entry.rate_hz.max(1);
        if core.person != entry.person || !self.level {
            let (person, rate_hz) = (entry.person, core.rate_hz);
            core.events.push_back(Event::Entered { person, rate_hz });
        }
        core.person = entry.person;
        core.group = entry.group.map(Secret);
        match entry.offer {
            None => {
                if core.role == Role::Device {
                    core.log = ReplicaLog::at(0, 0, entry.turns.clone(), entry.people.clone());
                } else {
                    core.log.set_turns(entry.turns.clone());
                }
                self.follow(core, &entry, now_us);
            }
            Some(index) => {
                self.level = false;
                // Another host's checkpoint of that frame has other bytes.
                let same = |f: &Fetch| f.index == index && f.entry.term == entry.term;
                let known = self.broken_off.take().filter(|f| same(f));
                let (next, early, last) =
                    known.map(|f| (f.next, f.early, f.last)).unwrap_or_default();
                let fetch = Fetch {
                    entry: *entry,
                    index,
                    next,
                    early,
                    asked: next,
                    last,
                    progress_us: now_us,
                    spoke_us: now_us,
                };
                self.phase = MemberPhase::Fetches(Box::new(fetch));
                self.advance(core, now_us);
            }
        }
    }

    fn follow(&mut self, core: &mut Core, entry: &Entry, now_us: u64) {
        core.outbox.begin_after(entry.applied);
        self.received = entry.applied;
        self.phase = MemberPhase::Follows;
        self.level = core.role != Role::Device;
        self.trip = RoundTrip::default();
        (self.heard_us, self.next_us, self.lost) = (now_us, now_us, false);
        self.budget = budget(now_us);
        core.host = entry.host;
        let host = entry.people.iter().map(|p| p.0.name.as_str()).collect::<Vec<_>>().join(", ");
        core.note(format!("joined turn {}; people so far: {host}", entry.term.number));
    }

    fn chunk(
        &mut self,
        core: &mut Core,
        index: u64,
        (number, last): (u32, bool),
        bytes: Vec<u8>,
        now_us: u64,
    ) {
        let MemberPhase::Fetches(fetch) = &mut self.phase else { return };
        if index != fetch.index || !(fetch.next..fetch.asked).contains(&number) {
            return;
        }
        if last {
            fetch.last = Some(number);
        }
        fetch.early.insert(number, bytes);
        fetch.progress_us = now_us;
        while let Some(bytes) = fetch.early.remove(&fetch.next) {
            core.events.push_back(Event::RestorePart { first: fetch.next == 0, bytes });
            fetch.next += 1;
        }
        if fetch.last.is_none_or(|last| fetch.next <= last) {
            return self.advance(core, now_us);
        }
        let MemberPhase::Fetches(fetch) = std::mem::replace(&mut self.phase, MemberPhase::Follows)
        else {
            return;
        };
        let Fetch { entry, index, .. } = *fetch;
        core.log = ReplicaLog::at(index, 0, entry.turns.clone(), entry.people.clone());
        core.events.push_back(Event::Restore { index });
        self.follow(core, &entry, now_us);
    }

    fn take_frame(&mut self, core: &mut Core, frame: Arc<Frame>) {
        if frame.index <= core.log.last() || self.early.len() >= MAX_EARLY {
            return;
        }
        self.early.insert(frame.index, frame);
        while let Some(next) = self.early.remove(&(core.log.last() + 1)) {
            if !core.append(next) {
                core.note("a frame of the host does not follow the one before it");
                self.early.clear();
                break;
            }
        }
    }

    /// Takes the hash of the local world after a frame.
    pub fn own_hash(&mut self, core: &mut Core, index: u64, hash: u64) {
        self.hashes.insert(index, hash);
        while self.hashes.len() > 64 {
            self.hashes.pop_first();
        }
        if let (MemberPhase::Follows, Some((up, _))) = (&self.phase, &mut self.seals) {
            core.up(self.host, up, &FromMember::Hash { index, hash });
        }
    }

    /// Goes.
    pub fn leave(&mut self, core: &mut Core) {
        if let Some((up, _)) = &mut self.seals {
            core.up(self.host, up, &FromMember::Leave);
        }
    }

    /// Sends what is to be sent.
    pub fn advance(&mut self, core: &mut Core, now_us: u64) {
        let silent = now_us >= self.heard_us + LOST_US;
        match &mut self.phase {
            MemberPhase::Greets { hello, next_us, .. } => {
                if now_us >= *next_us {
                    *next_us = now_us + GREET_US;
                    hello.send(core);
                }
                self.decide(core, now_us);
            }
            MemberPhase::Joins { next_us, tries } => {
                if now_us < *next_us {
                    return;
                }
                let Some((up, _)) = &mut self.seals else { return };
                // A checkpoint may take a while to be made; a silent host is another.
                (*next_us, *tries) = (now_us + GREET_US * 3, *tries + 1);
                if *tries > 1 && silent {
                    return self.greet(core, now_us);
                }
                if *tries == 1 {
                    let reached = self.level.then(|| core.log.reached());
                    let (name, role) = (core.name.clone(), core.role);
                    core.up(self.host, up, &FromMember::Join { name, role, reached });
                } else {
                    let (sent_ms, echo_ms) = (ms(now_us), self.trip.echo_ms(now_us));
                    let batches = Vec::new();
                    let have = NOT_ENTERED;
                    let up_to = FromMember::Up { have, after_gap: 0, sent_ms, echo_ms, batches };
                    core.up(self.host, up, &up_to);
                }
            }
            MemberPhase::Fetches(fetch) => {
                if now_us >= self.heard_us + FETCHING_US.1 {
                    return self.greet(core, now_us);
                }
                let Some((up, _)) = &mut self.seals else { return };
                let index = fetch.index;
                let mut ask = |chunks: std::ops::Range<u32>| {
                    let (first, count) = (chunks.start, chunks.len() as u32);
                    core.up(self.host, up, &FromMember::Want { index, first, count });
                };
                let end = fetch.last.map_or(u32::MAX, |last| last + 1).min(fetch.next + WINDOW);
                if end >= fetch.asked + WINDOW / 4 || now_us >= fetch.spoke_us + FETCHING_US.0 {
                    // Of none, too: a sign of life.
                    ask(fetch.asked..end.max(fetch.asked));
                    fetch.asked = end.max(fetch.asked);
                    fetch.spoke_us = now_us;
                }
                if now_us >= fetch.progress_us + CHUNK_US {
                    fetch.progress_us = now_us;
                    gaps(fetch).into_iter().for_each(ask);
                }
            }
            MemberPhase::Follows => {
                self.lost = silent && now_us >= self.vouched_us + LOST_US;
                if now_us >= self.heard_us + UNHEARD_US {
                    core.note("the host is there for others, and unheard of here: joining anew");
                    return self.greet(core, now_us);
                }
                core.log.trim(u64::MAX);
                if now_us < self.next_us {
                    return;
                }
                let patience = self.trip.patience_us();
                let budget = |bytes| self.budget.take(bytes as f64, now_us);
                let batches = core.outbox.due(self.received, now_us, patience, budget);
                let busy = !batches.is_empty() || core.outbox.count_after(self.received) > 0;
                let behind = !self.early.is_empty();
                self.next_us = now_us + if busy || behind { SEND_US } else { IDLE_US / 2 };
                let Some((up, _)) = &mut self.seals else { return };
                if let Some(members) = &core.members
                    && members.list().version > self.host_knows.0
                    && now_us >= self.host_knows.1 + MEMBERS_US
                {
                    self.host_knows.1 = now_us;
                    let newer = FromMember::Members(members.to_bytes());
                    core.up(self.host, up, &newer);
                }
                let message = FromMember::Up {
                    have: if core.role == Role::Device { 0 } else { core.log.last() },
                    after_gap: self.early.keys().next().copied().unwrap_or(0),
                    sent_ms: ms(now_us),
                    echo_ms: self.trip.echo_ms(now_us),
                    batches,
                };
                core.up(self.host, up, &message);
            }
        }
    }

    /// Something new waits in the outbox: it is sent when the time between two messages is over,
    /// and not when an idle member would speak.
    pub fn hurry(&mut self, now_us: u64) {
        self.next_us = self.next_us.min(now_us + SEND_US);
    }
}

fn budget(now_us: u64) -> RateLimit {
    RateLimit::new(BYTES.0 * LARGE_SHARE, BYTES.1 * LARGE_SHARE, now_us)
}

/// The chunks that were asked for and did not come, up to the newest that did.
fn gaps(fetch: &Fetch) -> Vec<std::ops::Range<u32>> {
    let mut gaps = Vec::new();
    let mut first = fetch.next;
    let end = fetch.last.map_or(fetch.asked, |last| last + 1);
    for &here in fetch.early.keys().chain([&end]) {
        if here > first && gaps.len() < MAX_GAPS {
            gaps.push(first..here);
        }
        first = here + 1;
    }
    gaps
}

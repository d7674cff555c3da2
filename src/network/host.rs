//! The host: lets people in, orders input into frames, sends them, compares hashes.
//!
//! Laws kept here:
//! * Nobody without a key gets further than a greeting ([`crate::door`]); whoever is no longer in
//!   the list of members is sent away, and the group of the heirs gets another key.
//! * A batch is acknowledged when it is in a frame that a replica has too.
//! * What a member may send is bounded in bytes a second, in batches that wait, and by its role;
//!   what goes beyond is dropped, counted and told.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::acknowledgement::Acknowledgements;
use crate::comparison::HashComparison;
use crate::core::{Core, ENDED, Event, HeirsSeal, IDLE_US, LOST_US, ms};
use crate::door::{Door, Greeted};
use crate::heirs::Heard;
use crate::held_checkpoint::{HeldCheckpoint, drop_old, is_recent, people_at};
use crate::host_limits::{
    ALONE_US, BUSY_US, GONE_US, HERE_ALREADY, MAX_MEMBERS, MEMBERS_US, PATIENCE, REST_US,
};
use crate::host_members::{
    BatchQueue, JoinedMember, PER_MESSAGE, bounded, comings, drop_silent, fill, not_admitted,
    note_departures, number_for, until_next,
};
use crate::keyring::fresh;
use crate::membership::SignedMembership;
use crate::order_hold::OrderHold;
use crate::wire::frame::{Arrival, Batch, Frame, Mark, PersonId, Role};
use crate::wire::greeting::Greeting;
use crate::wire::message::{
    Address, AmongHeirs, Entry, FromHost, FromMember, HeirsWord, NOT_ENTERED, Offer, Reached, Term,
};

/// The host's state.
#[derive(Debug)]
pub struct Host {
    /// This turn.
    pub term: Term,
    heirs: HeirsSeal,
    /// Challenges of others, and when they were heard.
    heard: Heard,
    door: Door,
    members: BTreeMap<Address, JoinedMember>,
    waiting: BTreeMap<PersonId, BatchQueue>,
    hold: OrderHold,
    arrivals: Vec<Arrival>,
    looked_us: u64,
    acknowledgements: Acknowledgements,
    /// The tick that was due at this time.
    epoch: (u64, u64),
    last_input_us: u64,
    last_frame_us: u64,
    compare_us: u64,
    input_since_compare: bool,
    comparison: HashComparison,
    /// Somebody waits for a checkpoint since.
    wanted_us: Option<u64>,
    /// The frame of the checkpoint that is being made.
    making: Option<u64>,
    /// The newest last; older ones as long as somebody fetches them.
    checkpoints: Vec<HeldCheckpoint>,
    at_rest: bool,
    alone_since_us: Option<u64>,
    present_us: u64,
}

impl Host {
    /// A host whose log is that of `core`, in a new turn.
    pub fn new(core: &mut Core, term: Term, now_us: u64) -> Host {
        core.log.begin_turn(term);
        let first = term.number == 1;
        core.person = if first { 1 } else { core.person };
        let group = core.group.get_or_insert_with(|| fresh(&mut core.entropy)).clone();
        let mut host = Host {
            term,
            heirs: HeirsSeal::new(&group, core),
            heard: Heard::default(),
            door: Door::new(now_us),
            members: BTreeMap::new(),
            waiting: BTreeMap::new(),
            hold: OrderHold::default(),
            arrivals: Vec::new(),
            looked_us: now_us,
            acknowledgements: Acknowledgements::default(),
            epoch: (core.log.tick(), now_us),
            last_input_us: now_us,
            last_frame_us: now_us,
            compare_us: now_us,
            input_since_compare: true,
            comparison: HashComparison::default(),
            wanted_us: None,
            making: None,
            checkpoints: Vec::new(),
            at_rest: true,
            // The first host has nobody to wait for.
            alone_since_us: first.then_some(0),
            present_us: 0,
        };
        // This host acknowledges the log entries that the previous one did not.
        for (person, applied) in core.log.people() {
            host.waiting.entry(person.person).or_default().received = applied;
            host.acknowledgements.expect(core.log.last(), person.person, applied);
        }
        // A successor may have been cut off before the frame in which it arrived.
        if core.log.person(core.person).is_none() {
            host.arrivals.push(core.arrival());
        }
        core.outbox.begin_after(core.log.applied(core.person));
        core.events.push_back(Event::Entered { person: core.person, rate_hz: core.rate_hz });
        core.host = core.person;
        core.events.push_back(Event::Hosting(true));
        host
    }

    /// Answers the challenge at once.
    pub fn present(&mut self, challenge: u64, now_us: u64) {
        self.heard.take(challenge, now_us);
        self.present_us = 0;
    }

    /// Takes a greeting. True: another host of the same sculpture goes on, and this one does not.
    pub fn greeting(
        &mut self,
        core: &mut Core,
        from: Address,
        greeting: &Greeting,
        now_us: u64,
    ) -> bool {
        match greeting {
            Greeting::Hello(hello) => {
                let about = (self.term, 1 + self.members.len().min(254) as u8);
                self.door.hello(core, from, hello, about, now_us);
                false
            }
            Greeting::Challenge(challenge) => {
                self.door.other_host(core, from, challenge, self.term, now_us)
            }
            Greeting::Refused(refusal) => {
                self.door.strangers_host(core, &refusal.to);
                false
            }
        }
    }

    /// Sends everybody to the host that stays.
    pub fn step_down(&mut self, core: &mut Core) {
        let all: Vec<Address> = self.members.keys().copied().collect();
        for to in all {
            self.dismiss(core, to, "another host has a later turn: join again");
        }
    }

    /// Takes a list of members. Members that are not in it are sent away; all others receive it.
    pub fn take_members(&mut self, core: &mut Core, members: SignedMembership, now_us: u64) {
        if !core.take_members(members) {
            return;
        }
        let group = fresh(&mut core.entropy);
        self.heirs = HeirsSeal::new(&group, core);
        core.group = Some(group);
        self.door.greeted.clear();
        self.look_at_members(core, now_us);
    }

    /// Sends away who is not in the list, or no longer; tells the others of a new list.
    fn look_at_members(&mut self, core: &mut Core, now_us: u64) {
        self.looked_us = now_us;
        let Some(members) = core.members.clone() else { return };
        if !members.list().may_host(&core.invitation.secret.public(), core.now_s(now_us)) {
            return core.end(ENDED);
        }
        for (to, why) in not_admitted(&self.members, core, now_us) {
            self.dismiss(core, to, &why);
        }
        let version = members.list().version;
        for (to, m) in &mut self.members {
            if m.knows < version && !m.waits && now_us >= m.told_members_us + MEMBERS_US {
                m.told_members_us = now_us;
                let group = core.group.as_ref().filter(|_| m.role == Role::Sculptor).map(|g| g.0);
                let members = members.to_bytes();
                core.down(*to, &mut m.down, &FromHost::Members { members, group });
            }
        }
    }

    /// Takes a sealed message.
    pub fn receive(&mut self, core: &mut Core, from: Address, sealed: &[u8], now_us: u64) {
        if let Some(greeted) = self.door.greeted.get_mut(&from)
            && let Some(plain) = greeted.up.open(sealed)
        {
            let message = FromMember::from_bytes(&plain);
            if let (Ok(FromMember::Join { name, role, reached }), Some(greeted)) =
                (message, self.door.greeted.remove(&from))
            {
                self.join(core, from, greeted, (name, role), reached, now_us);
            }
            return;
        }
        let Some(member) = self.members.get_mut(&from) else { return };
        let Some(plain) = member.up.open(sealed) else { return };
        if !member.limits.bytes.take(plain.len() as f64, now_us) {
            return self.violation(core, from, "sends more than is allowed", now_us);
        }
        match FromMember::from_bytes(&plain) {
            Ok(message) => self.message(core, from, message, now_us),
            Err(e) => self.violation(core, from, &e.to_string(), now_us),
        }
    }

    fn violation(&mut self, core: &mut Core, from: Address, what: &str, now_us: u64) {
        let Some(member) = self.members.get_mut(&from) else { return };
        member.violations += 1;
        if now_us >= member.told_us + 1_000_000 || member.told_us == 0 {
            member.told_us = now_us;
            let JoinedMember { name, violations, .. } = member;
            core.note(format!("'{name}': {what}; dropped ({violations} times by now)"));
        }
        if member.violations >= PATIENCE {
            self.dismiss(core, from, what);
        }
    }

    /// Sends a member away.
    fn dismiss(&mut self, core: &mut Core, from: Address, why: &str) {
        if let Some(mut member) = self.members.remove(&from) {
            core.note(format!("'{}' is sent away: {why}", member.name));
            core.down(from, &mut member.down, &FromHost::Refused(why.into()));
        }
    }

    fn join(
        &mut self,
        core: &mut Core,
        from: Address,
        mut greeted: Greeted,
        (name, role): (String, Role),
        reached: Option<Reached>,
        now_us: u64,
    ) {
        self.members.remove(&from);
        let number = number_for(&name, &self.arrivals, &core.log);
        let clean = !name.trim().is_empty() && !name.chars().any(char::is_control);
        let there = |m: &JoinedMember| m.name == name && now_us < m.heard_us + LOST_US * 2;
        let key = greeted.member_key.key.name();
        let allowed = core.admits(&key, &name, role, now_us);
        let refused = match (allowed, number) {
            (Err(why), _) => Some(why),
            _ if !clean => Some("a name is text without control characters".into()),
            _ if name == core.name || self.members.values().any(there) => {
                Some(format!("'{name}' {HERE_ALREADY}"))
            }
            _ if self.members.len() >= MAX_MEMBERS => {
                Some(format!("{MAX_MEMBERS} people are here, and no more are let in"))
            }
            (_, None) => Some("as many people have come as can be told apart".into()),
            _ => None,
        };
        if let Some(why) = refused {
            core.note(format!("'{name}' ({}) was not let in: {why}", role.name()));
            return core.down(from, &mut greeted.down, &FromHost::Refused(why));
        }
        let person = number.unwrap_or_default();
        self.members.retain(|_, m| m.name != name);
        core.note(format!("'{name}' joins as {}", role.name()));
        let arrival = Arrival { person, name: name.clone(), role, here: true };
        let resumes = reached.is_some_and(|r| core.log.continues(r));
        self.arrivals.retain(|a| a.person != person);
        self.arrivals.extend(comings(core.log.person(person), arrival, resumes));
        self.waiting.entry(person).or_default().early.clear();
        let resumes = resumes || role == Role::Device;
        let first = reached.map_or(core.log.last(), |r| r.1);
        let who = (person, name, role);
        // The answer to its greeting had the list.
        let mut member = JoinedMember::new(who, greeted, core.members_version(), first, now_us);
        (member.waits, member.have) = (!resumes, resumes.then_some(first));
        self.members.insert(from, member);
        if resumes {
            let people = core.log.people();
            self.enter(core, from, None, people);
        } else if let Some(held) = self.checkpoints.last().filter(|held| is_recent(core, held)) {
            let (offer, people) = (Some(held.index), held.people.clone());
            self.enter(core, from, offer, people);
        } else {
            self.wanted_us.get_or_insert(now_us);
        }
    }

    /// Tells a member how it is let in.
    fn enter(
        &mut self,
        core: &mut Core,
        to: Address,
        offer: Option<Offer>,
        people: Vec<(Arrival, u64)>,
    ) {
        let Some(member) = self.members.get_mut(&to) else { return };
        member.waits = false;
        if let Some(index) = offer {
            (member.sent, member.first) = (index, index);
        }
        let waiting = self.waiting.get(&member.person);
        let entry = Entry {
            person: member.person,
            host: core.person,
            term: self.term,
            rate_hz: core.rate_hz,
            applied: waiting.map_or_else(|| core.log.applied(member.person), |w| w.received),
            offer,
            people,
            turns: core.log.turns().to_vec(),
            group: core.group.as_ref().filter(|_| member.role == Role::Sculptor).map(|g| g.0),
        };
        core.down(to, &mut member.down, &FromHost::Entry(Box::new(entry)));
    }

    fn message(&mut self, core: &mut Core, from: Address, message: FromMember, now_us: u64) {
        let Some(member) = self.members.get_mut(&from) else { return };
        member.heard_us = now_us;
        match message {
            FromMember::Up { have, after_gap, sent_ms, echo_ms, batches } => {
                member.trip.take(sent_ms, echo_ms, now_us);
                if have == NOT_ENTERED {
                    // Its entry was lost.
                    let held = self.checkpoints.iter().find(|c| c.index == member.first);
                    return match (member.waits, member.have) {
                        (true, _) => {}
                        (false, Some(_)) => self.enter(core, from, None, core.log.people()),
                        (false, None) => {
                            let (offer, people) = held.map(|c| (c.index, c.people.clone())).unzip();
                            self.enter(core, from, offer, people.unwrap_or_default());
                        }
                    };
                }
                if have > core.log.last() {
                    return self.violation(core, from, "has frames that never were", now_us);
                }
                if member.role != Role::Device && member.have.is_none_or(|h| have > h) {
                    // Before that it has the checkpoint that it was let in with, or less.
                    if member.have.is_some() || !member.waits && have >= member.first {
                        (member.have, member.progress_us) = (Some(have), now_us);
                        member.sent = member.sent.max(have);
                    }
                }
                if after_gap > have + 1 && member.have == Some(have) {
                    let frames = core.log.from(have + 1, (after_gap - have - 1) as usize);
                    if now_us >= member.progress_us + member.trip.patience_us() / 2 {
                        member.progress_us = now_us;
                        let frames = bounded(frames.unwrap_or_default());
                        self.send_frames(core, from, &frames, now_us);
                    }
                }
                self.take_batches(core, from, batches, now_us);
            }
            FromMember::Want { index, first, count } => {
                let Some(held) = self.checkpoints.iter().find(|c| c.index == index) else {
                    return self.dismiss(core, from, "the checkpoint is gone: join again");
                };
                member.want(first, count);
                held.send(core, from, member);
            }
            FromMember::Hash { index, hash } => {
                let own = self.comparison.take(index, from, hash);
                own.into_iter().for_each(|own| self.differs(core, index, from, own));
            }
            FromMember::Leave => {
                let name = member.name.clone();
                self.members.remove(&from);
                core.note(format!("'{name}' leaves"));
            }
            FromMember::Members(bytes) => {
                let owner = core.invitation.owner;
                match SignedMembership::from_bytes(&bytes, &owner) {
                    Ok(members) => self.take_members(core, members, now_us),
                    Err(_) => {
                        self.violation(core, from, "sends a list that is not the owner's", now_us)
                    }
                }
            }
            FromMember::KnowsMembers(version) => member.knows = member.knows.max(version),
            FromMember::Join { .. } => self.violation(core, from, "joins twice", now_us),
        }
    }

    fn take_batches(&mut self, core: &mut Core, from: Address, batches: Vec<Batch>, now_us: u64) {
        let Some(member) = self.members.get_mut(&from) else { return };
        if !batches.is_empty() && member.role == Role::Viewer {
            return self.violation(core, from, "is a viewer, and sends input", now_us);
        }
        let person = member.person;
        let waiting = self.waiting.entry(person).or_default();
        if let Some(what) = waiting.take(batches, &mut member.limits, person, now_us) {
            self.violation(core, from, what, now_us);
        }
    }

    /// Takes the hash of the local world after a frame.
    pub fn own_hash(&mut self, core: &mut Core, index: u64, hash: u64) {
        for from in self.comparison.take_own(index, hash) {
            self.differs(core, index, from, hash);
        }
    }

    fn differs(&mut self, core: &mut Core, index: u64, from: Address, hash: u64) {
        if let Some(mut member) = self.members.remove(&from) {
            core.note(format!("'{}' differs after frame {index}: it joins anew", member.name));
            core.down(from, &mut member.down, &FromHost::Differs { index, hash });
        }
    }

    /// The next bytes of the checkpoint of a frame with that mark; `last`: nothing follows them.
    pub fn checkpoint_part(&mut self, core: &mut Core, index: u64, part: &[u8], last: bool) {
        if self.making != Some(index) {
            return;
        }
        if self.checkpoints.last().is_none_or(|held| held.index != index) {
            self.begin_checkpoint(core, index);
        }
        let Some(held) = self.checkpoints.last_mut() else { return };
        held.push(part, last);
        held.send_to(core, &mut self.members);
        if last {
            self.making = None;
        }
    }

    /// Those who wait are let in: they fetch the checkpoint while it is made.
    fn begin_checkpoint(&mut self, core: &mut Core, index: u64) {
        let people = people_at(core, index);
        self.checkpoints.push(HeldCheckpoint::new(index, people.clone()));
        let waiting: Vec<Address> =
            self.members.iter().filter(|(_, m)| m.waits).map(|(a, _)| *a).collect();
        for to in waiting {
            self.enter(core, to, Some(index), people.clone());
        }
    }

    /// No checkpoint could be made after a frame with that mark: another is tried.
    pub fn checkpoint_failed(&mut self, index: u64, now_us: u64) {
        if self.making == Some(index) {
            self.making = None;
            self.wanted_us = Some(now_us);
        }
    }

    /// Notes whether nothing was under way in the world after the last frame.
    pub fn after_step(&mut self, at_rest: bool) {
        self.at_rest = at_rest;
    }

    /// Makes the frames that are due, and sends what is to be sent.
    pub fn advance(&mut self, core: &mut Core, now_us: u64) {
        self.order(core, now_us);
        drop_silent(&mut self.members, core, now_us);
        self.acknowledge(core, now_us);
        if now_us >= self.present_us {
            self.present_us = now_us + IDLE_US;
            // Those who were with an earlier host have some time to join this one.
            if now_us >= self.epoch.1 + GONE_US {
                note_departures(&mut self.arrivals, &self.members, core);
            }
            let (challenge, heard) = (0, self.heard.recent(now_us));
            let word = HeirsWord::Host { term: self.term };
            core.among_heirs(&mut self.heirs, &AmongHeirs { challenge, heard, word });
        }
        if now_us >= self.looked_us + MEMBERS_US {
            self.look_at_members(core, now_us);
        }
        self.door.look(core, now_us);
        let due: Vec<Address> =
            self.members.iter().filter(|(_, m)| now_us >= m.next_us).map(|m| *m.0).collect();
        for to in due {
            self.send_next(core, to, now_us);
        }
        let offered = self.members.values().filter(|m| m.have.is_none() && !m.waits);
        drop_old(&mut self.checkpoints, core, |index| offered.clone().any(|m| m.first == index));
        let slowest = self.replicas().filter_map(|m| m.have).min().unwrap_or(u64::MAX);
        let slowest = offered.map(|m| m.sent).min().unwrap_or(u64::MAX).min(slowest);
        core.log.trim(slowest.max(core.log.last().saturating_sub(200_000)));
    }

    fn order(&mut self, core: &mut Core, now_us: u64) {
        let own = core.outbox.count_after(self.waiting.entry(core.person).or_default().received);
        let ready = own > 0 || self.waiting.values().any(|w| !w.ready.is_empty());
        let passed = now_us.saturating_sub(self.epoch.1);
        let due = self.epoch.0 + passed * u64::from(core.rate_hz) / 1_000_000;
        if due <= core.log.tick() {
            return;
        }
        if ready {
            self.last_input_us = now_us;
        }
        let busy = now_us < self.last_input_us + BUSY_US || !self.arrivals.is_empty();
        let waited = self.wanted_us.is_some_and(|at| self.at_rest || now_us >= at + REST_US);
        let checkpoint = waited && self.making.is_none();
        if !busy && !checkpoint && now_us < self.last_frame_us + IDLE_US {
            return;
        }
        let compares = self.input_since_compare && now_us >= self.compare_us + 1_000_000;
        let index = core.log.last() + 1;
        let mut frame = Frame { index, tick: due, ..Frame::default() };
        frame.arrivals.append(&mut self.arrivals);
        if checkpoint {
            frame.mark = Mark::Checkpoint;
            (self.making, self.wanted_us) = (Some(index), None);
        } else {
            if compares {
                frame.mark = Mark::Compare;
                (self.compare_us, self.input_since_compare) = (now_us, false);
            }
            fill(&mut frame, core, &mut self.waiting, &mut self.hold, now_us);
        }
        self.input_since_compare |= frame.has_input();
        self.last_frame_us = now_us;
        for batch in &frame.batches {
            self.acknowledgements.expect(index, batch.person, batch.number);
        }
        core.append(Arc::new(frame));
    }

    /// Those who have a world.
    fn replicas(&self) -> impl Iterator<Item = &JoinedMember> {
        self.members.values().filter(|m| m.role != Role::Device)
    }

    fn acknowledge(&mut self, core: &mut Core, now_us: u64) {
        // A viewer's replica is given up with this host: only a sculptor takes over.
        let heirs = || self.members.values().filter(|m| m.role == Role::Sculptor);
        let through = match heirs().filter_map(|m| m.have).max() {
            Some(have) => {
                self.alone_since_us = None;
                have
            }
            None if heirs().next().is_some() => 0,
            None => {
                let since = *self.alone_since_us.get_or_insert(now_us);
                if since == 0 || now_us >= since + ALONE_US { core.log.last() } else { 0 }
            }
        };
        self.acknowledgements.reach(through);
        core.outbox.acknowledge(self.acknowledgements.of(core.person));
    }

    fn send_next(&mut self, core: &mut Core, to: Address, now_us: u64) {
        let Some(member) = self.members.get_mut(&to) else { return };
        if member.waits {
            member.next_us = now_us + IDLE_US;
            return self.send_frames(core, to, &[], now_us);
        }
        let last = core.log.last();
        if let Some(have) = member.have
            && have < member.sent
            && now_us >= member.progress_us + member.trip.patience_us()
        {
            (member.sent, member.progress_us) = (have, now_us);
        }
        let wants = member.role != Role::Device && member.have.is_some();
        let frames =
            if wants { core.log.from(member.sent + 1, PER_MESSAGE.0) } else { Some(vec![]) };
        let Some(frames) = frames else {
            return self.dismiss(core, to, "is too far behind: join again");
        };
        let frames = bounded(frames);
        if let Some(newest) = frames.last() {
            if member.have == Some(member.sent) {
                member.progress_us = now_us;
            }
            member.sent = newest.index;
        }
        let behind = wants && member.sent < last;
        let busy = now_us < self.last_input_us + BUSY_US;
        member.next_us = now_us + until_next(behind, busy, member.trip.is_long());
        self.send_frames(core, to, &frames, now_us);
    }

    fn send_frames(&mut self, core: &mut Core, to: Address, frames: &[Arc<Frame>], now_us: u64) {
        let Some(member) = self.members.get_mut(&to) else { return };
        let frames = member.bytes_of(frames, &core.log);
        let down = FromHost::Down {
            received: self.waiting.get(&member.person).map_or(0, |w| w.received),
            acknowledged: self.acknowledgements.of(member.person),
            sent_ms: ms(now_us),
            echo_ms: member.trip.echo_ms(now_us),
            frames,
        };
        core.down(to, &mut member.down, &down);
    }
}

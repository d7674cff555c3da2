//! What a host keeps of each who greets it and of each who joined.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use crate::core::{Core, IDLE_US, RoundTrip, SEND_US};
use crate::door::Greeted;
use crate::host_limits::{BYTES, ENTRIES, GONE_US, MAX_WAITING, MAX_WANTED};
use crate::membership::MemberKey;
use crate::order_hold::OrderHold;
use crate::rate_limit::RateLimit;
use crate::replica_log::ReplicaLog;
use crate::seal::Seal;
use crate::wire::frame::{Arrival, Batch, Frame, PersonId, Role};
use crate::wire::frame_codec::frames_to_bytes;
use crate::wire::message::Address;

/// Frames of one message, and of their input's entries.
pub const PER_MESSAGE: (usize, usize) = (64, 2048);

/// Samples, commands and batches of one person and one frame; one batch may go beyond.
const PER_FRAME: usize = 128;

/// Limits of a member's messages.
#[derive(Debug)]
pub struct SenderLimits {
    pub bytes: RateLimit,
    entries: RateLimit,
}

impl SenderLimits {
    /// Of one who joins now.
    pub fn new(now_us: u64) -> SenderLimits {
        SenderLimits {
            bytes: RateLimit::new(BYTES.0, BYTES.1, now_us),
            entries: RateLimit::new(ENTRIES.0, ENTRIES.1, now_us),
        }
    }

    /// Why a batch is not taken now, where so many of the member's wait; `None`: it is.
    pub fn excess(&mut self, batch: &Batch, waiting: usize, now_us: u64) -> Option<&'static str> {
        let entries = batch.samples.len() + batch.commands.len() + 1;
        match waiting >= MAX_WAITING {
            true => Some("sends more batches than there are ticks"),
            false if self.entries.take(entries as f64, now_us) => None,
            false => Some("sends more input than is allowed"),
        }
    }
}

/// Who joined.
#[derive(Debug)]
pub struct JoinedMember {
    /// Permissions of its key when it joined; the newest list decides.
    pub member_key: MemberKey,
    /// Version of the list of members that it has confirmed, and time of the last message about it.
    pub knows: u64,
    pub told_members_us: u64,
    pub person: PersonId,
    pub name: String,
    pub role: Role,
    pub up: Seal,
    pub down: Seal,
    pub heard_us: u64,
    /// Waits for a checkpoint.
    pub waits: bool,
    /// Index of the last frame it has; `None`: it does not have the checkpoint yet.
    pub have: Option<u64>,
    /// The frames after this one are those of the log.
    pub first: u64,
    /// Frames up to this one were sent.
    pub sent: u64,
    pub progress_us: u64,
    /// Chunks of the checkpoint that are to be sent as soon as they are made.
    pub wanted: BTreeSet<u32>,
    pub next_us: u64,
    pub trip: RoundTrip,
    pub limits: SenderLimits,
    pub violations: u32,
    pub told_us: u64,
}

impl JoinedMember {
    /// A member that has the frames up to `first`, and the list of members of this version.
    pub fn new(
        (person, name, role): (PersonId, String, Role),
        greeted: Greeted,
        knows: u64,
        first: u64,
        now_us: u64,
    ) -> JoinedMember {
        JoinedMember {
            member_key: greeted.member_key,
            knows,
            told_members_us: 0,
            person,
            name,
            role,
            up: greeted.up,
            down: greeted.down,
            heard_us: now_us,
            waits: true,
            have: None,
            first,
            sent: first,
            progress_us: now_us,
            wanted: Default::default(),
            next_us: now_us,
            trip: RoundTrip::default(),
            limits: SenderLimits::new(now_us),
            violations: 0,
            told_us: 0,
        }
    }

    /// Chunks of the checkpoint are wanted; of too many the last ones are not sent.
    pub fn want(&mut self, first: u32, count: u32) {
        self.wanted.extend(first..first.saturating_add(count.min(MAX_WANTED)));
        while self.wanted.len() > 2 * MAX_WANTED as usize {
            self.wanted.pop_last();
        }
    }

    /// Encodes frames for this member, as differences to frames that it is known to have.
    pub fn bytes_of(&self, frames: &[Arc<Frame>], log: &ReplicaLog) -> Vec<u8> {
        frames_to_bytes(frames, log, (self.first, self.have.unwrap_or(self.first)))
    }
}

/// A person's batches on their way into frames.
#[derive(Debug, Default)]
pub struct BatchQueue {
    /// All up to this one were received.
    pub received: u64,
    pub ready: VecDeque<Batch>,
    pub early: BTreeMap<u64, Batch>,
}

impl BatchQueue {
    /// Takes a person's batches. Returns why some of them are not taken.
    pub fn take(
        &mut self,
        batches: Vec<Batch>,
        limits: &mut SenderLimits,
        person: PersonId,
        now_us: u64,
    ) -> Option<&'static str> {
        let mut fault = None;
        for mut batch in batches {
            if let Some(what) = crate::policy::refused(&batch) {
                fault = Some(what);
                // The number is used up: what follows is not held back.
                batch.commands.clear();
                batch.samples.clear();
            }
            batch.person = person;
            let (number, early) = (batch.number, self.early.len() + self.ready.len());
            if number > self.received && number <= self.received + MAX_WAITING as u64 {
                if let Some(what) = limits.excess(&batch, early, now_us) {
                    fault = Some(what);
                    break;
                }
                self.early.insert(number, batch);
            }
        }
        while let Some(batch) = self.early.remove(&(self.received + 1)) {
            self.received += 1;
            self.ready.push_back(batch);
        }
        fault
    }
}

/// Members that the list does not admit any more, each with the reason.
pub fn not_admitted(
    members: &BTreeMap<Address, JoinedMember>,
    core: &Core,
    now_us: u64,
) -> Vec<(Address, String)> {
    let refused = members.iter().filter_map(|(to, m)| {
        let key = m.member_key.key.name();
        Some((*to, core.admits(&key, &m.name, m.role, now_us).err()?))
    });
    refused.collect()
}

/// The number of a person of this name: a known one, or the next that is free. `arrivals`: those
/// who are not in the log yet.
pub fn number_for(name: &str, arrivals: &[Arrival], log: &ReplicaLog) -> Option<PersonId> {
    let waiting = arrivals.iter().find(|a| a.name == name).map(|a| a.person);
    waiting.or_else(|| {
        let next = log.number(name)?;
        let taken = |n: PersonId| arrivals.iter().any(|a| a.person == n);
        (next..=254).find(|n| !taken(*n) && (*n == next || log.person(*n).is_none()))
    })
}

/// Microseconds until the next message to a member who lacks frames, while somebody gives input,
/// over a long way.
///
/// TCP sends a lost packet again after three that follow it, or after two round trips and more: on
/// a long way an idle host would be silent for over [`crate::core::LOST_US`] with each.
pub fn until_next(behind: bool, busy: bool, long: bool) -> u64 {
    match (behind, busy || long) {
        (true, _) => SEND_US / 10,
        (_, true) => SEND_US,
        _ => IDLE_US,
    }
}

/// As many of the frames as one message may hold; one at least.
pub fn bounded(mut frames: Vec<Arc<Frame>>) -> Vec<Arc<Frame>> {
    let entries = |f: &Arc<Frame>| {
        f.batches.iter().map(|b| b.samples.len() + 64 * b.commands.len() + 1).sum::<usize>()
    };
    let mut sum = 0;
    let mut count = 0;
    for frame in frames.iter().take(PER_MESSAGE.0) {
        sum += entries(frame);
        if sum > PER_MESSAGE.1 && count > 0 {
            break;
        }
        count += 1;
    }
    frames.truncate(count);
    frames
}

/// Lets those go who have been silent for too long.
pub fn drop_silent(members: &mut BTreeMap<Address, JoinedMember>, core: &mut Core, now_us: u64) {
    members.retain(|_, m| {
        let here = now_us < m.heard_us + GONE_US;
        if !here {
            core.note(format!("'{}' is gone", m.name));
        }
        here
    });
}

/// Those who are connected no longer, to be told with those who came.
pub fn note_departures(
    arrivals: &mut Vec<Arrival>,
    members: &BTreeMap<Address, JoinedMember>,
    core: &Core,
) {
    let joined = |a: &Arrival| members.values().any(|m| m.person == a.person);
    let told = |a: &Arrival| arrivals.iter().any(|p| p.person == a.person);
    let gone = core.log.here().filter(|a| a.person != core.person && !joined(a) && !told(a));
    let gone: Vec<Arrival> = gone.map(|a| Arrival { here: false, ..a.clone() }).collect();
    arrivals.extend(gone);
}

/// Returns the log entries for a person who joins; `known` is the last one. A process that
/// `resumes` continues its strokes. Another process of somebody who is here replaces the one before
/// it, whose pens must not stay on the clay.
pub fn comings(known: Option<&Arrival>, arrival: Arrival, resumes: bool) -> Vec<Arrival> {
    match known {
        Some(known) if known.here && !resumes => {
            vec![Arrival { here: false, ..known.clone() }, arrival]
        }
        Some(known) if *known == arrival => Vec::new(),
        _ => vec![arrival],
    }
}

/// Puts everybody's next batch into a frame; of those who are behind, more. During a hold, only the
/// holder's.
pub fn fill(
    frame: &mut Frame,
    core: &Core,
    waiting: &mut BTreeMap<PersonId, BatchQueue>,
    hold: &mut OrderHold,
    now_us: u64,
) {
    let (own, person) = (waiting.entry(core.person).or_default(), core.person);
    if hold.admits(person, now_us) {
        let count = 1 + core.outbox.count_after(own.received) / 8;
        let count = fitting(core.outbox.after(own.received, count));
        for batch in core.outbox.after(own.received, count) {
            frame.batches.push(Batch { person, ..batch.clone() });
        }
        own.received = frame.batches.last().map_or(own.received, |last| last.number);
    }
    for (_, waiting) in waiting.iter_mut().filter(|(person, _)| hold.admits(**person, now_us)) {
        let count = 1 + waiting.ready.len() / 8;
        let count = fitting(waiting.ready.iter().take(count));
        frame.batches.extend(waiting.ready.drain(..count));
    }
    frame.batches.iter().for_each(|batch| hold.ordered(batch, now_us));
}

/// Returns the number of a person's next batches that fit into one frame, so that a frame of all
/// people fits into a message. It is at least one if there are any. A frame's commands are stepped
/// before its samples: a command that came after samples waits for the next frame, or a stroke
/// would get the brush of the one after it.
fn fitting<'a>(batches: impl Iterator<Item = &'a Batch>) -> usize {
    let (mut sum, mut has_samples) = (0, false);
    let fits = |b: &&Batch| {
        let fits = sum < PER_FRAME && (b.commands.is_empty() || !has_samples);
        sum += b.samples.len() + b.commands.len() + 1;
        has_samples |= !b.samples.is_empty();
        fits
    };
    batches.take_while(fits).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_devices::{Body, DeviceId, Pen, Sample};
    use sculptd_engine::command::Command;

    #[test]
    fn a_command_that_came_after_samples_waits_for_the_next_frame() {
        let body = Body::Pen(Pen::default());
        let sample = Sample { device: DeviceId(0), t_us: 0, device_t_us: None, body };
        let batch = |commands: usize, samples: usize| Batch {
            commands: vec![Command::Undo; commands],
            samples: vec![sample; samples],
            ..Batch::default()
        };
        let stroke = [batch(1, 0), batch(1, 1), batch(0, 1), batch(0, 1), batch(1, 0)];
        assert_eq!(fitting(stroke.iter()), 4);
        assert_eq!(fitting(stroke[4..].iter()), 1);
        assert_eq!(fitting([batch(0, 1), batch(1, 1)].iter()), 1);
        assert_eq!(fitting(std::iter::empty()), 0);
    }
}

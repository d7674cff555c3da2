//! The own input on its way to the log: numbered, and kept until a replica has it too, and a while
//! longer: of a network that was split in two, one part's log is given up when it heals, and what
//! only that one had is sent again.

use std::collections::VecDeque;

use crate::host_limits::{BYTES, LARGE_SHARE};
use crate::wire::frame::{Batch, MAX_ENTRIES};
use sculptd_devices::Sample;
use sculptd_engine::command::Command;

/// Batches beyond which motion is left out: 17 seconds at 120 a second. Transitions and commands
/// never are.
const CONGESTED: usize = 2048;
/// Samples and commands of one message.
const PER_MESSAGE: usize = 512;
/// Microseconds that a byte of a large batch is on its way, before it is sent again.
const BYTE_US: u64 = 8;

/// Acknowledged batches that are kept: at 120 a second the last two minutes, where every tick has
/// some.
const KEPT: usize = 14_400;
/// Bytes of acknowledged batches with a mesh or the like that are kept: what a member may send in
/// two minutes.
const KEPT_BYTES: usize = ((BYTES.0 + 120.0 * BYTES.1) * LARGE_SHARE) as usize;

/// A batch, and what became of it.
#[derive(Debug)]
struct Kept {
    batch: Batch,
    /// Time of the last attempt to send it.
    sent: Option<u64>,
    /// Its bytes, if it has more than some hundred; else 0.
    bytes: usize,
}

/// The commands of a batch, by the numbers that the loop knows them by.
#[derive(Debug)]
struct Numbered {
    batch: u64,
    first: u64,
    count: usize,
}

/// The local batches without an acknowledgement, and the newest ones with it.
#[derive(Debug, Default)]
pub struct Outbox {
    batches: VecDeque<Kept>,
    /// Batches with commands that have not been stepped yet.
    numbered: VecDeque<Numbered>,
    /// The number after the last command's.
    next_command: u64,
    /// All up to this one are acknowledged.
    acknowledged: u64,
    /// Bytes of the acknowledged ones with a mesh or the like.
    kept_bytes: usize,
    /// The last of each device.
    last: Vec<Sample>,
    next: u64,
    /// Counts of the accepted input and of its fate.
    pub counts: OutboxCounts,
}

/// Counts of an outbox's input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OutboxCounts {
    /// Samples that did more than move.
    pub transitions: u64,
    /// Samples that were left out because too much waits: all of them only moved.
    pub dropped: u64,
    /// Batches that were acknowledged, are in no log that is left, and were not kept either.
    pub lost: u64,
}

impl Outbox {
    /// Takes the input of the local devices and people from one tick. `first`: the number of the
    /// first command.
    pub fn push(&mut self, samples: Vec<Sample>, commands: Vec<Command>, first: u64) {
        self.next_command = first + commands.len() as u64;
        let congested = self.len() >= CONGESTED;
        let mut kept: Vec<(Sample, bool)> = Vec::with_capacity(samples.len());
        for sample in samples {
            let old = self.last.iter_mut().find(|l| l.device == sample.device);
            let moved = old.as_ref().is_some_and(|l| sample.only_moved_since(l));
            if congested && moved {
                self.counts.dropped += 1;
                continue;
            }
            self.counts.transitions += u64::from(!moved);
            // Of motion within one tick the newest is enough.
            match kept.last_mut() {
                Some((last, true)) if moved && last.device == sample.device => *last = sample,
                _ => kept.push((sample, moved)),
            }
            match old {
                Some(old) => *old = sample,
                None => self.last.push(sample),
            }
        }
        if kept.is_empty() && commands.is_empty() {
            return;
        }
        // One tick's is one batch, but for what is too much for one.
        let mut samples = kept.into_iter().map(|k| k.0);
        let mut commands = commands.into_iter();
        while samples.len() + commands.len() > 0 {
            self.next += 1;
            let samples: Vec<Sample> = samples.by_ref().take(MAX_ENTRIES).collect();
            let first = self.next_command - commands.len() as u64;
            let commands: Vec<Command> = commands.by_ref().take(MAX_ENTRIES).collect();
            if !commands.is_empty() {
                let (batch, count) = (self.next, commands.len());
                self.numbered.push_back(Numbered { batch, first, count });
            }
            let batch = Batch { person: 0, number: self.next, samples, commands };
            let bytes = if is_large(&batch) { size(&batch) } else { 0 };
            self.batches.push_back(Kept { batch, sent: None, bytes });
        }
    }

    /// The numbers of a batch's commands, once it is in the order that all step. Batches before it
    /// are stepped too.
    pub fn take_numbers(&mut self, batch: u64) -> std::ops::Range<u64> {
        while let Some(numbered) = self.numbered.front().filter(|n| n.batch <= batch) {
            let Numbered { batch: of, first, count } = *numbered;
            self.numbered.pop_front();
            if of == batch {
                return first..first + count as u64;
            }
        }
        0..0
    }

    /// Commands with lower numbers are stepped, or in no order that is left. `applied`: the last
    /// batch that is stepped.
    pub fn waiting_from(&mut self, applied: u64) -> u64 {
        while self.numbered.front().is_some_and(|n| n.batch <= applied) {
            self.numbered.pop_front();
        }
        self.numbered.front().map_or(self.next_command, |n| n.first)
    }

    /// The number of the next command.
    pub fn next_command(&self) -> u64 {
        self.next_command
    }

    /// Bytes of the large batches that no other replica is known to have.
    pub fn waiting_bytes(&self) -> usize {
        self.batches.range(self.from(self.acknowledged)..).map(|k| k.bytes).sum()
    }

    /// Takes the batches after `applied` out of the box, each with the number of its first command:
    /// nobody else will order them.
    pub fn take_after(&mut self, applied: u64) -> Vec<(Batch, u64)> {
        let from = self.from(applied);
        let batches: Vec<Batch> = self.batches.drain(from..).map(|k| k.batch).collect();
        let numbered = |b: Batch| {
            let first = self.take_numbers(b.number).start;
            (b, first)
        };
        batches.into_iter().map(numbered).collect()
    }

    /// Batches up to this one are in the log, and a replica has them.
    pub fn acknowledge(&mut self, through: u64) {
        while self.acknowledged < through.min(self.next) {
            self.acknowledged += 1;
            self.kept_bytes += self.get(self.acknowledged).map_or(0, |k| k.bytes);
        }
        while let Some(front) = self.batches.front()
            && front.batch.number <= self.acknowledged
            && (self.batches.len() - self.len() > KEPT || self.kept_bytes > KEPT_BYTES)
        {
            self.kept_bytes -= front.bytes;
            self.batches.pop_front();
        }
    }

    fn get(&self, number: u64) -> Option<&Kept> {
        let at = number.checked_sub(self.batches.front()?.batch.number)?;
        self.batches.get(at as usize)
    }

    /// Restarts after `applied`, the last batch in the log: later batches are numbered from the one
    /// after it, and are sent again.
    pub fn begin_after(&mut self, applied: u64) {
        // The log of a new host may lack batches of the old one: they are sent again under the same
        // numbers. A batch no longer kept leaves a gap that nobody would ever fill.
        let first = self.batches.front().map_or(self.next + 1, |k| k.batch.number);
        let lost = first.saturating_sub(applied + 1);
        self.counts.lost += lost;
        self.next = self.next.saturating_sub(lost).max(applied);
        self.acknowledged = self.acknowledged.saturating_sub(lost).min(applied);
        self.kept_bytes = 0;
        for kept in &mut self.batches {
            (kept.batch.number, kept.sent) = (kept.batch.number - lost, None);
            let is_kept = kept.batch.number <= self.acknowledged;
            self.kept_bytes += if is_kept { kept.bytes } else { 0 };
        }
        self.numbered.retain(|n| n.batch >= first);
        self.numbered.iter_mut().for_each(|n| n.batch -= lost);
    }

    fn from(&self, received: u64) -> usize {
        self.batches.partition_point(|k| k.batch.number <= received)
    }

    /// Returns the batches to send now: those after `received` that were never sent, or sent longer
    /// than `patience_us` ago. A large one goes alone, and when `budget` has its bytes: the host
    /// takes no more.
    pub fn due(
        &mut self,
        received: u64,
        now_us: u64,
        patience_us: u64,
        mut budget: impl FnMut(usize) -> bool,
    ) -> Vec<Batch> {
        let (mut due, mut entries, from) = (Vec::new(), 0, self.from(received));
        for kept in self.batches.range_mut(from..) {
            let way_us = patience_us + kept.bytes as u64 * BYTE_US;
            if kept.sent.is_some_and(|at| now_us < at + way_us) {
                continue;
            }
            let batch = &kept.batch;
            entries += batch.samples.len() + batch.commands.len();
            let is_full = entries > PER_MESSAGE || kept.bytes > 0;
            if is_full && !due.is_empty() || kept.bytes > 0 && !budget(kept.bytes) {
                break;
            }
            kept.sent = Some(now_us);
            due.push(batch.clone());
            if is_full {
                break;
            }
        }
        due
    }

    /// Returns the batches after `received`, for a host that orders its local ones.
    pub fn after(&self, received: u64, most: usize) -> impl Iterator<Item = &Batch> {
        self.batches.range(self.from(received)..).map(|k| &k.batch).take(most)
    }

    /// Returns the number of batches after `received`.
    pub fn count_after(&self, received: u64) -> usize {
        self.batches.len() - self.from(received)
    }

    /// The number of the last batch.
    pub fn last(&self) -> u64 {
        self.next
    }

    /// All up to this one are acknowledged.
    pub fn acknowledged(&self) -> u64 {
        self.acknowledged
    }

    /// Returns the number of batches without an acknowledgement.
    pub fn len(&self) -> usize {
        self.count_after(self.acknowledged)
    }

    /// Returns true if all batches are acknowledged.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Returns true if a batch has more than some hundred bytes.
fn is_large(batch: &Batch) -> bool {
    batch.commands.iter().any(Command::owns_memory)
}

fn size(batch: &Batch) -> usize {
    let of = |c: &Command| postcard::to_stdvec(c).map_or(usize::MAX / 1024, |bytes| bytes.len());
    batch.commands.iter().map(of).sum::<usize>().max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_devices::{Body, DeviceId, Pen};

    fn sample(tip: bool, x: f32) -> Sample {
        let pos_mm = glam::Vec2::new(x, 0.0);
        let body = Body::Pen(Pen { in_range: true, tip, pos_mm, ..Pen::default() });
        Sample { device: DeviceId(0), t_us: 0, device_t_us: None, body }
    }

    #[test]
    fn congestion_drops_motion_and_never_a_transition() {
        let mut outbox = Outbox::default();
        for k in 0..CONGESTED * 2 {
            outbox.push(vec![sample(k % 100 < 50, k as f32)], vec![], 0);
        }
        let all = outbox.due(0, 0, 0, |_| true).len() as u64;
        assert!(
            all > 0 && outbox.counts.dropped > CONGESTED as u64 / 2,
            "{} dropped",
            outbox.counts.dropped
        );
        let waiting: Vec<_> = outbox.after(0, usize::MAX).collect();
        let tips = |s: &Sample| matches!(s.body, Body::Pen(p) if p.tip);
        let transitions =
            waiting.windows(2).filter(|w| tips(&w[0].samples[0]) != tips(&w[1].samples[0])).count();
        assert_eq!(transitions, CONGESTED * 2 / 50 - usize::from(CONGESTED * 2 % 50 == 0));
        assert!(waiting.windows(2).all(|w| w[0].number + 1 == w[1].number), "no gap");
    }

    #[test]
    fn what_is_not_acknowledged_is_sent_again_to_a_new_host() {
        let mut outbox = Outbox::default();
        (0..6).for_each(|_| outbox.push(vec![], vec![Command::Undo], 0));
        assert_eq!(outbox.due(0, 10, 100, |_| true).len(), 6);
        assert_eq!(outbox.due(2, 50, 100, |_| true).len(), 0, "none is late");
        assert_eq!(outbox.due(2, 110, 100, |_| true).len(), 4, "all that was not received is");
        outbox.acknowledge(3);
        // The new host has one more than was acknowledged.
        outbox.begin_after(4);
        let again: Vec<u64> = outbox.due(4, 120, 100, |_| true).iter().map(|b| b.number).collect();
        assert_eq!(again, [5, 6]);
        // It lacks two that were: they are kept, and go again.
        let mut outbox = Outbox::default();
        (0..6).for_each(|_| outbox.push(vec![], vec![Command::Undo], 0));
        outbox.acknowledge(5);
        assert_eq!(outbox.len(), 1);
        outbox.begin_after(3);
        let again: Vec<u64> = outbox.due(3, 120, 100, |_| true).iter().map(|b| b.number).collect();
        assert_eq!((again, outbox.len(), outbox.counts.lost), (vec![4, 5, 6], 3, 0));
    }

    #[test]
    fn what_is_kept_no_longer_leaves_no_gap() {
        let mut outbox = Outbox::default();
        let many = KEPT as u64 + 10;
        (0..many).for_each(|_| outbox.push(vec![], vec![Command::Undo], 0));
        outbox.acknowledge(many);
        assert_eq!((outbox.len(), outbox.count_after(0)), (0, KEPT));
        outbox.begin_after(4);
        assert_eq!(outbox.counts.lost, 6);
        let again = outbox.due(4, 0, 100, |_| true);
        assert_eq!(again.first().map(|b| b.number), Some(5));
        // None waits, and the log lacks all: what comes next is the next.
        let mut outbox = Outbox::default();
        outbox.begin_after(100);
        outbox.push(vec![], vec![Command::Undo], 0);
        outbox.acknowledge(101);
        (outbox.batches, outbox.kept_bytes) = (VecDeque::new(), 0);
        outbox.begin_after(40);
        outbox.push(vec![], vec![Command::Undo], 0);
        assert_eq!(outbox.due(40, 0, 100, |_| true).first().map(|b| b.number), Some(41));
    }

    #[test]
    fn commands_are_known_by_their_numbers_whatever_becomes_of_the_batches() {
        let mut outbox = Outbox::default();
        outbox.push(vec![], vec![Command::Undo, Command::Redo], 7);
        outbox.push(vec![sample(true, 0.0)], vec![], 9);
        outbox.push(vec![], vec![Command::Undo], 9);
        assert_eq!((outbox.waiting_from(0), outbox.take_numbers(1)), (7, 7..9));
        assert_eq!((outbox.take_numbers(2), outbox.take_numbers(3)), (0..0, 9..10));
        assert_eq!(outbox.waiting_from(3), 10);
        // A world that comes as a checkpoint has the first batch in it.
        outbox.push(vec![], vec![Command::Undo], 10);
        outbox.push(vec![], vec![Command::Undo], 11);
        assert_eq!(outbox.waiting_from(4), 11);
        let undelivered = outbox.take_after(4);
        let numbers: Vec<_> = undelivered.iter().map(|(b, first)| (b.number, *first)).collect();
        assert_eq!(numbers, [(5, 11)]);
    }

    #[test]
    fn a_large_batch_goes_alone_and_waits_for_its_bytes() {
        let mut outbox = Outbox::default();
        let load = || {
            Command::Picture(std::sync::Arc::new(sculptd_clay::brush::Picture {
                width: 100,
                height: 100,
                heights: vec![9; 10_000],
                cover: Vec::new(),
            }))
        };
        outbox.push(vec![], vec![Command::Undo], 0);
        outbox.push(vec![], vec![load()], 1);
        outbox.push(vec![], vec![Command::Undo], 2);
        assert!(outbox.waiting_bytes() >= 10_000);
        let numbers = |due: Vec<Batch>| due.iter().map(|b| b.number).collect::<Vec<_>>();
        assert_eq!(numbers(outbox.due(0, 10, 100, |_| false)), [1]);
        assert_eq!(numbers(outbox.due(0, 20, 100, |_| false)), [] as [u64; 0]);
        let mut asked = 0;
        let mut budget = |bytes| {
            asked += bytes;
            true
        };
        assert_eq!(numbers(outbox.due(0, 30, 100, &mut budget)), [2]);
        assert_eq!(numbers(outbox.due(0, 40, 100, &mut budget)), [3]);
        assert!(asked >= 10_000);
        // Its way is long: it is not sent again as soon as a small one.
        assert_eq!(numbers(outbox.due(0, 1_000, 100, |_| true)), [1, 3]);
        outbox.acknowledge(3);
        assert_eq!(outbox.waiting_bytes(), 0);
        // Of a network that was split, all that could be sent in two minutes is kept.
        (4..=20).for_each(|k| outbox.push(vec![], vec![load()], k));
        outbox.acknowledge(20);
        assert_eq!((outbox.count_after(0), outbox.counts.lost), (20, 0));
        outbox.begin_after(0);
        assert_eq!(outbox.counts.lost, 0);
    }
}

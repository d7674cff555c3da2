//! The own input on its way to the log: numbered, and kept until a replica has it too.

use std::collections::VecDeque;

use crate::wire::frame::{Batch, MAX_ENTRIES};
use sculptd_devices::Sample;
use sculptd_engine::command::Command;

/// Batches beyond which motion is left out: 17 seconds at 120 a second. Transitions and commands
/// never are.
const CONGESTED: usize = 2048;
/// Samples and commands of one message.
const PER_MESSAGE: usize = 512;

/// The own batches that are not acknowledged.
#[derive(Debug, Default)]
pub struct Outbox {
    waiting: VecDeque<(Batch, Option<u64>)>,
    /// The last of each device.
    last: Vec<Sample>,
    next: u64,
    /// Samples that were left out because too much waits.
    pub dropped: u64,
}

impl Outbox {
    /// Takes what the own devices and people gave in one tick.
    pub fn push(&mut self, samples: Vec<Sample>, commands: Vec<Command>) {
        let congested = self.waiting.len() >= CONGESTED;
        let mut kept: Vec<(Sample, bool)> = Vec::with_capacity(samples.len());
        for sample in samples {
            let old = self.last.iter_mut().find(|l| l.device == sample.device);
            let moved = old.as_ref().is_some_and(|l| sample.only_moved_since(l));
            if congested && moved {
                self.dropped += 1;
                continue;
            }
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
            let commands = commands.by_ref().take(MAX_ENTRIES).collect();
            let batch = Batch { person: 0, number: self.next, samples, commands };
            self.waiting.push_back((batch, None));
        }
    }

    /// Batches up to this one are in the log, and a replica has them.
    pub fn acknowledge(&mut self, through: u64) {
        while self.waiting.front().is_some_and(|(b, _)| b.number <= through) {
            self.waiting.pop_front();
        }
    }

    /// The log has the batches up to `applied`: what follows is numbered from the one after it, and
    /// is to be sent anew.
    pub fn begin_after(&mut self, applied: u64) {
        let waiting = std::mem::take(&mut self.waiting);
        let of_log = |b: &Batch| b.number <= applied;
        // The log of a new host may lack what was in the old one's: it is sent again under the same
        // numbers. Where numbers were given to nobody else, a gap cannot be.
        let contiguous = waiting.iter().find(|(b, _)| !of_log(b)).map(|(b, _)| b.number);
        let shift = contiguous.map_or(0, |first| first as i64 - (applied as i64 + 1));
        self.next = applied.max((self.next as i64 - shift) as u64);
        for (mut batch, _) in waiting {
            if !of_log(&batch) {
                batch.number = (batch.number as i64 - shift) as u64;
            }
            self.waiting.push_back((batch, None));
        }
    }

    /// What is to be sent now: batches after `received` that were never sent, or longer ago than
    /// `patience_us`.
    pub fn due(&mut self, received: u64, now_us: u64, patience_us: u64) -> Vec<Batch> {
        let (mut due, mut entries) = (Vec::new(), 0);
        for (batch, sent) in self.waiting.iter_mut().filter(|(b, _)| b.number > received) {
            if sent.is_some_and(|at| now_us < at + patience_us) {
                continue;
            }
            entries += batch.samples.len() + batch.commands.len();
            if entries > PER_MESSAGE && !due.is_empty() {
                break;
            }
            *sent = Some(now_us);
            due.push(batch.clone());
        }
        due
    }

    /// The batches after `received`, for a host that orders its own.
    pub fn after(&self, received: u64, most: usize) -> impl Iterator<Item = &Batch> {
        let from = self.waiting.iter().map(|(b, _)| b).skip_while(move |b| b.number <= received);
        from.take(most)
    }

    /// How many are after `received`.
    pub fn count_after(&self, received: u64) -> usize {
        self.waiting.iter().rev().take_while(|(b, _)| b.number > received).count()
    }

    /// How many are not acknowledged.
    pub fn len(&self) -> usize {
        self.waiting.len()
    }

    /// Whether all are acknowledged.
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Everything that waits is given up.
    pub fn clear(&mut self) {
        self.waiting.clear();
    }
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
            outbox.push(vec![sample(k % 100 < 50, k as f32)], vec![]);
        }
        let all = outbox.due(0, 0, 0).len() as u64;
        assert!(all > 0 && outbox.dropped > CONGESTED as u64 / 2, "{} dropped", outbox.dropped);
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
        (0..6).for_each(|_| outbox.push(vec![], vec![Command::Undo]));
        assert_eq!(outbox.due(0, 10, 100).len(), 6);
        assert_eq!(outbox.due(2, 50, 100).len(), 0, "none is late");
        assert_eq!(outbox.due(2, 110, 100).len(), 4, "all that was not received is");
        outbox.acknowledge(3);
        // The new host has one more than was acknowledged.
        outbox.begin_after(4);
        let again: Vec<u64> = outbox.due(4, 120, 100).iter().map(|b| b.number).collect();
        assert_eq!(again, [5, 6]);
        // It lacks two that were: their numbers are given anew, and nothing waits for ever.
        let mut outbox = Outbox::default();
        (0..6).for_each(|_| outbox.push(vec![], vec![Command::Undo]));
        outbox.acknowledge(5);
        outbox.begin_after(3);
        let again: Vec<u64> = outbox.due(3, 120, 100).iter().map(|b| b.number).collect();
        assert_eq!(again, [4]);
    }
}

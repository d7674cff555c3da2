//! The channel between the readers and their consumer: bounded, lock-free, and it never loses a
//! transition.
//!
//! Rules:
//! * The consumer (the tick thread) never waits: [`Receiver::drain`] takes the samples present.
//! * A sample that differs from its device's last one in nothing but motion may be replaced by a
//!   newer one while the channel is full. A **transition** (contact, proximity, buttons, the set of
//!   hands) is kept, in order, until there is room; no motion is ever merged across one.
//! * Every sample is accounted for, by device: `sent = received + coalesced + lost + closed + still
//!   on the way`.
//!
//! Guaranteed: order within a device. Not guaranteed: order between devices (the consumer orders by
//! `t_us`).

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::Duration;

use crossbeam_channel as cc;
use serde::Serialize;

use crate::calibration::Calibration;
use crate::sample::{DeviceId, Sample};

/// Devices that have counters of their own; ids from here up share the last slot, so that counting
/// never allocates.
pub const COUNTED_DEVICES: usize = 512;

/// Most samples that one sender keeps back while the channel is full. Half of it can be motion (one
/// between two transitions); 256 transitions are more than ten seconds of a pen tapping as fast as
/// a hand can.
const MAX_PENDING: usize = 512;

/// Duration of one blocked attempt before the stop flag is checked again.
const WAIT_SLICE: Duration = Duration::from_millis(5);

/// Time for which a dropped sender keeps trying to send the samples that it kept.
const DROP_PATIENCE: Duration = Duration::from_millis(500);

/// A channel that holds at most `capacity` samples (at least 1). The factory makes one [`Sender`]
/// for each adaptor.
pub fn channel(capacity: usize) -> (SenderFactory, Receiver) {
    let (tx, rx) = cc::bounded(capacity.max(1));
    let stats = Arc::new(Stats::default());
    (SenderFactory { tx, stats: stats.clone() }, Receiver { rx, stats })
}

/// Counters of the samples of every device. Readable from any thread at any time.
#[derive(Debug)]
pub struct Stats {
    devices: Box<[Counters]>,
}

impl Default for Stats {
    fn default() -> Self {
        Stats { devices: (0..COUNTED_DEVICES).map(|_| Counters::default()).collect() }
    }
}

impl Stats {
    /// The live counters of one device.
    pub fn device(&self, id: DeviceId) -> &Counters {
        &self.devices[(id.0 as usize).min(COUNTED_DEVICES - 1)]
    }

    /// One device's counts, as they are now.
    pub fn of(&self, id: DeviceId) -> Count {
        self.device(id).read()
    }

    /// The sum over all devices.
    pub fn total(&self) -> Count {
        self.devices.iter().map(Counters::read).fold(Count::default(), Count::plus)
    }
}

/// One device's counters, each only ever rising.
#[derive(Debug, Default)]
pub struct Counters {
    sent: AtomicU64,
    received: AtomicU64,
    coalesced: AtomicU64,
    lost_motion: AtomicU64,
    lost_transition: AtomicU64,
    closed: AtomicU64,
    waits: AtomicU64,
}

impl Counters {
    fn read(&self) -> Count {
        // `sent` is read last: it is raised first, so the difference to the rest is never negative.
        let mut c = Count {
            received: self.received.load(Relaxed),
            coalesced: self.coalesced.load(Relaxed),
            lost_motion: self.lost_motion.load(Relaxed),
            lost_transition: self.lost_transition.load(Relaxed),
            closed: self.closed.load(Relaxed),
            waits: self.waits.load(Relaxed),
            sent: 0,
        };
        c.sent = self.sent.load(Relaxed);
        c
    }
}

/// A reading of [`Counters`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Count {
    /// Samples given to [`Sender::push`].
    pub sent: u64,
    /// Samples that the consumer took.
    pub received: u64,
    /// Motion replaced by newer motion of the same device, with no transition between.
    pub coalesced: u64,
    /// Motion dropped because even the sender's own list was full.
    pub lost_motion: u64,
    /// Transitions dropped: a sender was dropped, or told to stop, while its consumer stood still.
    /// Else always 0.
    pub lost_transition: u64,
    /// Samples pushed after the consumer had gone for good.
    pub closed: u64,
    /// Times that a reader thread had to wait for room.
    pub waits: u64,
}

impl Count {
    /// Samples in the channel or kept back by a sender.
    pub fn on_the_way(&self) -> u64 {
        let ended =
            self.received + self.coalesced + self.lost_motion + self.lost_transition + self.closed;
        self.sent.saturating_sub(ended)
    }

    /// The sum, field by field.
    pub fn plus(self, o: Count) -> Count {
        Count {
            sent: self.sent + o.sent,
            received: self.received + o.received,
            coalesced: self.coalesced + o.coalesced,
            lost_motion: self.lost_motion + o.lost_motion,
            lost_transition: self.lost_transition + o.lost_transition,
            closed: self.closed + o.closed,
            waits: self.waits + o.waits,
        }
    }
}

/// Makes senders; cheap to clone and to hand to any thread.
#[derive(Debug, Clone)]
pub struct SenderFactory {
    tx: cc::Sender<Sample>,
    stats: Arc<Stats>,
}

impl SenderFactory {
    /// A sender for one adaptor. All samples of one device must go through one sender.
    pub fn sender(&self) -> Sender {
        Sender {
            tx: self.tx.clone(),
            stats: self.stats.clone(),
            last: Vec::new(),
            pending: VecDeque::new(),
            stop: None,
            calibrations: Vec::new(),
        }
    }

    /// The counters of every device.
    pub fn stats(&self) -> Arc<Stats> {
        self.stats.clone()
    }
}

/// One adaptor's end. Owned by its reader thread.
#[derive(Debug)]
pub struct Sender {
    tx: cc::Sender<Sample>,
    stats: Arc<Stats>,
    /// The last sample pushed for each device, to distinguish motion from a transition. There are
    /// few, so the search is linear.
    last: Vec<Sample>,
    pending: VecDeque<Kept>,
    stop: Option<Arc<AtomicBool>>,
    /// The person's calibrations, for the few devices of this adaptor that have one.
    calibrations: Vec<(DeviceId, Calibration)>,
}

#[derive(Debug, Clone, Copy)]
struct Kept {
    sample: Sample,
    motion: bool,
}

impl Sender {
    /// Sets the flag after which no call waits any more. An adaptor passes its stop flag.
    pub fn stop_when(&mut self, flag: Arc<AtomicBool>) {
        self.stop = Some(flag);
    }

    /// Samples of this device go out as the person set it up, from here on.
    pub fn calibrate(&mut self, device: DeviceId, calibration: Calibration) {
        self.calibrations.retain(|(d, _)| *d != device);
        if !calibration.is_plain() {
            self.calibrations.push((device, calibration));
        }
    }

    /// The counters of every device.
    pub fn stats(&self) -> Arc<Stats> {
        self.stats.clone()
    }

    /// Samples that are kept because the channel is full.
    pub fn pending(&self) -> usize {
        self.pending.len()
    }

    /// Hands one sample over. Never waits for motion. For a transition it waits only when the
    /// channel *and* the list of kept samples are full, and then it is the caller, a reader thread,
    /// that waits.
    pub fn push(&mut self, mut sample: Sample) {
        if let Some((_, calibration)) = self.calibrations.iter().find(|(d, _)| *d == sample.device)
        {
            calibration.apply(&mut sample);
        }
        self.stats.device(sample.device).sent.fetch_add(1, Relaxed);
        let motion = self.remember(sample);
        self.flush();
        if self.pending.is_empty() {
            match self.tx.try_send(sample) {
                Ok(()) => return,
                Err(cc::TrySendError::Disconnected(_)) => return self.count_closed(sample.device),
                Err(cc::TrySendError::Full(_)) => {}
            }
        }
        self.keep(Kept { sample, motion });
    }

    /// Counts a sample of motion that the adaptor itself replaced by a newer one, because more came
    /// than its rate allows.
    pub fn count_coalesced(&self, device: DeviceId) {
        let counters = self.stats.device(device);
        counters.sent.fetch_add(1, Relaxed);
        counters.coalesced.fetch_add(1, Relaxed);
    }

    /// Sends the kept samples, as far as there is room. True when nothing is left. An
    /// adaptor calls it whenever its device is silent.
    pub fn flush(&mut self) -> bool {
        while let Some(kept) = self.pending.front() {
            match self.tx.try_send(kept.sample) {
                Ok(()) => {}
                Err(cc::TrySendError::Disconnected(s)) => self.count_closed(s.device),
                Err(cc::TrySendError::Full(_)) => return false,
            }
            self.pending.pop_front();
        }
        true
    }

    /// Notes the device's newest state; true if nothing but motion changed.
    fn remember(&mut self, sample: Sample) -> bool {
        match self.last.iter_mut().find(|l| l.device == sample.device) {
            Some(last) => {
                let motion = sample.only_moved_since(last);
                *last = sample;
                motion
            }
            None => {
                self.last.push(sample);
                false
            }
        }
    }

    fn keep(&mut self, new: Kept) {
        let counters = self.stats.device(new.sample.device);
        if new.motion
            && let Some(newest) =
                self.pending.iter_mut().rev().find(|k| k.sample.device == new.sample.device)
            && newest.motion
        {
            newest.sample = new.sample;
            counters.coalesced.fetch_add(1, Relaxed);
            return;
        }
        if self.pending.len() < MAX_PENDING {
            self.pending.push_back(new);
            return;
        }
        if new.motion {
            counters.lost_motion.fetch_add(1, Relaxed);
            return;
        }
        // A transition and no room: motion is dropped first, then the reader waits.
        if let Some(at) = self.pending.iter().position(|k| k.motion) {
            if let Some(gone) = self.pending.remove(at) {
                self.stats.device(gone.sample.device).lost_motion.fetch_add(1, Relaxed);
            }
        } else {
            counters.waits.fetch_add(1, Relaxed);
            loop {
                if self.stop.as_ref().is_some_and(|s| s.load(Relaxed)) {
                    self.stats.device(new.sample.device).lost_transition.fetch_add(1, Relaxed);
                    return;
                }
                if self.hand_over_one() {
                    break;
                }
            }
        }
        self.pending.push_back(new);
    }

    /// Waits one slice for room for the oldest kept sample. Returns true when it was sent.
    fn hand_over_one(&mut self) -> bool {
        let Some(kept) = self.pending.front() else { return true };
        match self.tx.send_timeout(kept.sample, WAIT_SLICE) {
            Ok(()) => {}
            Err(cc::SendTimeoutError::Disconnected(s)) => self.count_closed(s.device),
            Err(cc::SendTimeoutError::Timeout(_)) => return false,
        }
        self.pending.pop_front();
        true
    }

    fn count_closed(&self, id: DeviceId) {
        self.stats.device(id).closed.fetch_add(1, Relaxed);
    }
}

impl Drop for Sender {
    /// The last samples of a device (tip up, out of range) are the likeliest to be still kept: they
    /// get some time.
    fn drop(&mut self) {
        let mut slices = DROP_PATIENCE.as_millis() / WAIT_SLICE.as_millis();
        while !self.flush() && slices > 0 {
            if !self.hand_over_one() {
                slices -= 1;
            }
        }
        for kept in &self.pending {
            let c = self.stats.device(kept.sample.device);
            if kept.motion { &c.lost_motion } else { &c.lost_transition }.fetch_add(1, Relaxed);
        }
    }
}

/// The consumer's end.
#[derive(Debug)]
pub struct Receiver {
    rx: cc::Receiver<Sample>,
    stats: Arc<Stats>,
}

impl Receiver {
    /// Appends at most `max` samples to `out`, never waiting; the number appended. Allocates
    /// nothing while `out` has room for them.
    pub fn drain(&mut self, max: usize, out: &mut Vec<Sample>) -> usize {
        let before = out.len();
        while out.len() - before < max {
            let Ok(sample) = self.rx.try_recv() else { break };
            self.stats.device(sample.device).received.fetch_add(1, Relaxed);
            out.push(sample);
        }
        out.len() - before
    }

    /// The next sample, waiting for it; `None` after `patience`, or at once when every sender has
    /// gone. For commands that only watch; the tick thread never calls it.
    pub fn next_within(&mut self, patience: Duration) -> Option<Sample> {
        let sample = self.rx.recv_timeout(patience).ok()?;
        self.stats.device(sample.device).received.fetch_add(1, Relaxed);
        Some(sample)
    }

    /// Adds the arrival of a sample to what `select` waits for.
    pub fn add_to<'a>(&'a self, select: &mut cc::Select<'a>) {
        select.recv(&self.rx);
    }

    /// Samples in the channel now.
    pub fn waiting(&self) -> usize {
        self.rx.len()
    }

    /// The counters of every device.
    pub fn stats(&self) -> Arc<Stats> {
        self.stats.clone()
    }
}

#[cfg(test)]
mod tests;

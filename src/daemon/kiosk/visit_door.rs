//! The door of an installation: what a visitor does before the visit has begun waits in the loop.
//!
//! While nobody is here, a press begins a visit, and a visit begins with a reset that would wipe
//! what the press has sculpted until then. So the loop keeps the samples of a visitor from the
//! first press on, and steps them after that reset, in order. The reset takes longer on a busy
//! machine; nothing is lost for ten seconds and for as many samples as there is room for.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use crate::adaptors::ATTRACT_IDS;
use sculptd_devices::{Body, Sample, Tool};

/// Samples that wait: those of eight seconds of the fastest pen.
const ROOM: usize = 8192;
/// Longest wait for a visit, in microseconds. Then the samples are stepped without one.
const LONGEST_US: u64 = 10_000_000;

/// The door, as the keeper and the loop know it.
#[derive(Debug, Default)]
pub struct VisitDoor {
    nobody: AtomicBool,
    locked: AtomicBool,
    knocked: AtomicBool,
}

impl VisitDoor {
    /// Says whether nobody is here, so that the next press begins a visit.
    pub fn set_nobody(&self, nobody: bool) {
        self.nobody.store(nobody, Relaxed);
    }

    /// Locks the door while the installation is closed: what visitors do is left out.
    pub fn set_locked(&self, locked: bool) {
        self.locked.store(locked, Relaxed);
    }

    /// Returns true, once, if somebody pressed while nobody was here.
    pub fn take_knock(&self) -> bool {
        self.knocked.swap(false, Relaxed)
    }
}

/// The loop's side of the door.
#[derive(Debug)]
pub struct WaitingVisitor {
    door: Arc<VisitDoor>,
    samples: VecDeque<Sample>,
    /// Time of the knock that nothing has followed yet, on the loop's clock.
    since_us: Option<u64>,
}

impl WaitingVisitor {
    /// Returns an empty queue before `door`.
    pub fn new(door: Arc<VisitDoor>) -> WaitingVisitor {
        WaitingVisitor { door, samples: VecDeque::with_capacity(ROOM + 1), since_us: None }
    }

    /// Returns true while samples wait.
    pub fn waits(&self) -> bool {
        !self.samples.is_empty()
    }

    /// Takes the samples of visitors that have to wait out of `samples`, or puts the ones that need
    /// not wait any more, as many as there is room for, behind the others. `begins`: a visit begins
    /// in this tick.
    pub fn step(&mut self, samples: &mut Vec<Sample>, begins: bool, now_us: u64) {
        if self.door.locked.load(Relaxed) {
            self.since_us = None;
            self.samples.clear();
            samples.retain(is_film);
            return;
        }
        if begins {
            self.since_us = None;
        } else if self.since_us.is_none() && self.samples.is_empty() {
            if !self.door.nobody.load(Relaxed) {
                return;
            }
            let Some(first) = samples.iter().position(presses) else { return };
            self.since_us = Some(now_us);
            self.door.knocked.store(true, Relaxed);
            self.keep(samples, first);
            return;
        }
        let late = self.since_us.is_some_and(|since| now_us.saturating_sub(since) >= LONGEST_US);
        if late || self.samples.len() + samples.len() > ROOM {
            self.since_us = None;
        }
        if self.since_us.is_some() {
            return self.keep(samples, 0);
        }
        // The newest go to the end of the queue, in exchange for the oldest.
        for sample in samples.iter_mut().filter(|sample| !is_film(sample)) {
            self.samples.push_back(*sample);
            *sample = self.samples.pop_front().unwrap_or(*sample);
        }
        let room = samples.capacity() - samples.len();
        samples.extend(self.samples.drain(..room.min(self.samples.len())));
    }

    /// Takes the samples of visitors from `first` on.
    fn keep(&mut self, samples: &mut Vec<Sample>, first: usize) {
        let mut at = 0;
        samples.retain(|sample| {
            let goes = at < first || is_film(sample);
            at += 1;
            if !goes {
                self.samples.push_back(*sample);
            }
            goes
        });
    }
}

fn is_film(sample: &Sample) -> bool {
    ATTRACT_IDS.contains(&sample.device.0)
}

/// A pen on the surface, or a hand over the tracker: bare hands touch nothing.
fn presses(sample: &Sample) -> bool {
    !is_film(sample)
        && match &sample.body {
            Body::Pen(pen) => pen.tip && pen.tool != Tool::Mouse,
            Body::Hands(hands) => hands.count > 0,
            Body::Pad(_) => false,
        }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_devices::{DeviceId, Pen};

    fn sample(device: u16, t_us: u64, tip: bool) -> Sample {
        let pen = Pen { in_range: true, tip, ..Pen::default() };
        Sample { device: DeviceId(device), t_us, device_t_us: None, body: Body::Pen(pen) }
    }

    fn times(samples: &[Sample]) -> Vec<u64> {
        samples.iter().map(|s| s.t_us).collect()
    }

    /// The samples of one tick after the door: room for eight.
    fn tick(door: &mut WaitingVisitor, of: &[Sample], begins: bool, now_us: u64) -> Vec<u64> {
        let mut samples = Vec::with_capacity(8);
        samples.extend_from_slice(of);
        door.step(&mut samples, begins, now_us);
        assert_eq!(samples.capacity(), 8, "the tick thread allocates nothing");
        times(&samples)
    }

    #[test]
    fn a_stroke_waits_for_its_visit_and_the_film_does_not() {
        let door = Arc::new(VisitDoor::default());
        let mut waiting = WaitingVisitor::new(door.clone());
        let film = ATTRACT_IDS.start;
        // During a visit everything passes.
        assert_eq!(tick(&mut waiting, &[sample(1, 1, true)], false, 1), [1]);
        door.set_nobody(true);
        assert_eq!(
            tick(&mut waiting, &[sample(1, 2, false), sample(film, 3, true)], false, 3),
            [2, 3]
        );
        assert!(!door.take_knock(), "a pen in the air and a film knock at no door");
        let all = [sample(1, 4, false), sample(1, 5, true), sample(film, 6, true)];
        assert_eq!(tick(&mut waiting, &all, false, 6), [4, 6]);
        assert!(door.take_knock() && !door.take_knock());
        let strokes: Vec<Sample> = (7..17).map(|t| sample(1 + t as u16 % 2, t, t < 16)).collect();
        assert!(tick(&mut waiting, &strokes[..5], false, 11).is_empty());
        assert!(tick(&mut waiting, &strokes[5..], false, 16).is_empty());
        assert!(!door.take_knock(), "one knock a visit");
        door.set_nobody(false);
        // The reset comes: in order, as many as a tick has room for.
        assert_eq!(
            tick(&mut waiting, &[sample(film, 17, false)], true, 20),
            [17, 5, 7, 8, 9, 10, 11, 12]
        );
        assert!(waiting.waits());
        assert_eq!(tick(&mut waiting, &[sample(1, 21, true)], false, 22), [13, 14, 15, 16, 21]);
        assert!(!waiting.waits());
        assert_eq!(tick(&mut waiting, &[sample(1, 23, true)], false, 23), [23]);
    }

    #[test]
    fn a_locked_door_lets_the_film_through_alone() {
        let door = Arc::new(VisitDoor::default());
        let mut waiting = WaitingVisitor::new(door.clone());
        door.set_locked(true);
        let film = ATTRACT_IDS.start;
        assert_eq!(tick(&mut waiting, &[sample(1, 1, true), sample(film, 2, true)], false, 2), [2]);
        assert!(!door.take_knock() && !waiting.waits());
        door.set_locked(false);
        assert_eq!(tick(&mut waiting, &[sample(1, 3, true)], false, 3), [3]);
    }

    #[test]
    fn without_a_visit_nothing_is_lost() {
        let door = Arc::new(VisitDoor::default());
        door.set_nobody(true);
        let mut waiting = WaitingVisitor::new(door.clone());
        assert!(tick(&mut waiting, &[sample(1, 1, true)], false, 1).is_empty());
        assert!(tick(&mut waiting, &[], false, LONGEST_US).is_empty());
        assert_eq!(tick(&mut waiting, &[], false, LONGEST_US + 1), [1], "late");
        // More than there is room for.
        let (mut sent, mut came) = (0, Vec::new());
        while sent < 2 * ROOM as u64 {
            let of: Vec<Sample> = (sent..sent + 4).map(|t| sample(1, t, true)).collect();
            came.extend(tick(&mut waiting, &of, false, 5));
            sent += 4;
        }
        while waiting.waits() {
            door.set_nobody(false);
            came.extend(tick(&mut waiting, &[], false, 6));
        }
        assert_eq!(came, (0..sent).collect::<Vec<_>>());
    }
}

//! What one connection may take, and all of them together.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use sculptd_devices::Clock;

/// Connections at a time.
pub const CONNECTIONS: usize = 256;
/// Longest request head, bytes.
pub const HEAD_BYTES: usize = 8192;
/// Most header fields of a request.
pub const HEAD_FIELDS: usize = 64;
/// Longest time that a client may take to send its request.
pub const HEAD_TIME: Duration = Duration::from_secs(2);
/// Longest time in which a client may take nothing of its answer.
pub const STALLED: Duration = Duration::from_secs(10);
/// Longest time that one connection may last.
pub const WHOLE: Duration = Duration::from_secs(600);
/// Fewest bytes a second that a client takes, on average from [`STALLED`] on.
pub const SLOWEST: u64 = 4096;
/// Most bytes a second that go out, of all connections together. What readers who do not read have
/// in their kernel's buffers goes out at this rate before a quick one gets its turn.
pub const FASTEST: u64 = 256 << 20;
/// Time by which a connection may exceed that rate before it waits. A timer for less than a
/// millisecond waits for a millisecond.
const AHEAD: Duration = Duration::from_millis(20);
/// Bytes that the kernel holds for one connection in each direction (it doubles them).
pub const SOCKET_BUFFER: usize = 64 << 10;
/// Bytes of a file that are read at a time.
pub const PIECE: usize = 32 << 10;

/// State of one connection. Times are on the server's clock, in microseconds.
#[derive(Debug)]
pub struct Progress {
    begun_us: u64,
    last_us: AtomicU64,
    asked: AtomicBool,
    sent: AtomicU64,
}

impl Progress {
    /// A connection that was accepted now.
    pub fn begin(now_us: u64) -> Self {
        Progress {
            begun_us: now_us,
            last_us: AtomicU64::new(now_us),
            asked: AtomicBool::new(false),
            sent: AtomicU64::new(0),
        }
    }

    /// The request is here as a whole.
    pub fn asked(&self, now_us: u64) {
        self.asked.store(true, Relaxed);
        self.last_us.store(now_us, Relaxed);
    }

    /// The client's socket took `bytes`.
    pub fn sent(&self, now_us: u64, bytes: usize) {
        self.sent.fetch_add(bytes as u64, Relaxed);
        self.last_us.store(now_us, Relaxed);
    }

    /// Returns true if the connection may continue.
    pub fn within_bounds(&self, now_us: u64) -> bool {
        let age = now_us.saturating_sub(self.begun_us);
        let quiet = now_us.saturating_sub(self.last_us.load(Relaxed));
        let us = |time: Duration| time.as_micros() as u64;
        if !self.asked.load(Relaxed) {
            return age < us(HEAD_TIME);
        }
        let least = age.saturating_sub(us(STALLED)) / 1_000_000 * SLOWEST;
        quiet < us(STALLED) && age < us(WHOLE) && self.sent.load(Relaxed) >= least
    }
}

/// The connections that there are, by the number in which they came.
#[derive(Debug, Default)]
pub struct ConnectionTable {
    taken: Mutex<BTreeMap<u64, (Arc<Progress>, tokio::task::AbortHandle)>>,
}

impl ConnectionTable {
    fn locked(&self) -> MutexGuard<'_, BTreeMap<u64, (Arc<Progress>, tokio::task::AbortHandle)>> {
        // Entries are put in and taken out as a whole: a panic leaves none half made.
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends the connection that has made no progress for the longest time, if all places are taken.
    pub fn make_room(&self) {
        let gone = {
            let mut taken = self.locked();
            if taken.len() < CONNECTIONS {
                return;
            }
            let longest = taken.iter().min_by_key(|(n, (p, _))| (p.last_us.load(Relaxed), **n));
            let number = longest.map(|(n, _)| *n);
            number.and_then(|n| taken.remove(&n))
        };
        // Without the lock: the task strikes itself out as it ends.
        if let Some((_, task)) = gone {
            task.abort();
        }
    }

    /// Enters a connection.
    pub fn enter(&self, number: u64, progress: Arc<Progress>, task: tokio::task::AbortHandle) {
        if !task.is_finished() {
            self.locked().insert(number, (progress, task));
        }
    }

    /// Strikes a connection out.
    pub fn leave(&self, number: u64) {
        self.locked().remove(&number);
    }

    /// Connections at present; never more than [`CONNECTIONS`].
    pub fn count(&self) -> usize {
        self.locked().len()
    }
}

/// Spreads what goes out over time, so that all connections together stay under [`FASTEST`].
#[derive(Debug)]
pub struct OutgoingRate {
    clock: Clock,
    free_us: AtomicU64,
}

impl OutgoingRate {
    /// Nothing has gone out yet.
    pub fn new(clock: Clock) -> Self {
        OutgoingRate { clock, free_us: AtomicU64::new(0) }
    }

    /// Reserves time for `bytes`. Returns how long to wait before they go out.
    pub fn reserve(&self, bytes: usize) -> Duration {
        let takes = bytes as u64 * 1_000_000 / FASTEST;
        let now = self.clock.now_us();
        // One thread serves, so nothing comes between the two.
        let free = self.free_us.load(Relaxed).max(now);
        self.free_us.store(free + takes, Relaxed);
        Duration::from_micros(free - now).saturating_sub(AHEAD)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_connection_that_makes_no_progress_is_out_of_bounds() {
        let silent = Progress::begin(0);
        assert!(silent.within_bounds(1_900_000) && !silent.within_bounds(2_000_000));
        let stalled = Progress::begin(0);
        stalled.asked(500_000);
        assert!(stalled.within_bounds(10_400_000) && !stalled.within_bounds(10_500_000));
        // A byte a second is progress, and too little of it.
        let trickle = Progress::begin(0);
        trickle.asked(0);
        (1..=30).for_each(|s| trickle.sent(s * 1_000_000, 1));
        assert!(!trickle.within_bounds(30_000_000));
        let steady = Progress::begin(0);
        steady.asked(0);
        (1..=30).for_each(|s| steady.sent(s * 1_000_000, 8192));
        assert!(steady.within_bounds(30_000_000));
        steady.sent(600_000_000, 1 << 30);
        assert!(!steady.within_bounds(600_000_000), "ten minutes are enough for anybody");
    }

    #[test]
    fn all_connections_together_stay_under_the_highest_rate() {
        let pace = OutgoingRate::new(Clock::manual());
        let waits = (0..64).map(|_| pace.reserve(1 << 20)).collect::<Vec<_>>();
        assert_eq!(waits[0], Duration::ZERO);
        let last = waits[63].as_secs_f64();
        assert!((last - 63.0 / 256.0 + AHEAD.as_secs_f64()).abs() < 0.001, "{last}");
    }
}

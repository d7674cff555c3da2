//! The clock of a window: while it handles an event that waited, the time is that of the event.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use sculptd_devices::Clock;

/// A clock on which an event that was handled late keeps its own time.
#[derive(Debug, Clone)]
pub struct EventClock {
    clock: Clock,
    /// Time of the event that is being handled, in microseconds; 0: none.
    event_us: Arc<AtomicU64>,
}

impl EventClock {
    /// Creates an event clock on the clock of the samples.
    pub fn new(clock: Clock) -> Self {
        EventClock { clock, event_us: Arc::default() }
    }

    /// Microseconds: the time of the event that is being handled, or else the present.
    pub fn now_us(&self) -> u64 {
        match self.event_us.load(Relaxed) {
            0 => self.clock.now_us(),
            us => us,
        }
    }

    /// Begins an event of the time `us`, or ends it with `None`.
    pub fn set_event(&self, us: Option<u64>) {
        self.event_us.store(us.unwrap_or(0), Relaxed);
    }
}

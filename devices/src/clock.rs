//! The daemon's monotonic clock, in microseconds. It can be held and moved by hand, so that tests,
//! replays and the stepped demo see the same stamps on every run.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::SeqCst};
use std::time::Instant;

/// A monotonic clock that counts microseconds from an arbitrary origin.
#[derive(Debug, Clone)]
pub enum Clock {
    /// Microseconds since the clock was made.
    Monotonic(Instant),
    /// Microseconds as last set by [`Clock::set_us`].
    Manual(Arc<AtomicU64>),
}

impl Clock {
    /// A clock that runs, from 0 now on.
    // The only place in this crate that reads the machine's clock.
    #[allow(clippy::disallowed_methods)]
    pub fn monotonic() -> Self {
        Clock::Monotonic(Instant::now())
    }

    /// Creates a clock that stays at 0 until [`Clock::set_us`] moves it.
    pub fn manual() -> Self {
        Clock::Manual(Arc::new(AtomicU64::new(0)))
    }

    /// Microseconds since the clock's origin.
    pub fn now_us(&self) -> u64 {
        match self {
            Clock::Monotonic(start) => start.elapsed().as_micros() as u64,
            Clock::Manual(us) => us.load(SeqCst),
        }
    }

    /// The same in nanoseconds, for timing short work; a manual clock knows microseconds only.
    pub fn now_ns(&self) -> u64 {
        match self {
            Clock::Monotonic(start) => start.elapsed().as_nanos() as u64,
            Clock::Manual(_) => self.now_us() * 1000,
        }
    }

    /// Moves a manual clock; a monotonic one cannot be moved and stays as it is.
    pub fn set_us(&self, us: u64) {
        if let Clock::Manual(now) = self {
            now.store(us, SeqCst);
        }
    }
}

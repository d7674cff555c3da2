//! Waiting for other threads and processes: for a condition, with one generous bound for all tests,
//! because the machine may be loaded.

use std::time::Duration;

use sculptd_devices::Clock;

/// The one bound.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Waits until it is so.
pub fn until(what: &str, so: impl FnMut() -> bool) {
    assert!(comes(so), "never: {what}");
}

/// Returns true if the condition becomes true within the time limit.
pub fn comes(mut so: impl FnMut() -> bool) -> bool {
    let clock = Clock::monotonic();
    while !so() {
        if clock.now_us() >= PATIENCE.as_micros() as u64 {
            return false;
        }
        pause(5);
    }
    true
}

/// Stands still.
pub fn pause(ms: u64) {
    let _ = crossbeam_channel::never::<()>().recv_timeout(Duration::from_millis(ms));
}

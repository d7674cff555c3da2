//! The state of a session's file, as others see it.

use std::sync::atomic::{AtomicU64, Ordering::SeqCst};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use sculptd_devices::Clock;

/// The journal's current fault, for people; `None` if there is none.
pub type Fault = Arc<Mutex<Option<String>>>;

/// Longest that a reply waits for its input to be safe from a kill.
const SAFE_PATIENCE: Duration = Duration::from_millis(300);
/// Time between two looks.
const SAFE_LOOK: Duration = Duration::from_micros(100);

/// State of the journal, for `status`, the log and the watchdog.
#[derive(Debug, Clone, Default)]
pub struct Health {
    pub fault: Fault,
    /// Number of ticks whose input the file has lost.
    pub lost: Arc<AtomicU64>,
    /// The last tick whose input was handed to the writing threads.
    pub handed: Arc<AtomicU64>,
    /// The last tick whose input outlives the process: in shared memory, or in the file.
    pub safe: Arc<AtomicU64>,
    /// The last tick on the disk.
    pub written: Arc<AtomicU64>,
    /// Grows with every turn of the writing thread: it is alive, whatever the disk does.
    pub turns: Arc<AtomicU64>,
}

impl Health {
    /// Waits until all input that was handed over so far outlives a kill of the process. Returns
    /// false if it does not within a short time, or if input was lost.
    pub fn wait_until_safe(&self) -> bool {
        let (handed, clock) = (self.handed.load(SeqCst), Clock::monotonic());
        let until = clock.now_us() + SAFE_PATIENCE.as_micros() as u64;
        while self.safe.load(SeqCst) < handed {
            if self.lost.load(SeqCst) > 0 || clock.now_us() >= until {
                return false;
            }
            let _ = crossbeam_channel::never::<()>().recv_timeout(SAFE_LOOK);
        }
        true
    }

    /// Returns the current fault, if any.
    pub fn trouble(&self) -> Option<String> {
        self.fault.lock().ok().and_then(|f| f.clone())
    }
}

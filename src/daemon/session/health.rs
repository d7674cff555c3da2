//! The state of a session's file, as others see it.

use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex};

/// The journal's current fault, for people; `None` if there is none.
pub type Fault = Arc<Mutex<Option<String>>>;

/// State of the journal, for `status`, the log and the watchdog.
#[derive(Debug, Clone, Default)]
pub struct Health {
    pub fault: Fault,
    /// Number of ticks whose input the file has lost.
    pub lost: Arc<AtomicU64>,
    /// The last tick on the disk.
    pub written: Arc<AtomicU64>,
    /// Grows with every turn of the writing thread: it is alive, whatever the disk does.
    pub turns: Arc<AtomicU64>,
}

impl Health {
    /// Returns the current fault, if any.
    pub fn trouble(&self) -> Option<String> {
        self.fault.lock().ok().and_then(|f| f.clone())
    }
}

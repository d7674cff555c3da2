//! How long work is watched and stopped.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Shared between the one who asked and the one who works. The worker looks at [`Job::cancelled`]
/// at least every 50 ms and reports its progress; neither waits for the other.
#[derive(Debug, Default)]
pub struct Job {
    cancelled: AtomicBool,
    per_mille: AtomicU32,
}

/// The asker lost interest. Nothing was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl Job {
    /// Asks the worker to stop; from any thread.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    /// Returns true if the job was cancelled.
    pub fn cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// `Err` once the asker cancelled: `job.check()?` inside every long loop.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// `done` from 0 to 1.
    pub fn progress(&self, done: f32) {
        self.per_mille.store((done.clamp(0.0, 1.0) * 1000.0) as u32, Relaxed);
    }

    /// The progress last reported, 0 to 1 in steps of a thousandth.
    pub fn done(&self) -> f32 {
        self.per_mille.load(Relaxed) as f32 / 1000.0
    }
}

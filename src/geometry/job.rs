//! How long work is watched and stopped.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Shared between the one who asked and the one who works. The worker looks at [`Job::cancelled`]
/// at least every 50 ms and reports its progress; neither waits for the other.
#[derive(Debug, Default)]
pub struct Job {
    cancelled: AtomicBool,
    per_mille: AtomicU32,
    /// Of the whole in thousandths: what was done before the part that is reported now, and what
    /// that part is not.
    before: AtomicU32,
    beside: AtomicU32,
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

    /// Reports progress, from 0 to 1, of the whole or of the part that [`Job::part`] named. It
    /// never falls: a smaller value than an earlier one changes nothing.
    pub fn progress(&self, done: f32) {
        let part = 1000 - self.beside.load(Relaxed).min(1000);
        let own = (done.clamp(0.0, 1.0) * part as f32) as u32;
        self.per_mille.fetch_max((self.before.load(Relaxed) + own).min(1000), Relaxed);
    }

    /// Makes what is reported from now on a part of the whole: step `step` of `steps`, from 0 on.
    /// `part(0, 1)` is the whole again.
    pub fn part(&self, step: usize, steps: usize) {
        let steps = steps.max(1);
        let at = |n: usize| (n.min(steps) * 1000 / steps) as u32;
        self.before.store(at(step), Relaxed);
        self.beside.store(1000 - (at(step + 1) - at(step)), Relaxed);
    }

    /// The furthest progress reported, 0 to 1 in steps of a thousandth.
    pub fn done(&self) -> f32 {
        self.per_mille.load(Relaxed) as f32 / 1000.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_progress_of_steps_only_grows() {
        let (job, mut last) = (Job::default(), 0.0);
        for step in 0..7 {
            job.part(step, 7);
            for done in [0.0, 0.2, 1.0] {
                job.progress(done);
                assert!(job.done() >= last, "{step} {done}");
                last = job.done();
            }
        }
        assert_eq!(last, 1.0);
        job.part(0, 1);
        job.progress(0.25);
        assert_eq!(job.done(), 1.0);
    }
}

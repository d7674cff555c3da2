//! The threads that help with a large dab. The tick thread is one of them.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads that work on a dab's pages. The first thread that uses them takes part itself, so it
/// should be the tick thread; others may use them too, but then only wait. Results do not depend on
/// the count.
#[derive(Debug, Clone)]
pub struct Workers {
    count: usize,
    pool: Arc<OnceLock<Option<ThreadPool>>>,
}

impl Workers {
    /// `count` threads, the caller's among them; 0 counts as 1. No thread is started yet.
    pub fn new(count: usize) -> Self {
        Workers { count: count.max(1), pool: Arc::default() }
    }

    /// Returns the number of threads that work on a dab.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Starts the threads, so that the first dab does not have to. The thread that calls it is the
    /// one that will use them.
    pub fn warm(&self) {
        self.pool();
        // rayon's queues register a thread with crossbeam's memory reclamation when it takes work
        // from another thread's queue for the first time, and that allocates. On a busy machine
        // this first time may be in the middle of a stroke.
        drop(crossbeam_epoch::pin());
    }

    fn pool(&self) -> Option<&ThreadPool> {
        if self.count == 1 {
            return None;
        }
        let named = || {
            ThreadPoolBuilder::new()
                .num_threads(self.count)
                .thread_name(|i| format!("sculptd-worker-{i}"))
        };
        // A thread can belong to one pool only; if this one does, the pool works without it.
        self.pool
            .get_or_init(|| named().use_current_thread().build().or_else(|_| named().build()).ok())
            .as_ref()
    }

    /// Calls `work` with each pair, on several threads if `parallel`. Pairs are handed out one by
    /// one: what they cost differs by far more than handing out does, and threads that finish at
    /// different times wait for each other.
    pub(super) fn each<A: Send, B: Send>(
        &self,
        parallel: bool,
        a: &mut [A],
        b: &mut [B],
        work: impl Fn(&mut A, &mut B) + Sync,
    ) {
        match if parallel { self.pool() } else { None } {
            Some(pool) => pool.install(|| {
                let pairs = a.par_iter_mut().zip(b.par_iter_mut());
                pairs.with_max_len(1).for_each(|(a, b)| work(a, b));
            }),
            None => a.iter_mut().zip(b.iter_mut()).for_each(|(a, b)| work(a, b)),
        }
    }
}

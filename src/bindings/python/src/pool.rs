//! Threads for parallel work, one pool a process. A forked process has none of its parent's
//! threads, so it makes a pool of its own at its first use.

use std::sync::{Arc, Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// The process that made the pool, and the pool.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

fn of_this_process() -> Option<Arc<ThreadPool>> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let own = std::process::id();
    match &*pool {
        Some((process, pool)) if *process == own => return Some(pool.clone()),
        _ => {}
    }
    let made = Arc::new(ThreadPoolBuilder::new().build().ok()?);
    // The threads of the parent's pool do not exist here: nothing may wait for them.
    std::mem::forget(pool.replace((own, made.clone())));
    Some(made)
}

/// Runs `work` with the threads of this process.
pub fn here<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match of_this_process() {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

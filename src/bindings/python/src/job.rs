//! Long work without the interpreter's lock, watched by the interpreter.

use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use crate::pool;
use pyo3::prelude::*;
use sculptd_geometry::job::Job;

/// Between two looks at signals and at the progress.
const LOOK: Duration = Duration::from_millis(100);
/// The time that cancelled work has to stop before it is left behind.
const GRACE: Duration = Duration::from_millis(50);

/// A progress callback: a Python function of one number from 0 to 1.
pub type Progress = Option<Py<PyAny>>;

/// Runs `work` on a separate thread. While it runs, the interpreter's lock is free. About ten times
/// a second the calling thread takes it, lets Python handle its signals and calls `progress`; an
/// exception from either cancels the job and is raised at most [`GRACE`] later. Work that has not
/// stopped by then stops at its next look at the job; its result is dropped.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: &Progress,
    work: impl FnOnce(&Job) -> T + Send + 'static,
) -> PyResult<T> {
    let (send, receive) = sync_channel(1);
    let out = py.detach(move || {
        let job = Arc::new(Job::default());
        let own = job.clone();
        let thread = std::thread::spawn(move || {
            // Nobody waits for the result of work that was left behind.
            let _ = send.send(pool::here(|| work(&own)));
        });
        loop {
            match receive.recv_timeout(LOOK) {
                Ok(out) => return Ok(out),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => match thread.join() {
                    Err(panic) => std::panic::resume_unwind(panic),
                    Ok(()) => unreachable!("the thread sends its result"),
                },
            }
            let looked = Python::attach(|py| {
                py.check_signals()?;
                match progress {
                    Some(call) => call.call1(py, (job.done(),)).map(|_| ()),
                    None => Ok(()),
                }
            });
            if let Err(e) = looked {
                job.cancel();
                let _ = receive.recv_timeout(GRACE);
                return Err(e);
            }
        }
    })?;
    if let Some(call) = progress {
        call.call1(py, (1.0,))?;
    }
    Ok(out)
}

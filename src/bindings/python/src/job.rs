//! Long work without the interpreter's lock, watched by the interpreter.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use crate::pool;
use pyo3::prelude::*;
use sculptd_geometry::job::Job;

/// Between two looks at signals and at the progress.
const LOOK: Duration = Duration::from_millis(100);

/// A progress callback: a Python function of one number from 0 to 1.
pub type Progress = Option<Py<PyAny>>;

/// Runs `work` on a separate thread. While it runs, the interpreter's lock is free. About ten times
/// a second the calling thread takes it, lets Python handle its signals and calls `progress`; an
/// exception from either cancels the job, and is raised once the work has stopped.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: &Progress,
    work: impl FnOnce(&Job) -> T + Send,
) -> PyResult<T> {
    let (done, wait) = sync_channel::<()>(1);
    let raised = py.detach(move || {
        let job = &Job::default();
        std::thread::scope(|scope| {
            let thread = scope.spawn(move || {
                // Dropped at the end, also by a panic: the receiver then sees a closed channel.
                let _done = done;
                pool::here(|| work(job))
            });
            let mut raised = None;
            while wait.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                let looked = Python::attach(|py| {
                    py.check_signals()?;
                    match progress {
                        Some(call) => call.call1(py, (job.done(),)).map(|_| ()),
                        None => Ok(()),
                    }
                });
                if let Err(e) = looked {
                    job.cancel();
                    raised = Some(e);
                    break;
                }
            }
            (thread.join(), raised)
        })
    });
    match raised {
        (_, Some(e)) => Err(e),
        (Ok(out), None) => {
            if let Some(call) = progress {
                call.call1(py, (1.0,))?;
            }
            Ok(out)
        }
        (Err(panic), None) => std::panic::resume_unwind(panic),
    }
}

//! The work of requests that takes time, as `progress` and `cancel` know it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use sculptd_control::RpcError;
use sculptd_geometry::job::Job;

/// All work under way, oldest first.
#[derive(Debug, Default)]
pub struct Jobs(Mutex<Vec<JobEntry>>);

#[derive(Debug)]
struct JobEntry {
    job: Arc<Job>,
    /// Operations change whole objects; there is one at a time.
    is_operation: bool,
}

/// Work under way; over when dropped, also on panic.
#[derive(Debug)]
pub(super) struct JobPlace<'a> {
    jobs: &'a Jobs,
    pub job: Arc<Job>,
}

impl Jobs {
    /// The list, whether or not a thread that held it has panicked.
    fn all(&self) -> MutexGuard<'_, Vec<JobEntry>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins to change a whole object, or refuses if that is done for another request.
    pub(super) fn begin_operation(&self) -> Result<JobPlace<'_>, RpcError> {
        let mut all = self.all();
        if all.iter().any(|e| e.is_operation) {
            let text = "another operation is under way. Wait for it, or cancel it";
            return Err(RpcError::failed(text));
        }
        let job = Arc::new(Job::default());
        all.push(JobEntry { job: job.clone(), is_operation: true });
        Ok(JobPlace { jobs: self, job })
    }

    /// Begins work of which there may be more at a time.
    pub(super) fn begin(&self) -> JobPlace<'_> {
        let job = Arc::new(Job::default());
        self.all().push(JobEntry { job: job.clone(), is_operation: false });
        JobPlace { jobs: self, job }
    }

    /// Progress of the operation, else of the oldest work; `None`: nothing is under way.
    pub(super) fn done(&self) -> Option<f32> {
        let all = self.all();
        all.iter().find(|e| e.is_operation).or(all.first()).map(|e| e.job.done())
    }

    /// Cancels all work. Returns false if there is none.
    pub(super) fn cancel(&self) -> bool {
        let all = self.all();
        all.iter().for_each(|e| e.job.cancel());
        !all.is_empty()
    }
}

impl Drop for JobPlace<'_> {
    fn drop(&mut self) {
        self.jobs.all().retain(|e| !Arc::ptr_eq(&e.job, &self.job));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_one_operation_at_a_time_and_a_panic_ends_it() {
        let jobs = Arc::new(Jobs::default());
        let held = jobs.begin_operation().expect("free");
        assert!(jobs.begin_operation().is_err(), "one at a time");
        let other = jobs.begin();
        assert!(jobs.cancel() && held.job.cancelled() && other.job.cancelled());
        held.job.progress(0.5);
        assert_eq!(jobs.done(), Some(0.5));
        drop((held, other));
        assert_eq!((jobs.done(), jobs.cancel()), (None, false));
        let inner = jobs.clone();
        let thread = std::thread::spawn(move || {
            let _place = inner.begin_operation().expect("free");
            panic!("a bug in an operation (expected in this test)");
        });
        assert!(thread.join().is_err());
        assert!(jobs.begin_operation().is_ok(), "the place is free again");
    }
}

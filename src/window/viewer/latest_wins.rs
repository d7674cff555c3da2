//! A latest-wins worker: a thread with one slot. A newer request replaces one that still waits,
//! and the job under way is cancelled.

use std::sync::Arc;

use crossbeam_channel as cc;

use sculptd_geometry::job::Job;

/// A request, and the job by which it is cancelled.
pub(super) type Request<W> = (W, Arc<Job>);

#[derive(Debug)]
pub struct LatestWins<W> {
    slot: (cc::Sender<Request<W>>, cc::Receiver<Request<W>>),
    under_way: Arc<Job>,
    /// True if a new request cancels the one under way.
    cancels: bool,
}

impl<W: Send + 'static> LatestWins<W> {
    /// Calls `each` with one request after another on a separate thread. The thread ends when
    /// `each` returns `false` or when this worker is dropped.
    pub fn start(
        name: &str,
        mut each: impl FnMut(W, &Job) -> bool + Send + 'static,
    ) -> LatestWins<W> {
        let slot = cc::bounded::<Request<W>>(1);
        let receiver = slot.1.clone();
        let _ = std::thread::Builder::new().name(name.into()).spawn(move || {
            while let Ok((request, job)) = receiver.recv() {
                if !each(request, &job) {
                    return;
                }
            }
        });
        LatestWins { slot, under_way: Arc::default(), cancels: true }
    }

    /// As [`LatestWins::start`], for a thread that looks for newer requests itself by the receiver:
    /// `run` is called once, and the job under way goes on.
    pub fn follow(
        name: &str,
        run: impl FnOnce(&cc::Receiver<Request<W>>) + Send + 'static,
    ) -> LatestWins<W> {
        let slot = cc::bounded::<Request<W>>(1);
        let receiver = slot.1.clone();
        let _ = std::thread::Builder::new().name(name.into()).spawn(move || run(&receiver));
        LatestWins { slot, under_way: Arc::default(), cancels: false }
    }

    /// Replaces whatever was requested before. Returns the job by which it is cancelled.
    pub fn request(&mut self, request: W) -> Arc<Job> {
        if self.cancels {
            self.cancel();
            self.under_way = Arc::default();
        } else {
            let _ = self.slot.1.try_recv();
        }
        let _ = self.slot.0.try_send((request, self.under_way.clone()));
        self.under_way.clone()
    }

    /// Cancels the job under way and empties the slot.
    pub fn cancel(&self) {
        self.under_way.cancel();
        let _ = self.slot.1.try_recv();
    }
}

impl<W> Drop for LatestWins<W> {
    fn drop(&mut self) {
        self.under_way.cancel();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_request_counts_and_the_one_under_way_is_cancelled() {
        let (say, said) = cc::unbounded();
        let (begun, begins) = cc::unbounded();
        let mut worker = LatestWins::start("test", move |request: u32, job| {
            let _ = begun.send(request);
            // The first runs until it is cancelled.
            while request == 1 && !job.cancelled() {
                std::thread::yield_now();
            }
            say.send((request, job.cancelled())).is_ok()
        });
        worker.request(1);
        assert_eq!(begins.recv(), Ok(1));
        worker.request(2);
        worker.request(3);
        assert_eq!(said.recv(), Ok((1, true)));
        let second = said.recv().expect("another");
        // The second may have started before the third came, but then it was cancelled.
        if second != (3, false) {
            assert_eq!(second.0, 2);
            assert_eq!(said.recv(), Ok((3, false)));
        }
        drop(worker);
        assert!(said.recv().is_err(), "the thread ends with its owner");
    }
}

//! A thread that works on the newest wish: one slot, a newer wish replaces one that still waits,
//! and the work under way is told to stop.

use std::sync::Arc;

use crossbeam_channel as cc;

use sculptd_geometry::job::Job;

/// A wish, and how its work is told to stop.
type Wish<W> = (W, Arc<Job>);

#[derive(Debug)]
pub struct Newest<W> {
    slot: (cc::Sender<Wish<W>>, cc::Receiver<Wish<W>>),
    under_way: Arc<Job>,
}

impl<W: Send + 'static> Newest<W> {
    /// `each` is called with one wish after another, and ends when it says `false` or nobody can
    /// wish any more.
    pub fn start(name: &str, mut each: impl FnMut(W, &Job) -> bool + Send + 'static) -> Newest<W> {
        let slot = cc::bounded::<Wish<W>>(1);
        let receiver = slot.1.clone();
        let _ = std::thread::Builder::new().name(name.into()).spawn(move || {
            while let Ok((wish, job)) = receiver.recv() {
                if !each(wish, &job) {
                    return;
                }
            }
        });
        Newest { slot, under_way: Arc::default() }
    }

    /// Asks for this, and for nothing asked before.
    pub fn wish(&mut self, wish: W) {
        self.cancel();
        self.under_way = Arc::default();
        let _ = self.slot.0.try_send((wish, self.under_way.clone()));
    }

    /// Nothing is wanted any more.
    pub fn cancel(&self) {
        self.under_way.cancel();
        let _ = self.slot.1.try_recv();
    }
}

impl<W> Drop for Newest<W> {
    fn drop(&mut self) {
        self.under_way.cancel();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_wish_counts_and_what_is_under_way_stops() {
        let (say, said) = cc::unbounded();
        let (begun, begins) = cc::unbounded();
        let mut newest = Newest::start("test", move |wish: u32, job| {
            let _ = begun.send(wish);
            // The first runs until it is told to stop.
            while wish == 1 && !job.cancelled() {
                std::thread::yield_now();
            }
            say.send((wish, job.cancelled())).is_ok()
        });
        newest.wish(1);
        assert_eq!(begins.recv(), Ok(1));
        newest.wish(2);
        newest.wish(3);
        assert_eq!(said.recv(), Ok((1, true)));
        let second = said.recv().expect("another");
        // The second may have been taken before the third came, but then it was told to stop.
        if second != (3, false) {
            assert_eq!(second.0, 2);
            assert_eq!(said.recv(), Ok((3, false)));
        }
        drop(newest);
        assert!(said.recv().is_err(), "the thread ends with its owner");
    }
}

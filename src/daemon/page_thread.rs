//! The thread that makes pages ahead of need, for dynamic topology.
//!
//! Laws kept here: the tick thread takes a page without waiting and without calling the allocator,
//! as long as one is ready. Nothing is made before topology is changed for the first time, and
//! nothing while enough is ready: an idle daemon uses no processor time for it.

use std::sync::Arc;

use crossbeam_channel as cc;

use sculptd_clay::{PageSupply, SparePage, SupplyPages};

/// Pages ready, at most: about 20 MB. A tick's topology writes some twenty, and its dabs at most
/// as many again for the first time in a stroke.
pub const READY: usize = 256;
/// With fewer ready the thread is woken.
const WAKE_BELOW: usize = READY - READY / 4;

/// The tick thread's end of the thread that makes pages. The thread ends when the last supply is
/// dropped.
#[derive(Debug, Clone)]
pub struct PageThread(Arc<Ready>);

#[derive(Debug)]
struct Ready {
    pages: cc::Receiver<SparePage>,
    wake: cc::Sender<()>,
}

impl SupplyPages for Ready {
    fn take(&self) -> Option<SparePage> {
        let page = self.pages.try_recv().ok();
        if self.pages.len() < WAKE_BELOW {
            // A full queue: it is awake.
            let _ = self.wake.try_send(());
        }
        page
    }
}

impl PageThread {
    /// # Errors
    /// If no thread can be started.
    pub fn start() -> std::io::Result<Self> {
        let (give, pages) = cc::bounded(READY);
        let (wake, woken) = cc::bounded(1);
        std::thread::Builder::new().name("sculptd-pages".into()).spawn(move || {
            for () in woken {
                while !give.is_full() {
                    if give.send(SparePage::new()).is_err() {
                        return;
                    }
                }
            }
        })?;
        Ok(PageThread(Arc::new(Ready { pages, wake })))
    }

    /// A supply for the world and its clay.
    pub fn supply(&self) -> PageSupply {
        PageSupply::new(self.0.clone())
    }

    /// Pages that are ready now.
    pub fn ready(&self) -> usize {
        self.0.pages.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn nothing_is_made_before_it_is_asked_for_and_enough_after() {
        let thread = PageThread::start().expect("a thread");
        let quiet = cc::never::<()>();
        let _ = quiet.recv_timeout(Duration::from_millis(20));
        assert_eq!(thread.ready(), 0);
        assert!(thread.0.take().is_none());
        for _ in 0..60_000 {
            if thread.ready() == READY {
                break;
            }
            let _ = quiet.recv_timeout(Duration::from_millis(1));
        }
        assert!((0..READY).all(|_| thread.0.take().is_some()));
    }
}

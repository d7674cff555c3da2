//! The thread that frees what the tick thread no longer needs.
//!
//! Law kept here: nothing large is freed on the tick thread, whatever is full. Garbage goes into a
//! bounded queue, which allocates nothing; when that is full, into an unbounded one, and is
//! counted.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crossbeam_channel as cc;

use sculptd_clay::{CollectGarbage, Garbage, GarbageSink};
use sculptd_engine::command::Command;

/// Garbage that the bounded queue holds.
const USUAL: usize = 4096;

/// The tick thread's end of the thread that frees. The thread ends when the last sink is dropped.
#[derive(Debug, Clone)]
pub struct GarbageThread(Arc<Queues>);

#[derive(Debug)]
struct Queues {
    usual: cc::Sender<Garbage>,
    overflow: cc::Sender<Garbage>,
    overflowed: AtomicU64,
}

impl CollectGarbage for Queues {
    fn collect(&self, garbage: Garbage) {
        if let Err(cc::TrySendError::Full(garbage)) = self.usual.try_send(garbage) {
            self.overflowed.fetch_add(1, Relaxed);
            let _ = self.overflow.send(garbage);
        }
    }
}

impl GarbageThread {
    /// # Errors
    /// If no thread can be started.
    pub fn start() -> std::io::Result<Self> {
        let (queues, usual, overflow) = queues(USUAL);
        std::thread::Builder::new().name("sculptd-drop".into()).spawn(move || {
            loop {
                let garbage = cc::select! {
                    recv(usual) -> garbage => garbage,
                    recv(overflow) -> garbage => garbage,
                };
                // Both close together. What the other still holds is freed with its receiver.
                let Ok(garbage) = garbage else { return };
                drop(garbage);
            }
        })?;
        Ok(GarbageThread(Arc::new(queues)))
    }

    /// A sink for the world and its clay.
    pub fn sink(&self) -> GarbageSink {
        GarbageSink::new(self.0.clone())
    }

    /// Returns the number of times that the bounded queue was full.
    pub fn overflowed(&self) -> u64 {
        self.0.overflowed.load(Relaxed)
    }
}

/// Empties the list; commands that own memory go to the sink.
pub fn discard_commands(commands: &mut Vec<Command>, sink: &GarbageSink) {
    commands.drain(..).filter(Command::owns_memory).for_each(|c| sink.discard_owned(c));
}

fn queues(capacity: usize) -> (Queues, cc::Receiver<Garbage>, cc::Receiver<Garbage>) {
    let ((usual, from_usual), (overflow, from_overflow)) = (cc::bounded(capacity), cc::unbounded());
    (Queues { usual, overflow, overflowed: AtomicU64::new(0) }, from_usual, from_overflow)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Weak;

    #[test]
    fn a_full_queue_frees_nothing_and_is_counted() {
        let (queues, usual, overflow) = queues(4);
        let thread = GarbageThread(Arc::new(queues));
        let things: Vec<Arc<u8>> = (0..20).map(Arc::new).collect();
        let seen: Vec<Weak<u8>> = things.iter().map(Arc::downgrade).collect();
        let sink = thread.sink();
        things.into_iter().for_each(|thing| sink.discard(Garbage::Shared(thing)));
        assert!(seen.iter().all(|w| w.strong_count() == 1), "freed by the sender");
        assert_eq!((usual.len(), overflow.len(), thread.overflowed()), (4, 16, 16));
        usual.try_iter().for_each(drop);
        overflow.try_iter().for_each(drop);
        assert!(seen.iter().all(|w| w.strong_count() == 0));
    }

    #[test]
    fn the_thread_frees_what_it_is_given() {
        let thread = GarbageThread::start().expect("a thread");
        let (told, freed) = cc::bounded::<()>(1);
        // The sender is dropped with the garbage, and the receiver sees it.
        thread.sink().discard_owned(told);
        let ended = freed.recv_timeout(std::time::Duration::from_secs(60));
        assert_eq!(ended, Err(cc::RecvTimeoutError::Disconnected));
    }
}

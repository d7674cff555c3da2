//! A thread that stops when its handle is dropped.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;

/// The handle: dropping it asks the thread to stop and waits until it has stopped.
#[derive(Debug)]
pub struct DeviceThread {
    flag: Arc<AtomicBool>,
    hold: Option<cc::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// Tells the thread whether it is to stop.
#[derive(Debug, Clone)]
pub struct StopToken {
    flag: Arc<AtomicBool>,
    released: cc::Receiver<()>,
}

/// Starts a named thread.
///
/// # Errors
/// Returns the system's error if no thread can be started.
pub fn spawn(
    name: &str,
    body: impl FnOnce(StopToken) + Send + 'static,
) -> io::Result<DeviceThread> {
    let flag = Arc::new(AtomicBool::new(false));
    let (hold, released) = cc::bounded(0);
    let stop = StopToken { flag: flag.clone(), released };
    let thread = std::thread::Builder::new().name(name.to_owned()).spawn(move || body(stop))?;
    Ok(DeviceThread { flag, hold: Some(hold), thread: Some(thread) })
}

/// A token without a thread: it stops when the caller drops the sender.
pub(crate) fn pair() -> (cc::Sender<()>, StopToken) {
    let (hold, released) = cc::bounded(0);
    (hold, StopToken { flag: Arc::new(AtomicBool::new(false)), released })
}

impl StopToken {
    /// Returns true if the thread is to stop.
    pub fn stopped(&self) -> bool {
        self.flag.load(Relaxed)
    }

    /// Waits; true if the thread is to stop, and then at once.
    pub fn wait(&self, time: Duration) -> bool {
        matches!(self.released.recv_timeout(time), Err(cc::RecvTimeoutError::Disconnected))
            || self.stopped()
    }

    /// Returns the flag, for those who look at it themselves.
    pub fn flag(&self) -> Arc<AtomicBool> {
        self.flag.clone()
    }
}

impl Drop for DeviceThread {
    fn drop(&mut self) {
        self.flag.store(true, Relaxed);
        drop(self.hold.take());
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::error!("a device thread panicked");
        }
    }
}

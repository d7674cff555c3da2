//! A window system that ends must not take the daemon with it.
//!
//! Xlib answers the loss of its X server by calling `exit` on the thread that uses it ("Xlib - C
//! Language X Interface", section 11.8.2: the default handler of a fatal IO error ends the client).
//! No destructor of that thread's stack runs then, and the call never returns. `exit` runs the
//! destructors of the calling thread's thread-local values first, before any handler of `atexit`
//! (glibc, `stdlib/exit.c`): one that waits keeps the process, with all its other threads, alive.
//! The thread of the window is then lost for good; another one goes on in its place and ends the
//! process when its time has come. A C library that runs no such destructors ends the process, as
//! without this guard: the session is on the disk.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use crossbeam_channel as cc;

thread_local! {
    /// Present while the window is shown on this thread.
    static AT_EXIT: RefCell<Option<WaitAtExit>> = const { RefCell::new(None) };
}

/// Wakes the survivor when it is dropped while it is armed, and never returns then.
struct WaitAtExit {
    armed: bool,
    lost: cc::Sender<()>,
}

impl Drop for WaitAtExit {
    #[allow(clippy::disallowed_methods)] // This thread is lost: it only waits for the end.
    fn drop(&mut self) {
        if self.armed && self.lost.try_send(()).is_ok() {
            loop {
                std::thread::sleep(Duration::from_secs(3600));
            }
        }
    }
}

/// Runs `show` on this thread. Returns `Err` with the reason if it panics. If it ends the process,
/// this call never returns: `survivor` runs on a separate thread and returns the exit code of the
/// process.
///
/// # Errors
/// Returns an error if `show` fails or panics, or if the survivor cannot start.
pub fn guarded(
    show: impl FnOnce() -> Result<(), String>,
    survivor: impl FnOnce() -> u8 + Send + 'static,
) -> Result<(), String> {
    let (lost, told) = cc::bounded(1);
    let survive = move || {
        if told.recv().is_ok() {
            // A bug in the survivor must not leave a process that nobody ends.
            let code = catch_unwind(AssertUnwindSafe(survivor)).unwrap_or(101);
            signal_hook::low_level::exit(i32::from(code));
        }
    };
    let thread = std::thread::Builder::new().name("sculptd-survivor".into());
    thread.spawn(survive).map_err(|e| format!("a thread could not be started: {e}"))?;
    AT_EXIT.set(Some(WaitAtExit { armed: true, lost }));
    let shown = catch_unwind(AssertUnwindSafe(show));
    if let Some(mut guard) = AT_EXIT.take() {
        guard.armed = false;
    }
    shown.unwrap_or_else(|_| Err("the window failed by a bug".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_that_returns_or_panics_needs_no_survivor() {
        let survivor = || -> u8 { unreachable!("nothing was lost") };
        assert_eq!(guarded(|| Ok(()), survivor), Ok(()));
        assert_eq!(guarded(|| Err("no screen".into()), survivor), Err("no screen".into()));
        let panics =
            || -> Result<(), String> { panic!("a bug in a panel (expected in this test)") };
        assert!(guarded(panics, survivor).is_err_and(|why| why.contains("bug")));
    }
}

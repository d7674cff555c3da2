//! Telling the service manager how we are: `READY`, `STOPPING`, and a watchdog that is fed by
//! progress.
//!
//! systemd's protocol is one datagram a message to the socket named in `NOTIFY_SOCKET` (a path, or
//! an abstract name behind '@'); see sd_notify(3). Without that variable nothing is sent.

use std::os::unix::net::{SocketAddr, UnixDatagram};
use std::sync::Arc;

use arc_swap::ArcSwap;

use super::Published;
use super::session::Health;
use crate::window_link::WindowLink;

/// The way to the service manager; to nobody where there is none.
#[derive(Debug, Default)]
pub struct Notifier {
    to: Option<(UnixDatagram, SocketAddr)>,
}

impl Notifier {
    pub fn from_env() -> Self {
        std::env::var("NOTIFY_SOCKET")
            .map_or_else(|_| Notifier::default(), |name| Notifier::to(&name))
    }

    /// `name`: an absolute path, or an abstract socket's name behind '@'. Anything else is nobody.
    pub fn to(name: &str) -> Self {
        let address = match name.as_bytes().first() {
            Some(b'/') => SocketAddr::from_pathname(name).ok(),
            #[cfg(target_os = "linux")]
            Some(b'@') => {
                use std::os::linux::net::SocketAddrExt;
                SocketAddr::from_abstract_name(&name[1..]).ok()
            }
            _ => None,
        };
        let socket = UnixDatagram::unbound().and_then(|s| s.set_nonblocking(true).map(|()| s)).ok();
        Notifier { to: socket.zip(address) }
    }

    pub fn is_heard(&self) -> bool {
        self.to.is_some()
    }

    /// Sends one message, e.g. `READY=1`. Never waits; a manager that cannot take it hears the next
    /// one.
    pub fn send(&self, message: &str) {
        if let Some((socket, address)) = &self.to {
            let _ = socket.send_to_addr(message.as_bytes(), address);
        }
    }
}

/// Returns the interval in which the manager expects a message, in microseconds: `WATCHDOG_USEC`.
/// `None` if it is unset or `WATCHDOG_PID` names another process.
pub fn watchdog_us() -> Option<u64> {
    let number = |name: &str| std::env::var(name).ok().and_then(|v| v.parse::<u64>().ok());
    match number("WATCHDOG_PID") {
        Some(pid) if pid != u64::from(std::process::id()) => None,
        _ => number("WATCHDOG_USEC").filter(|us| *us > 0),
    }
}

/// Looks at the tick loop and the journal, and says when the manager may be told that all goes on.
/// Not a timer: a loop that stands still, or a journal thread that hangs in its disk, is not
/// vouched for.
#[derive(Debug)]
pub struct Watchdog {
    every_us: u64,
    next_us: u64,
    seen: (u64, u64),
    moved: (bool, bool),
}

impl Watchdog {
    /// `limit_us`: the manager's time limit. It is notified four times within it.
    pub fn new(limit_us: u64, now_us: u64) -> Self {
        Watchdog { every_us: limit_us / 4, next_us: now_us, seen: (0, 0), moved: (false, false) }
    }

    /// Returns true if a notification is due, and both the loop and the journal have advanced since
    /// the last one. `tick`: the loop's last; `turns`: the journal's, `None` without one.
    pub fn look(&mut self, now_us: u64, tick: u64, turns: Option<u64>) -> bool {
        self.moved.0 |= tick != self.seen.0;
        self.moved.1 |= turns.is_none_or(|t| t != self.seen.1);
        self.seen = (tick, turns.unwrap_or(0));
        if now_us < self.next_us || self.moved != (true, true) {
            return false;
        }
        self.next_us = now_us + self.every_us;
        self.moved = (false, false);
        true
    }
}

/// State that the watchdog observes.
#[derive(Debug, Clone)]
pub struct Watched {
    pub published: Arc<ArcSwap<Published>>,
    pub journal: Option<Health>,
    pub window: WindowLink,
}

impl Watched {
    /// The loop's last tick, and the journal's turns.
    pub fn progress(&self) -> (u64, Option<u64>) {
        let turns =
            self.journal.as_ref().map(|h| h.turns.load(std::sync::atomic::Ordering::Relaxed));
        (self.published.load().tick, turns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hears(name: &str, socket: &UnixDatagram) {
        let notifier = Notifier::to(name);
        assert!(notifier.is_heard());
        notifier.send("READY=1");
        notifier.send("WATCHDOG=1");
        let mut buffer = [0; 64];
        for expected in ["READY=1", "WATCHDOG=1"] {
            let n = socket.recv(&mut buffer).expect("a datagram");
            assert_eq!(&buffer[..n], expected.as_bytes());
        }
    }

    #[test]
    fn a_manager_on_a_path_and_on_an_abstract_name_hears() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("notify");
        let socket = UnixDatagram::bind(&path).expect("bound");
        hears(&path.display().to_string(), &socket);
        #[cfg(target_os = "linux")]
        {
            use std::os::linux::net::SocketAddrExt;
            let name = format!("sculptd-test-{}", std::process::id());
            let address = SocketAddr::from_abstract_name(&name).expect("a name");
            let socket = UnixDatagram::bind_addr(&address).expect("bound");
            hears(&format!("@{name}"), &socket);
        }
        for nobody in ["", "relative", "vsock:2:1234"] {
            assert!(!Notifier::to(nobody).is_heard(), "{nobody}");
        }
    }

    #[test]
    fn only_progress_feeds_the_watchdog() {
        let mut dog = Watchdog::new(4_000_000, 0);
        assert!(dog.look(0, 1, Some(1)));
        assert!(!dog.look(500_000, 60, Some(2)), "too early");
        assert!(dog.look(1_100_000, 120, Some(2)), "both moved, if not at the same look");
        assert!(!dog.look(3_000_000, 120, Some(9)), "the loop stands still");
        assert!(!dog.look(9_000_000, 120, Some(10)), "however long");
        assert!(dog.look(9_100_000, 121, Some(11)));
        assert!(!dog.look(20_000_000, 900, Some(11)), "the journal hangs");
        assert!(dog.look(20_100_000, 901, Some(12)));
        assert!(dog.look(40_000_000, 902, None), "without a journal the loop alone");
    }
}

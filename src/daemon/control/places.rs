//! The connected clients. Places are limited, and an idle client cannot keep one. When all are
//! taken, a newcomer replaces a client that floods, otherwise the one that has been silent longest.
//! A client that waits for a reply, is subscribed to events or has just connected keeps its place.

use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

use super::host::locked;
use sculptd_devices::Clock;

/// A client that was silent for so long gives way, microseconds.
const SILENT_US: u64 = 1_000_000;
/// Time for which a new client cannot be replaced, in microseconds.
const GRACE_US: u64 = 250_000;

/// The places, all of one kind.
#[derive(Debug)]
pub(super) struct ClientPlaces {
    clients: Arc<Mutex<Vec<Arc<ConnectedClient>>>>,
    most: usize,
    clock: Clock,
}

/// A connected client.
#[derive(Debug)]
struct ConnectedClient {
    /// Used to end the connection; `None` if the client can never be replaced.
    stream: Option<UnixStream>,
    came_us: u64,
    /// Time of its last answered request, in microseconds.
    last_us: AtomicU64,
    /// True while one of its requests is being answered.
    is_busy: AtomicBool,
    is_subscribed: AtomicBool,
    is_flooding: AtomicBool,
}

/// A taken place, freed when dropped, also on panic.
#[derive(Debug)]
pub(super) struct ClientPlace {
    client: Arc<ConnectedClient>,
    clients: Arc<Mutex<Vec<Arc<ConnectedClient>>>>,
    clock: Clock,
}

impl ClientPlaces {
    pub fn new(most: usize) -> ClientPlaces {
        ClientPlaces { clients: Arc::default(), most, clock: Clock::monotonic() }
    }

    /// Returns a place; `None`: all are taken, and nobody gives way. `stream`: the client's, ended
    /// where it gives way.
    pub fn take(&self, stream: Option<UnixStream>) -> Option<ClientPlace> {
        let now = self.clock.now_us();
        let mut clients = locked(&self.clients);
        if clients.len() >= self.most {
            let at = who_gives_way(&clients, now)?;
            let gone = clients.swap_remove(at);
            if let Some(stream) = &gone.stream {
                let _ = stream.shutdown(Shutdown::Both);
            }
        }
        let flag = || AtomicBool::new(false);
        let client = Arc::new(ConnectedClient {
            stream,
            came_us: now,
            last_us: AtomicU64::new(now),
            is_busy: flag(),
            is_subscribed: flag(),
            is_flooding: flag(),
        });
        clients.push(client.clone());
        let clients = self.clients.clone();
        Some(ClientPlace { client, clients, clock: self.clock.clone() })
    }
}

/// Returns the place in the list of the client that gives way.
fn who_gives_way(clients: &[Arc<ConnectedClient>], now: u64) -> Option<usize> {
    let may = |c: &ConnectedClient| {
        let silent = now.saturating_sub(c.last_us.load(Relaxed)) >= SILENT_US;
        let floods = c.is_flooding.load(Relaxed);
        c.stream.is_some()
            && !c.is_busy.load(Relaxed)
            && !c.is_subscribed.load(Relaxed)
            && now.saturating_sub(c.came_us) >= GRACE_US
            && (silent || floods)
    };
    let all = clients.iter().enumerate().filter(|(_, c)| may(c));
    let rank = |c: &ConnectedClient| (!c.is_flooding.load(Relaxed), c.last_us.load(Relaxed));
    all.min_by_key(|(_, c)| rank(c)).map(|(at, _)| at)
}

impl ClientPlace {
    /// A request is being answered from now on, or was answered.
    pub fn set_busy(&self, busy: bool) {
        self.client.is_busy.store(busy, Relaxed);
        self.client.last_us.store(self.clock.now_us(), Relaxed);
    }

    /// It hears events, and is silent for good reason.
    pub fn set_subscribed(&self) {
        self.client.is_subscribed.store(true, Relaxed);
    }

    /// It asks more often than anybody may.
    pub fn set_flooding(&self, flooding: bool) {
        self.client.is_flooding.store(flooding, Relaxed);
    }
}

impl Drop for ClientPlace {
    fn drop(&mut self) {
        locked(&self.clients).retain(|c| !Arc::ptr_eq(c, &self.client));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(most: usize) -> (ClientPlaces, Clock) {
        let clock = Clock::manual();
        (ClientPlaces { clock: clock.clone(), ..ClientPlaces::new(most) }, clock)
    }

    fn ends() -> (UnixStream, Option<UnixStream>) {
        let (here, there) = UnixStream::pair().expect("a pair");
        (here, Some(there))
    }

    fn is_ended(mut here: &UnixStream) -> bool {
        here.set_nonblocking(true).expect("set");
        matches!(std::io::Read::read(&mut here, &mut [0]), Ok(0))
    }

    #[test]
    fn a_flooding_client_gives_way_first_then_the_longest_silent_one() {
        let (places, clock) = places(3);
        let all: Vec<_> = (0..3).map(|_| ends()).collect();
        let taken: Vec<ClientPlace> = all
            .iter()
            .enumerate()
            .map(|(k, (_, there))| {
                clock.set_us(10 * k as u64);
                let there = there.as_ref().map(|t| t.try_clone().expect("cloned"));
                places.take(there).expect("free")
            })
            .collect();
        assert!(places.take(ends().1).is_none(), "all have just come");
        clock.set_us(GRACE_US + 100);
        assert!(places.take(ends().1).is_none(), "nobody was silent for long");
        taken[2].set_flooding(true);
        let fourth = places.take(ends().1).expect("of the one that floods");
        assert!(is_ended(&all[2].0) && !is_ended(&all[0].0));
        clock.set_us(2 * SILENT_US);
        taken[0].set_busy(true);
        fourth.set_subscribed();
        assert!(places.take(ends().1).is_some(), "of the one that was silent");
        assert!(is_ended(&all[1].0) && !is_ended(&all[0].0));
        assert!(places.take(ends().1).is_some(), "the one before has left");
        let _fifth = places.take(ends().1).expect("free");
        assert!(places.take(ends().1).is_none(), "one is busy, one subscribed, one has just come");
    }
}

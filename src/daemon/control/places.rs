//! The connected clients. Places are limited, and nobody can keep one from everybody else. When all
//! are taken, these give way to a newcomer: a client that floods, unless the newcomer's process
//! holds a place and has asked as much lately; one whose process holds several places while the
//! newcomer's holds none; and one that has been silent. A client that waits for a reply or is
//! subscribed to events keeps its place.

use std::collections::BTreeMap;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

use super::host::locked;
use sculptd_devices::Clock;

/// A client that was silent for so long gives way, microseconds.
const SILENT_US: u64 = 1_000_000;
/// Time in which the memory of a process's requests halves, in microseconds.
const FADES_US: u64 = 1_000_000;
/// Processes whose requests are remembered.
const REMEMBERED: usize = 1024;

/// Number of requests of each process, which fades, and the time of the last one.
type RequestCounts = BTreeMap<i32, (u64, u64)>;

#[derive(Debug)]
pub(super) struct ClientPlaces {
    clients: Arc<Mutex<Vec<Arc<ConnectedClient>>>>,
    asked: Arc<Mutex<RequestCounts>>,
    most: usize,
    clock: Clock,
}

/// A connected client.
#[derive(Debug)]
struct ConnectedClient {
    /// Used to end the connection; `None` if the client can never be replaced.
    stream: Option<UnixStream>,
    /// Its process.
    pid: i32,
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
    asked: Arc<Mutex<RequestCounts>>,
    clock: Clock,
}

fn faded((count, last_us): (u64, u64), now: u64) -> u64 {
    count.checked_shr((now.saturating_sub(last_us) / FADES_US) as u32).unwrap_or(0)
}

impl ClientPlaces {
    pub fn new(most: usize) -> ClientPlaces {
        let (clients, asked) = (Arc::default(), Arc::default());
        ClientPlaces { clients, asked, most, clock: Clock::monotonic() }
    }

    /// Returns a function of how much a process has asked lately.
    pub fn asked_lately(&self) -> impl Fn(i32) -> u64 {
        let (now, asked) = (self.clock.now_us(), locked(&self.asked).clone());
        move |pid| asked.get(&pid).map_or(0, |a| faded(*a, now))
    }

    /// Returns a place; `None`: all are taken, and nobody gives way. `stream`: the client's, ended
    /// where it gives way. `pid`: its process.
    pub fn take(&self, stream: Option<UnixStream>, pid: i32) -> Option<ClientPlace> {
        let now = self.clock.now_us();
        let lately = self.asked_lately();
        let mut clients = locked(&self.clients);
        if clients.len() >= self.most {
            let at = who_gives_way(&clients, pid, now, lately)?;
            let gone = clients.swap_remove(at);
            if let Some(stream) = &gone.stream {
                let _ = stream.shutdown(Shutdown::Both);
            }
        }
        let flag = || AtomicBool::new(false);
        let client = Arc::new(ConnectedClient {
            stream,
            pid,
            last_us: AtomicU64::new(now),
            is_busy: flag(),
            is_subscribed: flag(),
            is_flooding: flag(),
        });
        clients.push(client.clone());
        let (clients, asked) = (self.clients.clone(), self.asked.clone());
        Some(ClientPlace { client, clients, asked, clock: self.clock.clone() })
    }
}

/// Returns the place in the list of the client that gives way to one of process `pid`.
fn who_gives_way(
    clients: &[Arc<ConnectedClient>],
    pid: i32,
    now: u64,
    lately: impl Fn(i32) -> u64,
) -> Option<usize> {
    let held = |pid: i32| clients.iter().filter(|c| c.pid == pid).count();
    let newcomer_has_none = held(pid) == 0;
    let may = |c: &ConnectedClient| {
        c.stream.is_some()
            && !c.is_busy.load(Relaxed)
            && !c.is_subscribed.load(Relaxed)
            && (c.is_flooding.load(Relaxed) && (newcomer_has_none || lately(pid) < lately(c.pid))
                || now.saturating_sub(c.last_us.load(Relaxed)) >= SILENT_US
                || newcomer_has_none && held(c.pid) > 1)
    };
    let all = clients.iter().enumerate().filter(|(_, c)| may(c));
    let rank = |c: &ConnectedClient| (!c.is_flooding.load(Relaxed), c.last_us.load(Relaxed));
    all.min_by_key(|(_, c)| rank(c)).map(|(at, _)| at)
}

impl ClientPlace {
    /// A request is being answered from now on, or was answered.
    pub fn set_busy(&self, busy: bool) {
        let now = self.clock.now_us();
        self.client.is_busy.store(busy, Relaxed);
        self.client.last_us.store(now, Relaxed);
        if busy {
            let mut asked = locked(&self.asked);
            let of_it = asked.entry(self.client.pid).or_insert((0, now));
            *of_it = (faded(*of_it, now) + 1, now);
            if asked.len() > REMEMBERED {
                let oldest = asked.iter().min_by_key(|(_, a)| a.1).map(|(pid, _)| *pid);
                oldest.and_then(|pid| asked.remove(&pid));
            }
        }
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

    /// Places taken by these processes, 10 microseconds apart, and their other ends.
    fn taken(places: &ClientPlaces, clock: &Clock, pids: &[i32]) -> Vec<(UnixStream, ClientPlace)> {
        let take = |(k, pid): (usize, &i32)| {
            clock.set_us(10 * k as u64);
            let (here, there) = ends();
            (here, places.take(there, *pid).expect("free"))
        };
        pids.iter().enumerate().map(take).collect()
    }

    #[test]
    fn a_flooding_client_gives_way_first_then_the_longest_silent_one() {
        let (places, clock) = places(3);
        let all = taken(&places, &clock, &[1, 2, 3]);
        assert!(places.take(ends().1, 4).is_none(), "nobody was silent for long");
        all[2].1.set_flooding(true);
        let fourth = places.take(ends().1, 4).expect("of the one that floods");
        assert!(is_ended(&all[2].0) && !is_ended(&all[0].0));
        clock.set_us(2 * SILENT_US);
        all[0].1.set_busy(true);
        fourth.set_subscribed();
        assert!(places.take(ends().1, 5).is_some(), "of the one that was silent");
        assert!(is_ended(&all[1].0) && !is_ended(&all[0].0));
        let _fifth = places.take(ends().1, 6).expect("free: the one before has left");
        assert!(
            places.take(ends().1, 7).is_none(),
            "one is busy, one subscribed, one has just come"
        );
    }

    #[test]
    fn a_process_with_several_places_gives_way_to_one_with_none() {
        let (places, clock) = places(3);
        let all = taken(&places, &clock, &[1, 1, 2]);
        assert!(places.take(ends().1, 1).is_none(), "it holds places already");
        let _third = places.take(ends().1, 3).expect("of process 1");
        assert!(is_ended(&all[0].0) && !is_ended(&all[1].0) && !is_ended(&all[2].0));
        assert!(places.take(ends().1, 4).is_none(), "each process holds one");
    }

    /// Else a process that floods and connects again for each ended connection would keep the
    /// daemon busy with nothing but that.
    #[test]
    fn a_flooding_process_does_not_take_its_own_places_from_itself() {
        let (places, clock) = places(2);
        let all = taken(&places, &clock, &[1, 2]);
        all[0].1.set_busy(true);
        all[0].1.set_busy(false);
        all[0].1.set_flooding(true);
        assert!(places.take(ends().1, 1).is_none());
        assert!(!is_ended(&all[0].0));
        assert!(places.take(ends().1, 2).is_some(), "of the process that floods");
        assert!(is_ended(&all[0].0));
    }

    #[test]
    fn what_a_process_asked_fades() {
        let (places, clock) = places(1);
        let all = taken(&places, &clock, &[7]);
        (0..8).for_each(|_| all[0].1.set_busy(true));
        assert_eq!((places.asked_lately()(7), places.asked_lately()(8)), (8, 0));
        clock.set_us(2 * FADES_US);
        assert_eq!(places.asked_lately()(7), 2);
        clock.set_us(200 * FADES_US);
        assert_eq!(places.asked_lately()(7), 0);
    }
}

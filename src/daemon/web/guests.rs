//! Who is connected, and who was a moment ago.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

use arc_swap::ArcSwapOption;

use super::delivery::Delivery;
use super::keys::{WebKey, WebRole};
use super::{MAX_PAGES, RESUMES, locked};
use crate::adaptors::BROWSER_TABLET_IDS;
use crate::people::{PeopleHere, Person, PersonRole};
use crate::random_token::random_token;
use sculptd_devices::DeviceId;

/// Longest name of a guest, characters.
pub const MAX_NAME: usize = 40;
/// Numbers of guests in the world; people of a shared sculpture have the lower ones.
const FIRST: u8 = 128;

/// A page that has joined.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Guest {
    /// Number of the guest; it is never used again.
    pub number: u64,
    /// Lets the page resume after a cut; a secret.
    pub ticket: String,
    /// Number of the key that it joined with.
    pub key: u32,
    pub role: WebRole,
    /// Number of the person in the world; 0 for who is none.
    pub person: u8,
    /// Id of its pen; `None` if it has none.
    pub pen: Option<DeviceId>,
    /// As the guest wants to be called.
    pub name: String,
}

/// Room for one connection; freed when dropped.
#[derive(Debug)]
pub struct PagePlace(Arc<AtomicUsize>);

impl Drop for PagePlace {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Relaxed);
    }
}

#[derive(Debug)]
struct Entry {
    guest: Guest,
    /// Number of its connection: a newer one takes over.
    connection: u64,
    /// State of its pictures and the time of the cut, while it is away.
    away: Option<(Delivery, u64)>,
}

#[derive(Debug, Default)]
struct List {
    entries: Vec<Entry>,
    connections: u64,
    last_person: u8,
}

/// Every guest.
#[derive(Debug, Default)]
pub struct GuestList {
    list: Mutex<List>,
    /// The list as the loop shows it.
    shown: Arc<ArcSwapOption<PeopleHere>>,
    connected: Arc<AtomicUsize>,
}

/// A guest who has joined, and the number of the connection.
#[derive(Debug)]
pub struct JoinedGuest {
    pub guest: Guest,
    pub connection: u64,
    /// What the page had received before it was cut off.
    pub resumed: Option<Delivery>,
}

impl GuestList {
    /// Creates an empty list that `shown` follows.
    pub fn shown_by(shown: Arc<ArcSwapOption<PeopleHere>>) -> GuestList {
        GuestList { shown, ..GuestList::default() }
    }

    /// Takes room for a connection; `None` if there is none.
    pub fn enter(&self) -> Option<PagePlace> {
        let more = |n: usize| (n < MAX_PAGES).then_some(n + 1);
        self.connected.fetch_update(Relaxed, Relaxed, more).ok()?;
        Some(PagePlace(self.connected.clone()))
    }

    /// Joins a page. `ticket`: the one that it had before it was cut off.
    ///
    /// # Errors
    /// Returns the reason in words: no number or no random numbers are left.
    pub fn join(
        &self,
        key: &WebKey,
        ticket: Option<&str>,
        name: &str,
        now_us: u64,
    ) -> Result<JoinedGuest, String> {
        let mut list = locked(&self.list);
        list.forget_absent(now_us);
        list.connections += 1;
        let connection = list.connections;
        let mine =
            |e: &&mut Entry| Some(e.guest.ticket.as_str()) == ticket && e.guest.key == key.id;
        if let Some(entry) = list.entries.iter_mut().find(mine) {
            // The old connection, should it still be there, ends: its number is not this one.
            entry.connection = connection;
            entry.guest.name = short(name);
            let resumed = entry.away.take().map(|(delivery, _)| delivery);
            let guest = entry.guest.clone();
            self.show(&list);
            return Ok(JoinedGuest { guest, connection, resumed });
        }
        let (person, pen) = match key.role {
            WebRole::Viewer => (0, None),
            WebRole::Device => (0, Some(list.next_tablet()?)),
            WebRole::Sculptor => {
                let person = list.next_person()?;
                (person, Some(DeviceId(u16::from(person) << 8)))
            }
        };
        let ticket = random_token().map_err(|e| e.to_string())?;
        let name = short(name);
        let guest =
            Guest { number: connection, ticket, key: key.id, role: key.role, person, pen, name };
        list.entries.push(Entry { guest: guest.clone(), connection, away: None });
        self.show(&list);
        Ok(JoinedGuest { guest, connection, resumed: None })
    }

    /// Gives a guest another name.
    pub fn rename(&self, connection: u64, name: &str) {
        let mut list = locked(&self.list);
        if let Some(entry) = list.entries.iter_mut().find(|e| e.connection == connection) {
            entry.guest.name = short(name);
        }
        self.show(&list);
    }

    /// Returns true while this connection is the newest of its guest.
    pub fn is_current(&self, connection: u64) -> bool {
        locked(&self.list).entries.iter().any(|e| e.connection == connection)
    }

    /// A connection has ended; its page may come back. `None`: it may not.
    pub fn leave(&self, connection: u64, delivery: Option<Delivery>, now_us: u64) {
        let mut list = locked(&self.list);
        let Some(at) = list.entries.iter().position(|e| e.connection == connection) else { return };
        match delivery {
            Some(delivery) => list.entries[at].away = Some((delivery, now_us)),
            None => drop(list.entries.remove(at)),
        }
        list.forget_absent(now_us);
        self.show(&list);
    }

    fn show(&self, list: &List) {
        let all: Vec<Person> =
            list.entries.iter().filter(|e| e.away.is_none()).map(person).collect();
        let people =
            (!all.is_empty()).then(|| Arc::new(PeopleHere { all, ..PeopleHere::default() }));
        self.shown.store(people);
    }

    /// Returns who is connected now, in the order in which they joined.
    pub fn here(&self) -> Vec<Guest> {
        let list = locked(&self.list);
        list.entries.iter().filter(|e| e.away.is_none()).map(|e| e.guest.clone()).collect()
    }
}

impl List {
    fn forget_absent(&mut self, now_us: u64) {
        let longest = RESUMES.as_micros() as u64;
        self.entries.retain(|e| {
            e.away.as_ref().is_none_or(|(_, since)| now_us.saturating_sub(*since) < longest)
        });
    }

    /// The next number that nobody has, in turn: the steps of who had it before are not the new
    /// guest's to undo for as long as possible.
    fn next_person(&mut self) -> Result<u8, String> {
        let taken = |n: u8| self.entries.iter().any(|e| e.guest.person == n);
        let after = self.last_person.max(FIRST - 1);
        let count = u8::MAX - FIRST + 1;
        let mut free = (0..count).map(|i| FIRST + (after - (FIRST - 1) + i) % count);
        let next = free.find(|n| !taken(*n));
        let next = next.ok_or("too many guests have joined. Wait half a minute")?;
        self.last_person = next;
        Ok(next)
    }

    fn next_tablet(&self) -> Result<DeviceId, String> {
        let taken = |id: u16| self.entries.iter().any(|e| e.guest.pen == Some(DeviceId(id)));
        let free = BROWSER_TABLET_IDS.into_iter().find(|id| !taken(*id));
        free.map(DeviceId).ok_or_else(|| "too many tablets have joined".into())
    }
}

/// The guest as the window lists people.
fn person(entry: &Entry) -> Person {
    let Guest { role, person, name, .. } = &entry.guest;
    let (role, fallback) = match role {
        WebRole::Sculptor => (PersonRole::Sculptor, format!("guest {}", person - (FIRST - 1))),
        WebRole::Viewer => (PersonRole::Viewer, "guest".into()),
        WebRole::Device => (PersonRole::Device, "tablet".into()),
    };
    let name = if name.is_empty() { fallback } else { name.clone() };
    Person { number: *person, name, role, here: true }
}

/// A name without control characters, of bounded length.
fn short(name: &str) -> String {
    name.trim().chars().filter(|c| !c.is_control()).take(MAX_NAME).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(role: WebRole) -> WebKey {
        WebKey { id: 1, role, secret: String::new(), until_us: None }
    }

    #[test]
    fn guests_get_numbers_in_turn_and_come_back_with_their_ticket() {
        let list = GuestList::default();
        let sculptor = key(WebRole::Sculptor);
        let join = |ticket: Option<&str>, at| list.join(&sculptor, ticket, "  Ada\n ", at);
        let ada = join(None, 0).expect("room");
        let bob = join(None, 0).expect("room");
        assert_eq!((ada.guest.person, bob.guest.person), (128, 129));
        assert_eq!((ada.guest.pen, ada.guest.name.as_str()), (Some(DeviceId(128 << 8)), "Ada"));
        list.leave(ada.connection, Some(Delivery::default()), 0);
        assert_eq!(list.here().len(), 1);
        // With the ticket the same person; the ticket of another key is worth nothing.
        let other = WebKey { id: 2, ..sculptor.clone() };
        let thief = list.join(&other, Some(&ada.guest.ticket), "", 1).expect("room");
        assert_eq!((thief.guest.person, thief.resumed.is_some()), (130, false));
        let back = join(Some(&ada.guest.ticket), 29_000_000).expect("room");
        assert_eq!((back.guest.person, back.resumed.is_some()), (128, true));
        // The old connection ends and takes nothing along.
        assert!(!list.is_current(ada.connection) && list.is_current(back.connection));
        list.leave(ada.connection, None, 29_000_000);
        assert!(list.is_current(back.connection));
        // Who stays away too long is a new guest, with a number that nobody had.
        list.leave(back.connection, Some(Delivery::default()), 30_000_000);
        let late = join(Some(&ada.guest.ticket), 60_000_001).expect("room");
        assert_eq!((late.guest.person, late.resumed.is_some()), (131, false));
    }

    #[test]
    fn numbers_turn_round_and_run_out() {
        let list = GuestList::default();
        let sculptor = key(WebRole::Sculptor);
        for n in 0..300u32 {
            let one = list.join(&sculptor, None, "", 0).expect("room");
            assert_eq!(u32::from(one.guest.person), 128 + n % 128);
            list.leave(one.connection, None, 0);
        }
        for _ in 0..128 {
            list.join(&sculptor, None, "", 0).expect("room");
        }
        assert!(list.join(&sculptor, None, "", 0).is_err());
        let tablets = (0..9).map(|_| list.join(&key(WebRole::Device), None, "", 0));
        assert_eq!(tablets.filter(Result::is_ok).count(), 8);
        let places: Vec<PagePlace> = (0..MAX_PAGES).map_while(|_| list.enter()).collect();
        assert!(places.len() == MAX_PAGES && list.enter().is_none());
        drop(places);
        assert!(list.enter().is_some());
    }
}

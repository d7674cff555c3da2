//! The people who share the sculpture, from the log of arrivals, for the loop and its window.

use crate::core::{Event, short_number};
use crate::station::Station;
use crate::wire::frame::{Arrival, Role};
use sculptd_daemon::people::{
    OwnInput, PeopleHere, Person, PersonRole, SharedStanding, SharedState,
};

/// Returns everybody who ever came, and who of them is connected. The successor of a killed host
/// reports it as gone five seconds after taking over.
pub fn people_here(station: &Station) -> PeopleHere {
    let person = |(a, _): (Arrival, u64)| Person {
        number: a.person,
        name: a.name,
        role: match a.role {
            Role::Sculptor => PersonRole::Sculptor,
            Role::Viewer => PersonRole::Viewer,
            Role::Device => PersonRole::Device,
        },
        here: a.here,
    };
    let all = station.log().people().into_iter().map(person).collect();
    PeopleHere {
        own: station.person(),
        all,
        sculpture: format!("{:08x}", short_number(station.sculpture())),
        others: station.others().iter().map(ToString::to_string).collect(),
        sent_away: None,
    }
}

/// Returns the state of the connection; `undelivered`: batches that the others never got.
pub fn standing(station: &Station, undelivered: u64) -> SharedStanding {
    let state = match () {
        () if station.person() == 0 => SharedState::NotShared,
        () if station.has_ended() => SharedState::SentAway,
        () if station.hosts() => SharedState::Hosts,
        () if station.hears_host() => SharedState::Follows,
        () => SharedState::CutOff,
    };
    let (host, waiting) = (station.host_person(), station.waiting());
    SharedStanding { state, host, since_s: 0, waiting, undelivered }
}

/// Returns the counts of the local input.
pub fn own_input(station: &Station) -> OwnInput {
    let outbox = station.outbox();
    OwnInput {
        transitions: outbox.counts.transitions,
        batches: outbox.last(),
        ordered: station.log().applied(station.person()),
        acknowledged: outbox.acknowledged(),
        dropped: outbox.counts.dropped,
        lost: outbox.counts.lost,
    }
}

/// Returns true if the result of [`people_here`] may change with this event.
pub fn changes_people(event: &Event) -> bool {
    match event {
        Event::Frame(frame) => !frame.arrivals.is_empty(),
        Event::Entered { .. } | Event::Restore { .. } => true,
        Event::RestorePart { .. } | Event::Hosting(_) | Event::Differs { .. } => false,
        Event::NobodyHosts | Event::Note(_) | Event::Refused(_) => false,
    }
}

//! The reply of `people`.

use crate::Published;
use crate::people::{Person, PersonRole, SharedState, colour_of};
use sculptd_control::people::{self, PeopleReply, PersonInfo, PersonPen, SharedLink, UndoRefused};
use sculptd_engine::world::OthersPen;

pub(super) fn people(shown: &Published) -> PeopleReply {
    let Some(known) = &shown.people else { return PeopleReply::default() };
    let pens = |number: u8| shown.others.iter().flatten().filter(move |p| p.person == number);
    let info = |p: &Person| {
        let [r, g, b] = colour_of(p.number);
        PersonInfo {
            number: p.number,
            name: p.name.clone(),
            role: match p.role {
                PersonRole::Sculptor => people::PersonRole::Sculptor,
                PersonRole::Viewer => people::PersonRole::Viewer,
                PersonRole::Device => people::PersonRole::Device,
            },
            here: p.here,
            colour: format!("#{r:02x}{g:02x}{b:02x}"),
            pens: pens(p.number).map(pen).collect(),
        }
    };
    let (refused, input) = (shown.undo_refused, shown.own_input);
    // Guests in a browser are people too, and nothing is shared over the network.
    let shared = known.own != 0;
    PeopleReply {
        shared,
        own: known.own,
        people: known.all.iter().map(info).collect(),
        link: link(shown),
        own_input: shared.then_some(people::OwnInput {
            transitions: input.transitions,
            batches: input.batches,
            ordered: input.ordered,
            acknowledged: input.acknowledged,
            dropped: input.dropped,
            lost: input.lost,
        }),
        undo_refused: refused.map(|r| UndoRefused { tick: r.tick, redo: r.redo, by: r.by }),
    }
}

/// The connection to the others; `None` if nothing is shared.
pub(super) fn link(shown: &Published) -> Option<SharedLink> {
    let (known, standing) = (shown.people.as_ref()?, shown.standing);
    let state = match standing.state {
        SharedState::NotShared => return None,
        SharedState::Hosts => people::SharedState::Hosts,
        SharedState::Follows => people::SharedState::Follows,
        SharedState::CutOff => people::SharedState::CutOff,
        SharedState::SentAway => people::SharedState::SentAway,
    };
    Some(SharedLink {
        state,
        host: known.person(standing.host).map(|p| p.name.clone()),
        since_s: standing.since_s,
        waiting: standing.waiting,
        undelivered: standing.undelivered,
        reason: known.sent_away.clone(),
        sculpture: known.sculpture.clone(),
        others: known.others.clone(),
    })
}

fn pen(pen: &OthersPen) -> PersonPen {
    PersonPen {
        position: pen.position.to_array(),
        normal: pen.normal.to_array(),
        radius: pen.radius,
        down: pen.down,
        object: pen.object.0,
    }
}

//! The reply of `people`.

use crate::Published;
use crate::people::{Person, PersonRole, colour_of};
use sculptd_control::people::{self, PeopleReply, PersonInfo, PersonPen, UndoRefused};
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

fn pen(pen: &OthersPen) -> PersonPen {
    PersonPen {
        position: pen.position.to_array(),
        normal: pen.normal.to_array(),
        radius: pen.radius,
        down: pen.down,
        object: pen.object.0,
    }
}

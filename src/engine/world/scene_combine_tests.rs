//! Random operations that make objects of others, and jumps to where the scene was before.

use std::sync::Arc;

use super::World;
use super::scene_tests::{Dice, ask, tell};
use crate::command::{Command, JumpObject, OtherWork, SceneJump};
use crate::payload::Payload;
use crate::scene::{
    Exchange, NewObject, Object, ObjectId, ObjectSource, Operand, SceneCommand, SceneEvent,
};
use sculptd_clay::{Clay, ObjectState, Page};
use sculptd_geometry::boolean::{BooleanOptions, Operation, compute};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, TriMesh};

fn operand(of: &Object) -> Operand {
    Operand {
        id: of.id,
        clay: of.clay.object_id(),
        revision: of.clay.revision(),
        transform: of.settings.transform,
    }
}

/// A Boolean of two objects where they stand, as the daemon computes it. `None`: there is none, for
/// one of them is open or nothing is left.
fn boolean_of(a: &Object, b: &Object, operation: Operation) -> Option<TriMesh> {
    let frame = a.settings.transform;
    let first = a.clay.to_tri().to_poly();
    let mut second: PolyMesh = b.clay.to_tri().to_poly();
    let way = b.settings.transform.then(&frame.inverse());
    second.positions.iter_mut().for_each(|p| *p = way.apply(*p));
    let options = BooleanOptions::default();
    let made = compute([&first, &second], &[operation], &options, &Job::default(), || 0.0);
    let mesh = made.ok()?.0.pop()?.mesh;
    let plain = mesh.triangulate().0;
    Clay::build(&plain, &Job::default()).is_ok().then_some(plain)
}

/// A Boolean of two objects. The operands go, or stay hidden. Whether there was a result.
pub(super) fn boolean_at_random(world: &mut World, dice: &mut Dice) -> bool {
    let operations = [
        Operation::Union,
        Operation::Intersection,
        Operation::Difference,
        Operation::ReverseDifference,
    ];
    let ids = [dice.object(world), dice.object(world)];
    let (operation, keep) = (operations[dice.roll(4)], dice.roll(3) == 0);
    let [Some(a), Some(b)] = ids.map(|id| world.scene().object(id)) else { return false };
    if ids[0] == ids[1] || a.settings.locked || b.settings.locked {
        return false;
    }
    let Some(plain) = boolean_of(a, b, operation) else { return false };
    let new = NewObject::new("result", ObjectSource::Mesh(plain.into()), a.settings.transform);
    let (remove, hide) = if keep { (vec![], ids.to_vec()) } else { (ids.to_vec(), vec![]) };
    let from = vec![operand(a), operand(b)];
    let event = SceneEvent::Boolean;
    let exchange = Exchange { event, from, remove, hide, add: vec![new] };
    ask(world, SceneCommand::Exchange(exchange)).is_ok()
}

/// States of the scene that one can go back to, as a session's history keeps them.
#[derive(Default)]
pub(super) struct Places {
    all: Vec<Place>,
    /// The highest revision, vertex and triangle that any clay ever had.
    high: (u64, [u32; 2]),
    jumps: u64,
}

struct Place {
    objects: Vec<PlacedObject>,
    active: u32,
}

struct PlacedObject {
    id: ObjectId,
    settings: crate::scene::ObjectSettings,
    pages: Vec<Arc<Page>>,
    work: OtherWork,
}

impl Places {
    /// Keeps the scene as it is.
    pub(super) fn keep(&mut self, world: &World) {
        self.look(world);
        let object = |o: &Object| PlacedObject {
            id: o.id,
            settings: o.settings.clone(),
            pages: (0..o.clay.page_count() as u32).map(|i| o.clay.page(i).clone()).collect(),
            work: OtherWork {
                rest: o.clay.rest(),
                middle: o.middle,
                extent: o.extent,
                levels: None,
            },
        };
        let objects = world.scene().objects().iter().map(object).collect();
        self.all.push(Place { objects, active: world.scene().active_index() as u32 });
    }

    /// Revisions go on above all that there ever were.
    pub(super) fn look(&mut self, world: &World) {
        for o in world.scene().objects() {
            let rest = o.clay.rest();
            self.high.0 = self.high.0.max(rest.revision);
            let next = |k: usize| self.high.1[k].max(rest.next[k]);
            self.high.1 = [next(0), next(1)];
        }
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// Goes to one of them.
    pub(super) fn jump(&mut self, world: &mut World, to: usize) {
        self.look(world);
        let place = &self.all[to];
        let (mut objects, mut clays) = (Vec::new(), Vec::new());
        for o in &place.objects {
            let (revision, next) = (self.high.0 + 1, self.high.1);
            let rest = ObjectState { revision, next, ..o.work.rest.clone() };
            let mut clay = Clay::of_stored(o.pages.clone(), &rest).expect("whole");
            clay.set_empty(rest.empty.clone());
            clays.push(clay);
            let pages = (0u32..).zip(&o.pages).map(|(i, p)| (i, p.revision())).collect();
            let clay = OtherWork { rest, ..o.work.clone() };
            objects.push(JumpObject { id: o.id, settings: o.settings.clone(), pages, clay });
        }
        let from = (world.mesh().object_id(), world.mesh().revision());
        self.jumps += 1;
        let jump = SceneJump { node: self.jumps, from, objects, active: place.active };
        let mut command = Command::JumpScene(Box::new(jump));
        world.deliver(&mut command, Payload::Clays(clays));
        let before = world.report().jumps;
        tell(world, command);
        assert_eq!(world.report().jumps, before + 1, "the jump is made");
    }
}

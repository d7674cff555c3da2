//! Random operations that make objects of others, and jumps to where the scene was before.

use std::sync::Arc;

use glam::DVec3;

use super::World;
use super::scene_tests::{Dice, ask, tell};
use crate::command::{Command, JumpObject, OtherWork, SceneJump};
use crate::payload::Payload;
use crate::scene::{
    Exchange, LiveBoolean, NewObject, Object, ObjectId, ObjectSource, ObjectTransform, Operand,
    Primitive, PrimitiveShape, Recomputed, SceneCommand, SceneError, SceneEvent,
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
    let operands = [operand(a), operand(b)];
    let exchange = Exchange { event, from, remove, hide, add: vec![new] };
    let command = match keep && dice.roll(2) > 0 {
        true => SceneCommand::ExchangeLive(Box::new((exchange, live(operation, operands)))),
        false => SceneCommand::Exchange(exchange),
    };
    ask(world, command).is_ok()
}

fn live(operation: Operation, operands: [Operand; 2]) -> LiveBoolean {
    LiveBoolean { operation, operands, keep_contact: false, tolerance: None, result: 0 }
}

/// Computes the results that no longer are of what their operands are, as the daemon does.
pub(super) fn follow(world: &mut World) -> usize {
    let mut done = 0;
    let ids: Vec<ObjectId> = world.scene().objects().iter().map(|o| o.id).collect();
    for id in ids {
        let scene = world.scene();
        let Some(live) = scene.object(id).and_then(Object::live).cloned() else { continue };
        let [Some(a), Some(b)] = live.operands.map(|o| scene.object(o.id)) else { continue };
        let operands = [operand(a), operand(b)];
        if operands == live.operands {
            continue;
        }
        let Some(plain) = boolean_of(a, b, live.operation) else { continue };
        let source = ObjectSource::Mesh(plain.into());
        let new = NewObject::new("result", source, a.settings.transform);
        let again = Recomputed { id, live: LiveBoolean { operands, ..live }, new };
        let asked = SceneCommand::Recomputed(Box::new(again));
        done += usize::from(ask(world, asked).is_ok());
    }
    done
}

/// Lists objects elsewhere, names a set, computes what follows, or applies it.
pub(super) fn arrange_at_random(world: &mut World, dice: &mut Dice) {
    let id = dice.object(world);
    let _ = match dice.roll(8) {
        6.. => {
            let transform = dice.transform();
            ask(world, SceneCommand::Drag(id, transform))
        }
        0 => ask(world, SceneCommand::Move(id, dice.roll(6) as u32)),
        1 => {
            let (other, name) = (dice.object(world), ["", "legs", "head"][dice.roll(3)]);
            ask(world, SceneCommand::Group(vec![id, other], name.into()))
        }
        2 => {
            let name = ["", "hoof"][dice.roll(2)];
            ask(world, SceneCommand::NameSet(dice.roll(4) as u16, name.into()))
        }
        3 => ask(world, SceneCommand::ApplyLive(id)),
        _ => {
            follow(world);
            Ok(id)
        }
    };
}

#[test]
fn a_live_result_follows_its_operands_within_their_step_until_it_is_changed_or_applied() {
    let mut world = super::scene_tests::world(1, u64::MAX);
    let shape = PrimitiveShape::Box([1.0, 1.0, 1.0]);
    let at = |x: f64| ObjectTransform { shift: DVec3::new(x, 0.0, 0.0), ..ObjectTransform::NONE };
    let source = ObjectSource::Primitive(Primitive { shape, edge: 0.2 });
    let new = NewObject::new("box", source, at(0.9));
    let tool = ask(&mut world, SceneCommand::Add(new)).expect("room");
    let (a, b) = (&world.scene().objects()[0], &world.scene().objects()[1]);
    let (ball, operands) = (a.id, [operand(a), operand(b)]);
    let plain = boolean_of(a, b, Operation::Difference).expect("a ball without a part");
    let new = NewObject::new("cut", ObjectSource::Mesh(plain.into()), ObjectTransform::NONE);
    let exchange = Exchange {
        event: SceneEvent::Boolean,
        from: operands.to_vec(),
        remove: vec![],
        hide: vec![ball, tool],
        add: vec![new],
    };
    let asked = (exchange, live(Operation::Difference, operands));
    let result = ask(&mut world, SceneCommand::ExchangeLive(Box::new(asked))).expect("made");
    let volume = |world: &World| {
        let object = world.scene().object(result).expect("there");
        sculptd_geometry::measure::measures(&object.clay.to_tri()).volume
    };
    assert_eq!(follow(&mut world), 0, "nothing has changed");
    let (before, steps, hash) = (volume(&world), world.undo_steps(), world.hash());
    // The tool goes further in: more is cut off, in the same step as the move.
    ask(&mut world, SceneCommand::Transform(tool, at(0.5))).expect("there");
    assert_eq!((follow(&mut world), follow(&mut world)), (1, 0));
    let moved = (volume(&world), world.hash());
    assert!(moved.0 < before - 0.2, "{} of {before}", moved.0);
    assert_eq!(world.undo_steps(), steps + 1);
    tell(&mut world, Command::Undo);
    assert_eq!((volume(&world), world.hash()), (before, hash));
    assert_eq!(follow(&mut world), 0, "both were taken back");
    tell(&mut world, Command::Redo);
    assert_eq!((volume(&world), world.hash()), moved);
    // Dragged there and on, with the result after it, and released: one step.
    tell(&mut world, Command::Undo);
    for x in [0.8, 0.7, 0.6, 0.5] {
        ask(&mut world, SceneCommand::Drag(tool, at(x))).expect("there");
        assert_eq!((follow(&mut world), world.undo_steps()), (1, steps + 1));
    }
    ask(&mut world, SceneCommand::Transform(tool, at(0.5))).expect("there");
    assert_eq!((volume(&world), world.undo_steps()), (moved.0, steps + 1));
    tell(&mut world, Command::Undo);
    assert_eq!((volume(&world), world.hash()), (before, hash));
    tell(&mut world, Command::Redo);
    // The next drag is another step.
    ask(&mut world, SceneCommand::Drag(tool, at(0.4))).expect("there");
    assert_eq!(world.undo_steps(), steps + 2);
    tell(&mut world, Command::Undo);
    let moved = (volume(&world), world.hash());
    assert_eq!((follow(&mut world), moved.0 < before - 0.2), (0, true));
    // Applied, it stays and its operands go, in one step.
    let applied = SceneCommand::ApplyLive(result);
    ask(&mut world, applied.clone()).expect("it follows");
    assert_eq!(world.scene().objects().len(), 1);
    assert_eq!(volume(&world), moved.0);
    tell(&mut world, Command::Undo);
    assert_eq!((world.scene().objects().len(), world.hash()), (3, moved.1));
    // A sculpted result is independent of its operands.
    ask(&mut world, SceneCommand::Activate(result)).expect("there");
    tell(&mut world, Command::Mask(sculptd_clay::brush::MaskAction::Invert));
    ask(&mut world, SceneCommand::Transform(tool, at(0.9))).expect("there");
    assert_eq!(follow(&mut world), 0);
    assert_eq!(ask(&mut world, applied), Err(SceneError::NotLive(result)));
    world.verify_invariants().expect("sound");
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

    /// Goes to one of them, once nothing is under way any more.
    pub(super) fn jump(&mut self, world: &mut World, to: usize) {
        tell(world, Command::LiftAll);
        for _ in 0..1000 {
            if world.is_at_rest() {
                break;
            }
            let tick = world.tick() + 1;
            world.step(tick, &[], &[]);
        }
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

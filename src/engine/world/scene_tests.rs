//! The scene under random operations: one undo timeline, the same bits with any number of workers.

use glam::{DQuat, DVec3, Vec2, Vec3};

use super::layer_tests::edit_at_random;
use super::scene_combine_tests::{Places, arrange_at_random, boolean_at_random};
use super::{World, WorldOptions};
use crate::answer::{Answer, CommandResult};
use crate::camera::Camera;
use crate::command::{Command, NewClay, OfClay};
use crate::hand::HandSettings;
use crate::payload::Payload;
use crate::scene::{
    Exchange, NewObject, ObjectId, ObjectSource, ObjectTransform, Operand, Primitive,
    PrimitiveShape, SceneCommand, SceneError, SceneEvent,
};
use crate::view_region::{SetsRegion, ViewRegion};
use sculptd_clay::brush::{BrushKind, BrushSettings, Falloff, MaskAction, Measure, Presets};
use sculptd_clay::face_sets::{FaceSetPart, PartEdit, Partition, SetsEdit, extract, partition};
use sculptd_clay::{Clay, Workers};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_geometry::{TriMesh, job::Job, shapes};

fn clay(plain: &TriMesh) -> Clay {
    Clay::build(plain, &Job::default()).expect("a form")
}

pub(super) fn world(workers: usize, undo_bytes: u64) -> World {
    let options = WorldOptions { dab_budget: 1 << 20, undo_bytes, hands: HandSettings::default() };
    let brush = BrushSettings { radius: 0.3, ..BrushSettings::default() };
    let ball = clay(&shapes::icosphere(1.0, 12));
    World::new(ball, Camera::default(), brush, Workers::new(workers), options)
}

/// Returns the result of a command, from its tick or, for an edit over several ticks, from a later
/// one.
pub(super) fn ask(world: &mut World, command: SceneCommand) -> Result<ObjectId, SceneError> {
    let tick = world.tick() + 1;
    world.step(tick, &[], &[Command::Scene(command)]);
    let object = |answer: CommandResult| match answer? {
        Answer::Object(id) => Ok(id),
        other => panic!("{other:?}"),
    };
    if world.answers()[0] != Ok(Answer::UnderWay) {
        return object(world.answers()[0]);
    }
    for tick in world.tick() + 1..world.tick() + 1000 {
        world.step(tick, &[], &[]);
        if let Some(late) = world.late_answer() {
            return object(late);
        }
    }
    panic!("no answer after a thousand ticks")
}

pub(super) fn tell(world: &mut World, command: Command) {
    let tick = world.tick() + 1;
    world.step(tick, &[], &[command]);
}

/// A stroke of a pen from one place of the view to another; the vertices that it moved.
pub(super) fn stroke(world: &mut World, from: Vec2, to: Vec2) -> u64 {
    let area_mm = Vec2::new(world.camera().aspect, 1.0) * 100.0;
    let mut moved = 0;
    for i in 0..=6 {
        let view = from.lerp(to, i as f32 / 5.0);
        let pen = Pen {
            in_range: true,
            tip: i < 6,
            pos_mm: view * area_mm,
            area_mm,
            pressure: Some(0.8),
            ..Pen::default()
        };
        let tick = world.tick() + 1;
        let body = Body::Pen(pen);
        let sample = Sample { device: DeviceId(1), t_us: tick * 8000, device_t_us: None, body };
        moved += world.step(tick, &[sample], &[]).vertices_moved;
    }
    moved
}

fn primitive(shape: PrimitiveShape, edge: f64) -> NewObject {
    let source = ObjectSource::Primitive(Primitive { shape, edge });
    NewObject::new(shape.name(), source, ObjectTransform::NONE)
}

/// Everything that undo must bring back, in words.
pub(super) fn state(world: &World) -> String {
    let scene = world.scene();
    let each = scene.objects().iter().map(|o| {
        let size = (o.middle, o.extent);
        format!("{} {:?} {size:?} {:016x}\n", o.id, o.settings, o.clay.hash())
    });
    format!("{}active {}", each.collect::<String>(), scene.active().id)
}

/// The first object.
fn one_of(world: &World) -> ObjectId {
    world.scene().objects()[0].id
}

pub(super) struct Dice(pub(super) u64);

impl Dice {
    pub(super) fn roll(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 33) as usize % most
    }

    pub(super) fn share(&mut self) -> f64 {
        self.roll(1 << 20) as f64 / f64::from(1 << 20)
    }

    fn view(&mut self) -> Vec2 {
        Vec2::new(self.share() as f32, self.share() as f32) * 0.6 + 0.2
    }

    pub(super) fn transform(&mut self) -> ObjectTransform {
        let v = |dice: &mut Self| DVec3::new(dice.share(), dice.share(), dice.share()) - 0.5;
        let axis = v(self).normalize_or(DVec3::Y);
        let turn = DQuat::from_axis_angle(axis, self.share() * 6.0);
        ObjectTransform { shift: v(self), turn, scale: 0.5 + self.share() }
    }

    pub(super) fn object(&mut self, world: &World) -> ObjectId {
        let all = world.scene().objects();
        all[self.roll(all.len())].id
    }

    fn shape(&mut self) -> NewObject {
        let shape = match self.roll(4) {
            0 => PrimitiveShape::Box([1.0, 1.5, 0.7]),
            1 => PrimitiveShape::Ball(0.8),
            2 => PrimitiveShape::Torus([0.8, 0.3]),
            _ => PrimitiveShape::Plane([2.0, 2.0]),
        };
        NewObject { transform: self.transform(), ..primitive(shape, 0.12) }
    }
}

/// Makes, hides or shows face sets, or extracts one.
fn edit_sets_at_random(world: &mut World, dice: &mut Dice) {
    let mut snapshot = world.mesh().duplicate(0);
    let snapshot = snapshot.snapshot();
    let set = dice.roll(usize::from(snapshot.highest_set()) + 2) as u16;
    let parted = |by| match partition(&snapshot, by, &Job::default()) {
        // As it was computed from the clay itself.
        Ok(SetsEdit::Assign { pages, .. }) => {
            SetsEdit::Assign { revision: world.mesh().revision(), pages }
        }
        other => panic!("{other:?}"),
    };
    let edit = match dice.roll(18) {
        16.. => {
            let region = ViewRegion::Box([dice.view(), dice.view()]);
            let edit = [PartEdit::NewSet, PartEdit::Hide, PartEdit::Isolate][dice.roll(3)];
            let asked = SetsRegion { region, edit, front_faces: dice.roll(2) > 0 };
            let _ = ask(world, SceneCommand::SetsRegion(asked));
            return;
        }
        0..=2 => SetsEdit::FromMask,
        3 => SetsEdit::FromVisible,
        4..=5 => parted(Partition::Normals(20.0 + dice.roll(60) as f32)),
        6 => parted(Partition::Crease(30.0)),
        7 => parted(Partition::Loose),
        8 => SetsEdit::Hide(set),
        9 => SetsEdit::Show(set),
        10 => SetsEdit::HideMasked,
        11 => SetsEdit::Invert,
        12 => SetsEdit::Isolate(set),
        13 => SetsEdit::Clear,
        14 => {
            let part = if dice.roll(2) > 0 { FaceSetPart::Masked } else { FaceSetPart::Set(set) };
            if let Ok(shell) = extract(&snapshot, part, 0.1) {
                let source = ObjectSource::Mesh(shell.into());
                let new = NewObject::new("shell", source, ObjectTransform::NONE);
                let _ = ask(world, SceneCommand::Add(new));
            }
            return;
        }
        _ => SetsEdit::ShowAll,
    };
    let _ = ask(world, SceneCommand::Sets(edit));
}

/// One random operation.
pub(super) fn operate(world: &mut World, dice: &mut Dice) {
    let id = dice.object(world);
    let full = world.scene().objects().len() > 8;
    match dice.roll(47) {
        0..=6 => {
            let (from, to) = (dice.view(), dice.view());
            stroke(world, from, to);
        }
        7..=9 => tell(world, Command::Undo),
        10..=11 => tell(world, Command::Redo),
        12 if !full => {
            let new = dice.shape();
            let _ = ask(world, SceneCommand::Add(new));
        }
        13 if !full => {
            let _ = ask(world, SceneCommand::Duplicate(id));
        }
        12..=14 => {
            let _ = ask(world, SceneCommand::Remove(id));
        }
        15 => {
            let name = format!("part {}", dice.roll(9));
            let _ = ask(world, SceneCommand::Rename(id, name));
        }
        16 => {
            let transform = dice.transform();
            let _ = ask(world, SceneCommand::Transform(id, transform));
        }
        17 => {
            let _ = ask(world, SceneCommand::Activate(id));
        }
        18 => {
            let visible = dice.roll(3) > 0;
            let _ = ask(world, SceneCommand::Show(id, visible));
        }
        19 => {
            let locked = dice.roll(3) == 0;
            let _ = ask(world, SceneCommand::Lock(id, locked));
        }
        20 => tell(world, Command::Mask(MaskAction::Invert)),
        21 => {
            let plain = std::sync::Arc::new(shapes::icosphere(0.9, 6 + dice.roll(6) as u32));
            tell(world, Command::Replace(NewClay::new(plain, true)));
        }
        22 => {
            let kind = match dice.roll(8) {
                6.. => BrushKind::DrawFaceSets,
                k => BrushKind::ALL[k],
            };
            let mut brush = Presets::default().of(kind);
            if kind == BrushKind::DrawFaceSets {
                (brush.strength, brush.falloff) = (1.0, Falloff::Constant);
                brush.negative = dice.roll(3) == 0;
            }
            brush.radius = 0.3;
            brush.auto.face_sets = dice.roll(2) > 0;
            brush.topology.by = if dice.roll(3) == 0 { Measure::Brush } else { Measure::Off };
            tell(world, Command::Brush(brush));
        }
        24..=31 => edit_at_random(world, dice),
        32..=39 => edit_sets_at_random(world, dice),
        40..=42 => {
            boolean_at_random(world, dice);
        }
        43.. => arrange_at_random(world, dice),
        _ => {
            let of = world.scene().object(id).expect("there");
            let from = Operand {
                id,
                clay: of.clay.object_id(),
                revision: of.clay.revision(),
                transform: of.settings.transform,
            };
            let exchange = Exchange {
                event: SceneEvent::Boolean,
                from: vec![from],
                remove: vec![id],
                hide: Vec::new(),
                add: vec![dice.shape()],
            };
            let _ = ask(world, SceneCommand::Exchange(exchange));
        }
    }
}

/// The hash after each of so many random operations, and after undo of everything.
fn random_run(workers: usize, rounds: usize, undo_bytes: u64) -> Vec<u64> {
    let mut world = world(workers, undo_bytes);
    let mut dice = Dice(42);
    let start = (state(&world), world.hash());
    let mut hashes = Vec::new();
    for round in 0..rounds {
        operate(&mut world, &mut dice);
        world.verify_invariants().unwrap_or_else(|e| panic!("round {round}: {e}"));
        hashes.push(world.hash());
    }
    if undo_bytes == u64::MAX {
        assert!(world.undo_steps() > rounds / 8, "{} steps", world.undo_steps());
    }
    let (newest, steps) = (state(&world), world.undo_steps());
    while world.undo_steps() > 0 {
        tell(&mut world, Command::Undo);
        world.verify_invariants().expect("sound on the way back");
    }
    if undo_bytes == u64::MAX {
        assert_eq!((state(&world), world.hash()), start, "undo of everything");
    }
    hashes.push(world.hash());
    for _ in 0..steps {
        tell(&mut world, Command::Redo);
    }
    assert_eq!(state(&world), newest, "redo of everything");
    hashes
}

/// The same with jumps between the operations, each to a state before; the hash after each
/// operation, and at the start, to which the last jump goes.
fn random_run_with_jumps(workers: usize, rounds: usize) -> Vec<u64> {
    let mut world = world(workers, u64::MAX);
    let mut dice = Dice(7);
    let start = (state(&world), world.hash());
    let (mut places, mut known, mut hashes) = (Places::default(), Vec::new(), Vec::new());
    places.keep(&world);
    known.push(start.clone());
    for round in 0..rounds {
        match dice.roll(12) {
            0 => {
                let to = dice.roll(places.len());
                places.jump(&mut world, to);
                assert_eq!((state(&world), world.hash()), known[to], "round {round}");
                assert_eq!(world.undo_steps(), 0, "the file takes back what lies before");
            }
            1 if world.is_at_rest() => {
                places.keep(&world);
                known.push((state(&world), world.hash()));
            }
            _ => operate(&mut world, &mut dice),
        }
        places.look(&world);
        world.verify_invariants().unwrap_or_else(|e| panic!("round {round}: {e}"));
        hashes.push(world.hash());
    }
    while world.undo_steps() > 0 {
        tell(&mut world, Command::Undo);
        world.verify_invariants().expect("sound on the way back");
    }
    places.jump(&mut world, 0);
    assert_eq!((state(&world), world.hash()), start, "back to the start");
    hashes
}

#[test]
fn random_operations_with_jumps_give_the_same_bits_with_any_number_of_workers() {
    let one = random_run_with_jumps(1, 400);
    for workers in [2, 3, 7, 16] {
        assert_eq!(random_run_with_jumps(workers, 400), one, "{workers} workers");
    }
}

#[test]
fn booleans_of_random_objects_are_taken_back_to_the_bit() {
    let mut world = world(1, u64::MAX);
    let mut dice = Dice(3);
    let mut made = 0;
    for _ in 0..40 {
        let new = dice.shape();
        ask(&mut world, SceneCommand::Add(new)).expect("room");
        let before = (state(&world), world.hash());
        if boolean_at_random(&mut world, &mut dice) {
            made += 1;
            let after = (state(&world), world.hash());
            tell(&mut world, Command::Undo);
            assert_eq!((state(&world), world.hash()), before);
            tell(&mut world, Command::Redo);
            assert_eq!((state(&world), world.hash()), after);
        }
        world.verify_invariants().expect("sound");
    }
    assert!(made > 10, "{made} of 40");
}

#[test]
fn a_brush_keeps_to_the_face_set_that_it_began_in() {
    let mut world = world(1, u64::MAX);
    let plain = shapes::icosphere(1.0, 40);
    // The border goes down the middle of what the camera sees.
    let right = world.camera().axes().0;
    let masks = plain.positions.iter().map(|p| f32::from(p.dot(right) > 0.0)).collect();
    let new = NewClay::new(plain.into(), false);
    tell(&mut world, Command::ReplaceMasked(new, std::sync::Arc::new(masks)));
    assert_eq!(ask(&mut world, SceneCommand::Sets(SetsEdit::FromMask)), Ok(ObjectId(1)));
    tell(&mut world, Command::Mask(MaskAction::Clear));
    let mut brush = BrushSettings { radius: 0.3, ..BrushSettings::default() };
    brush.auto.face_sets = true;
    tell(&mut world, Command::Brush(brush));
    let camera = *world.camera();
    let set = |at: Vec2| {
        let hit = world.mesh().pick(camera.ray(at)).expect("the ball");
        world.mesh().set_at(&hit)
    };
    let (left, right) = (Vec2::new(0.45, 0.5), Vec2::new(0.55, 0.5));
    let (first, other) = (set(left), set(right));
    assert!(first != other, "{first} and {other}");
    let places = |world: &World, set| {
        let mut all = Vec::new();
        for p in 0..world.mesh().page_count() as u32 {
            let page = world.mesh().page(p);
            let rows = (0..page.own()).filter(|&v| page.face_set(v) == set);
            all.extend(rows.map(|v| page.point(v).to_array().map(f32::to_bits)));
        }
        all
    };
    // The stroke goes on over the border, and changes nothing there.
    let before = [first, other].map(|set| places(&world, set));
    assert!(stroke(&mut world, left, right) > 100);
    assert_ne!(places(&world, first), before[0]);
    assert_eq!(places(&world, other), before[1]);
    // A stroke that runs from what is shown into what is hidden changes nothing there.
    assert!(ask(&mut world, SceneCommand::Sets(SetsEdit::Isolate(other))).is_ok());
    let before = places(&world, first);
    assert!(stroke(&mut world, right, left) > 0);
    assert_eq!(places(&world, first), before, "hidden");
    tell(&mut world, Command::Undo);
    tell(&mut world, Command::Undo);
    assert!(!(0..world.mesh().page_count() as u32).any(|p| {
        let page = world.mesh().page(p);
        (0..page.own()).any(|v| page.is_hidden(v))
    }));
}

#[test]
fn random_operations_over_objects_give_the_same_bits_with_any_number_of_workers() {
    let one = random_run(1, 400, u64::MAX);
    for workers in [2, 3, 7, 16] {
        assert_eq!(random_run(workers, 400, u64::MAX), one, "{workers} workers");
    }
}

#[test]
fn undo_within_a_bound_goes_back_as_far_as_it_holds_and_no_further() {
    // About three pages: the oldest steps go all the time.
    random_run(1, 200, 300_000);
    random_run(1, 60, 0);
}

#[test]
fn a_stroke_on_an_object_that_was_moved_turned_and_scaled_is_the_one_on_its_own_form() {
    let (from, to) = (Vec2::new(0.4, 0.45), Vec2::new(0.6, 0.55));
    let camera = Camera { yaw: 0.4, pitch: 0.2, distance: 4.0, ..Camera::default() };
    let mut plain = world(1, u64::MAX);
    tell(&mut plain, Command::Camera(camera));
    assert!(stroke(&mut plain, from, to) > 0);
    // About +y, so that a turntable camera can follow.
    let turn = DQuat::from_axis_angle(DVec3::Y, 0.7);
    let transform = ObjectTransform { shift: DVec3::new(30.0, -20.0, 10.0), turn, scale: 3.0 };
    let mut moved = world(1, u64::MAX);
    ask(&mut moved, SceneCommand::Transform(ObjectId(0), transform)).expect("there");
    tell(
        &mut moved,
        Command::Camera(Camera {
            target: transform.point(Vec3::ZERO),
            yaw: camera.yaw + 0.7,
            distance: 12.0,
            ..camera
        }),
    );
    assert!(stroke(&mut moved, from, to) > 0);
    let (a, b) = (plain.mesh().to_tri(), moved.mesh().to_tri());
    let far = a.positions.iter().zip(&b.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    let start = shapes::icosphere(1.0, 12);
    let raised = a.positions.iter().zip(&start.positions).map(|(a, b)| a.distance(*b));
    let raised = raised.fold(0.0, f32::max);
    assert!(far < 0.02 * raised, "{far} of {raised}");
}

#[test]
fn one_object_that_stands_where_it_is_has_the_hash_of_its_clay() {
    let mut world = world(1, u64::MAX);
    let bare = world.mesh().hash();
    assert_eq!(world.hash(), bare);
    ask(&mut world, SceneCommand::Rename(ObjectId(0), "pig".into())).expect("there");
    assert_eq!(world.hash(), bare);
    let moved = ObjectTransform { shift: DVec3::X, ..ObjectTransform::NONE };
    ask(&mut world, SceneCommand::Transform(ObjectId(0), moved)).expect("there");
    assert_ne!(world.hash(), bare);
    tell(&mut world, Command::Undo);
    ask(&mut world, SceneCommand::Add(primitive(PrimitiveShape::Ball(1.0), 0.2))).expect("room");
    assert_ne!(world.hash(), bare);
}

#[test]
fn what_is_locked_or_hidden_or_last_is_left_alone() {
    let mut world = world(1, u64::MAX);
    let first = ObjectId(0);
    let (from, to) = (Vec2::splat(0.45), Vec2::splat(0.55));
    assert_eq!(ask(&mut world, SceneCommand::Remove(first)), Err(SceneError::Last));
    assert_eq!(
        ask(&mut world, SceneCommand::Remove(ObjectId(9))),
        Err(SceneError::NoObject(ObjectId(9)))
    );
    ask(&mut world, SceneCommand::Lock(first, true)).expect("there");
    let before = world.hash();
    assert_eq!(stroke(&mut world, from, to), 0);
    tell(&mut world, Command::Mask(MaskAction::Invert));
    let plain = std::sync::Arc::new(shapes::icosphere(0.5, 3));
    tell(&mut world, Command::Replace(NewClay::new(plain, true)));
    assert_eq!(world.hash(), before);
    let moved = SceneCommand::Transform(first, ObjectTransform::NONE);
    assert_eq!(ask(&mut world, moved), Err(SceneError::Locked(first)));
    ask(&mut world, SceneCommand::Lock(first, false)).expect("there");
    ask(&mut world, SceneCommand::Show(first, false)).expect("there");
    assert_eq!(stroke(&mut world, from, to), 0);
    ask(&mut world, SceneCommand::Show(first, true)).expect("there");
    assert!(stroke(&mut world, from, to) > 0);
    assert_eq!(ask(&mut world, SceneCommand::Rename(first, " \n".into())), Err(SceneError::Name));
    let far = ObjectTransform { scale: f64::NAN, ..ObjectTransform::NONE };
    assert_eq!(ask(&mut world, SceneCommand::Transform(first, far)), Err(SceneError::Transform));
}

#[test]
fn the_numbers_of_a_primitive_can_be_changed_until_its_first_stroke() {
    let mut world = world(1, u64::MAX);
    let id = ask(&mut world, SceneCommand::Add(primitive(PrimitiveShape::Ball(1.0), 0.1)));
    let id = id.expect("room");
    let before = state(&world);
    let larger = primitive(PrimitiveShape::Cylinder([1.0, 3.0]), 0.1);
    ask(&mut world, SceneCommand::Reshape(id, larger.clone())).expect("untouched");
    let (lo, hi) = world.mesh().bounds();
    assert!(((hi - lo) - Vec3::new(2.0, 3.0, 2.0)).length() < 0.02, "{}", hi - lo);
    tell(&mut world, Command::Undo);
    assert_eq!(state(&world), before);
    tell(&mut world, Command::Redo);
    assert!(stroke(&mut world, Vec2::splat(0.45), Vec2::splat(0.55)) > 0);
    let refused = ask(&mut world, SceneCommand::Reshape(id, larger.clone()));
    assert_eq!(refused, Err(SceneError::NotAPrimitive(id)));
    let refused = ask(&mut world, SceneCommand::Reshape(ObjectId(0), larger));
    assert_eq!(refused, Err(SceneError::NotAPrimitive(ObjectId(0))));
}

#[test]
fn a_result_that_was_computed_for_another_clay_changes_nothing() {
    let mut world = world(1, u64::MAX);
    let first = (world.mesh().object_id(), world.mesh().revision());
    ask(&mut world, SceneCommand::Add(primitive(PrimitiveShape::Ball(1.0), 0.2))).expect("room");
    let before = state(&world);
    let plain = std::sync::Arc::new(shapes::icosphere(0.5, 3));
    let of = |clay: u32| {
        Command::OfClay(Box::new(OfClay {
            clay,
            revision: Some(first.1),
            command: Command::Replace(NewClay::new(plain.clone(), true)),
        }))
    };
    tell(&mut world, of(first.0));
    assert_eq!(state(&world), before);
    ask(&mut world, SceneCommand::Activate(ObjectId(0))).expect("there");
    tell(&mut world, of(first.0));
    assert_eq!(world.mesh().hash(), clay(&plain).hash());
}

#[test]
fn a_world_that_was_saved_with_several_objects_goes_on_to_the_bit() {
    let mut one = world(1, u64::MAX);
    let mut dice = Dice(5);
    for _ in 0..60 {
        operate(&mut one, &mut dice);
    }
    ask(&mut one, SceneCommand::Add(primitive(PrimitiveShape::Ball(0.6), 0.1))).expect("room");
    let first = one_of(&one);
    ask(&mut one, SceneCommand::Activate(first)).expect("there");
    tell(&mut one, Command::LiftAll);
    let saved = one.save().expect("at rest");
    let list = saved.scene().expect("readable").expect("several objects");
    // Content of a session file: the pages, and the other state of each clay.
    let clays = one.scene().objects().iter().zip(&list.objects).map(|(o, saved)| {
        let pages = (0..o.clay.page_count() as u32).map(|i| o.clay.page(i).clone()).collect();
        Clay::of_stored(pages, &saved.rest).expect("whole")
    });
    let clays = clays.collect();
    let options =
        WorldOptions { dab_budget: 1 << 20, undo_bytes: u64::MAX, hands: HandSettings::default() };
    let mut two = World::restore(clays, saved.clone(), Workers::new(2), options).expect("its own");
    // Neither can go back beyond here.
    tell(&mut one, Command::Reopened);
    tell(&mut two, Command::Reopened);
    assert_eq!(state(&one), state(&two));
    let mut other = Dice(dice.0);
    assert!(one.scene().objects().len() > 1);
    for _ in 0..60 {
        operate(&mut one, &mut dice);
        operate(&mut two, &mut other);
        assert_eq!(one.hash(), two.hash());
    }
    assert_eq!(state(&one), state(&two));
    // A list whose clays are not all there is refused.
    assert!(World::restore(Vec::new(), saved, Workers::new(1), options).is_err());
}

#[test]
fn a_new_object_is_the_same_with_its_payload_and_from_its_bytes() {
    let plain = std::sync::Arc::new(shapes::icosphere(0.7, 9));
    let new = NewObject::new("ball", ObjectSource::Mesh(plain.clone()), ObjectTransform::NONE);
    let (mut sent, mut read) = (world(1, u64::MAX), world(1, u64::MAX));
    let mut command = Command::Scene(SceneCommand::Add(new));
    sent.deliver(&mut command, Payload::Clay(Box::new(clay(&plain))));
    let bytes = postcard::to_stdvec(&command).expect("plain data");
    tell(&mut sent, command);
    tell(&mut read, postcard::from_bytes(&bytes).expect("plain data"));
    assert_eq!(state(&sent), state(&read));
    assert_eq!(sent.mesh().hash(), clay(&plain).hash());
}

//! Several people at one world: each with a view and a brush, and none in another's way.

use glam::Vec2;

use super::{World, WorldOptions};
use crate::camera::Camera;
use crate::command::{Command, OfPerson};
use crate::hand::HandSettings;
use sculptd_clay::brush::{BrushKind, BrushSettings};
use sculptd_clay::{Clay, Workers};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

fn options() -> WorldOptions {
    WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 30, hands: HandSettings::default() }
}

fn world() -> World {
    let clay = Clay::build(&shapes::sphere_of_about(3000), &Job::default()).expect("a ball");
    World::new(clay, Camera::default(), BrushSettings::default(), Workers::new(1), options())
}

fn of(person: u8, command: Command) -> Command {
    Command::OfPerson(Box::new(OfPerson { person, command }))
}

fn pen(person: u16, tip: bool, x: f32) -> Sample {
    let pen = Pen {
        in_range: true,
        tip,
        pos_mm: Vec2::new(x, 50.0),
        area_mm: Vec2::new(100.0, 100.0),
        pressure: Some(0.8),
        ..Pen::default()
    };
    let device = DeviceId(person << 8);
    Sample { device, t_us: 0, device_t_us: None, body: Body::Pen(pen) }
}

/// Two people, one of whom looks from behind with another brush, sculpt at once.
fn sculpt(world: &mut World, ticks: std::ops::Range<u64>) {
    for tick in ticks {
        let (tip, x) = (tick % 12 < 9, 40.0 + (tick % 12) as f32 * 1.5);
        world.step(tick, &[pen(1, tip, x), pen(2, tip, 100.0 - x)], &[]);
    }
}

fn settle(world: &mut World) {
    let behind = Camera { yaw: world.camera().yaw + 3.0, ..*world.camera() };
    let brush =
        BrushSettings { kind: BrushKind::Inflate, radius: 0.05, ..BrushSettings::default() };
    world.step(1, &[], &[of(1, Command::LiftAll), of(2, Command::Camera(behind))]);
    world.step(2, &[], &[of(2, Command::Brush(brush))]);
}

#[test]
fn each_person_has_a_view_and_a_brush_whomever_the_world_is_shown_to() {
    let mut seen = [world(), world(), world()];
    for (own, world) in seen.iter_mut().enumerate() {
        world.show_to(own as u8);
        settle(world);
        sculpt(world, 3..60);
        world.verify_invariants().expect("sound");
    }
    let [a, b, c] = &seen;
    assert_eq!((a.hash(), a.hash()), (b.hash(), c.hash()));
    assert_ne!(a.hash(), world().hash());
    assert_ne!(b.camera().yaw, c.camera().yaw);
    assert_eq!(c.brush().kind, BrushKind::Inflate);
    assert_eq!(b.brush().kind, BrushSettings::default().kind);
    assert_eq!((b.pens().count(), c.pens().count()), (1, 1), "each sees the own pen");
    // Both sides of the ball were sculpted: the second looked from behind.
    let (ball, now) = (world().mesh().to_tri().positions, b.mesh().to_tri().positions);
    let eyes = [b.camera().backward(), c.camera().backward()];
    let moved = |eye: glam::Vec3| {
        ball.iter().zip(&now).any(|(p, q)| p != q && p.normalize().dot(eye) > 0.7)
    };
    assert!(eyes.into_iter().all(moved));
}

#[test]
fn everybody_sees_where_the_others_pens_meet_the_clay() {
    let mut world = world();
    for shown in [1, 2] {
        world.show_to(shown);
        settle(&mut world);
        let both = [pen(1, false, 45.0), pen(2, true, 55.0)];
        world.step(3, &both, &[]);
        world.step(4, &both, &[]);
        let other = 3 - shown;
        let seen: Vec<_> = world.pens_of_others().collect();
        let [one] = seen.as_slice() else { panic!("one pen: {seen:?}") };
        assert_eq!((one.person, one.device), (other, DeviceId(u16::from(other) << 8)));
        assert_eq!(one.down, other == 2);
        // The pen is on the ball, at the side that person sees, with that person's brush.
        world.show_to(other);
        assert!(one.position.normalize().dot(world.camera().backward()) > 0.9);
        assert!((one.position.length() - 1.0).abs() < 0.02, "{one:?}");
        assert!(one.normal.dot(one.position.normalize()) > 0.9);
        let brush = world.brush();
        let pressed = if one.down { 0.8 } else { 1.0 };
        let expected = world.brush_radius() * brush.pressure_radius.factor(pressed);
        assert_eq!(one.radius, expected);
        assert!(!world.pens_of_others().any(|p| p.person == other), "never the own");
        // Beside the clay there is no place, and out of range there is no pen.
        world.show_to(shown);
        let gone = pen(u16::from(other), false, 99.9);
        world.step(5, &[gone], &[]);
        assert_eq!(world.pens_of_others().count(), 0);
        world.step(6, &[], &[of(1, Command::LiftAll)]);
    }
    world.step(9, &[], &[Command::OnePerson]);
    assert_eq!(world.pens_of_others().count(), 0, "a world of one person has no others");
}

#[test]
fn a_saved_world_knows_everybody() {
    let mut world = world();
    world.show_to(1);
    settle(&mut world);
    sculpt(&mut world, 3..40);
    world.step(40, &[], &[Command::Reopened]);
    let saved = world.save().expect("at rest");
    let clay = world.mesh().duplicate(world.mesh().object_id());
    let mut again =
        World::restore(vec![clay], saved, Workers::new(1), options()).expect("the same");
    again.show_to(2);
    assert_eq!(again.brush().kind, BrushKind::Inflate);
    sculpt(&mut world, 41..90);
    sculpt(&mut again, 41..90);
    assert_eq!(world.hash(), again.hash());
}

#[test]
fn a_shared_world_goes_on_with_one_person() {
    let mut world = world();
    world.show_to(1);
    settle(&mut world);
    sculpt(&mut world, 3..40);
    assert!(world.has_people());
    let brush = *world.brush();
    world.show_to(0);
    world.step(40, &[], &[Command::Reopened, Command::OnePerson]);
    assert!(!world.has_people());
    assert_eq!(*world.brush(), brush, "that of the first");
    // A device of any number is that person's.
    let before = world.hash();
    for tick in 41..60 {
        world.step(tick, &[pen(1, tick < 58, 40.0 + tick as f32 * 0.3)], &[]);
    }
    assert_ne!(world.hash(), before);
    assert_eq!(world.pens().count(), 1, "and it is shown");
}

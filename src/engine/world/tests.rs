//! What the world keeps for others, and what it hands over.

use std::sync::{Arc, Mutex};

use super::{World, WorldOptions};
use crate::camera::Camera;
use crate::command::{Command, Jump, NewClay, OtherWork};
use crate::hand::HandSettings;
use crate::payload::{Payload, PayloadId};
use crate::scene::{ObjectId, SceneCommand, SceneError};
use sculptd_clay::brush::BrushSettings;
use sculptd_clay::{Clay, CollectGarbage, Garbage, GarbageSink, Workers};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

fn clay(plain: &TriMesh) -> Clay {
    Clay::build(plain, &Job::default()).expect("a ball")
}

fn world(plain: &TriMesh) -> World {
    let options =
        WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 30, hands: HandSettings::default() };
    World::new(clay(plain), Camera::default(), BrushSettings::default(), Workers::new(1), options)
}

/// Keeps all garbage, so that a test can look at it.
#[derive(Debug, Default)]
struct Kept(Mutex<Vec<Garbage>>);

impl CollectGarbage for Kept {
    fn collect(&self, garbage: Garbage) {
        self.0.lock().expect("one thread").push(garbage);
    }
}

impl Kept {
    fn clays(&self) -> usize {
        let all = self.0.lock().expect("one thread");
        all.iter().filter(|g| matches!(g, Garbage::Owned(any) if any.is::<Clay>())).count()
    }
}

#[test]
fn new_clay_is_the_same_with_its_payload_and_from_its_bytes() {
    let (first, second) = (shapes::sphere_of_about(400), Arc::new(shapes::sphere_of_about(900)));
    let (mut sent, mut read) = (world(&first), world(&first));
    let mut command = Command::Replace(NewClay::new(second.clone(), false));
    sent.deliver(&mut command, Payload::Clay(Box::new(clay(&second))));
    let bytes = postcard::to_stdvec(&command).expect("plain data");
    sent.step(1, &[], &[command]);
    let again: Command = postcard::from_bytes(&bytes).expect("plain data");
    assert!(matches!(&again, Command::Replace(new) if new.built.is_none()));
    read.step(1, &[], &[again]);
    assert_eq!(sent.hash(), clay(&second).hash());
    assert_eq!(read.hash(), sent.hash());
}

#[test]
fn a_jump_that_was_read_from_bytes_works_where_its_pages_can_be_had() {
    let plain = shapes::sphere_of_about(2000);
    let mut world = world(&plain);
    // The same ball, larger: each of its pages differs.
    let mut larger = plain;
    larger.positions.iter_mut().for_each(|p| *p *= 1.5);
    let larger = clay(&larger);
    let jump = Jump {
        node: 7,
        from: (world.mesh().object_id(), world.mesh().revision()),
        object_id: 0,
        pages: (0..larger.page_count() as u32).map(|i| (i, larger.page(i).revision())).collect(),
        other: None,
    };
    let bytes = postcard::to_stdvec(&Command::Jump(Box::new(jump))).expect("plain data");
    let read: Command = postcard::from_bytes(&bytes).expect("plain data");
    // Without its pages the jump is ignored, and counted as not made.
    assert_eq!(world.step(1, &[], std::slice::from_ref(&read)).jumps, 0);
    let Command::Jump(named) = &read else { panic!("not a jump") };
    assert_eq!(named.payload_id(), PayloadId::Jump { node: 7, from: (0, 0) });
    let pages = named.pages.iter().map(|&(i, _)| (i, larger.page(i).clone())).collect();
    world.deliver_for_jump(named, Payload::Pages(pages));
    assert_eq!(world.step(2, &[], &[read]).jumps, 1);
    assert_eq!(world.hash(), larger.hash());
    world.verify_invariants().expect("sound");
}

#[test]
fn a_jump_that_was_made_for_another_scene_is_refused() {
    let mut world = world(&shapes::sphere_of_about(400));
    let first = world.mesh().object_id();
    world.step(1, &[], &[Command::Scene(SceneCommand::Duplicate(ObjectId(0)))]);
    let [ball, copy] = world.scene().objects() else { panic!("two objects") };
    assert_eq!(ball.clay.object_id(), first);
    let from = (copy.clay.object_id(), copy.clay.revision());
    // It leads the copy to the clay that the ball has.
    let other = OtherWork {
        rest: ball.clay.rest(),
        middle: ball.middle,
        extent: ball.extent,
        levels: None,
    };
    let jump = Jump { node: 7, from, object_id: first, pages: Vec::new(), other: Some(other) };
    let payload = Payload::Clay(Box::new(clay(&shapes::sphere_of_about(400))));
    world.deliver_for_jump(&jump, payload);
    let hash = world.hash();
    assert_eq!(world.step(2, &[], &[Command::Jump(Box::new(jump))]).jumps, 0);
    assert_eq!(world.answers(), [Err(SceneError::Stale)]);
    assert_eq!(world.hash(), hash);
    world.verify_invariants().expect("sound");
}

#[test]
fn what_is_replaced_and_what_no_command_takes_goes_to_the_sink() {
    let plain = Arc::new(shapes::sphere_of_about(400));
    let kept = Arc::new(Kept::default());
    let mut world = world(&plain);
    world.set_garbage_sink(GarbageSink::new(kept.clone()));
    // A payload whose command is not in the step.
    let mut command = Command::Replace(NewClay::new(plain.clone(), false));
    world.deliver(&mut command, Payload::Clay(Box::new(clay(&plain))));
    world.step(1, &[], &[]);
    let payloads = |all: &[Garbage]| {
        all.iter().filter(|g| matches!(g, Garbage::Owned(any) if any.is::<Payload>())).count()
    };
    assert_eq!(payloads(&kept.0.lock().expect("one thread")), 1);
    // The clay that a file replaces cannot come back; the clay that a Boolean replaces can.
    for (tick, keep_camera, clays) in [(2, false, 1), (3, true, 1), (4, true, 1), (5, false, 4)] {
        let mut command = Command::Replace(NewClay::new(plain.clone(), keep_camera));
        world.deliver(&mut command, Payload::Clay(Box::new(clay(&plain))));
        world.step(tick, &[], &[command]);
        assert_eq!(kept.clays(), clays, "tick {tick}");
    }
    // A command that needs no payload.
    world.deliver(&mut Command::Undo, Payload::Pages(Vec::new()));
    assert_eq!(payloads(&kept.0.lock().expect("one thread")), 2);
}

#[test]
fn each_brush_keeps_its_settings_through_a_hundred_switches_and_a_restart() {
    use sculptd_clay::brush::{BrushKind, OwnBrush, Presets};
    let plain = shapes::sphere_of_about(400);
    let presets = Presets::default();
    // Several of one kind, and one of the kind that is in hand at the start.
    let of_one = |(name, kind): &(&str, &str)| {
        let text = format!("kind = '{kind}'\n[settings]\nspacing = 0.07\n");
        OwnBrush::read(name, &text, &|kind| presets.of(kind)).expect("valid")
    };
    let names = [("bark", "texture"), ("oak", "texture"), ("soft", "draw"), ("hard", "clay")];
    presets.set_own(names.iter().map(of_one).collect());
    let own = presets.own();
    let mut world = world(&plain);
    let mut seed = 7u64;
    let mut dice = |most: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize % most
    };
    let count = BrushKind::ALL.len() + own.len();
    // Last settings of each brush, once it was set.
    let mut set: Vec<Option<BrushSettings>> = vec![None; count];
    set[world.brush().kind as usize] = Some(*world.brush());
    let take = |world: &World, i: usize| {
        let (now, kept) = (world.brush(), world.kept_brushes());
        match BrushKind::ALL.get(i) {
            Some(kind) if now.key() == (*kind, 0) => *now,
            Some(kind) => presets.recalled(now, kept, *kind),
            None if now.key() == own[i - BrushKind::ALL.len()].settings.key() => *now,
            None => presets.taken(now, kept, &own[i - BrushKind::ALL.len()]),
        }
    };
    for tick in 1..=100u64 {
        // Every other time one of a person's own.
        let i = match dice(2) {
            0 => dice(count),
            _ => BrushKind::ALL.len() + dice(own.len()),
        };
        let recalled = take(&world, i);
        match set[i] {
            Some(set) => assert_eq!(recalled, set, "{} at switch {tick}", recalled.kind),
            None if i < BrushKind::ALL.len() => {
                // A brush never set starts at the current size.
                let radius = world.brush().radius;
                let begins = presets.of(recalled.kind);
                assert_eq!(recalled, BrushSettings { radius, ..begins }, "at switch {tick}");
            }
            None => assert_eq!(recalled, own[i - BrushKind::ALL.len()].settings),
        }
        // Each time something else is set.
        let mut now = recalled;
        now.radius = 0.01 + dice(500) as f32 / 1000.0;
        now.strength = dice(1000) as f32 / 1000.0;
        now.pressure_strength.gamma = 0.1 + dice(900) as f32 / 100.0;
        now.steady = dice(100) as f32 / 100.0;
        now.stamp.turn_degrees = dice(180) as f32;
        now.path.average = dice(64) as u8;
        set[i] = Some(now);
        world.step(tick, &[], &[Command::Brush(now)]);
        if tick % 20 == 0 {
            let saved = world.save().expect("at rest");
            let again = World::restore(
                vec![clay(&plain)],
                saved,
                Workers::new(1),
                WorldOptions {
                    dab_budget: 1 << 20,
                    undo_bytes: 1 << 30,
                    hands: HandSettings::default(),
                },
            );
            world = again.expect("its own bytes");
        }
    }
    for (i, set) in set.iter().enumerate() {
        if let Some(set) = set {
            assert_eq!(take(&world, i), *set, "{} at the end", set.kind);
        }
    }
    // Taken while it is in hand already, one's own brush is as its file has it.
    let bark = &own[0];
    let now = BrushSettings { strength: 0.125, ..bark.settings };
    world.step(101, &[], &[Command::Brush(now)]);
    assert_eq!(presets.taken(world.brush(), world.kept_brushes(), bark), bark.settings);
}

#[test]
fn a_session_that_is_opened_again_has_no_desktop() {
    use crate::desktop_layout::{DesktopLayout, PenPlace};
    let plain = shapes::icosphere(1.0, 4);
    let mut world = world(&plain);
    let id = sculptd_devices::DeviceId(3);
    let mut layout = DesktopLayout { away: true, ..DesktopLayout::default() };
    layout.tablets[0] = Some((id, PenPlace::Unknown));
    world.step(1, &[], &[Command::DesktopLayout(layout)]);
    assert_eq!(world.desktop, layout);
    world.step(2, &[], &[Command::Reopened]);
    assert_eq!(world.desktop, DesktopLayout::default());
}

#[test]
fn what_is_seen_in_a_region_is_masked_as_one_step() {
    use crate::mask_region::MaskRegion;
    use crate::view_region::ViewRegion;
    use glam::Vec2;
    let plain = shapes::icosphere(1.0, 8);
    let mut world = world(&plain);
    let masked = |world: &mut World, front_faces: bool| {
        let region = ViewRegion::Box([Vec2::ZERO, Vec2::new(0.5, 1.0)]);
        let region = MaskRegion { region, mask: 1.0, front_faces };
        let tick = world.tick() + 1;
        world.step(tick, &[], &[Command::MaskRegion(region)]);
        let masks = world.snapshot().masks().expect("some are protected");
        let points = world.mesh().to_tri().positions;
        let camera = *world.camera();
        for (p, mask) in points.iter().zip(&masks) {
            let left = camera.project(*p).expect("before the eye").x <= 0.5;
            // A vertex of a ball faces the eye if the eye lies beyond its tangent plane.
            let seen = !front_faces || (camera.eye() - *p).dot(*p) > 0.0;
            if (camera.eye() - *p).normalize().dot(*p).abs() > 0.05 {
                assert_eq!(*mask, f32::from(u8::from(left && seen)), "{p}");
            }
        }
        world.step(tick + 1, &[], &[Command::Undo]);
        assert_eq!(world.snapshot().masks(), None, "one step takes it back");
        masks.iter().filter(|m| **m > 0.0).count()
    };
    let (through, front) = (masked(&mut world, false), masked(&mut world, true));
    assert!(front > 0 && front < through, "{front} of {through} face the eye");
}

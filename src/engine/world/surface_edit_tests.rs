//! Edits of a whole mask and of face sets that take several ticks.

use std::sync::Arc;

use glam::Vec2;

use super::World;
use super::scene_tests::{tell, world};
use crate::answer::Answer;
use crate::command::{Command, NewClay};
use crate::mask_region::MaskRegion;
use crate::scene::{ObjectId, SceneCommand, SceneError};
use crate::view_region::{SetsRegion, ViewRegion};
use sculptd_clay::brush::MaskAction;
use sculptd_clay::face_sets::{PartEdit, SetsEdit, SetsError};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_geometry::shapes;

/// A ball so large that every edit takes several ticks.
fn large(workers: usize) -> World {
    let mut world = world(workers, u64::MAX);
    let ball = Arc::new(shapes::icosphere(1.0, 150));
    tell(&mut world, Command::Replace(NewClay::new(ball, false)));
    world
}

fn circle() -> ViewRegion {
    let corner = |i: usize| Vec2::splat(0.5) + 0.12 * Vec2::from_angle(i as f32 / 10.0);
    ViewRegion::Polygon(Arc::new((0..62).map(corner).collect()))
}

fn sets(edit: SetsEdit) -> Command {
    Command::Scene(SceneCommand::Sets(edit))
}

fn part(edit: PartEdit) -> Command {
    let asked = SetsRegion { region: circle(), edit, front_faces: true };
    Command::Scene(SceneCommand::SetsRegion(asked))
}

fn edits() -> Vec<Command> {
    let masked = |mask| MaskRegion { region: circle(), mask, front_faces: false };
    let mut all = vec![Command::MaskRegion(masked(0.75)), sets(SetsEdit::FromMask)];
    // Edits that read neighbours, across the borders of portions.
    all.extend(
        [MaskAction::Blur, MaskAction::Grow, MaskAction::Sharpen, MaskAction::Shrink]
            .map(Command::Mask),
    );
    all.extend([MaskAction::Cavity(-0.2), MaskAction::Invert].map(Command::Mask));
    all.extend([part(PartEdit::NewSet), sets(SetsEdit::Hide(1)), part(PartEdit::Hide)]);
    all.extend([SetsEdit::Invert, SetsEdit::ShowAll, SetsEdit::Isolate(2)].map(sets));
    all.extend([SetsEdit::Show(1), SetsEdit::FromVisible, SetsEdit::Clear].map(sets));
    all
}

/// Does a command, and what follows of it in ticks of their own; how many there were.
pub(super) fn settle(world: &mut World, command: Command) -> usize {
    let mut commands = vec![command];
    for ticks in 1.. {
        let tick = world.tick() + 1;
        world.step(tick, &[], &commands);
        commands.clear();
        assert_eq!(world.is_in_surface_edit(), world.report().paused);
        if !world.report().paused {
            assert!(world.is_at_rest());
            return ticks;
        }
        assert!(world.save().is_none(), "it is under way");
    }
    0
}

#[test]
fn in_portions_comes_what_comes_at_once() {
    let (mut portions, mut at_once) = (large(1), large(1));
    let start = portions.hash();
    let mut hashes = Vec::new();
    for (steps, edit) in (portions.undo_steps()..).zip(edits()) {
        let ticks = settle(&mut portions, edit.clone());
        assert!(ticks > 2, "{edit:?}: {ticks}");
        let tick = at_once.tick() + 1;
        at_once.step(tick, &[], &[edit.clone(), Command::LiftAll]);
        assert_eq!(portions.hash(), at_once.hash(), "{edit:?}");
        portions.verify_invariants().expect("sound");
        assert_eq!(portions.undo_steps(), steps + 1, "{edit:?}: one step");
        hashes.push(portions.hash());
    }
    for hash in hashes.iter().rev() {
        assert_eq!(portions.hash(), *hash);
        tell(&mut portions, Command::Undo);
    }
    assert_eq!(portions.hash(), start);
    for hash in &hashes {
        tell(&mut portions, Command::Redo);
        assert_eq!(portions.hash(), *hash);
    }
}

#[test]
fn portions_are_the_same_bits_with_any_number_of_workers() {
    let run = |workers| {
        let mut world = large(workers);
        let mut hashes = Vec::new();
        for edit in edits().into_iter().take(9) {
            let tick = world.tick() + 1;
            world.step(tick, &[], &[edit]);
            hashes.push(world.hash());
            while world.report().paused {
                let tick = world.tick() + 1;
                world.step(tick, &[], &[]);
                world.verify_invariants().expect("sound, half way too");
                hashes.push(world.hash());
            }
        }
        hashes
    };
    let one = run(1);
    for workers in [2, 3, 7, 16] {
        assert_eq!(run(workers), one, "{workers} workers");
    }
}

#[test]
fn a_result_that_comes_late_is_told_and_a_refusal_changes_nothing() {
    let mut world = large(1);
    let edit = |world: &mut World, command: Command| {
        let tick = world.tick() + 1;
        // A command that is refused at once has its answer before it.
        let locked = SceneCommand::Activate(ObjectId(99));
        world.step(tick, &[], &[Command::Scene(locked), command]);
        let none = Err(SceneError::NoObject(ObjectId(99)));
        assert_eq!(world.answers(), [none, Ok(Answer::UnderWay)]);
        assert_eq!(world.late_answer(), None);
        for _ in 0..1000 {
            let tick = world.tick() + 1;
            world.step(tick, &[], &[]);
            if let Some(late) = world.late_answer() {
                return late;
            }
        }
        panic!("no result");
    };
    let nothing = Err(SceneError::Sets(SetsError::Nothing));
    let start = (world.hash(), world.undo_steps());
    for refused in [SetsEdit::FromMask, SetsEdit::ShowAll, SetsEdit::Clear] {
        assert_eq!(edit(&mut world, sets(refused)), nothing);
    }
    for refused in [SetsEdit::Hide(3), SetsEdit::Show(3), SetsEdit::Isolate(3)] {
        let none = Err(SceneError::Sets(SetsError::NoSet(3)));
        assert_eq!(edit(&mut world, sets(refused)), none);
    }
    let many = (0..world.mesh().page_count() as u32)
        .map(|p| (p, vec![if p == 0 { 1 } else { 0x8001 }; world.mesh().page(p).own()]));
    let pages = Arc::new(many.collect());
    let revision = world.mesh().revision();
    let assign = SetsEdit::Assign { revision, pages };
    let tick = world.tick() + 1;
    world.step(tick, &[], &[sets(assign)]);
    assert_eq!(world.answers(), [Err(SceneError::Sets(SetsError::Full))]);
    assert_eq!((world.hash(), world.undo_steps()), start);
    assert_eq!(edit(&mut world, part(PartEdit::NewSet)), Ok(Answer::Object(ObjectId(1))));
    assert_eq!(edit(&mut world, sets(SetsEdit::Isolate(1))), Ok(Answer::Object(ObjectId(1))));
    // Another command finishes it, and both answers are at their indices.
    let tick = world.tick() + 1;
    world.step(tick, &[], &[sets(SetsEdit::ShowAll), sets(SetsEdit::FromVisible)]);
    assert_eq!(world.answers(), [Ok(Answer::Object(ObjectId(0))), Ok(Answer::UnderWay)]);
    tell(&mut world, Command::LiftAll);
    assert_eq!(world.late_answer(), Some(Ok(Answer::Object(ObjectId(2)))));
}

#[test]
fn a_stroke_waits_until_the_last_page_has_followed() {
    let mut world = large(2);
    let steps = world.undo_steps();
    let mut commands = vec![Command::Mask(MaskAction::Cavity(-1e9))];
    let (mut waited, mut dabs) = (0, 0);
    for i in 0..40u32 {
        let area_mm = Vec2::new(world.camera().aspect, 1.0) * 100.0;
        let pen = Pen {
            in_range: true,
            tip: i < 30,
            pos_mm: Vec2::new(0.45 + 0.002 * i as f32, 0.5) * area_mm,
            area_mm,
            pressure: Some(0.8),
            ..Pen::default()
        };
        let tick = world.tick() + 1;
        let body = Body::Pen(pen);
        let t_us = tick * 8000;
        let sample = Sample { device: DeviceId(1), t_us, device_t_us: None, body };
        let report = *world.step(tick, &[sample], &commands);
        commands.clear();
        dabs += report.dabs;
        if world.is_in_surface_edit() {
            assert_eq!((report.dabs, report.paused), (0, true));
            waited += 1;
        }
    }
    assert!(waited > 1 && dabs > 0, "{waited}, {dabs}");
    let ball = shapes::icosphere(1.0, 150).positions;
    assert_eq!(world.mesh().to_tri().positions, ball, "all was protected before it began");
    assert_eq!(world.undo_steps(), steps + 1);
    world.verify_invariants().expect("sound");
}

//! Layers in the world: what a tick may take, what undo brings back, what a saved state holds.

use std::sync::Arc;

use glam::Vec2;

use super::scene_tests::{Dice, ask, stroke, tell, world};
use super::{World, WorldOptions};
use crate::command::{Command, NewClay};
use crate::hand::HandSettings;
use crate::scene::{ObjectId, SceneCommand, SceneError};
use sculptd_clay::brush::{BrushKind, BrushSettings};
use sculptd_clay::layers::LayerOffsets;
use sculptd_clay::{Clay, LayerEdit, LayerError, LayerId, Workers};
use sculptd_geometry::shapes;

pub(super) fn edit(world: &mut World, edit: LayerEdit) -> Result<LayerId, SceneError> {
    ask(world, SceneCommand::Layers(edit)).map(|id| LayerId(id.0))
}

fn set(id: LayerId, intensity: f32, visible: bool, live: bool) -> LayerEdit {
    LayerEdit::Set { id, intensity: Some(intensity), visible: Some(visible), live }
}

/// A random edit of the layers of the active object.
pub(super) fn edit_at_random(world: &mut World, dice: &mut Dice) {
    let count = world.mesh().layers().map_or(0, |s| s.next);
    let id = LayerId(dice.roll(count as usize + 1) as u32);
    let few = world.mesh().layer_count() < 6;
    let asked = match dice.roll(14) {
        0..=3 if few => LayerEdit::Add(format!("layer {}", dice.roll(99))),
        4 => LayerEdit::Remove(id),
        5 => LayerEdit::Move(id, dice.roll(4) as u32),
        6 => LayerEdit::MergeDown(id),
        7 if few => LayerEdit::Duplicate(id),
        8 => LayerEdit::Clear(id),
        9 => LayerEdit::Bake,
        10 => LayerEdit::Activate((dice.roll(3) > 0).then_some(id)),
        11 => LayerEdit::Rename(id, format!("name {}", dice.roll(99))),
        _ => {
            let intensity = (dice.share() * 4.0 - 2.0) as f32;
            set(id, intensity, dice.roll(4) > 0, dice.roll(3) == 0)
        }
    };
    let _ = edit(world, asked);
}

fn places(world: &World) -> Vec<[u32; 3]> {
    world.mesh().to_tri().positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

fn settle(world: &mut World) -> u32 {
    let mut ticks = 0;
    while world.report().paused {
        let tick = world.tick() + 1;
        world.step(tick, &[], &[]);
        ticks += 1;
    }
    ticks
}

fn large_world(workers: usize) -> World {
    let options =
        WorldOptions { dab_budget: 1 << 20, undo_bytes: u64::MAX, hands: HandSettings::default() };
    let brush = BrushSettings { radius: 0.3, ..BrushSettings::default() };
    let ball = shapes::icosphere(1.0, 110);
    let ball = Clay::build(&ball, &Default::default()).expect("a form");
    World::new(ball, Default::default(), brush, Workers::new(workers), options)
}

/// Offsets for every vertex of the active object.
fn everywhere(world: &World) -> LayerEdit {
    let count = world.mesh().vertex_count() as u32;
    let offsets = (0..count).map(|v| (v, [0.01, 0.0, (v % 7) as f32 * 1e-3])).collect();
    let layer = LayerOffsets { name: "all".into(), intensity: 1.0, visible: true, offsets };
    LayerEdit::Import(Arc::new(vec![layer]))
}

#[test]
fn a_stroke_goes_to_the_active_layer_and_what_it_did_can_be_weakened_and_taken_back() {
    let mut w = world(1, u64::MAX);
    let (from, to) = (Vec2::new(0.4, 0.45), Vec2::new(0.6, 0.55));
    let start = (places(&w), w.hash());
    let id = edit(&mut w, LayerEdit::Add("bumps".into())).expect("room");
    assert!(stroke(&mut w, from, to) > 0);
    let raised = places(&w);
    edit(&mut w, set(id, 0.0, true, false)).expect("there");
    assert!(places(&w) == start.0 && !w.mesh().takes_strokes());
    assert_eq!(stroke(&mut w, from, to), 0);
    edit(&mut w, set(id, 1.0, true, false)).expect("there");
    assert!(places(&w) == raised);
    assert_eq!(w.undo_steps(), 4);
    assert_eq!(
        edit(&mut w, LayerEdit::Remove(LayerId(7))),
        Err(SceneError::Layers(LayerError::NoLayer(LayerId(7))))
    );
    assert_eq!(edit(&mut w, LayerEdit::Rename(id, " \n".into())), Err(SceneError::Name));
    ask(&mut w, SceneCommand::Lock(ObjectId(0), true)).expect("there");
    assert_eq!(edit(&mut w, LayerEdit::Bake), Err(SceneError::Locked(ObjectId(0))));
    assert_eq!(w.undo_steps(), 5);
    for _ in 0..5 {
        tell(&mut w, Command::Undo);
        w.verify_invariants().expect("sound");
    }
    assert_eq!(w.hash(), start.1);
}

#[test]
fn a_large_layer_follows_over_several_ticks_and_a_drag_is_one_step() {
    let hashes = [1, 2, 3].map(|workers| {
        let mut w = large_world(workers);
        let all = everywhere(&w);
        let start = w.hash();
        let id = edit(&mut w, all).expect("room");
        assert!(w.report().paused && w.save().is_none());
        assert!(settle(&mut w) >= 2);
        w.verify_invariants().expect("sound");
        assert_eq!(w.undo_steps(), 1);
        let full = places(&w);
        for k in 1..=20 {
            edit(&mut w, set(id, 1.0 - k as f32 * 0.05, true, true)).expect("there");
        }
        settle(&mut w);
        // The slider is still held.
        assert!(w.undo_steps() == 1 && w.save().is_none());
        edit(&mut w, set(id, 0.5, true, false)).expect("there");
        settle(&mut w);
        w.verify_invariants().expect("sound");
        assert!(w.undo_steps() == 2 && w.save().is_some());
        let half = places(&w);
        // A drag that nobody ends is ended by whatever comes next.
        edit(&mut w, set(id, -1.5, true, true)).expect("there");
        tell(&mut w, Command::Undo);
        assert!(places(&w) == half);
        tell(&mut w, Command::Undo);
        assert!(places(&w) == full);
        tell(&mut w, Command::Undo);
        assert_eq!(w.hash(), start);
        for _ in 0..3 {
            tell(&mut w, Command::Redo);
        }
        w.verify_invariants().expect("sound");
        w.hash()
    });
    assert_eq!(hashes[0], hashes[1]);
    assert_eq!(hashes[0], hashes[2]);
}

#[test]
fn strokes_wait_until_a_large_layer_has_followed() {
    let mut w = large_world(2);
    let all = everywhere(&w);
    edit(&mut w, all).expect("room");
    assert!(stroke(&mut w, Vec2::new(0.4, 0.45), Vec2::new(0.6, 0.55)) > 0);
    settle(&mut w);
    w.verify_invariants().expect("sound");
    assert_eq!(w.undo_steps(), 2);
}

#[test]
fn the_brush_that_erases_a_layer_goes_back_to_what_is_below_it() {
    let mut w = world(1, u64::MAX);
    let (from, to) = (Vec2::new(0.4, 0.5), Vec2::new(0.6, 0.5));
    stroke(&mut w, from, to);
    let below = w.mesh().to_tri().positions;
    edit(&mut w, LayerEdit::Add("bumps".into())).expect("room");
    stroke(&mut w, from, to);
    let far = |w: &World| {
        let now = w.mesh().to_tri().positions;
        now.iter().zip(&below).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
    };
    let raised = far(&w);
    let eraser = BrushSettings {
        radius: 0.6,
        strength: 1.0,
        hardness: 0.9,
        ..BrushSettings::new(BrushKind::EraseLayer)
    };
    tell(&mut w, Command::Brush(eraser));
    for _ in 0..4 {
        assert!(stroke(&mut w, from, to) > 0);
    }
    let left = far(&w);
    assert!(raised > 0.01 && left < 0.1 * raised, "{left} of {raised}");
    w.verify_invariants().expect("sound");
    // On the base there is nothing below.
    edit(&mut w, LayerEdit::Activate(None)).expect("base");
    assert_eq!(stroke(&mut w, from, to), 0);
}

#[test]
fn other_clay_has_no_layers_and_undo_brings_them_back() {
    let mut w = world(1, u64::MAX);
    edit(&mut w, LayerEdit::Add("bumps".into())).expect("room");
    stroke(&mut w, Vec2::new(0.4, 0.45), Vec2::new(0.6, 0.55));
    let before = w.hash();
    let plain = Arc::new(shapes::icosphere(0.9, 8));
    tell(&mut w, Command::Replace(NewClay::new(plain, true)));
    assert_eq!(w.mesh().layer_count(), 0);
    tell(&mut w, Command::Undo);
    assert_eq!((w.hash(), w.mesh().layer_count()), (before, 1));
    // A duplicate has separate layers.
    ask(&mut w, SceneCommand::Duplicate(ObjectId(0))).expect("room");
    edit(&mut w, LayerEdit::Bake).expect("layers");
    assert_eq!(w.mesh().layer_count(), 0);
    ask(&mut w, SceneCommand::Activate(ObjectId(0))).expect("there");
    assert_eq!(w.mesh().layer_count(), 1);
    w.verify_invariants().expect("sound");
}

#[test]
fn edits_of_layers_are_the_same_from_their_bytes() {
    let (mut sent, mut read) = (world(1, u64::MAX), world(3, u64::MAX));
    let all = everywhere(&sent);
    let id = LayerId(1);
    for edit in [
        LayerEdit::Add("a".into()),
        all,
        set(id, -0.3, true, false),
        LayerEdit::Duplicate(id),
        LayerEdit::Move(id, 0),
        LayerEdit::Clear(LayerId(0)),
        LayerEdit::MergeDown(LayerId(0)),
    ] {
        let command = Command::Scene(SceneCommand::Layers(edit));
        let bytes = postcard::to_stdvec(&command).expect("plain data");
        tell(&mut sent, command);
        tell(&mut read, postcard::from_bytes(&bytes).expect("plain data"));
        assert_eq!(sent.hash(), read.hash());
        assert_eq!(sent.answers(), read.answers());
    }
    assert!(sent.mesh().layer_count() == 2 && sent.answers()[0].is_ok());
}

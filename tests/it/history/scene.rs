//! A scene of several objects in the session file: every step comes back by undo, in memory and out
//! of the file, by a restart and by a replay from the start.

use glam::{DQuat, DVec3, Vec2};

use super::{Studio, both_ways};
use sculptd_daemon::session::history::listing;
use sculptd_engine::command::Command;
use sculptd_engine::scene::{
    NewObject, ObjectId, ObjectSource, ObjectTransform, Primitive, PrimitiveShape, SceneCommand,
};

fn primitive(shape: PrimitiveShape, edge: f64) -> SceneCommand {
    let source = ObjectSource::Primitive(Primitive { shape, edge });
    SceneCommand::Add(NewObject::new(shape.name(), source, ObjectTransform::NONE))
}

fn turned(x: f64) -> ObjectTransform {
    let turn = DQuat::from_rotation_y(0.4);
    ObjectTransform { shift: DVec3::new(x, 0.1, 0.2), turn, scale: 0.9 }
}

/// Everything that can be done to a scene, with strokes between; the hash after each step.
fn work(s: &mut Studio) -> Vec<u64> {
    let mut hashes = vec![s.world.hash()];
    let stroke = |s: &mut Studio, at: Vec2| {
        let before = s.world.hash();
        assert_ne!(s.stroke(at), before, "the stroke met the object");
    };
    let ask = |s: &mut Studio, hashes: &mut Vec<u64>, command: SceneCommand| {
        s.tick(&[], &[Command::Scene(command)]);
        assert!(s.world.answers()[0].is_ok(), "{:?}", s.world.answers());
        hashes.push(s.world.hash());
    };
    ask(s, &mut hashes, primitive(PrimitiveShape::Ball(0.8), 0.08));
    let ball = s.world.scene().active().id;
    ask(s, &mut hashes, SceneCommand::Transform(ball, turned(0.3)));
    stroke(s, Vec2::new(0.02, 0.02));
    hashes.push(s.world.hash());
    ask(s, &mut hashes, SceneCommand::Activate(ObjectId(0)));
    stroke(s, Vec2::new(-0.05, 0.05));
    hashes.push(s.world.hash());
    ask(s, &mut hashes, SceneCommand::Duplicate(ball));
    let twin = s.world.scene().active().id;
    stroke(s, Vec2::new(0.0, -0.02));
    hashes.push(s.world.hash());
    ask(s, &mut hashes, SceneCommand::Rename(twin, "twin".into()));
    ask(s, &mut hashes, SceneCommand::Show(ObjectId(0), false));
    ask(s, &mut hashes, SceneCommand::Lock(ball, true));
    ask(s, &mut hashes, SceneCommand::Remove(twin));
    // The removed one was active: the ball is now, its neighbour.
    assert_eq!(s.world.scene().active().id, ball);
    ask(s, &mut hashes, SceneCommand::Activate(ObjectId(0)));
    hashes
}

fn back_and_forth(s: &mut Studio, hashes: &[u64]) {
    for hash in hashes.iter().rev().skip(1) {
        s.tick(&[], &[Command::Undo]);
        s.becomes(*hash);
    }
    for hash in &hashes[1..] {
        s.tick(&[], &[Command::Redo]);
        s.becomes(*hash);
    }
}

#[test]
fn every_step_over_several_objects_comes_back_from_memory_and_from_the_file() {
    // All of it in memory; nothing in memory.
    for undo_bytes in [1 << 30, 1] {
        let dir = tempfile::tempdir().expect("a folder");
        let mut s = Studio::begin(dir.path(), 3000, undo_bytes);
        let hashes = work(&mut s);
        let newest = hashes[hashes.len() - 1];
        s.settle();
        let nodes = s.history.tree().len();
        assert_eq!(nodes, hashes.len(), "a node for each step, and the start");
        back_and_forth(&mut s, &hashes);
        assert_eq!(s.history.tree().len(), nodes, "going back makes no node");
        let path = s.end();
        assert_eq!(both_ways(&path), (newest, newest), "undo of {undo_bytes} bytes");
        // After a restart all undo is in the file.
        let mut s = Studio::reopened(&path);
        assert_eq!(s.world.hash(), newest);
        back_and_forth(&mut s, &hashes);
        assert_eq!(s.history.tree().len(), nodes);
        let path = s.end();
        assert_eq!(both_ways(&path), (newest, newest), "again");
        let names: Vec<String> = listing::read(&path)
            .expect("reads")
            .places
            .iter()
            .map(|p| serde_json::to_string(&p.deed).expect("JSON"))
            .collect();
        for name in ["add", "transform", "activate", "duplicate", "rename", "show", "lock"] {
            assert!(names.contains(&format!("{{\"scene\":\"{name}\"}}")), "{name}: {names:?}");
        }
    }
}

#[test]
fn a_work_of_one_object_that_is_not_the_first_stands_where_it_was_when_it_is_opened_again() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1 << 30);
    let asked = [
        SceneCommand::Duplicate(ObjectId(0)),
        SceneCommand::Rename(ObjectId(1), "object".into()),
        SceneCommand::Remove(ObjectId(0)),
    ];
    let mut before = 0;
    for command in asked {
        before = s.world.hash();
        s.tick(&[], &[Command::Scene(command)]);
        assert!(s.world.answers()[0].is_ok(), "{:?}", s.world.answers());
    }
    assert!(s.world.scene_view().is_plain(), "but for its number it is as a session begins");
    s.settle();
    let (nodes, here) = (s.history.tree().len(), s.history.tree().cursor);
    let path = s.end();
    let mut s = Studio::reopened(&path);
    assert_eq!((s.history.tree().len(), s.history.tree().cursor), (nodes, here));
    // The first undo takes the last step back.
    s.tick(&[], &[Command::Undo]);
    s.becomes(before);
}

#[test]
fn a_bounded_history_keeps_what_opening_a_scene_needs() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::bounded(dir.path(), 3000, 1 << 30, 1 << 20);
    let hashes = work(&mut s);
    let mut newest = hashes[hashes.len() - 1];
    for k in 0..20 {
        if k == 0 {
            let show = SceneCommand::Show(ObjectId(0), true);
            s.tick(&[], &[Command::Scene(show)]);
        }
        newest = s.stroke(Vec2::new(-0.04 + 0.004 * k as f32, 0.0));
        s.settle();
    }
    let path = s.end();
    let kept = listing::read(&path).expect("reads");
    assert!(kept.dropped > 0, "{kept:?}");
    assert_eq!(both_ways(&path), (newest, newest));
    let mut s = Studio::reopened(&path);
    assert_eq!(s.world.hash(), newest);
    s.tick(&[], &[Command::Undo]);
    s.tick(&[], &[]);
    s.settle();
    s.world.verify_invariants().expect("sound");
    let path = s.end();
    both_ways(&path);
}

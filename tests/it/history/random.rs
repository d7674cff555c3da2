//! Random sequences of everything that can be done to a scene: whatever was done, the live
//! sculpture, the reopened one, the one replayed from the start and the one opened from a copy
//! have one hash.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec2};

use super::{Studio, both_ways};
use crate::seeded::Random;
use sculptd_clay::brush::{BrushKind, MaskAction, Measure};
use sculptd_clay::face_sets::SetsEdit;
use sculptd_clay::{LayerEdit, LayerId, Workers};
use sculptd_daemon::session::history::{Want, listing};
use sculptd_daemon::session::{self, reopen, replay};
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::scene::{
    NewObject, ObjectId, ObjectSource, ObjectTransform, Primitive, PrimitiveShape, SceneCommand,
};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

/// Returns a random place near the middle of the view.
fn place(r: &mut Random) -> Vec2 {
    Vec2::new(r.part() as f32 - 0.5, r.part() as f32 - 0.5) * 0.3
}

fn object(r: &mut Random, s: &Studio) -> ObjectId {
    let objects = s.world.scene().objects();
    objects[r.below(objects.len() as u64) as usize].id
}

fn layer(r: &mut Random, s: &Studio) -> LayerId {
    let layers = s.world.mesh().layers().map_or(&[][..], |l| &l.layers);
    match layers.len() as u64 {
        0 => LayerId(0),
        n => layers[r.below(n) as usize].id,
    }
}

fn layer_edit(r: &mut Random, s: &Studio) -> LayerEdit {
    let id = layer(r, s);
    match r.below(12) {
        0..3 => LayerEdit::Add(format!("layer {}", r.below(100))),
        3 => LayerEdit::Remove(id),
        4 => LayerEdit::Move(id, r.below(3) as u32),
        5 | 6 => LayerEdit::Set {
            id,
            intensity: Some(r.part() as f32 * 2.0),
            visible: None,
            live: r.below(2) == 0,
        },
        7 => LayerEdit::Set { id, intensity: None, visible: Some(r.below(2) == 0), live: false },
        8 => LayerEdit::Activate((r.below(2) == 0).then_some(id)),
        9 => LayerEdit::MergeDown(id),
        10 => LayerEdit::Duplicate(id),
        _ => match r.below(2) {
            0 => LayerEdit::Clear(id),
            _ => LayerEdit::Bake,
        },
    }
}

fn sets_edit(r: &mut Random) -> SetsEdit {
    match r.below(8) {
        0 => SetsEdit::FromMask,
        1 => SetsEdit::FromVisible,
        2 => SetsEdit::Clear,
        3 => SetsEdit::Hide(1),
        4 => SetsEdit::HideMasked,
        5 => SetsEdit::Invert,
        6 => SetsEdit::Isolate(1),
        _ => SetsEdit::ShowAll,
    }
}

fn mask_action(r: &mut Random) -> MaskAction {
    match r.below(8) {
        0 => MaskAction::Clear,
        1 => MaskAction::Fill,
        2 => MaskAction::Invert,
        3 => MaskAction::Blur,
        4 => MaskAction::Sharpen,
        5 => MaskAction::Grow,
        6 => MaskAction::Shrink,
        _ => MaskAction::Cavity(r.part() as f32 * 0.05),
    }
}

fn scene_command(r: &mut Random, s: &Studio) -> SceneCommand {
    let id = object(r, s);
    match r.below(14) {
        0 | 1 => {
            let shape = PrimitiveShape::Ball(0.5);
            let source = ObjectSource::Primitive(Primitive { shape, edge: 0.1 });
            SceneCommand::Add(NewObject::new("ball", source, ObjectTransform::NONE))
        }
        2 => SceneCommand::Remove(id),
        3 => SceneCommand::Duplicate(id),
        4 => SceneCommand::Rename(id, format!("object {}", r.below(100))),
        5 | 6 => {
            let shift = DVec3::new(r.part(), r.part(), 0.0) * 0.2;
            let transform = ObjectTransform { shift, ..ObjectTransform::NONE };
            match r.below(2) {
                0 => SceneCommand::Transform(id, transform),
                _ => SceneCommand::Drag(id, transform),
            }
        }
        7..10 => SceneCommand::Activate(id),
        10 => SceneCommand::Show(id, r.below(2) == 0),
        11 => SceneCommand::Lock(id, r.below(4) == 0),
        12 => SceneCommand::Move(id, r.below(4) as u32),
        _ => SceneCommand::Group(vec![id], "group".into()),
    }
}

/// Does one random thing, then lets everything that was begun come to its end.
fn act(r: &mut Random, s: &mut Studio) {
    match r.below(24) {
        0..8 => {
            let at = place(r);
            s.stroke(at);
        }
        8..12 => {
            let edit = layer_edit(r, s);
            s.tick(&[], &[Command::Scene(SceneCommand::Layers(edit))]);
        }
        12 => s.tick(&[], &[Command::Scene(SceneCommand::Sets(sets_edit(r)))]),
        13 => s.tick(&[], &[Command::Mask(mask_action(r))]),
        14..17 => {
            let command = scene_command(r, s);
            s.tick(&[], &[Command::Scene(command)]);
        }
        17..19 => s.tick(&[], &[Command::Undo]),
        19 => s.tick(&[], &[Command::Redo]),
        20 => {
            let mut brush = *s.world.brush();
            brush.kind = BrushKind::ALL[r.below(BrushKind::ALL.len() as u64) as usize];
            brush.topology.by = if r.below(3) == 0 { Measure::Brush } else { Measure::Off };
            brush.topology.edge = 0.15;
            s.tick(&[], &[Command::Brush(brush)]);
        }
        21 => {
            let mesh = Arc::new(shapes::sphere_of_about(600 + 100 * r.below(4) as usize));
            s.tick(&[], &[Command::Replace(NewClay::new(mesh, r.below(2) == 0))]);
        }
        22 => {
            s.settle();
            let places = listing::places(&s.history.tree());
            let to = places[r.below(places.len() as u64) as usize].node;
            s.history.want(Want::Node(to));
            s.settle();
            s.tick(&[], &[]);
        }
        _ => {
            // Two things in one tick.
            let edit = layer_edit(r, s);
            let command = scene_command(r, s);
            s.tick(&[], &[Command::Scene(SceneCommand::Layers(edit)), Command::Scene(command)]);
        }
    }
    for _ in 0..3 {
        s.tick(&[], &[]);
    }
    while s.world.report().paused {
        s.tick(&[], &[]);
    }
}

/// The files of a session as they are now, copied elsewhere while it is written.
fn copied(path: &Path, to: &Path) -> std::path::PathBuf {
    let target = to.join("copy.sculpt");
    for ending in ["", "-wal"] {
        let file = |p: &Path| {
            let mut name = p.as_os_str().to_owned();
            name.push(ending);
            std::path::PathBuf::from(name)
        };
        let _ = std::fs::copy(file(path), file(&target));
    }
    target
}

/// Returns how many of three openings a checkpoint served.
fn sequence(seed: u64, steps: u64) -> usize {
    println!("seed {seed}");
    let mut quickly = 0;
    let mut r = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let dir = tempfile::tempdir().expect("a folder");
    let undo_bytes = [1, 1 << 16, 1 << 30][r.below(3) as usize];
    let mut s = Studio::begin(dir.path(), 1200, undo_bytes);
    for _ in 0..3 {
        for _ in 0..steps {
            act(&mut r, &mut s);
        }
        if r.below(2) == 0 {
            s.settle();
            let elsewhere = tempfile::tempdir().expect("a folder");
            let copy = copied(&s.path, elsewhere.path());
            let opened = session::open(&copy).expect("a copy opens");
            let workers = Workers::new(1);
            let whole = replay::replay(&opened, None, workers, &Job::default()).expect("replays");
            if let Some(quick) = reopen(&copy, &opened, None, 1, &Job::default()) {
                let both = (quick.replayed.world.hash(), quick.replayed.ticks);
                assert_eq!(both, (whole.world.hash(), whole.ticks), "seed {seed}: a copy");
            }
        }
        let live = s.world.hash();
        let path = s.end();
        let opened = session::open(&path).expect("opens");
        assert_eq!(opened.loss, None, "seed {seed}");
        let whole =
            replay::replay(&opened, None, Workers::new(2), &Job::default()).expect("replays");
        assert_eq!((whole.world.hash(), whole.jumps_missed), (live, 0), "seed {seed}: replayed");
        // If undo went back beyond every checkpoint, the file opens by replaying.
        if let Some(quick) = reopen(&path, &opened, None, 1, &Job::default()) {
            assert_eq!(quick.replayed.world.hash(), live, "seed {seed}: reopened");
            quickly += 1;
        }
        s = Studio::reopened(&path);
        assert_eq!(s.world.hash(), live, "seed {seed}: a restart");
    }
    s.end();
    quickly
}

#[test]
fn a_layer_added_after_strokes_loses_none_of_them() {
    for edits in [
        vec![],
        vec![Command::Undo],
        vec![Command::Scene(SceneCommand::Layers(LayerEdit::Bake))],
        vec![Command::Scene(SceneCommand::Layers(LayerEdit::Remove(LayerId(1))))],
    ] {
        let dir = tempfile::tempdir().expect("a folder");
        let mut s = Studio::begin(dir.path(), 3000, 1 << 30);
        let stroke = s.stroke(Vec2::ZERO);
        s.tick(&[], &[Command::Scene(SceneCommand::Layers(LayerEdit::Add("detail".into())))]);
        s.tick(&[], &edits);
        s.tick(&[], &[]);
        let live = s.world.hash();
        s.settle();
        let path = s.end();
        assert_eq!(both_ways(&path), (live, live), "after {edits:?}");
        let mut s = Studio::reopened(&path);
        s.tick(&[], &[Command::Undo]);
        if edits.is_empty() {
            s.becomes(stroke);
        }
        s.end();
    }
}

#[test]
fn a_checkpoint_that_gives_another_sculpture_is_not_opened() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1 << 30);
    s.stroke(Vec2::ZERO);
    s.settle();
    s.stroke(Vec2::new(0.05, 0.0));
    let live = s.world.hash();
    s.settle();
    let path = s.end();
    let opened = session::open(&path).expect("opens");
    let newest = reopen(&path, &opened, None, 1, &Job::default()).expect("a checkpoint");
    let spoil = |what: &str| {
        let db = rusqlite::Connection::open(&path).expect("a database");
        db.execute_batch(&format!("UPDATE proof SET hash = hash + 1 {what}")).expect("spoilt");
    };
    spoil("WHERE checkpoint = (SELECT max(checkpoint) FROM proof)");
    let older = reopen(&path, &opened, None, 1, &Job::default()).expect("an older checkpoint");
    assert_eq!(older.replayed.world.hash(), live);
    assert!(older.checkpoint < newest.checkpoint, "{} {}", older.checkpoint, newest.checkpoint);
    spoil("WHERE checkpoint < (SELECT max(checkpoint) FROM proof)");
    assert!(reopen(&path, &opened, None, 1, &Job::default()).is_none(), "no proof holds");
    // The input is whole: the session opens by replaying it.
    let s = Studio::reopened(&path);
    assert_eq!(s.world.hash(), live);
    s.end();
}

#[test]
fn random_sequences_of_commands_reopen_and_replay_to_the_live_hash() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let first = std::env::var("SCULPTD_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(0);
    let seeds = if long { 2000 } else { 24 };
    let quickly: usize = (first..first + seeds).map(|seed| sequence(seed, 8)).sum();
    assert!(quickly as u64 > 2 * seeds, "checkpoints served {quickly} of {} openings", 3 * seeds);
}

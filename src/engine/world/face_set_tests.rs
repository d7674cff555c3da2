//! Face sets that a stroke draws and that a region of the view makes or hides.

use std::sync::Arc;

use glam::Vec2;

use super::World;
use super::scene_tests::{ask, stroke, tell, world};
use crate::command::{Command, NewClay};
use crate::mask_region::MaskRegion;
use crate::scene::{ObjectId, SceneCommand, SceneError};
use crate::view_region::{SetsRegion, ViewRegion};
use sculptd_clay::brush::{BrushKind, BrushSettings, Falloff, MaskAction, Method, draw_face_sets};
use sculptd_clay::face_sets::{PartEdit, SetsEdit, SetsError};
use sculptd_geometry::shapes;

/// A ball of many pages, and the brush that draws face sets.
fn drawing(workers: usize) -> (World, BrushSettings) {
    let mut world = world(workers, u64::MAX);
    let ball = Arc::new(shapes::icosphere(1.0, 60));
    tell(&mut world, Command::Replace(NewClay::new(ball, false)));
    let brush = BrushSettings {
        radius: 0.15,
        strength: 1.0,
        falloff: Falloff::Constant,
        ..BrushSettings::new(BrushKind::DrawFaceSets)
    };
    tell(&mut world, Command::Brush(brush));
    (world, brush)
}

/// Each set and its vertices; what is in none has number 0.
fn sets(world: &World) -> Vec<(u16, u64)> {
    let mut copy = world.mesh().duplicate(0);
    copy.snapshot().face_sets().iter().map(|s| (s.0, s.1)).collect()
}

fn numbers(world: &World) -> Vec<u16> {
    sets(world).iter().map(|s| s.0).collect()
}

const LEFT: Vec2 = Vec2::new(0.42, 0.5);
const RIGHT: Vec2 = Vec2::new(0.58, 0.5);
const LOW: Vec2 = Vec2::new(0.5, 0.62);

#[test]
fn a_stroke_begins_a_face_set_or_goes_on_with_that_under_it() {
    let (mut world, brush) = drawing(1);
    let start = world.hash();
    let positions = world.mesh().to_tri().positions;
    let moved = stroke(&mut world, LEFT, RIGHT);
    let first = sets(&world);
    assert_eq!(numbers(&world), [0, 1]);
    assert!(first[1].1 > 100 && moved >= first[1].1, "{first:?}, {moved}");
    world.verify_invariants().expect("sound");
    // The next one begins another, which takes from the first what it passes over.
    stroke(&mut world, LOW, RIGHT);
    let second = sets(&world);
    assert_eq!(numbers(&world), [0, 1, 2]);
    assert!(second[1].1 < first[1].1, "{second:?}");
    // The other way round: from the first set into what is in none, and from none over the second.
    tell(&mut world, Command::Brush(BrushSettings { negative: true, ..brush }));
    stroke(&mut world, LEFT, Vec2::new(0.42, 0.38));
    assert_eq!(numbers(&world), [0, 1, 2]);
    let third = sets(&world);
    assert!(third[1].1 > second[1].1 && third[2] == second[2], "{third:?}");
    stroke(&mut world, Vec2::new(0.45, 0.7), LOW);
    let fourth = sets(&world);
    assert!(fourth[0].1 > third[0].1 && fourth[2].1 < third[2].1, "{fourth:?}");
    // By its number.
    let mut named = brush;
    named.extra[draw_face_sets::SET] = 7.0;
    tell(&mut world, Command::Brush(named));
    stroke(&mut world, LEFT, LOW);
    assert_eq!(numbers(&world).last(), Some(&7));
    world.verify_invariants().expect("sound");
    assert_eq!(world.mesh().to_tri().positions, positions, "nothing moves");
    let end = world.hash();
    for _ in 0..5 {
        tell(&mut world, Command::Undo);
    }
    assert_eq!(world.hash(), start, "a step each, undone to the first bit");
    for _ in 0..5 {
        tell(&mut world, Command::Redo);
    }
    assert_eq!(world.hash(), end);
}

#[test]
fn drawn_sets_are_the_same_bits_with_any_number_of_workers() {
    let run = |workers| {
        let (mut world, brush) = drawing(workers);
        let mut hashes = Vec::new();
        for (symmetry, method) in [
            ([false; 3], Method::Space),
            ([true, true, false], Method::Space),
            ([true, false, false], Method::Anchored),
            ([false; 3], Method::DragDot),
        ] {
            let mut brush = BrushSettings { radius: 0.4, symmetry, ..brush };
            brush.path.method = method;
            tell(&mut world, Command::Brush(brush));
            let before = numbers(&world).last().copied();
            stroke(&mut world, Vec2::new(0.4, 0.45), RIGHT);
            // All images draw one set.
            assert_eq!(numbers(&world).last().copied(), before.map(|n| n + 1), "{method:?}");
            world.verify_invariants().expect("sound");
            hashes.push(world.hash());
        }
        hashes
    };
    let one = run(1);
    for workers in [2, 7] {
        assert_eq!(run(workers), one, "{workers} workers");
    }
}

#[test]
fn what_is_masked_or_hidden_stays_in_its_set() {
    let (mut world, _) = drawing(1);
    tell(&mut world, Command::Mask(MaskAction::Fill));
    let before = world.hash();
    stroke(&mut world, LEFT, RIGHT);
    assert_eq!((numbers(&world), world.hash()), (vec![0], before), "all is masked");
    tell(&mut world, Command::Mask(MaskAction::Clear));
    let left = ViewRegion::Box([Vec2::ZERO, Vec2::new(0.5, 1.0)]);
    let asked = SetsRegion { region: left, edit: PartEdit::Hide, front_faces: false };
    assert_eq!(ask(&mut world, SceneCommand::SetsRegion(asked)), Ok(ObjectId(0)));
    stroke(&mut world, RIGHT, LEFT);
    let mut copy = world.mesh().duplicate(0);
    let drawn = copy.snapshot().face_sets();
    assert!(drawn.len() == 2 && drawn[1].2 == 0, "none of the new set is hidden: {drawn:?}");
    // The greatest number is taken: a stroke that wants a new one draws nothing.
    let mut last = BrushSettings { falloff: Falloff::Constant, strength: 1.0, ..world.brush };
    last.extra[draw_face_sets::SET] = 32767.0;
    tell(&mut world, Command::Brush(last));
    stroke(&mut world, RIGHT, Vec2::new(0.6, 0.5));
    last.extra[draw_face_sets::SET] = 0.0;
    tell(&mut world, Command::Brush(last));
    let before = world.hash();
    stroke(&mut world, RIGHT, Vec2::new(0.6, 0.6));
    assert_eq!(world.hash(), before);
}

#[test]
fn a_region_of_the_view_becomes_a_set_or_is_hidden() {
    let (mut world, _) = drawing(1);
    let (start, steps) = (world.hash(), world.undo_steps());
    let all = sets(&world)[0].1;
    let lasso = [(0.3, 0.3), (0.7, 0.35), (0.6, 0.7), (0.35, 0.65)];
    let lasso = ViewRegion::Polygon(Arc::new(lasso.map(|(x, y)| Vec2::new(x, y)).to_vec()));
    let of = |edit, front_faces| {
        SceneCommand::SetsRegion(SetsRegion { region: lasso.clone(), edit, front_faces })
    };
    assert_eq!(ask(&mut world, of(PartEdit::NewSet, true)), Ok(ObjectId(1)));
    let front = sets(&world)[1].1;
    assert_eq!(ask(&mut world, of(PartEdit::NewSet, false)), Ok(ObjectId(2)));
    let through = sets(&world)[1].1;
    assert!(through > front * 3 / 2 && through < all, "{front} of {through} of {all}");
    let hidden = |world: &World| {
        let mut copy = world.mesh().duplicate(0);
        copy.snapshot().face_sets().iter().map(|s| s.2).sum::<u64>()
    };
    assert!(ask(&mut world, of(PartEdit::Hide, false)).is_ok());
    assert_eq!(hidden(&world), through);
    let nothing = Err(SceneError::Sets(SetsError::Nothing));
    assert_eq!(ask(&mut world, of(PartEdit::Hide, false)), nothing);
    assert_eq!(ask(&mut world, of(PartEdit::NewSet, false)), nothing, "hidden stays as it is");
    assert!(ask(&mut world, SceneCommand::Sets(SetsEdit::Invert)).is_ok());
    assert_eq!(hidden(&world), all - through);
    assert_eq!(ask(&mut world, of(PartEdit::Isolate, false)), nothing);
    let region = ViewRegion::Line([LEFT, LEFT]);
    let none = SetsRegion { region, edit: PartEdit::Hide, front_faces: false };
    let refused = ask(&mut world, SceneCommand::SetsRegion(none));
    assert_eq!(refused, Err(SceneError::Region));
    // The mask of the same region is that of the same vertices.
    assert!(ask(&mut world, SceneCommand::Sets(SetsEdit::ShowAll)).is_ok());
    let mask = MaskRegion { region: lasso.clone(), mask: 1.0, front_faces: false };
    tell(&mut world, Command::MaskRegion(mask));
    assert_eq!(ask(&mut world, SceneCommand::Sets(SetsEdit::FromMask)), Ok(ObjectId(3)));
    assert_eq!(sets(&world)[1], (3, through));
    world.verify_invariants().expect("sound");
    while world.undo_steps() > steps {
        tell(&mut world, Command::Undo);
    }
    assert_eq!(world.hash(), start);
}

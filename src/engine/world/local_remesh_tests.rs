//! Triangles of one size in a part of an object.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::World;
use super::scene_tests::{ask, tell, world};
use super::surface_edit_tests::settle;
use crate::answer::Answer;
use crate::command::{Command, NewClay};
use crate::local_remesh::{LocalRemesh, WantedEdge};
use crate::mask_region::MaskRegion;
use crate::remesh_work::usual_edge;
use crate::scene::{SceneCommand, SceneError};
use crate::view_region::ViewRegion;
use sculptd_clay::LayerEdit;
use sculptd_geometry::check::report;
use sculptd_geometry::{TriMesh, job::Job, shapes};

/// A ball that was drawn out to one side, as by a snake hook: its far end has edges six times as
/// long.
fn stretched(workers: usize) -> World {
    let mut ball = shapes::icosphere(1.0, 60);
    for p in ball.positions.iter_mut().filter(|p| p.x > 0.0) {
        p.x *= 1.0 + 5.0 * p.x * p.x;
    }
    let mut world = world(workers, u64::MAX);
    tell(&mut world, Command::Replace(NewClay::new(Arc::new(ball), false)));
    world
}

fn remesh(edge: f32, stretched_only: bool, region: Option<ViewRegion>) -> SceneCommand {
    let edge = WantedEdge::OfUsual(edge);
    SceneCommand::RemeshLocal(LocalRemesh { edge, stretched_only, region })
}

fn shape(world: &World) -> TriMesh {
    world.mesh().to_tri()
}

/// Asserts that the mesh is one closed surface that nowhere crosses itself.
fn assert_whole(mesh: &TriMesh) {
    let r = report(&mesh.to_poly(), true, &Job::default()).expect("not cancelled");
    assert!(r.closed && r.manifold && r.oriented && r.euler == 2, "{r:?}");
    assert_eq!((r.components, r.self_intersections), (1, Some(0)));
}

fn edges(mesh: &TriMesh) -> impl Iterator<Item = [Vec3; 2]> + '_ {
    mesh.triangles.iter().flat_map(|t| {
        let p = t.map(|v| mesh.positions[v as usize]);
        [[p[0], p[1]], [p[1], p[2]], [p[2], p[0]]]
    })
}

fn longest(mesh: &TriMesh) -> f32 {
    edges(mesh).map(|[a, b]| a.distance(b)).fold(0.0, f32::max)
}

#[test]
fn what_was_stretched_is_refined_and_the_rest_stays() {
    let mut world = stretched(1);
    let (before, start, steps) = (shape(&world), world.hash(), world.undo_steps());
    let usual = usual_edge(world.mesh()).expect("edges");
    assert!(longest(&before) > 4.0 * usual);
    let ticks = settle(&mut world, Command::Scene(remesh(1.0, true, None)));
    assert!(ticks > 2, "{ticks}: in portions");
    assert!(matches!(world.late_answer(), Some(Ok(Answer::Object(changed))) if changed.0 > 1000));
    world.verify_invariants().expect("sound");
    let after = shape(&world);
    assert_whole(&after);
    assert!(longest(&after) < 1.5 * usual, "{} of {usual}", longest(&after));
    // No vertex was lost or moved, and where nothing was stretched none came.
    let places = |mesh: &TriMesh, low: bool| {
        let all = mesh.positions.iter().filter(|p| !low || p.x < -0.1);
        let mut bits: Vec<[u32; 3]> = all.map(|p| p.to_array().map(f32::to_bits)).collect();
        bits.sort_unstable();
        bits
    };
    assert_eq!(places(&before, true), places(&after, true));
    let all = places(&after, false);
    assert!(places(&before, false).iter().all(|p| all.binary_search(p).is_ok()));
    // Done again, there is nothing to do, and no step.
    assert_eq!(world.undo_steps(), steps + 1);
    let hash = world.hash();
    let edge = WantedEdge::Length(usual);
    let again = LocalRemesh { edge, stretched_only: true, region: None };
    settle(&mut world, Command::Scene(SceneCommand::RemeshLocal(again)));
    assert_eq!((world.hash(), world.undo_steps()), (hash, steps + 1));
    tell(&mut world, Command::Undo);
    assert_eq!(world.hash(), start);
    tell(&mut world, Command::Redo);
    assert_eq!(world.hash(), hash);
}

#[test]
fn a_region_is_remeshed_without_a_rim() {
    let mut world = stretched(1);
    // Masked vertices stay, in the region too.
    let half = ViewRegion::Box([Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.5)]);
    let left = ViewRegion::Box([Vec2::new(0.0, 0.0), Vec2::new(0.4, 1.0)]);
    let masked = MaskRegion { region: left.clone(), mask: 1.0, front_faces: false };
    tell(&mut world, Command::MaskRegion(masked));
    let before = shape(&world);
    settle(&mut world, Command::Scene(remesh(0.5, false, Some(half))));
    world.verify_invariants().expect("sound");
    let after = shape(&world);
    assert_whole(&after);
    let (camera, aspect) = (world.camera, world.camera.aspect);
    let asked = |p: Vec3| {
        let at = camera.project(p).expect("in view");
        at.y < 0.5 && !left.holds(at, aspect)
    };
    let bits = |mesh: &TriMesh| -> Vec<[u32; 3]> {
        let out = mesh.positions.iter().filter(|p| !asked(**p));
        let mut bits: Vec<_> = out.map(|p| p.to_array().map(f32::to_bits)).collect();
        bits.sort_unstable();
        bits
    };
    let inside = |mesh: &TriMesh| mesh.positions.iter().filter(|p| asked(**p)).count();
    assert!(inside(&after) > 3 * inside(&before), "{} of {}", inside(&after), inside(&before));
    // No vertex outside moved or vanished. The new ones are on edges that leave the region.
    let (old, new) = (bits(&before), bits(&after));
    assert!(old.iter().all(|p| new.binary_search(p).is_ok()));
    assert!(new.len() - old.len() < old.len() / 20, "{} of {}", new.len(), old.len());
    let usual = usual_edge(world.mesh()).expect("edges");
    // Near the rim long edges that leave the region hold triangles, and no vertex of theirs takes
    // more than twelve neighbours.
    let deep = |p: Vec3| camera.project(p).is_some_and(|at| at.y < 0.4 && at.x > 0.5);
    let of = |t: &[u32; 3]| t.map(|v| after.positions[v as usize]);
    let inside = after.triangles.iter().map(of).filter(|t| t.iter().all(|p| deep(*p)));
    let lengths = inside.flat_map(|[a, b, c]| [a.distance(b), b.distance(c), c.distance(a)]);
    let worst = lengths.fold(0.0, f32::max);
    assert!(worst < 1.5 * usual, "{worst} of {usual}");
}

#[test]
fn the_same_bits_with_any_number_of_workers() {
    let run = |workers| {
        let mut world = stretched(workers);
        settle(&mut world, Command::Scene(remesh(0.7, false, None)));
        world.hash()
    };
    let one = run(1);
    for workers in [2, 3, 7, 16] {
        assert_eq!(run(workers), one, "{workers} workers");
    }
}

#[test]
fn what_cannot_be_done_is_refused_and_nothing_changes() {
    let mut world = stretched(1);
    let hash = world.hash();
    for edge in [0.0, 0.05, 17.0, f32::NAN, f32::INFINITY, -1.0] {
        assert_eq!(ask(&mut world, remesh(edge, true, None)), Err(SceneError::Edge), "{edge}");
    }
    // 36,000 vertices, each edge in sixteen, come to 18 million triangles.
    assert_eq!(ask(&mut world, remesh(1.0 / 16.0, true, None)), Err(SceneError::Fine));
    let region = Some(ViewRegion::Line([Vec2::ZERO; 2]));
    assert_eq!(ask(&mut world, remesh(1.0, true, region)), Err(SceneError::Region));
    assert_eq!(world.hash(), hash);
    ask(&mut world, SceneCommand::Layers(LayerEdit::Add("one".into()))).expect("a layer");
    assert_eq!(ask(&mut world, remesh(1.0, true, None)), Err(SceneError::KeptByVertex));
}

#[test]
fn an_undo_takes_back_what_is_under_way() {
    for workers in [1, 2, 3, 7, 16] {
        let mut world = stretched(workers);
        let (before, steps) = (shape(&world), world.undo_steps());
        let samples = [];
        world.step(100, &samples, &[Command::Scene(remesh(0.3, true, None))]);
        world.step(101, &samples, &[]);
        assert!(world.is_in_surface_edit(), "it takes more than two ticks");
        assert!(world.is_taken_back_by(&Command::Undo));
        assert_ne!(shape(&world).triangles.len(), before.triangles.len());
        world.step(102, &samples, &[Command::Undo]);
        assert_eq!(world.late_answer(), Some(Err(SceneError::TakenBack)));
        assert!(!world.is_in_surface_edit() && !world.is_taken_back_by(&Command::Undo));
        assert!(shape(&world) == before, "to the bit");
        assert_eq!((world.undo_steps(), world.redo_steps()), (steps, 0));
        world.verify_invariants().expect("in order");
        // It may be asked for again, and is one step as ever.
        settle(&mut world, Command::Scene(remesh(1.0, true, None)));
        assert_whole(&shape(&world));
        assert_eq!(world.undo_steps(), steps + 1);
    }
}

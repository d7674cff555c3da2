//! Levels of detail and trimming, as the control socket asks for them.

use arc_swap::ArcSwap;
use glam::{Vec2, Vec3};
use sculptd::analysis::cancel::Job;
use sculptd::brush::{BrushKind, BrushSettings, Measure};
use sculptd::command::Command;
use sculptd::daemon::published::{Published, PublishedFigures};
use sculptd::daemon::{joiner, trim};
use sculptd::mesh::{TriMesh, check, shapes};

use super::{Studio, s_curve};

fn shown(studio: &mut Studio) -> ArcSwap<Published> {
    ArcSwap::from_pointee(Published::of(&mut studio.world, PublishedFigures::default()))
}

fn go(studio: &mut Studio, finer: bool) -> (usize, usize) {
    let (command, at) = joiner::level(&shown(studio), finer).expect("there is such a level");
    studio.tell(command);
    studio.world.verify_invariants().expect("in order");
    at
}

fn volume(mesh: &TriMesh) -> f64 {
    let c = |v: u32| mesh.positions[v as usize].as_dvec3();
    mesh.triangles.iter().map(|t| c(t[0]).dot(c(t[1]).cross(c(t[2])))).sum::<f64>() / 6.0
}

#[test]
fn detail_survives_strokes_on_a_coarser_level() {
    let start = shapes::icosphere(1.0, 16);
    let fine = BrushSettings { radius: 0.06, strength: 0.1, ..BrushSettings::of(BrushKind::Draw) };
    let coarse = BrushSettings { radius: 0.5, strength: 0.4, ..BrushSettings::of(BrushKind::Grab) };
    let mut studio = Studio::new(&start, fine, 1);
    assert_eq!(go(&mut studio, true), (1, 2));
    assert_eq!(go(&mut studio, true), (2, 3));
    let smooth = studio.world.mesh().to_tri();
    studio.stroke(&s_curve());
    let detailed = studio.world.mesh().to_tri();
    let heights = |a: &TriMesh, b: &TriMesh| -> Vec<f32> {
        a.positions.iter().zip(&b.positions).map(|(a, b)| (*a - *b).length()).collect()
    };
    let before = heights(&smooth, &detailed);
    // Two levels down, where nothing of it is seen, a long pull; and up again.
    assert_eq!((go(&mut studio, false), go(&mut studio, false)), ((1, 3), (0, 3)));
    assert_eq!(studio.world.mesh().to_tri(), start);
    studio.tell(Command::Brush(coarse));
    studio.stroke(&[(Vec2::splat(0.5), 1.0), (Vec2::new(0.6, 0.4), 1.0)]);
    let pulled = studio.world.mesh().to_tri();
    assert_ne!(pulled, start);
    assert_eq!((go(&mut studio, true), go(&mut studio, true)), ((1, 3), (2, 3)));
    // The pulled form without the detail: the same levels made anew.
    let mut bare = Studio::new(&pulled, fine, 1);
    go(&mut bare, true);
    go(&mut bare, true);
    let bare = bare.world.mesh().to_tri();
    let after = heights(&bare, &studio.world.mesh().to_tri());
    let most = before.iter().copied().fold(0.0, f32::max);
    let off = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    println!("detail up to {most:.4} high, kept to {off:.1e} under a pull");
    assert!(most > 0.003 && off < 1e-5, "{off} of {most}");
    // Each way is a step of undo: back to the detailed form before the way down.
    for _ in 0..5 {
        studio.tell(Command::Undo);
    }
    assert_eq!(studio.world.mesh().to_tri(), detailed);
    assert_eq!(go(&mut studio, false), (1, 3));
}

#[test]
fn cut_triangles_end_the_levels() {
    let mut brush = BrushSettings { radius: 0.15, ..BrushSettings::of(BrushKind::Draw) };
    brush.topology.by = Measure::Brush;
    let mut studio = Studio::new(&shapes::icosphere(1.0, 16), brush, 1);
    go(&mut studio, true);
    studio.stroke(&s_curve());
    assert!(joiner::level(&shown(&mut studio), false).is_err());
    assert_eq!(go(&mut studio, true), (1, 2), "what is there is the lowest of new ones");
}

#[test]
fn a_box_and_a_line_cut_off_what_is_seen_there() {
    let start = shapes::icosphere(1.0, 40);
    let mut studio = Studio::new(&start, BrushSettings::default(), 1);
    let whole = volume(&start);
    let cut = |studio: &mut Studio, part: trim::Part| {
        let done = trim::at_rest(&shown(studio), &part).expect("something is there");
        done.into_iter().for_each(|c| studio.tell(c));
        studio.world.verify_invariants().expect("in order");
        studio.world.mesh().to_tri()
    };
    // The left half: the cut lies in the plane of the eye, through the middle.
    let (foot, head) = (studio.view(Vec3::NEG_Y * 0.9), studio.view(Vec3::Y * 0.9));
    let half = cut(&mut studio, trim::Part::Line([foot.x, foot.y, head.x, head.y]));
    assert!((volume(&half) / whole - 0.5).abs() < 1e-4, "{}", volume(&half) / whole);
    assert!(half.positions.iter().all(|p| p.x > -1e-5));
    // Of that the upper part.
    let (a, b) = (studio.view(Vec3::new(-0.5, 0.0, 0.0)), Vec2::new(1.0, -0.5));
    let quarter = cut(&mut studio, trim::Part::Box([a.x, a.y, b.x, b.y]));
    assert!((volume(&quarter) / whole - 0.25).abs() < 1e-4, "{}", volume(&quarter) / whole);
    let facts = check::report(&quarter.to_poly(), false, &Job::default()).expect("not cancelled");
    assert!(facts.closed && facts.manifold, "{facts:?}");
    studio.tell(Command::Undo);
    studio.tell(Command::Undo);
    assert_eq!(studio.world.mesh().to_tri(), start);
    let none = trim::at_rest(&shown(&mut studio), &trim::Part::Box([0.0, 0.0, 1.0, 1.0]));
    assert!(none.is_err(), "nothing of the work would be left");
}

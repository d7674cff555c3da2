//! Levels of detail and trimming, as the control socket asks for them.

use glam::{Vec2, Vec3};
use sculptd_clay::brush::{BrushKind, BrushSettings, MaskAction, Measure};
use sculptd_daemon::operations::{Computed, OperationError};
use sculptd_daemon::published::{Published, PublishedFigures};
use sculptd_daemon::{boolean_jobs, trim};
use sculptd_engine::answer::Answer;
use sculptd_engine::command::Command;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, check, shapes};

use super::{Studio, s_curve};

fn shown(studio: &mut Studio) -> Published {
    Published::of(&mut studio.world, PublishedFigures::default())
}

fn go(studio: &mut Studio, finer: bool) -> (usize, usize) {
    let level = boolean_jobs::level(&shown(studio), finer, &Job::default());
    let level = level.expect("there is such a level");
    let command = level.edit.deliver(&mut studio.world);
    studio.tell(command);
    assert_eq!(studio.world.answers(), [Ok(Answer::Done)]);
    studio.world.verify_invariants().expect("in order");
    level.made
}

fn volume(mesh: &TriMesh) -> f64 {
    let c = |v: u32| mesh.positions[v as usize].as_dvec3();
    mesh.triangles.iter().map(|t| c(t[0]).dot(c(t[1]).cross(c(t[2])))).sum::<f64>() / 6.0
}

#[test]
fn detail_survives_strokes_on_a_coarser_level() {
    let start = shapes::icosphere(1.0, 16);
    let fine =
        BrushSettings { radius: 0.06, strength: 0.1, ..sculptd::presets().of(BrushKind::Draw) };
    let coarse =
        BrushSettings { radius: 0.5, strength: 0.4, ..sculptd::presets().of(BrushKind::Grab) };
    let mut studio = Studio::new(&start, fine, 1);
    assert_eq!(go(&mut studio, true), (1, 2));
    assert_eq!(go(&mut studio, true), (2, 3));
    let smooth = studio.world.mesh().to_tri();
    studio.stroke(&s_curve());
    let detailed = studio.world.mesh().to_tri();
    let heights = |a: &TriMesh, b: &TriMesh| -> Vec<f32> {
        a.positions.iter().zip(&b.positions).map(|(a, b)| (*a - *b).length()).collect()
    };
    let widest = |a: &TriMesh, b: &TriMesh| heights(a, b).into_iter().fold(0.0, f32::max);
    // Two levels down, which follow what was sculpted, and up again: nothing is lost, to the bit.
    assert_eq!((go(&mut studio, false), go(&mut studio, false)), ((1, 3), (0, 3)));
    let followed = studio.world.mesh().to_tri();
    let (most, taken) = (widest(&smooth, &detailed), widest(&start, &followed));
    assert!(most > 0.003 && taken > 0.1 * most, "{taken} of {most} is seen on the lowest level");
    assert_eq!((go(&mut studio, true), go(&mut studio, true)), ((1, 3), (2, 3)));
    assert_eq!(studio.world.mesh().to_tri(), detailed);
    assert_eq!((go(&mut studio, false), go(&mut studio, false)), ((1, 3), (0, 3)));
    assert_eq!(studio.world.mesh().to_tri(), followed);
    // A long pull there, and up again.
    studio.tell(Command::Brush(coarse));
    studio.stroke(&[(Vec2::splat(0.5), 1.0), (Vec2::new(0.6, 0.4), 1.0)]);
    let pulled = studio.world.mesh().to_tri();
    assert_ne!(pulled, followed);
    assert_eq!((go(&mut studio, true), go(&mut studio, true)), ((1, 3), (2, 3)));
    // Both forms without the detail: the same levels computed again.
    let bare = |of: &TriMesh| {
        let mut bare = Studio::new(of, fine, 1);
        go(&mut bare, true);
        go(&mut bare, true);
        bare.world.mesh().to_tri()
    };
    let (before, after) = (
        heights(&bare(&followed), &detailed),
        heights(&bare(&pulled), &studio.world.mesh().to_tri()),
    );
    let detail = before.iter().copied().fold(0.0, f32::max);
    let off = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    println!(
        "{most:.4} sculpted, {taken:.4} of it seen two levels lower; {detail:.4} of detail kept to \
            {off:.1e} under a pull"
    );
    assert!(detail > 0.001 && off < 0.03 * detail, "{off} of {detail}");
    // Each way is a step of undo: back to the detailed form before the way down.
    for _ in 0..9 {
        studio.tell(Command::Undo);
    }
    assert_eq!(studio.world.mesh().to_tri(), detailed);
    assert_eq!(go(&mut studio, false), (1, 3));
}

#[test]
fn mask_and_colour_go_up_and_down_with_the_level() {
    let mut studio = Studio::new(
        &shapes::icosphere(1.0, 16),
        BrushSettings { radius: 0.3, ..sculptd::presets().of(BrushKind::Mask) },
        1,
    );
    studio.stroke(&s_curve());
    let all = |s: &mut Studio| {
        let now = s.world.snapshot();
        (now.to_tri(), now.masks().unwrap_or_default())
    };
    let sum = |(_, mask): &(TriMesh, Vec<f32>)| mask.iter().sum::<f32>() / mask.len() as f32;
    let low = all(&mut studio);
    assert_eq!(go(&mut studio, true), (1, 2));
    let high = all(&mut studio);
    assert!(
        sum(&low) > 0.01 && (sum(&high) / sum(&low) - 1.0).abs() < 0.02,
        "{} {}",
        sum(&low),
        sum(&high)
    );
    assert_eq!((go(&mut studio, false), all(&mut studio) == low), ((0, 2), true));
    assert_eq!((go(&mut studio, true), all(&mut studio) == high), ((1, 2), true));
    // Painted and masked on the finer one: down, and up again.
    studio.tell(Command::Mask(MaskAction::Invert));
    studio.tell(Command::Brush(BrushSettings {
        radius: 0.3,
        colour: [200, 10, 20, 255],
        ..sculptd::presets().of(BrushKind::Paint)
    }));
    studio.stroke(&s_curve());
    let painted = all(&mut studio);
    assert!(painted.0.colours.is_some() && painted.1 != high.1);
    go(&mut studio, false);
    let below = all(&mut studio);
    let (colours, n) = (painted.0.colours.as_deref().expect("painted"), low.0.positions.len());
    assert_eq!((below.0.colours.as_deref(), &below.1[..]), (Some(&colours[..n]), &painted.1[..n]));
    go(&mut studio, true);
    assert!(all(&mut studio) == painted);
    // A mask of the coarser level applies to the finer one.
    go(&mut studio, false);
    studio.tell(Command::Mask(MaskAction::Fill));
    go(&mut studio, true);
    assert!(all(&mut studio).1.iter().all(|m| *m == 1.0));
    studio.world.verify_invariants().expect("in order");
}

#[test]
fn cut_triangles_end_the_levels() {
    let mut brush = BrushSettings { radius: 0.15, ..sculptd::presets().of(BrushKind::Draw) };
    brush.topology.by = Measure::Brush;
    let mut studio = Studio::new(&shapes::icosphere(1.0, 16), brush, 1);
    go(&mut studio, true);
    studio.stroke(&s_curve());
    assert!(boolean_jobs::level(&shown(&mut studio), false, &Job::default()).is_err());
    assert_eq!(go(&mut studio, true), (1, 2), "what is there is the lowest of new ones");
}

fn trimmed(now: &Published, part: &trim::Part) -> Result<Computed<usize>, OperationError> {
    boolean_jobs::join(now, trim::tool(now, part)?, false, Operation::Difference, &Job::default())
}

#[test]
fn a_box_and_a_line_cut_off_what_is_seen_there() {
    let start = shapes::icosphere(1.0, 40);
    let mut studio = Studio::new(&start, BrushSettings::default(), 1);
    let whole = volume(&start);
    let cut = |studio: &mut Studio, part: trim::Part| {
        let done = trimmed(&shown(studio), &part).expect("something is there");
        for queued in done.into_commands() {
            let command = queued.deliver(&mut studio.world);
            studio.tell(command);
            assert!(studio.world.answers()[0].is_ok());
        }
        studio.world.verify_invariants().expect("in order");
        studio.world.mesh().to_tri()
    };
    // The left half: the cut is a plane through the eye and the middle.
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
    let none = trimmed(&shown(&mut studio), &trim::Part::Box([0.0, 0.0, 1.0, 1.0]));
    assert!(none.is_err(), "nothing of the work would be left");
}

//! Changes of a whole object while somebody sculpts on one part of it: each lands, with the strokes
//! made meanwhile.

#[cfg(unix)]
mod callers;
mod studio;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::seeded::Random;
use sculptd_clay::Workers;
use sculptd_clay::brush::{BrushKind, BrushSettings, MaskAction, Measure, TopologySettings};
use sculptd_daemon::boolean_jobs::{join, level};
use sculptd_daemon::decimate_job::{DecimateWanted, decimated};
use sculptd_daemon::input_hold::LONGEST_HOLD;
use sculptd_daemon::operations::{self, Computed, OperationError, TRIES};
use sculptd_daemon::quad_job::{QuadsWanted, quads};
use sculptd_daemon::remesh_job::{Wanted, remeshed};
use sculptd_daemon::scene_jobs::{self, SceneBoolean};
use sculptd_daemon::{Published, carry_over, session};
use sculptd_engine::command::Command;
use sculptd_engine::scene::{NewObject, ObjectId, ObjectSource, ObjectTransform, SceneCommand};
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, shapes};
use studio::{Pace, Studio, brush};

type Outcome = Result<Computed<()>, OperationError>;

/// Vertices of the ball.
const SIZE: usize = 40_000;

fn plain<T>(computed: Computed<T>) -> Computed<()> {
    let Computed { edit, then, basis, .. } = computed;
    Computed { edit, then, made: (), basis }
}

/// A solid on the far side of the pen.
fn far_tool(under: Vec3, radius: f64) -> PolyMesh {
    let mut out = shapes::icosphere(1.0, 24).to_poly();
    let at = -under.normalize().as_dvec3();
    out.positions.iter_mut().for_each(|p: &mut DVec3| *p = *p * radius + at);
    out
}

fn mirrored(now: &Published, job: &Job) -> Outcome {
    let id = now.scene.active().map_or(ObjectId(0), |o| o.id);
    Ok(Computed::of_combined(now, scene_jobs::mirror(now, id, 0, job)?, ()))
}

/// Tries an operation: its name, the vertices of the ball, and how near its result is to follow the
/// strokes: half an edge of the result, a whole one where that is coarse.
type Visit<'a> = &'a dyn Fn(&str, usize, f64, &dyn Fn(&Published, &Job, Vec3) -> Outcome);

fn each(visit: Visit<'_>) {
    let voxel = Wanted { voxel: Some(0.025), sharp: false };
    visit("remesh", SIZE, 0.0125, &|now, job, _| remeshed(now, &voxel, job).map(plain));
    let wanted = QuadsWanted { quads: 6000, ..Default::default() };
    visit("quads", SIZE / 4, 0.046, &|now, job, _| quads(now, &wanted, job).map(plain));
    let fewer = DecimateWanted { triangles: 40_000, max_error: None };
    visit("decimate", SIZE, 0.015, &|now, job, _| decimated(now, &fewer, job).map(plain));
    visit("union", SIZE, 0.01, &|now, job, under| {
        join(now, far_tool(under, 0.9), false, Operation::Union, job).map(plain)
    });
    visit("carve", SIZE, 0.01, &|now, job, under| {
        join(now, far_tool(under, 0.1), false, Operation::Difference, job).map(plain)
    });
    visit("finer", SIZE, 0.01, &|now, job, _| level(now, true, job).map(plain));
}

fn lands(pace: Pace) {
    each(&|name, size, within, compute| {
        let mut studio = Studio::new(shapes::sphere_of_about(size), brush(), 2);
        let under = studio.under;
        let begun = studio.now_us();
        let done = studio.operate(pace, |now, job| compute(now, job, under));
        let took = (studio.now_us() - begun) as f64 * 1e-6;
        let done = done.unwrap_or_else(|e| panic!("{name}: {e}"));
        let figures = studio.shown().figures;
        println!(
            "{name}, {pace:?}: {took:.2} s, {} tries, {} rounds, {} holds, the longest {:.1} ms",
            done.tries,
            done.rounds,
            figures.input_holds,
            figures.longest_hold_us as f64 * 1e-3
        );
        let run = studio.check();
        assert_eq!(run.installed, 1, "{name}");
        run.has_the_strokes(under, within);
    });
}

#[test]
fn each_operation_lands_between_many_strokes() {
    lands(Pace::Many);
}

#[test]
fn each_operation_lands_during_one_long_stroke() {
    lands(Pace::One);
}

#[test]
fn a_large_object_is_put_in_place_within_the_time_of_a_hold() {
    let mut studio = Studio::new(shapes::sphere_of_about(150_000), brush(), 2);
    let under = studio.under;
    let voxel = Wanted { voxel: Some(0.01), sharp: false };
    let begun = studio.now_us();
    let done = studio.operate(Pace::One, |now, job| remeshed(now, &voxel, job)).expect("lands");
    let took = (studio.now_us() - begun) as f64 * 1e-6;
    let longest_ms = studio.shown().figures.longest_hold_us as f64 * 1e-3;
    let (vertices, tries, rounds) = (done.made.vertices, done.tries, done.rounds);
    println!(
        "{vertices} vertices: {took:.1} s, {tries} tries, {rounds} rounds, {longest_ms:.1} ms"
    );
    let run = studio.check();
    assert_eq!((run.installed, tries), (1, 1));
    run.has_the_strokes(under, 0.01);
}

#[test]
fn a_stroke_that_the_coarser_level_cannot_show_is_back_on_the_finer_one() {
    let mut studio = Studio::new(shapes::sphere_of_about(SIZE / 4), brush(), 2);
    let (under, job) = (studio.under, Job::default());
    let up = |studio: &Studio| {
        operations::carry_out(studio.to(), &job, |now| level(now, true, &job)).expect("finer")
    };
    up(&studio);
    let done = studio.operate(Pace::One, |now, job| level(now, false, job)).expect("coarser");
    println!("{} tries, {} rounds", done.tries, done.rounds);
    assert_eq!(done.made, (0, 2));
    assert_eq!(up(&studio).made, (1, 2));
    let run = studio.check();
    assert_eq!(run.installed, 3);
    run.has_the_strokes(under, 0.015);
}

#[test]
fn a_mirrored_twin_lands_during_one_long_stroke() {
    let mut studio = Studio::new(shapes::sphere_of_about(10_000), brush(), 1);
    studio.operate(Pace::One, mirrored).expect("a twin");
    assert_eq!(studio.shown().scene.objects.len(), 2);
    studio.check();
}

/// A second object on the far side of the pen; the first is active again.
fn with_another(studio: &Studio) -> [ObjectId; 2] {
    let first = studio.shown().scene.active().expect("an object").id;
    let ball = shapes::icosphere(0.6, 20);
    let at = -studio.under.normalize().as_dvec3();
    let transform = ObjectTransform { shift: at, ..ObjectTransform::NONE };
    let new = NewObject::new("far", ObjectSource::Mesh(Arc::new(ball)), transform);
    studio.tell(Command::Scene(SceneCommand::Add(new)));
    let second = studio.shown().scene.active().expect("an object").id;
    studio.tell(Command::Scene(SceneCommand::Activate(first)));
    [first, second]
}

fn two_objects(asked: SceneBoolean) {
    let mut studio = Studio::new(shapes::sphere_of_about(SIZE), brush(), 2);
    let (ids, under) = (with_another(&studio), studio.under);
    let done = studio.operate(Pace::One, |now, job| {
        Ok(Computed::of_combined(now, scene_jobs::boolean(now, ids, asked, job)?, ()))
    });
    println!("{asked:?}: {:?}", done.expect("a result"));
    let run = studio.check();
    assert_eq!(run.installed, 1);
    run.has_the_strokes(under, 0.01);
}

#[test]
fn a_boolean_of_two_objects_lands_during_one_long_stroke() {
    two_objects(SceneBoolean::new(Operation::Union));
    two_objects(SceneBoolean { keep: true, ..SceneBoolean::new(Operation::Difference) });
}

#[test]
fn colours_and_masks_painted_meanwhile_are_carried_over() {
    let painted = |kind| BrushSettings {
        radius: 0.12,
        strength: 1.0,
        colour: [200, 10, 10, 255],
        ..sculptd::presets().of(kind)
    };
    // In a short run, one operation by projection and one by Boolean for each.
    let short = [(BrushKind::Paint, ["remesh", "carve"]), (BrushKind::Mask, ["decimate", "union"])];
    for (kind, few) in short {
        each(&|name, size, _, compute| {
            if !crate::field::long() && !few.contains(&name) {
                return;
            }
            let mut studio = Studio::new(shapes::sphere_of_about(size), painted(kind), 2);
            let under = studio.under;
            studio.operate(Pace::One, |now, job| compute(now, job, under)).expect("a result");
            let shown = studio.shown();
            let (result, masks) = (shown.mesh.to_tri(), shown.mesh.masks());
            let run = studio.check();
            let old = &run.reference;
            let solid = DistanceSolid::build(old, &Job::default()).expect("a solid");
            let at = carry_over::places(old, &solid, &result.positions, &Job::default());
            let at = at.expect("places");
            let (want, got): (Vec<f32>, Vec<f32>) = match kind {
                BrushKind::Mask => {
                    let old_masks = run.masks.as_ref().expect("masked");
                    (carry_over::values(old, old_masks, &at), masks.expect("masked"))
                }
                _ => {
                    let share = |c: &[u8; 4]| f32::from(255 - c[1]) / 255.0;
                    let want = carry_over::colours(old, &at).expect("painted");
                    let got = result.colours.expect("painted");
                    (want.iter().map(share).collect(), got.iter().map(share).collect())
                }
            };
            let count = want.iter().filter(|w| **w > 0.5).count();
            let off: f32 = want.iter().zip(&got).map(|(a, b)| (a - b).abs()).sum();
            let all: f32 = want.iter().sum();
            println!("{kind:?} {name}: {count} vertices, off by {:.4}", off / all);
            assert!(count > 10, "{name}: only {count} vertices");
            assert!(off < 0.2 * all, "{name}: off by {off} of {all}");
        });
    }
}

#[test]
fn new_triangles_meanwhile_have_it_computed_again_or_refused() {
    let topology = TopologySettings { by: Measure::Brush, edge: 0.06, ..Default::default() };
    for pace in [Pace::One, Pace::Many] {
        let clay = sculptd::presets().of(BrushKind::Clay);
        let brush = BrushSettings { topology, radius: 0.15, strength: 0.1, ..clay };
        let mut studio = Studio::new(shapes::sphere_of_about(SIZE), brush, 2);
        studio.tell(Command::Brush(brush));
        let (under, count) = (studio.under, studio.shown().mesh.vertex_count());
        let wanted = Wanted { voxel: Some(0.025), sharp: false };
        let done = studio.operate(pace, |now, job| remeshed(now, &wanted, job));
        println!("{pace:?}: {:?}", done.as_ref().map(|d| (d.tries, d.rounds)));
        let run = studio.check();
        match done {
            Ok(_) => assert_eq!(run.installed, 1),
            Err(e) => {
                assert!(matches!(e, OperationError::Restless), "{e}");
                assert_eq!(run.installed, 0);
            }
        }
        run.has_the_strokes(under, 0.01);
        assert_ne!(run.reference.positions.len(), count, "triangles were cut");
    }
}

/// Computes something that is stale twice, and `last` the third time, when the input is held.
fn held_for(studio: &Studio, last: impl Fn()) -> Result<(), OperationError> {
    let old = studio.shown();
    let tries = std::cell::Cell::new(0);
    studio.comes("the pen goes on", |now| now.mesh.revision() > old.mesh.revision());
    operations::carry_out(studio.to(), &Job::default(), |_| {
        tries.set(tries.get() + 1);
        if tries.get() == TRIES {
            last();
        }
        Ok(Computed::of_clay(&old, Command::Mask(MaskAction::Fill).into(), ()))
    })
    .map(|_| ())
}

#[test]
fn held_input_is_let_go_after_a_panic_and_after_its_time_and_all_of_it_arrives() {
    let mut studio = Studio::new(shapes::sphere_of_about(10_000), brush(), 1);
    let drawing = studio.draw(Pace::One);
    let panics = AssertUnwindSafe(|| held_for(&studio, || panic!("a bug, as the test wants it")));
    assert!(catch_unwind(panics).is_err());
    let goes_on = |studio: &Studio| {
        let dabs = studio.shown().figures.dabs;
        studio.comes("the pen sculpts on", |now| now.figures.dabs > dabs + 5);
    };
    goes_on(&studio);
    assert_eq!(studio.shown().figures.input_holds, 1);
    studio::wait(2 * LONGEST_HOLD);
    // One that takes its time: the loop does not wait for it.
    let slow = held_for(&studio, || {
        studio::wait(LONGEST_HOLD / 2);
        let at = studio.shown().figures.samples;
        studio::wait(LONGEST_HOLD / 4);
        assert_eq!(studio.shown().figures.samples, at, "the input is held");
        studio::wait(2 * LONGEST_HOLD);
        goes_on(&studio);
    });
    assert!(matches!(slow, Err(OperationError::Restless)), "{slow:?}");
    studio.end(drawing);
    let figures = studio.shown().figures;
    let longest_ms = figures.longest_hold_us as f64 * 1e-3;
    println!("{} holds, the longest {longest_ms:.1} ms", figures.input_holds);
    assert_eq!(figures.input_holds, 2);
    // A tick more, on a machine that runs all tests at once some.
    assert!((100.0..200.0).contains(&longest_ms), "{longest_ms}");
    studio.check();
}

/// Runs of a few operations each, over a session; the whole is decided by the seed.
fn random(rounds: u64, seed: u64) {
    let mut dice = Random(seed);
    for round in 0..rounds {
        let workers = [1, 2, 3, 7, 16][(round % 5) as usize];
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("s.sculpt");
        let ball = shapes::sphere_of_about(1500 + dice.below(8000) as usize);
        let (writer, thread) =
            session::create(&path, &ball, &studio::settings(brush())).expect("a session");
        let mut studio = Studio::kept(ball, brush(), workers, Some(Box::new(writer)));
        let under = studio.under;
        for _ in 0..1 + dice.below(3) {
            let pace = if dice.below(2) == 0 { Pace::One } else { Pace::Many };
            let name = dice.of(&["remesh", "quads", "decimate", "tool", "finer", "coarser"]);
            let size = studio.shown().mesh.vertex_count();
            let voxel = Wanted { voxel: Some(0.04 + 0.04 * dice.part() as f32), sharp: false };
            let wanted = QuadsWanted {
                quads: size / 2 + 200,
                levels: dice.below(2) as u32,
                ..Default::default()
            };
            let fewer =
                DecimateWanted { triangles: size + dice.below(800) as usize, max_error: None };
            let (radius, by) = (0.1 + dice.part() * 0.8, dice.below(2) == 0);
            let by = if by { Operation::Union } else { Operation::Difference };
            let done = studio.operate(pace, |now, job| match name {
                "remesh" => remeshed(now, &voxel, job).map(plain),
                "quads" => quads(now, &wanted, job).map(plain),
                "decimate" => decimated(now, &fewer, job).map(plain),
                "tool" => join(now, far_tool(under, radius), false, by, job).map(plain),
                "coarser" => level(now, false, job).map(plain),
                _ if size > 20_000 => level(now, false, job).map(plain),
                _ => level(now, true, job).map(plain),
            });
            match done {
                Ok(_)
                // What a person hears who asks for what cannot be; nothing is changed then.
                | Err(
                    OperationError::Level(_)
                    | OperationError::Boolean(_)
                    | OperationError::Quads(_)
                    | OperationError::Restless
                    | OperationError::Nothing,
                ) => {}
                Err(e) => panic!("seed {seed}, round {round}: {name}: {e}"),
            }
        }
        let run = studio.check();
        assert!(thread.finish().is_none());
        let opened = session::open(&path).expect("opens");
        let job = Job::default();
        let replayed = session::replay::replay(&opened, None, Workers::new(3), &job);
        assert_eq!(replayed.expect("replays").world.hash(), run.hash, "round {round}: the replay");
        if let Some(quick) = session::reopen(&path, &opened, None, 1, &job) {
            assert_eq!(quick.replayed.world.hash(), run.hash, "round {round}: reopened");
        }
    }
}

#[test]
fn random_operations_give_the_same_live_replayed_and_reopened() {
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 400 } else { 8 };
    random(rounds, 0x5CA1_AB1E);
}

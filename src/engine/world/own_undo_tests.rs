//! Undo of one's own steps: random strokes of three people, undone and done again in any order.

use glam::Vec2;
use proptest::prelude::*;

use super::{UndoRefusal, World, WorldOptions};
use crate::camera::Camera;
use crate::command::{Command, OfPerson};
use crate::hand::HandSettings;
use crate::scene::{ObjectId, SceneCommand};
use sculptd_clay::brush::{BrushKind, BrushSettings, Measure};
use sculptd_clay::{Clay, LayerEdit, Workers};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

const PEOPLE: [u8; 3] = [1, 2, 3];

fn of(person: u8, command: Command) -> Command {
    Command::OfPerson(Box::new(OfPerson { person, command }))
}

fn pen(person: u8, tip: bool, at: Vec2) -> Sample {
    let pen = Pen {
        in_range: true,
        tip,
        pos_mm: at * 100.0,
        area_mm: Vec2::splat(100.0),
        pressure: Some(0.8),
        ..Pen::default()
    };
    let device = DeviceId(u16::from(person) << 8);
    Sample { device, t_us: 0, device_t_us: None, body: Body::Pen(pen) }
}

/// A world, and its next tick.
struct Shared {
    world: World,
    tick: u64,
}

impl Shared {
    /// Three people: two look from nearly the same side, the third from behind.
    fn new(workers: usize) -> Shared {
        let clay = Clay::build(&shapes::sphere_of_about(20_000), &Job::default()).expect("a ball");
        let options = WorldOptions {
            dab_budget: 1 << 20,
            undo_bytes: 1 << 30,
            hands: HandSettings::default(),
        };
        let brush = BrushSettings { radius: 0.06, strength: 0.8, ..BrushSettings::default() };
        let workers = Workers::new(workers);
        let world = World::new(clay, Camera::default(), brush, workers, options);
        let mut shared = Shared { world, tick: 0 };
        shared.world.show_to(1);
        let from = |yaw: f32| Camera { yaw, ..*shared.world.camera() };
        let cameras = [from(0.0), from(0.3), from(3.0)];
        let inflate = BrushSettings { kind: BrushKind::Inflate, ..brush };
        let clay = BrushSettings { kind: BrushKind::Clay, ..brush };
        let mut commands = Vec::new();
        for ((person, camera), brush) in PEOPLE.into_iter().zip(cameras).zip([brush, inflate, clay])
        {
            commands.push(of(person, Command::Camera(camera)));
            commands.push(of(person, Command::Brush(brush)));
        }
        shared.step(&[], &commands);
        shared
    }

    fn step(&mut self, samples: &[Sample], commands: &[Command]) {
        self.tick += 1;
        self.world.step(self.tick, samples, commands);
    }

    fn asks(&mut self, person: u8, command: Command) {
        self.world.show_to(person);
        self.step(&[], &[of(person, command)]);
    }

    /// Strokes at once, and in the middle of them somebody's command; then all rest.
    fn strokes(&mut self, strokes: &[(u8, Vec2)], meanwhile: Option<(u8, &Command)>) {
        for k in 0..10 {
            let at = |from: Vec2| from + Vec2::new(0.008, 0.005) * k as f32;
            // The pen that starts first ends first.
            let tip = |i: usize| k < 8 - i;
            let pens = strokes.iter().enumerate();
            let samples: Vec<Sample> = pens.map(|(i, s)| pen(s.0, tip(i), at(s.1))).collect();
            match meanwhile {
                Some((person, command)) if k == 4 => {
                    self.step(&samples, &[of(person, command.clone())]);
                }
                _ => self.step(&samples, &[]),
            }
        }
        self.rest();
    }

    /// Finishes the pending work on pages and triangles.
    fn rest(&mut self) {
        for _ in 0..200 {
            self.step(&[], &[]);
            if self.world.is_at_rest() {
                return;
            }
        }
        panic!("never at rest");
    }

    fn stroke(&mut self, person: u8, x: f32, y: f32) {
        self.strokes(&[(person, Vec2::new(x, y))], None);
    }

    fn verify(&self) {
        self.world.verify_invariants().expect("the world is sound");
        self.world.mesh().verify_invariants().expect("the clay is sound");
    }

    /// Steps of all, counted for each owner.
    fn steps(&mut self) -> (usize, usize) {
        let mut sum = (0, 0);
        for person in PEOPLE {
            self.world.show_to(person);
            sum = (sum.0 + self.world.undo_steps(), sum.1 + self.world.redo_steps());
        }
        sum
    }

    fn refused(&mut self, person: u8) -> Option<UndoRefusal> {
        self.world.show_to(person);
        self.world.undo_refused().filter(|r| r.tick == self.tick)
    }

    /// All ask in turn, until nobody has a step left.
    fn all(&mut self, command: &Command, left: impl Fn((usize, usize)) -> usize) {
        for _ in 0..200 {
            let before = left(self.steps());
            if before == 0 {
                return;
            }
            for person in PEOPLE {
                self.asks(person, command.clone());
            }
            assert!(left(self.steps()) < before, "nobody gets on, with {before} steps left");
        }
        panic!("still steps left");
    }
}

#[derive(Debug, Clone)]
enum Op {
    Strokes(Vec<(u8, Vec2)>, Option<(u8, bool)>),
    Undo(u8),
    Redo(u8),
    Rename(u8),
    /// The brush cuts triangles from now on, or no longer.
    Topology(u8, bool),
    /// A layer is added, or all are removed.
    Layer(u8, bool),
}

fn ops() -> impl Strategy<Value = Vec<Op>> {
    let person = || 1u8..=3;
    let place = || (0.35f32..0.62, 0.35f32..0.62).prop_map(|(x, y)| Vec2::new(x, y));
    let strokes = proptest::collection::vec((person(), place()), 1..=3).prop_map(|mut all| {
        all.sort_by_key(|s| s.0);
        all.dedup_by_key(|s| s.0);
        all
    });
    let meanwhile = proptest::option::weighted(0.25, (person(), any::<bool>()));
    let op = prop_oneof![
        5 => (strokes, meanwhile).prop_map(|(s, m)| Op::Strokes(s, m)),
        4 => person().prop_map(Op::Undo),
        3 => person().prop_map(Op::Redo),
        1 => person().prop_map(Op::Rename),
        1 => (person(), any::<bool>()).prop_map(|(p, on)| Op::Topology(p, on)),
        1 => (person(), any::<bool>()).prop_map(|(p, on)| Op::Layer(p, on)),
    ];
    proptest::collection::vec(op, 4..24)
}

fn way(undo: bool) -> Command {
    if undo { Command::Undo } else { Command::Redo }
}

fn apply(shared: &mut Shared, op: &Op) {
    match op {
        Op::Strokes(strokes, meanwhile) => {
            let asked = meanwhile.map(|(person, undo)| (person, way(undo)));
            shared.strokes(strokes, asked.as_ref().map(|(person, way)| (*person, way)));
        }
        Op::Undo(person) => shared.asks(*person, Command::Undo),
        Op::Redo(person) => shared.asks(*person, Command::Redo),
        Op::Rename(person) => {
            let name = format!("of {person} at {}", shared.tick);
            let rename = SceneCommand::Rename(ObjectId(0), name);
            shared.asks(*person, Command::Scene(rename));
        }
        Op::Topology(person, on) => {
            shared.world.show_to(*person);
            let mut brush = *shared.world.brush();
            brush.kind = BrushKind::Draw;
            brush.topology.by = if *on { Measure::Brush } else { Measure::Off };
            shared.asks(*person, Command::Brush(brush));
        }
        Op::Layer(person, on) => {
            let edit = if *on { LayerEdit::Add("of one".into()) } else { LayerEdit::Bake };
            shared.asks(*person, Command::Scene(SceneCommand::Layers(edit)));
            shared.rest();
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Everything can be undone by its authors, to the bit, and redone.
    #[test]
    fn all_is_taken_back_to_the_bit_and_done_again(ops in ops()) {
        let mut shared = Shared::new(1);
        let begin = shared.world.hash();
        for op in &ops {
            apply(&mut shared, op);
            shared.verify();
        }
        // Each makes a new step: no undone step can be redone.
        for person in PEOPLE {
            shared.stroke(person, 0.3 + 0.1 * f32::from(person), 0.65);
        }
        prop_assert_eq!(shared.steps().1, 0);
        let end = shared.world.hash();
        shared.all(&Command::Undo, |s| s.0);
        prop_assert_eq!(shared.world.hash(), begin);
        shared.verify();
        shared.all(&Command::Redo, |s| s.1);
        prop_assert_eq!(shared.world.hash(), end);
        shared.verify();
    }

    /// The same bits after each step, however many workers there are and whomever the world is
    /// shown to.
    #[test]
    fn the_bits_do_not_depend_on_the_workers(ops in ops()) {
        let mut told: Option<Vec<u64>> = None;
        for workers in [1, 2, 3, 7, 16] {
            let mut shared = Shared::new(workers);
            let hashes: Vec<u64> = ops.iter().map(|op| {
                apply(&mut shared, op);
                shared.world.show_to((workers % 3) as u8 + 1);
                shared.world.hash()
            }).collect();
            let first = told.get_or_insert_with(|| hashes.clone());
            prop_assert_eq!(&hashes, first, "{} workers", workers);
        }
    }
}

/// Positions of all vertices.
fn places(shared: &Shared) -> Vec<glam::Vec3> {
    shared.world.mesh().to_tri().positions
}

#[test]
fn a_step_that_is_free_is_taken_back_and_what_came_after_it_stays() {
    let mut shared = Shared::new(2);
    let ball = places(&shared);
    shared.stroke(1, 0.4, 0.45);
    let first = places(&shared);
    shared.stroke(3, 0.5, 0.5);
    shared.stroke(2, 0.6, 0.6);
    let all = places(&shared);
    shared.asks(1, Command::Undo);
    assert_eq!(shared.refused(1), None);
    // Vertices that the step changed are back on the ball; the others keep the others' changes.
    let now = places(&shared);
    let moved = |i: &usize| ball[*i] != first[*i];
    let (own, others): (Vec<usize>, Vec<usize>) = (0..ball.len()).partition(moved);
    assert!(own.len() > 20 && own.iter().all(|&i| now[i] == ball[i]));
    assert!(others.iter().all(|&i| now[i] == all[i]));
    shared.verify();
    // It is done again although the others went on meanwhile, elsewhere.
    shared.stroke(3, 0.45, 0.55);
    let on = places(&shared);
    shared.asks(1, Command::Redo);
    let again = places(&shared);
    assert!(own.iter().all(|&i| again[i] == first[i]));
    assert!(others.iter().all(|&i| again[i] == on[i]));
    shared.verify();
}

#[test]
fn a_step_under_somebody_elses_is_refused_and_whose_it_is_is_told() {
    let mut shared = Shared::new(1);
    let begin = shared.world.hash();
    shared.stroke(1, 0.5, 0.5);
    let first = shared.world.hash();
    shared.stroke(2, 0.44, 0.5);
    let both = shared.world.hash();
    shared.asks(1, Command::Undo);
    let refusal = |tick, redo, by| Some(UndoRefusal { tick, redo, by });
    assert_eq!(shared.refused(1), refusal(shared.tick, false, 2));
    assert_eq!(shared.world.hash(), both, "nothing is changed");
    shared.asks(2, Command::Undo);
    assert_eq!(shared.world.hash(), first);
    shared.asks(1, Command::Undo);
    assert_eq!(shared.world.hash(), begin);
    // The second person's step builds on the first one's.
    shared.asks(2, Command::Redo);
    assert_eq!(shared.refused(2), refusal(shared.tick, true, 1));
    assert_eq!(shared.world.hash(), begin);
    shared.asks(1, Command::Redo);
    shared.asks(2, Command::Redo);
    assert_eq!(shared.world.hash(), both);
    assert_eq!(shared.refused(2), None);
    // A person without a step undoes nothing, and nobody blocks it.
    shared.asks(3, Command::Undo);
    assert_eq!((shared.refused(3), shared.world.hash()), (None, both));
    shared.verify();
}

#[test]
fn strokes_at_once_are_a_step_of_each_where_they_share_no_page_and_one_of_both_where_they_do() {
    let apart = [(1, Vec2::new(0.4, 0.5)), (3, Vec2::new(0.5, 0.5))];
    let mut shared = Shared::new(1);
    let begin = shared.world.hash();
    shared.strokes(&apart, None);
    assert_eq!(shared.steps().0, 2);
    shared.asks(3, Command::Undo);
    assert_ne!(shared.world.hash(), begin, "the other stroke stays");
    shared.asks(1, Command::Undo);
    assert_eq!(shared.world.hash(), begin);
    // On one place it is one step, which either of them undoes.
    let together = [(1, Vec2::new(0.5, 0.5)), (2, Vec2::new(0.44, 0.5))];
    shared.strokes(&together, None);
    shared.world.show_to(1);
    assert_eq!((shared.world.undo_steps(), shared.steps().0), (1, 2), "both have the one step");
    shared.asks(2, Command::Undo);
    assert_eq!(shared.world.hash(), begin);
}

#[test]
fn who_rests_takes_the_own_strokes_back_one_by_one_while_another_goes_on() {
    let mut shared = Shared::new(1);
    let third = |k: u64| pen(3, true, Vec2::new(0.5, 0.4) + Vec2::splat(0.002) * k as f32);
    // The third draws all the time; the first makes two strokes meanwhile.
    for k in 0..30 {
        let first = pen(1, k % 12 < 8, Vec2::new(0.35 + 0.01 * k as f32, 0.5));
        shared.step(&[first, third(k)], &[]);
    }
    shared.world.show_to(1);
    assert_eq!(shared.world.undo_steps(), 2, "each was closed when it ended");
    shared.verify();
}

#[test]
fn a_stroke_of_somebody_else_goes_on_through_an_undo() {
    // The undo in the middle of the other's stroke, and after it.
    let hashes = [7, 25].map(|when| {
        let mut shared = Shared::new(1);
        shared.stroke(1, 0.4, 0.45);
        for k in 0..30u64 {
            let at = Vec2::new(0.5, 0.4) + Vec2::splat(0.002) * k as f32;
            let undo = of(1, Command::Undo);
            let commands = if k == when { std::slice::from_ref(&undo) } else { &[] };
            shared.step(&[pen(3, k < 20, at)], commands);
        }
        shared.verify();
        shared.world.show_to(1);
        assert_eq!((shared.world.undo_steps(), shared.world.undo_refused()), (0, None));
        shared.world.show_to(3);
        assert_eq!(shared.world.undo_steps(), 1, "the stroke is whole");
        shared.world.hash()
    });
    assert_eq!(hashes[0], hashes[1]);
    // A stroke under way on the same place blocks it.
    let mut shared = Shared::new(1);
    shared.stroke(1, 0.5, 0.5);
    for k in 0..6 {
        shared.step(&[pen(2, true, Vec2::new(0.44 + 0.005 * k as f32, 0.5))], &[]);
    }
    shared.world.show_to(1);
    shared.step(&[], &[of(1, Command::Undo)]);
    assert_eq!(shared.refused(1).map(|r| r.by), Some(2));
    shared.verify();
}

#[test]
fn the_pens_of_one_person_are_lifted_alone() {
    let mut shared = Shared::new(1);
    let both =
        |k: f32| [pen(1, true, Vec2::new(0.4 + 0.01 * k, 0.45)), pen(3, true, Vec2::splat(0.5))];
    (0..5u8).for_each(|k| shared.step(&both(f32::from(k)), &[]));
    shared.world.show_to(2);
    assert_eq!(shared.world.pens_of_others().count(), 2);
    shared.step(&[], &[of(1, Command::LiftAll)]);
    let left: Vec<(u8, bool)> = shared.world.pens_of_others().map(|p| (p.person, p.down)).collect();
    assert_eq!(left, [(3, true)]);
    shared.world.show_to(1);
    assert_eq!(shared.world.undo_steps(), 1);
    shared.world.show_to(3);
    assert_eq!(shared.world.undo_steps(), 0, "it goes on");
    shared.verify();
}

//! What holds for every brush, whatever is set.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use sculptd_clay::Clay;
use sculptd_clay::brush::{
    BrushKind, BrushSettings, Falloff, Grip, MaskAction, Measure, Method, PressureCurve, StampBy,
    TopologySettings,
};
use sculptd_engine::command::{Command, NewClay};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

use super::super::clay::Dice;
use super::{Studio, form};

/// A brush with everything set at random.
pub(super) fn any_brush(dice: &mut Dice) -> BrushSettings {
    let mut pick = |n: usize| ((dice.next() * n as f32) as usize).min(n - 1);
    let kind = BrushKind::ALL[pick(BrushKind::ALL.len())];
    let mut b = sculptd::presets().of(kind);
    b.falloff = Falloff::ALL[pick(Falloff::ALL.len())];
    b.negative = pick(3) == 0;
    b.symmetry = std::array::from_fn(|_| pick(4) == 0);
    b.mirror.radial = 1 + if pick(5) == 0 { pick(4) as u8 } else { 0 };
    b.mirror.plane = if pick(6) == 0 { [1.0, -0.5, 0.3] } else { [0.0; 3] };
    b.saturation = if pick(4) == 0 { 1.0 } else { 0.0 };
    b.auto.front_faces = pick(4) == 0;
    b.auto.topology = pick(4) == 0;
    b.auto.boundary = pick(4) == 0;
    b.auto.normal_degrees = if pick(4) == 0 { 40.0 } else { 0.0 };
    b.auto.cavity = if pick(5) == 0 { 0.7 } else { 0.0 };
    let methods = [
        Method::Space,
        Method::Dots,
        Method::Airbrush,
        Method::Anchored,
        Method::DragDot,
        Method::Line,
        Method::Curve,
    ];
    b.path.method = methods[pick(7)];
    let stamps =
        [StampBy::Off, StampBy::Off, StampBy::Off, StampBy::Dab, StampBy::View, StampBy::Stencil];
    b.stamp.by = stamps[pick(6)];
    b.stamp.repeat = pick(2) == 0;
    b.plane_trim = if pick(4) == 0 { 0.3 } else { 0.0 };
    b.path.continuous = pick(5) == 0;
    b.path.rope = if pick(5) == 0 { 0.04 } else { 0.0 };
    b.path.average = if pick(5) == 0 { 6 } else { 0 };
    b.path.jitter = if pick(4) == 0 { 0.4 } else { 0.0 };
    b.radius = 0.05 + dice.next() * 0.2;
    b.strength = dice.next();
    b.spacing = 0.1 + dice.next() * 0.3;
    b.clamped()
}

pub(super) fn any_stroke(dice: &mut Dice) -> Vec<(Vec2, f32)> {
    let mut at = Vec2::new(0.35 + 0.3 * dice.next(), 0.3 + 0.4 * dice.next());
    (0..6)
        .map(|_| {
            at += Vec2::new(dice.next() - 0.5, dice.next() - 0.5) * 0.1;
            (at, dice.next())
        })
        .collect()
}

#[test]
fn random_strokes_leave_all_in_order_undo_takes_them_back_and_a_second_run_is_equal() {
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 400 } else { 60 };
    let run = move |check: bool, workers: usize| {
        let mut dice = Dice(2024);
        let mut studio = Studio::new(&form(12_000), BrushSettings::default(), workers);
        studio.told = (!check).then(Vec::new);
        let triangles = studio.world.mesh().to_tri().triangles;
        let mut cut = false;
        for round in 0..rounds {
            if round % 60 == 59 {
                // A new work, so that cuts do not pile up, and all steps of one stroke are kept by
                // undo.
                let plain = form(12_000);
                studio.tell(Command::Replace(NewClay::new(Arc::new(plain), false)));
                cut = false;
            }
            let brush = any_brush(&mut dice);
            studio.tell(Command::Brush(brush));
            let before = (studio.world.hash(), studio.world.mesh().undo_steps());
            studio.stroke(&any_stroke(&mut dice));
            if round % 17 == 16 {
                studio.tell(Command::Mask(MaskAction::Clear));
            }
            if !check {
                continue;
            }
            studio.world.verify_invariants().unwrap_or_else(|e| panic!("{round}: {e}\n{brush:?}"));
            cut |= brush.topology.by != Measure::Off;
            assert!(
                cut || studio.world.mesh().to_tri().triangles == triangles,
                "{round}: other triangles"
            );
            let after = (studio.world.hash(), studio.world.mesh().undo_steps());
            let steps = after.1.saturating_sub(before.1);
            for _ in 0..steps {
                studio.tell(Command::Undo);
            }
            assert_eq!(studio.world.hash(), before.0, "{round}: undo\n{brush:?}");
            studio
                .world
                .verify_invariants()
                .unwrap_or_else(|e| panic!("{round}, undone: {e}\n{brush:?}"));
            for _ in 0..steps {
                studio.tell(Command::Redo);
            }
            assert_eq!(studio.world.hash(), after.0, "{round}: redo\n{brush:?}");
            studio
                .world
                .verify_invariants()
                .unwrap_or_else(|e| panic!("{round}, redone: {e}\n{brush:?}"));
        }
        (studio.world.hash(), studio.told)
    };
    let (checked, _) = run(true, 1);
    // Undo and redo leave no trace, nor does another number of workers.
    let (plain, told) = std::thread::spawn(move || run(false, 3)).join().expect("no panic");
    assert_eq!(checked, plain);
    // And a replay of what was written down is what was live.
    let written = postcard::to_stdvec(&told.expect("it was kept")).expect("plain data");
    let told: Vec<super::Told> = postcard::from_bytes(&written).expect("as it was written");
    let mut again = Studio::new(&form(12_000), BrushSettings::default(), 2);
    for (tick, samples, commands) in &told {
        again.world.step(*tick, samples, commands);
    }
    assert_eq!(again.world.hash(), checked, "replay");
}

#[test]
fn no_pressure_moves_nothing_and_no_vertex_outside_the_dab_moves() {
    let start = shapes::icosphere(1.0, 50);
    for kind in BrushKind::ALL {
        let none = PressureCurve { at_zero: 0.0, gamma: 1.0 };
        let firm = PressureCurve { at_zero: 1.0, gamma: 1.0 };
        let brush = BrushSettings {
            radius: 0.1,
            pressure_strength: none,
            pressure_radius: firm,
            // The test identifies vertices by their numbers.
            topology: TopologySettings::default(),
            ..sculptd::presets().of(*kind)
        };
        let mut studio = Studio::new(&start, brush, 1);
        let (a, b) = (Vec2::new(0.48, 0.5), Vec2::new(0.52, 0.5));
        let before = studio.world.hash();
        studio.stroke(&[(a, 0.0), (b, 0.0)]);
        assert_eq!(studio.world.hash(), before, "{kind}");
        // There is neither a mask to blur nor a border to move nor a layer to erase.
        if matches!(kind, BrushKind::MaskBlur | BrushKind::Boundary | BrushKind::EraseLayer) {
            continue;
        }
        studio.stroke(&[(a, 1.0), (b, 1.0)]);
        let end = studio.positions();
        // No dab's middle is off the segment by more than the ball bends over it.
        let radius = studio.world.brush_radius();
        let radii = match kind {
            BrushKind::Elastic => 4.0,
            BrushKind::ClayStrips => std::f32::consts::SQRT_2,
            _ => 1.0,
        };
        let (from, to) = (hit(&start, &studio, a), hit(&start, &studio, b));
        let off = |p: Vec3| {
            let t = ((p - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
            (p - from.lerp(to, t)).length()
        };
        let painted = changed(&studio, end.len());
        let all = end.iter().zip(&start.positions).enumerate();
        let touched = all.filter(|(v, (q, p))| q != p || painted[*v]).map(|(_, (_, p))| *p);
        let widest = touched.map(off).fold(0.0, f32::max) / radius;
        println!("{kind}: {widest:.3} radii of {radii:.3}");
        assert!(widest > 0.1 && widest < radii + 0.05, "{kind}: {widest} radii");
    }
}

/// Returns the point of the initial ball under a view position.
fn hit(start: &TriMesh, studio: &Studio, view: Vec2) -> Vec3 {
    let mesh = Clay::build(start, &Job::default()).expect("builds");
    mesh.pick(studio.world.camera().ray(view)).expect("on the ball").position
}

/// Returns, for each vertex, true if it was masked, coloured or put into a face set.
fn changed(studio: &Studio, count: usize) -> Vec<bool> {
    let (mesh, mut all) = (studio.world.mesh(), vec![false; count]);
    for i in 0..mesh.page_count() as u32 {
        let page = mesh.page(i);
        for k in 0..page.own() {
            let v = page.topology().ids[k] as usize;
            let painted = page.mask(k) != 0.0 || page.colour(k) != [255; 4];
            all[v] = painted || page.face_set(k) != 0;
        }
    }
    all
}

#[test]
fn no_brush_allocates_in_the_steady_state_of_a_stroke() {
    for kind in BrushKind::ALL {
        let mut brush = BrushSettings { radius: 0.1, ..sculptd::presets().of(*kind) };
        // Cutting triangles rebuilds pages, which is no steady state.
        brush.topology.by = Measure::Off;
        brush.auto.topology = true;
        if kind.grip() == Grip::Surface {
            // Faint, so that the surface stays among the pages that it touches.
            brush.strength = 0.002;
        }
        brush.symmetry = [true, false, false];
        let mut studio = Studio::new(&form(30_000), brush, 1);
        let there_and_back = |studio: &mut Studio| {
            for i in 0..40 {
                let x = 0.5 + 0.04 * (i as f32 * std::f32::consts::TAU / 40.0).sin();
                studio.sample(Vec2::new(x, 0.5), 0.7, true);
            }
        };
        // The first rounds touch each page once and fill the pools; a brush that carries the
        // surface along may come upon one more page later. Three rounds in a row must then need
        // nothing.
        let (mut quiet, mut rounds) = (0, 0);
        while quiet < 3 {
            let calls = crate::allocations::counted(|| there_and_back(&mut studio));
            quiet = if calls == 0 { quiet + 1 } else { 0 };
            rounds += 1;
            assert!(rounds < 16, "{kind}: still {calls} calls in round {rounds}");
        }
    }
}

#[test]
fn a_masked_vertex_stays() {
    let start = shapes::icosphere(1.0, 40);
    for kind in BrushKind::ALL {
        let mut studio = Studio::new(&start, sculptd::presets().of(*kind), 1);
        studio.tell(Command::Mask(MaskAction::Fill));
        studio.stroke(&super::s_curve());
        assert!(studio.positions() == start.positions, "{kind}");
    }
}

#[test]
fn the_mask_of_the_whole_work() {
    let start = form(8_000);
    let mut studio = Studio::new(&start, sculptd::presets().of(BrushKind::Mask), 2);
    let sum = |s: &Studio| -> f64 {
        let mesh = s.world.mesh();
        (0..mesh.page_count() as u32)
            .flat_map(|p| (0..mesh.page(p).own()).map(move |v| f64::from(mesh.page(p).mask(v))))
            .sum()
    };
    let all = start.positions.len() as f64;
    studio.stroke(&super::s_curve());
    let painted = sum(&studio);
    assert!(painted > 10.0 && painted < 0.5 * all);
    studio.tell(Command::Mask(MaskAction::Grow));
    let grown = sum(&studio);
    assert!(grown > painted);
    studio.tell(Command::Undo);
    assert_eq!(sum(&studio), painted);
    studio.tell(Command::Mask(MaskAction::Invert));
    assert!((sum(&studio) - (all - painted)).abs() < 1e-3 * all);
    studio.tell(Command::Mask(MaskAction::Clear));
    assert_eq!(sum(&studio), 0.0);
    studio.tell(Command::Mask(MaskAction::Cavity(0.1)));
    assert!(sum(&studio) > 0.0 && sum(&studio) < 0.5 * all);
    studio.world.verify_invariants().expect("in order");
}

#[test]
fn the_method_may_change_in_the_middle_of_a_stroke() {
    let methods = [
        Method::Space,
        Method::Dots,
        Method::Airbrush,
        Method::Anchored,
        Method::DragDot,
        Method::Line,
        Method::Curve,
    ];
    let mut studio = Studio::new(&form(6_000), BrushSettings::default(), 1);
    for kind in [BrushKind::Draw, BrushKind::Grab, BrushKind::SnakeHook] {
        for first in methods {
            for second in methods {
                let of = |method| {
                    let mut b = BrushSettings { radius: 0.1, ..sculptd::presets().of(kind) };
                    b.path.method = method;
                    b
                };
                let before = studio.world.hash();
                let points = super::s_curve();
                studio.tell(Command::Brush(of(first)));
                for &(at, pressure) in &points[..8] {
                    studio.sample(at, pressure, true);
                }
                studio.tell(Command::Brush(of(second)));
                studio.stroke(&points[8..]);
                studio
                    .world
                    .verify_invariants()
                    .unwrap_or_else(|e| panic!("{first:?}, {second:?}: {e}"));
                while studio.world.mesh().undo_steps() > 0 {
                    studio.tell(Command::Undo);
                }
                assert_eq!(studio.world.hash(), before, "{first:?}, {second:?}");
            }
        }
    }
}

//! What holds for every brush, whatever is set.

use glam::{Vec2, Vec3};
use sculptd::brush::{
    BrushKind, BrushSettings, Falloff, Grip, MaskAction, Measure, Method, PressureCurve, Topology,
};
use sculptd::command::Command;
use sculptd::mesh::shapes;

use super::super::clay::Dice;
use super::{Studio, form};

/// A brush with everything set at random.
fn any_brush(dice: &mut Dice) -> BrushSettings {
    let mut pick = |n: usize| ((dice.next() * n as f32) as usize).min(n - 1);
    let kind = BrushKind::ALL[pick(BrushKind::ALL.len())];
    let mut b = BrushSettings::of(kind);
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
    let methods =
        [Method::Space, Method::Dots, Method::Airbrush, Method::Anchored, Method::DragDot, Method::Line];
    b.path.method = methods[pick(6)];
    b.path.continuous = pick(5) == 0;
    b.path.rope = if pick(5) == 0 { 0.04 } else { 0.0 };
    b.path.average = if pick(5) == 0 { 6 } else { 0 };
    b.path.jitter = if pick(4) == 0 { 0.4 } else { 0.0 };
    b.radius = 0.05 + dice.next() * 0.2;
    b.strength = dice.next();
    b.spacing = 0.1 + dice.next() * 0.3;
    b.clamped()
}

fn any_stroke(dice: &mut Dice) -> Vec<(Vec2, f32)> {
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
        let triangles = studio.world.mesh().to_tri().triangles;
        let mut cut = false;
        for round in 0..rounds {
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
            assert!(cut || studio.world.mesh().to_tri().triangles == triangles, "{round}: other triangles");
            let after = (studio.world.hash(), studio.world.mesh().undo_steps());
            let steps = after.1.saturating_sub(before.1);
            for _ in 0..steps {
                studio.tell(Command::Undo);
            }
            assert_eq!(studio.world.hash(), before.0, "{round}: undo\n{brush:?}");
            for _ in 0..steps {
                studio.tell(Command::Redo);
            }
            assert_eq!(studio.world.hash(), after.0, "{round}: redo\n{brush:?}");
        }
        studio.world.hash()
    };
    let checked = run(true, 1);
    // Undo and redo leave no trace, nor does another number of workers.
    assert_eq!(checked, std::thread::spawn(move || run(false, 3)).join().expect("no panic"));
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
            // Vertices are told by their numbers here.
            topology: Topology::default(),
            ..BrushSettings::of(*kind)
        };
        let mut studio = Studio::new(&start, brush, 1);
        let (a, b) = (Vec2::new(0.48, 0.5), Vec2::new(0.52, 0.5));
        let before = studio.world.hash();
        studio.stroke(&[(a, 0.0), (b, 0.0)]);
        assert_eq!(studio.world.hash(), before, "{kind}");
        studio.stroke(&[(a, 1.0), (b, 1.0)]);
        let end = studio.positions();
        // Held brushes reach where they took hold (elastic ones four radii about it), the others along the stroke.
        let radii = if *kind == BrushKind::Elastic { 4.0 } else { 1.5 };
        let reach = studio.world.brush_radius() * radii;
        let segment = |p: Vec3| {
            let (a, b) = (Vec3::new(-0.25, 0.0, 0.97), Vec3::new(0.25, 0.0, 0.97));
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            (p - a.lerp(b, t)).length()
        };
        for (p, q) in start.positions.iter().zip(&end) {
            assert!(p == q || segment(*p) < reach + 0.25, "{kind}: {p} moved");
        }
    }
}

#[test]
fn no_brush_allocates_in_the_steady_state_of_a_stroke() {
    for kind in BrushKind::ALL {
        let mut brush = BrushSettings { radius: 0.1, ..BrushSettings::of(*kind) };
        // Where triangles are cut, pages are built anew: that is no steady state.
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
        // The first rounds touch each page once and fill the pools; a brush that carries the surface along may come upon
        // one more page later. Three rounds in a row must then need nothing.
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
        let mut studio = Studio::new(&start, BrushSettings::of(*kind), 1);
        studio.tell(Command::Mask(MaskAction::Fill));
        studio.stroke(&super::s_curve());
        assert!(studio.positions() == start.positions, "{kind}");
    }
}

#[test]
fn the_mask_of_the_whole_work() {
    let start = form(8_000);
    let mut studio = Studio::new(&start, BrushSettings::of(BrushKind::Mask), 2);
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

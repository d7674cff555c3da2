//! Curves laid by their points, with a pen, before the brush follows them.

use glam::Vec2;
use sculptd_clay::brush::{BrushKind, BrushSettings, Method};
use sculptd_engine::command::Command;
use sculptd_engine::stroke::CurveAction;

use super::{Studio, form};

fn studio(workers: usize) -> Studio {
    let mut brush = BrushSettings { radius: 0.12, ..sculptd::presets().of(BrushKind::Draw) };
    brush.path.method = Method::Curve;
    Studio::new(&form(20_000), brush, workers)
}

/// The pen comes down, moves along, and lifts.
fn pen(s: &mut Studio, points: &[(f32, f32)]) {
    for &(x, y) in points {
        s.sample(Vec2::new(x, y), 0.8, true);
    }
    let (x, y) = points[points.len() - 1];
    s.sample(Vec2::new(x, y), 0.0, false);
    s.rest(1);
}

fn views(s: &Studio) -> Vec<Vec2> {
    s.world.curve_stroke().map(|d| d.points().iter().map(|p| p.view).collect()).unwrap_or_default()
}

fn act(s: &mut Studio, act: CurveAction) {
    s.tell(Command::CurveStroke(act));
    s.rest(3);
    s.world.verify_invariants().expect("in order");
}

/// Four points set one by one, one moved, one put between, one taken away.
fn edited(s: &mut Studio) {
    for at in [(0.4, 0.4), (0.5, 0.45), (0.6, 0.6), (0.55, 0.7)] {
        pen(s, &[at]);
    }
    assert_eq!(views(s).len(), 4);
    pen(s, &[(0.502, 0.452), (0.48, 0.47), (0.46, 0.5)]);
    assert!((views(s)[1] - Vec2::new(0.46, 0.5)).length() < 1e-6);
    let aspect = s.world.camera().aspect;
    let between = s.world.curve_stroke().expect("laid").at(24, aspect).view;
    pen(s, &[(between.x, between.y), (between.x + 0.02, between.y)]);
    assert_eq!(views(s).len(), 5);
    assert!((views(s)[2] - between - Vec2::new(0.02, 0.0)).length() < 1e-6);
    act(s, CurveAction::Delete(4));
    assert_eq!(views(s).len(), 4);
}

#[test]
fn points_stay_to_be_changed_and_the_curve_is_one_step() {
    let mut s = studio(1);
    let start = s.world.hash();
    edited(&mut s);
    let laid: Vec<_> = views(&s);
    assert_eq!(
        (s.world.hash(), s.world.undo_steps()),
        (start, 0),
        "nothing is sculpted while it is laid"
    );
    act(&mut s, CurveAction::Apply);
    let drawn = s.world.hash();
    assert_eq!((views(&s).len(), s.world.undo_steps()), (0, 1));
    assert_ne!(drawn, start);
    // The clay rose along the curve and nowhere else.
    let (before, aspect) = (form(20_000), s.world.camera().aspect);
    let mut curve = sculptd_engine::stroke::CurveStroke::default();
    for view in &laid {
        // At the end each time: off the curve so far.
        curve.grab(
            &sculptd_engine::stroke::PenPoint {
                view: *view,
                pressure: 0.8,
                tilt: None,
                inverted: false,
            },
            aspect,
        );
        curve.release();
    }
    assert_eq!(curve.points().iter().map(|p| p.view).collect::<Vec<_>>(), laid);
    let reach = s.world.brush_radius() / s.world.camera().world_per_view(s.world.camera().distance);
    for (p, q) in before.positions.iter().zip(s.positions()).filter(|(p, q)| *p != q) {
        let seen = s.view(*p);
        let off = |k: usize| ((curve.at(k, aspect).view - seen) * Vec2::new(aspect, 1.0)).length();
        let nearest = (0..=curve.pieces()).map(off).fold(f32::INFINITY, f32::min);
        assert!(nearest < 1.6 * reach, "{nearest} of {reach} off the curve moved from {p} to {q}");
    }
    s.tell(Command::Undo);
    assert_eq!(s.world.hash(), start);
    s.tell(Command::Redo);
    assert_eq!(s.world.hash(), drawn);
    // The same with any number of workers, however small the budget of a tick.
    for workers in [2, 7] {
        let hash = std::thread::scope(|scope| {
            let run = scope.spawn(|| {
                let mut other = studio(workers);
                edited(&mut other);
                act(&mut other, CurveAction::Apply);
                other.world.hash()
            });
            run.join().expect("no panic")
        });
        assert_eq!(hash, drawn);
    }
}

#[test]
fn a_curve_that_is_put_away_leaves_nothing() {
    let mut s = studio(1);
    let start = s.world.hash();
    edited(&mut s);
    act(&mut s, CurveAction::Cancel);
    assert_eq!((views(&s).len(), s.world.undo_steps()), (0, 0));
    // By an undo, which undoes nothing else.
    pen(&mut s, &[(0.4, 0.5), (0.45, 0.52), (0.5, 0.5), (0.6, 0.55)]);
    assert_eq!(views(&s).len(), 5, "what is drawn freely gets handles");
    act(&mut s, CurveAction::Apply);
    let drawn = s.world.hash();
    pen(&mut s, &[(0.4, 0.6)]);
    s.tell(Command::Undo);
    assert_eq!((views(&s).len(), s.world.undo_steps(), s.world.hash()), (0, 1, drawn));
    s.tell(Command::Undo);
    assert_eq!(s.world.hash(), start);
    // By another method, also while the pen is down.
    s.sample(Vec2::new(0.5, 0.5), 0.8, true);
    s.sample(Vec2::new(0.55, 0.5), 0.8, true);
    s.tell(Command::Brush(sculptd::presets().of(BrushKind::Draw)));
    s.sample(Vec2::new(0.6, 0.5), 0.8, true);
    s.sample(Vec2::new(0.6, 0.5), 0.0, false);
    s.rest(2);
    assert_eq!((views(&s).len(), s.world.hash()), (0, start));
    // Acts with nothing laid are no matter.
    for a in [CurveAction::Apply, CurveAction::Cancel, CurveAction::Delete(3)] {
        act(&mut s, a);
    }
    assert_eq!(s.world.hash(), start);
}

#[test]
fn another_brush_may_follow_the_curve_that_is_laid() {
    let mut s = studio(1);
    pen(&mut s, &[(0.4, 0.5), (0.5, 0.45), (0.6, 0.55)]);
    let mut paint = BrushSettings { radius: 0.1, ..sculptd::presets().of(BrushKind::Paint) };
    paint.path.method = Method::Curve;
    s.tell(Command::Brush(paint));
    assert_eq!(views(&s).len(), 5);
    act(&mut s, CurveAction::Apply);
    let mesh = s.world.mesh().to_tri();
    assert_eq!(mesh.positions, form(20_000).positions);
    assert!(mesh.colours.is_some_and(|c| c.iter().any(|c| *c != [255; 4])));
}

//! Fingers on a touch screen, in a real window: one sculpts, two turn the view, three undo.

use glam::DVec2;
use serde_json::Value;

use super::stage::{Stage, pause};
use super::x_server::{Driven, Finger, SCREEN, desktop};

/// Pixels of the screen as a share of it.
fn share(x: f64, y: f64) -> DVec2 {
    DVec2::new(x / f64::from(SCREEN.0), y / f64::from(SCREEN.1))
}

/// Fingers that land 15 ms apart, go each its way in a fifth of a second, and are lifted.
fn go(touch: &mut Driven, ways: &[[(f64, f64); 2]]) {
    for (n, [from, _]) in ways.iter().enumerate() {
        touch.finger(n as u32 + 1, Finger::Begin, share(from.0, from.1));
        pause(15);
    }
    for step in 1..=20 {
        for (n, [from, to]) in ways.iter().enumerate().filter(|w| w.1[0] != w.1[1]) {
            let part = f64::from(step) / 20.0;
            let at = (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part);
            touch.finger(n as u32 + 1, Finger::Move, share(at.0, at.1));
        }
        pause(if ways[0][0] == ways[0][1] { 3 } else { 10 });
    }
    for (n, [_, to]) in ways.iter().enumerate() {
        touch.finger(n as u32 + 1, Finger::End, share(to.0, to.1));
        pause(10);
    }
}

/// Makes a gesture until it is seen. On a stalled machine the second finger may arrive too late for
/// a gesture. The first finger has then sculpted, correctly; the stroke is undone and the gesture
/// made again. A gesture that does neither is lost, and fails.
fn make(s: &mut Stage, touch: &mut Driven, what: &str, gesture: &Gesture<'_>) {
    let before = steps(s);
    for _ in 0..5 {
        go(touch, gesture.ways);
        let mut late = false;
        s.until(what, |s| {
            late = steps(s) > before;
            late || (gesture.done)(s)
        });
        if !late {
            return;
        }
        println!("{what}: the second finger came too late, and the gesture is made again");
        s.ask("undo", &Value::Null);
        s.until("the first finger's stroke is taken back", |s| steps(s) == before);
    }
    panic!("never in time: {what}");
}

/// The ways of its fingers, and what is seen once it was made.
struct Gesture<'a> {
    ways: &'a [[(f64, f64); 2]],
    done: &'a dyn Fn(&Stage) -> bool,
}

fn steps(s: &Stage) -> u64 {
    s.figure("undo_steps")
}

#[test]
fn one_finger_sculpts_two_turn_the_view_and_three_take_back() {
    let Some(mut s) = Stage::on(desktop, "[devices]\nhid = false\n") else { return };
    let mut touch = Driven::connect(&s.dir.path().join("touch.sock"));
    s.seen("fingers-start");
    let camera = |s: &Stage| s.ask("camera", &serde_json::json!({}));
    let number = |camera: &Value, name: &str| camera[name].as_f64().expect("a number");

    let mut marks = Vec::new();
    for n in 1..=3 {
        let dabs = s.figure("dabs");
        let y = 280.0 + 40.0 * n as f64;
        go(&mut touch, &[[(560.0, y), (700.0, y)]]);
        s.until("the finger's stroke has come", |s| steps(s) == n);
        marks.push(s.figure("dabs") - dabs);
    }
    // A whole stroke each time, whatever the frames: no pointer of the system tears it into taps.
    let (least, most) = (marks.iter().min(), marks.iter().max());
    assert!(most.zip(least).is_some_and(|(most, least)| most - least <= 2), "{marks:?}");
    let before = camera(&s);
    // Apart, on the clay: nearer, and nothing is sculpted.
    let ways = &[[(600.0, 360.0), (520.0, 360.0)], [(680.0, 360.0), (760.0, 360.0)]];
    let done = &|s: &Stage| number(&camera(s), "distance") < 0.8 * number(&before, "distance");
    make(&mut s, &mut touch, "the view has come nearer", &Gesture { ways, done });
    let near = camera(&s);
    let ways = &[[(600.0, 330.0), (700.0, 330.0)], [(600.0, 400.0), (700.0, 400.0)]];
    let done = &|s: &Stage| number(&camera(s), "yaw") != number(&near, "yaw");
    make(&mut s, &mut touch, "the view has turned", &Gesture { ways, done });
    assert_eq!(steps(&s), 3, "two fingers sculpt nothing");
    // A tap of three fingers takes the last stroke back.
    let ways = &[(560.0, 300.0), (640.0, 280.0), (720.0, 300.0)].map(|p| [p, p]);
    let done = &|s: &Stage| steps(s) == 2;
    make(&mut s, &mut touch, "the last stroke is taken back", &Gesture { ways, done });
    s.look("fingers-end");
}

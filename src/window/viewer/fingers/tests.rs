//! Simulated touches: strokes come, gestures and palms leave nothing.

use super::*;

/// Numbers from a seed (Marsaglia's xorshift, 2003), 0 to 1.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn between(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.next()
    }

    fn place(&mut self) -> Vec2 {
        Vec2::new(self.between(200.0, 1000.0), self.between(100.0, 700.0))
    }
}

/// A finger that lands, goes from a place by a way in a time, and is lifted.
#[derive(Clone, Copy)]
struct Plan {
    id: u64,
    from_us: u64,
    to_us: u64,
    from: Vec2,
    by: Vec2,
    /// Pixels that it trembles by.
    tremble: f32,
}

/// Reports at 125 Hz, as touch screens send them, and a look at the clock every 16 ms. `pen`: from
/// when to when it is near.
fn play(plans: &[Plan], pen: Option<[u64; 2]>, chance: &mut Chance) -> Vec<FingerAction> {
    let mut fingers = Fingers::default();
    fingers.set_up(1.0, TwoFingers::Turn);
    play_on(&mut fingers, plans, pen, chance)
}

fn play_on(
    fingers: &mut Fingers,
    plans: &[Plan],
    pen: Option<[u64; 2]>,
    chance: &mut Chance,
) -> Vec<FingerAction> {
    let mut out = Vec::new();
    let first = plans.iter().map(|p| p.from_us).min().expect("a finger");
    let start = pen.map_or(first, |p| p[0].min(first)) / 1000;
    let end = plans.iter().map(|p| p.to_us).max().expect("a finger") / 1000 + 700;
    for ms in start..end {
        let t_us = ms * 1000;
        fingers.pen(t_us, pen.is_some_and(|p| (p[0]..p[1]).contains(&t_us)));
        for p in plans {
            let [from, to] = [p.from_us / 1000, p.to_us / 1000];
            let part = (ms.saturating_sub(from)) as f32 / (to - from).max(1) as f32;
            let shake = Vec2::new(chance.between(-1.0, 1.0), chance.between(-1.0, 1.0));
            let at = p.from + p.by * part.min(1.0) + shake * p.tremble;
            let contact = Contact { id: p.id, t_us, at, force: None };
            match ms {
                _ if ms == from => fingers.touch(TouchStep::Down, contact),
                _ if ms == to => fingers.touch(TouchStep::Up, contact),
                _ if ms > from && ms < to && (ms - from) % 8 == 0 => {
                    fingers.touch(TouchStep::Moved, contact);
                }
                _ => {}
            }
        }
        if ms % 16 == 0 {
            fingers.tick(t_us);
        }
        out.extend(fingers.take_actions());
    }
    assert_eq!(fingers.state, State::Idle, "all fingers are lifted");
    out
}

fn presses(actions: &[FingerAction]) -> usize {
    actions.iter().filter(|a| matches!(a, FingerAction::Press(_))).count()
}

#[test]
fn a_thousand_gestures_of_two_and_three_fingers_sculpt_nothing() {
    let mut chance = Chance(0x5EED);
    let mut moved = 0;
    for n in 0..1000u64 {
        let count = 2 + n % 2;
        let (middle, slide) = (chance.place(), chance.place() - Vec2::new(600.0, 400.0));
        let pinch = chance.between(-0.6, 1.5);
        let plans: Vec<Plan> = (0..count)
            .map(|id| {
                let arm = Vec2::from_angle(id as f32 * 2.1 + chance.next()) * 110.0;
                // Fingers of one gesture land up to nine hundredths of a second apart.
                let from_us = 1_000_000 + chance.between(0.0, 90_000.0) as u64;
                let to_us = from_us + chance.between(120_000.0, 900_000.0) as u64;
                let by = slide * 0.5 + arm * pinch;
                Plan { id, from_us, to_us, from: middle + arm, by, tremble: 1.0 }
            })
            .collect();
        let done = play(&plans, None, &mut chance);
        assert_eq!(presses(&done), 0, "gesture {n}: {done:?}");
        moved += usize::from(!done.is_empty());
    }
    assert!(moved > 900, "{moved} of 1000 gestures moved the view");
}

#[test]
fn a_thousand_palms_sculpt_nothing() {
    let mut chance = Chance(0xFA1);
    let mut fingers = Fingers::default();
    fingers.set_up(1.0, TwoFingers::Turn);
    // The pen was here before: a person draws with it.
    fingers.pen(0, true);
    fingers.pen(10_000, false);
    for n in 0..1000u64 {
        let base = 2_000_000 + n * 10_000_000;
        // The hand lies down up to 0.4 s before the pen is near, or later, and stays beyond it.
        let lands = base + chance.between(0.0, 900_000.0) as u64;
        let pen = [base + 400_000, base + 400_000 + chance.between(2e5, 2e6) as u64];
        let place = chance.place();
        let parts = 1 + (chance.next() * 3.0) as u64;
        let plans: Vec<Plan> = (0..parts)
            .map(|i| {
                let off = Vec2::new(chance.between(-70.0, 70.0), chance.between(-40.0, 40.0));
                let from_us = lands + chance.between(0.0, 60_000.0) as u64;
                let to_us = from_us + chance.between(60_000.0, 2_500_000.0) as u64;
                let creeps = Vec2::from_angle(chance.next() * 6.3) * chance.between(0.0, 10.0);
                Plan { id: n * 8 + i, from_us, to_us, from: place + off, by: creeps, tremble: 1.5 }
            })
            .collect();
        let done = play_on(&mut fingers, &plans, Some(pen), &mut chance);
        assert_eq!(presses(&done), 0, "palm {n}: {done:?}");
        assert!(!done.iter().any(|a| matches!(a, FingerAction::Undo)), "palm {n}");
    }
}

#[test]
fn a_thousand_strokes_of_one_finger_come_whole() {
    let mut chance = Chance(7);
    for n in 0..1000u64 {
        let pen_was_here = n % 2 == 1;
        let mut fingers = Fingers::default();
        fingers.set_up(1.0, TwoFingers::Turn);
        if pen_was_here {
            fingers.pen(0, true);
            fingers.pen(1000, false);
        }
        let (from, to) = (chance.place(), chance.place());
        let from_us = 1_000_000;
        let to_us = from_us + chance.between(40_000.0, 900_000.0) as u64;
        // Without a pen a tap is a dab too.
        let far = from.distance(to) > 4.0 * FAR;
        let by = if far || pen_was_here { to - from } else { Vec2::ZERO };
        if pen_was_here && !far {
            continue;
        }
        let plan = Plan { id: n, from_us, to_us, from, by, tremble: 0.5 };
        let done = play_on(&mut fingers, &[plan], None, &mut chance);
        assert_eq!(presses(&done), 1, "stroke {n}");
        assert!(matches!(done[0], FingerAction::Press(c) if c.t_us == from_us), "{:?}", done[0]);
        assert!(matches!(done.last(), Some(FingerAction::Lift(_))), "stroke {n}");
        // Every report is present, in the order of time.
        let times: Vec<u64> = done
            .iter()
            .map(|a| match a {
                FingerAction::Press(c) | FingerAction::Drag(c) | FingerAction::Lift(c) => c.t_us,
                other => panic!("stroke {n}: {other:?}"),
            })
            .collect();
        assert!(times.is_sorted());
        let (first, last) = (from_us / 1000, to_us / 1000);
        let reports = (first + 1..last).filter(|ms| (ms - first) % 8 == 0).count();
        assert!(times.len() > reports, "{} of {reports}", times.len());
    }
}

#[test]
fn three_fingers_tap_to_undo_and_four_to_do_again() {
    let mut chance = Chance(9);
    for (count, wanted) in [(2, None), (3, Some(FingerAction::Undo)), (4, Some(FingerAction::Redo))]
    {
        for _ in 0..100 {
            let plans: Vec<Plan> = (0..count)
                .map(|id| {
                    let from_us = 1_000_000 + chance.between(0.0, 60_000.0) as u64;
                    let to_us = from_us + chance.between(60_000.0, 180_000.0) as u64;
                    Plan { id, from_us, to_us, from: chance.place(), by: Vec2::ZERO, tremble: 1.0 }
                })
                .collect();
            let done = play(&plans, None, &mut chance);
            assert_eq!(done, wanted.into_iter().collect::<Vec<_>>(), "{count} fingers");
        }
    }
    // Held for long they are no tap.
    let held = |id| Plan {
        id,
        from_us: 1_000_000,
        to_us: 2_000_000,
        from: Vec2::new(300.0 + 90.0 * id as f32, 300.0),
        by: Vec2::ZERO,
        tremble: 0.5,
    };
    assert_eq!(play(&[held(0), held(1), held(2)], None, &mut chance), []);
}

#[test]
fn the_view_follows_the_fingers() {
    let mut chance = Chance(3);
    let finger = |id, x: f32, by| Plan {
        id,
        from_us: 1_000_000 + id * 30_000,
        to_us: 1_600_000,
        from: Vec2::new(x, 300.0),
        by,
        tremble: 0.0,
    };
    // Apart to twice the distance: twice as near, about the middle, less what the slop takes.
    let apart = [finger(0, 500.0, Vec2::new(-50.0, 0.0)), finger(1, 600.0, Vec2::new(50.0, 0.0))];
    let done = play(&apart, None, &mut chance);
    let factor: f32 = done
        .iter()
        .map(|a| match a {
            FingerAction::Zoom { factor, about } => {
                assert!(about.distance(Vec2::new(550.0, 300.0)) < 12.0, "{about}");
                *factor
            }
            _ => 1.0,
        })
        .product();
    assert!((1.6..2.01).contains(&factor), "{factor}");
    // Together: a turn; with the other preference, or a third finger, a slide.
    let together = |count: u64| -> Vec<Plan> {
        (0..count).map(|id| finger(id, 400.0 + 80.0 * id as f32, Vec2::new(120.0, 0.0))).collect()
    };
    for (two, count, turns) in [
        (TwoFingers::Turn, 2, true),
        (TwoFingers::Turn, 3, false),
        (TwoFingers::Slide, 2, false),
        (TwoFingers::Slide, 3, true),
    ] {
        let mut fingers = Fingers::default();
        fingers.set_up(1.0, two);
        let done = play_on(&mut fingers, &together(count), None, &mut chance);
        let (mut turned, mut slid) = (0.0, 0.0);
        for action in &done {
            match action {
                FingerAction::Turn(by) => turned += by.x,
                FingerAction::Slide(by) => slid += by.x,
                _ => {}
            }
        }
        let (most, none) = if turns { (turned, slid) } else { (slid, turned) };
        assert!(most > 90.0 && none == 0.0, "{two:?}, {count}: {turned}, {slid}");
    }
}

#[test]
fn a_finger_beside_a_pen_or_just_after_it_is_its_hand() {
    let mut chance = Chance(5);
    let stroke = |from_us: u64| Plan {
        id: 1,
        from_us,
        to_us: from_us + 300_000,
        from: Vec2::new(300.0, 300.0),
        by: Vec2::new(200.0, 60.0),
        tremble: 0.5,
    };
    let pen = Some([500_000, 1_000_000]);
    for from_us in [520_000, 900_000, 1_000_000 + AFTER_PEN_US - 20_000] {
        assert_eq!(play(&[stroke(from_us)], pen, &mut chance), [], "{from_us}");
    }
    // A finger that sculpts is lifted when the pen comes.
    let before = play(&[stroke(300_000)], pen, &mut chance);
    assert_eq!(presses(&before), 1);
    assert!(matches!(before.last(), Some(FingerAction::Lift(c)) if c.t_us <= 500_000));
}

#[test]
fn a_second_finger_that_lands_while_the_window_draws_is_heard_first() {
    let mut fingers = Fingers::default();
    fingers.set_up(1.0, TwoFingers::Turn);
    let contact = |id, t_us, x| Contact { id, t_us, at: Vec2::new(x, 300.0), force: None };
    fingers.touch(TouchStep::Down, contact(1, 0, 400.0));
    // A slow frame: earlier events are delivered at its end, and only then the time.
    let late = 3 * HOLD_US;
    fingers.touch(TouchStep::Moved, contact(1, late, 404.0));
    fingers.touch(TouchStep::Down, contact(2, late, 500.0));
    fingers.tick(late);
    fingers.touch(TouchStep::Moved, contact(2, late + 8_000, 600.0));
    fingers.touch(TouchStep::Moved, contact(2, late + 16_000, 620.0));
    let done = fingers.take_actions();
    assert_eq!(presses(&done), 0, "{done:?}");
    assert!(!done.is_empty());
}

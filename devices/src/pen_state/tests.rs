//! What users of pens report elsewhere, each a test here.

use super::*;

const CFG: PenConfig = PenConfig {
    device: DeviceId(3),
    scale: PenScale {
        min: [0, 0],
        max: [20_000, 10_000],
        area_mm: Vec2::new(200.0, 100.0),
        max_pressure: 1000,
        max_distance: 60,
    },
    silence_us: None,
    contact_silence_us: CONTACT_SILENCE_US,
    tilts: false,
};

/// A pen over the middle, pressed by so many counts, with or without a tip switch.
fn pen(pressure: u32, tip: Option<bool>) -> PenReport {
    PenReport {
        tool: Some(Tool::Pen),
        tip,
        pos: Some([10_000, 5000]),
        pressure: Some(pressure),
        buttons: Some(0),
        ..PenReport::default()
    }
}

/// Returns the output of a state that receives reports 5 ms apart.
fn run(cfg: PenConfig, reports: &[PenReport]) -> Vec<Pen> {
    let mut state = PenState::new(cfg);
    let mut out = Vec::new();
    for (i, r) in reports.iter().enumerate() {
        state.report(r, i as u64 * 5000, &mut |s| out.push(s));
    }
    state.leave(1_000_000, &mut |s| out.push(s));
    out.iter().map(|s| if let Body::Pen(p) = s.body { p } else { unreachable!() }).collect()
}

fn tips(pens: &[Pen]) -> Vec<bool> {
    pens.iter().map(|p| p.tip).collect()
}

#[test]
fn without_a_switch_contact_begins_at_5_percent_and_ends_below_1() {
    let got = run(CFG, &[0, 30, 49, 50, 30, 11, 9, 30, 60].map(|p| pen(p, None)));
    assert_eq!(tips(&got), [false, false, false, true, true, true, false, false, true, false]);
}

#[test]
fn a_switch_decides_alone() {
    let reports =
        [pen(400, Some(false)), pen(0, Some(true)), pen(0, Some(true)), pen(400, Some(false))];
    let got = run(CFG, &reports);
    // Pressure in the air is no click, and a pen-down report without pressure does not cut the
    // stroke.
    assert_eq!(tips(&got), [false, true, true, false, false]);
}

#[test]
fn buttons_are_let_go_and_the_tip_lifts_when_the_pen_leaves() {
    let held = PenReport { buttons: Some(3), ..pen(500, Some(true)) };
    let got = run(CFG, &[held, held]);
    let last = got[2];
    assert_eq!(
        (last.in_range, last.tip, last.buttons, last.pressure),
        (false, false, 0, Some(0.0))
    );
    assert_eq!(last.raw, [10_000, 5000], "it left where it was");
}

#[test]
fn silence_ends_a_visit_of_a_pen_that_never_says_so() {
    let mut state = PenState::new(PenConfig { silence_us: Some(50_000), ..CFG });
    let mut out = Vec::new();
    state.report(&pen(500, Some(true)), 1000, &mut |s| out.push(s));
    state.tick(50_999, &mut |s| out.push(s));
    assert_eq!((out.len(), state.due_us()), (1, Some(51_000)));
    state.tick(60_000, &mut |s| out.push(s));
    let Body::Pen(p) = out[1].body else { unreachable!() };
    assert_eq!(
        (out[1].t_us, p.in_range, p.tip),
        (51_000, false, false),
        "at the end of the silence, not when it was noticed"
    );
    // A late report finds the visit ended before it begins the next.
    state.report(&pen(500, Some(true)), 70_000, &mut |s| out.push(s));
    state.tick(200_000, &mut |s| out.push(s));
    state.report(&pen(500, Some(true)), 200_000, &mut |s| out.push(s));
    let times: Vec<_> = out.iter().map(|s| s.t_us).collect();
    assert_eq!(times, [1000, 51_000, 70_000, 120_000, 200_000]);
}

#[test]
fn pressure_never_leaves_0_to_1() {
    for (counts, share) in [(0, 0.0), (1000, 1.0), (1023, 1.0), (u32::MAX, 1.0)] {
        let got = run(CFG, &[pen(0, None), pen(counts, None)]);
        assert_eq!(got[1].pressure, Some(share), "{counts}");
    }
    let none = PenConfig { scale: PenScale { max_pressure: 0, ..CFG.scale }, ..CFG };
    assert_eq!(run(none, &[pen(5, Some(true))])[0].pressure, None);
}

#[test]
fn full_pressure_in_the_first_report_is_the_last_visits() {
    let got = run(CFG, &[pen(1000, None), pen(20, None), pen(700, None)]);
    assert_eq!(tips(&got), [false, false, true, false]);
    assert_eq!(got[0].pressure, Some(0.0));
    let got = run(CFG, &[pen(1000, Some(true)), pen(1000, Some(true))]);
    assert_eq!(tips(&got), [false, true, false], "held for one report, not for good");
}

#[test]
fn a_worn_pen_that_presses_in_the_air_is_learned() {
    let high = |p| PenReport { distance: Some(50), ..pen(p, None) };
    let low = |p| PenReport { distance: Some(5), ..pen(p, None) };
    let got = run(CFG, &[high(80), low(100), low(120), low(140), low(60), low(85)]);
    // 80 at rest: down at 5 % of what is left, up when it is back at rest; a lower rest is believed
    // at once.
    assert_eq!(tips(&got), [false, false, false, true, false, false, false]);
    let got = run(CFG, &[high(600), low(600)]);
    assert_eq!(tips(&got), [true, true, false], "more than half is a hand");
}

#[test]
fn the_tool_is_decided_at_entry() {
    let eraser = PenReport { tool: Some(Tool::Eraser), ..pen(500, Some(true)) };
    let got = run(CFG, &[pen(500, Some(true)), eraser]);
    let seen: Vec<_> = got.iter().map(|p| (p.tool, p.in_range, p.tip)).collect();
    assert_eq!(
        seen,
        [
            (Tool::Pen, true, true),
            (Tool::Pen, false, false),
            (Tool::Eraser, true, true),
            (Tool::Eraser, false, false)
        ]
    );
    let puck = PenReport { tool: Some(Tool::Mouse), ..pen(1000, Some(true)) };
    assert_eq!(
        tips(&run(CFG, &[puck, puck])),
        [false, false, false],
        "a puck moves, it never presses"
    );
}

#[test]
fn positions_stay_on_the_area_and_nothing_unplaced_comes_out() {
    let at = |x, y| PenReport { pos: Some([x, y]), ..pen(0, None) };
    let got = run(CFG, &[at(-5, 20_000), at(i32::MAX, i32::MIN), at(20_000, 10_000)]);
    assert_eq!((got[0].pos_mm, got[1].pos_mm), (Vec2::new(0.0, 100.0), Vec2::new(200.0, 0.0)));
    assert_eq!(got[2].pos_mm, Vec2::new(200.0, 100.0));
    let nowhere = PenReport { pos: None, ..pen(500, Some(true)) };
    assert!(run(CFG, &[nowhere]).is_empty());
}

#[test]
fn angles_are_wrapped_and_finite() {
    let turned = |twist, tilt| PenReport { twist: Some(twist), tilt: Some(tilt), ..pen(0, None) };
    let got = run(CFG, &[turned(7.0, [120.0, -45.0]), turned(f32::NAN, [0.0, 0.0])]);
    assert!((got[0].twist.unwrap() - (7.0 - std::f32::consts::TAU)).abs() < 1e-5);
    assert_eq!(got[0].tilt, Some(Vec2::new(90f32.to_radians(), -45f32.to_radians())));
    assert_eq!(got[1].twist, got[0].twist, "no number, no news");
}

#[test]
fn a_silent_pen_in_contact_was_pulled_away_from_a_tablet_that_repeats() {
    let mut state = PenState::new(CFG);
    let mut out = Vec::new();
    state.report(&pen(0, Some(false)), 0, &mut |s| out.push(s));
    assert_eq!(state.due_us(), None, "in the air the family's own report is awaited");
    // Reports of a pen that rests, each like the one before.
    for k in 0..=u64::from(REPEATS) {
        state.report(&pen(500, Some(true)), 1_000 + k * 1_000, &mut |s| out.push(s));
    }
    let last = 1_000 + u64::from(REPEATS) * 1_000;
    assert_eq!(state.due_us(), Some(last + CONTACT_SILENCE_US));
    out.drain(2..);
    // Back at once in contact, 20 s later: another visit, so that no line joins the two.
    state.tick(20_000_000, &mut |s| out.push(s));
    state.report(&pen(500, Some(true)), 20_000_000, &mut |s| out.push(s));
    let seen: Vec<_> = out
        .iter()
        .map(|s| if let Body::Pen(p) = s.body { (s.t_us, p.in_range, p.tip) } else { panic!() })
        .collect();
    let left = (last + CONTACT_SILENCE_US, false, false);
    let expected = [(0, true, false), (1_000, true, true), left];
    assert_eq!(seen[..3], expected);
    assert_eq!(seen[3], (20_000_000, true, true));
}

#[test]
fn a_pen_that_rests_on_a_tablet_that_sends_changes_alone_is_not_pulled_away() {
    let at = |x: i32, pressure| PenReport { pos: Some([x, 5000]), ..pen(pressure, Some(true)) };
    let due_after = |reports: &[PenReport]| {
        let mut state = PenState::new(CFG);
        for (i, r) in reports.iter().enumerate() {
            state.report(r, i as u64 * 5000, &mut |_| {});
        }
        state.due_us().map(|due| due - (reports.len() as u64 - 1) * 5000)
    };
    let moving: Vec<PenReport> = (0..20).map(|i| at(10 * i, 600)).collect();
    assert_eq!(due_after(&moving), None, "it may be one that sends changes alone");
    let fast: Vec<PenReport> = (0..20).map(|i| at(40 * i, 600)).collect();
    assert_eq!(due_after(&fast), Some(CONTACT_SILENCE_US), "no pen stops from 80 mm/s at once");
    let mut resting = moving;
    resting.push(at(190, 600));
    assert_eq!(due_after(&resting), None, "one equal report is chance");
    resting.extend([at(190, 600); 8]);
    assert_eq!(due_after(&resting), Some(CONTACT_SILENCE_US), "this tablet repeats itself");
}

#[test]
fn a_pressure_that_is_always_0_is_none() {
    let got = run(CFG, &[pen(0, Some(true)); 8]);
    let none = got.iter().filter(|p| p.tip && p.pressure.is_none()).count();
    assert_eq!(none, 8 - NO_PRESSURE as usize + 1);
    // A pen that had pressure once has it; a report without any is a light touch.
    let mut reports = vec![pen(300, Some(true))];
    reports.extend([pen(0, Some(true)); 8]);
    assert!(run(CFG, &reports).iter().all(|p| p.pressure.is_some()));
    // The next visit knows it at once, and the first pressure takes it back.
    let mut state = PenState::new(CFG);
    let mut out = Vec::new();
    for i in 0..5 {
        state.report(&pen(0, Some(true)), i * 5000, &mut |s| out.push(s));
    }
    state.leave(30_000, &mut |s| out.push(s));
    state.report(&pen(0, Some(true)), 40_000, &mut |s| out.push(s));
    state.report(&pen(40, Some(true)), 45_000, &mut |s| out.push(s));
    let last: Vec<_> = out[6..]
        .iter()
        .map(|s| if let Body::Pen(p) = s.body { p.pressure } else { panic!() })
        .collect();
    assert_eq!(last, [None, Some(0.04)]);
}

#[test]
fn a_button_that_hides_the_tip_is_judged_by_the_resting_pressure() {
    // A selector names one control: none, tip, barrel button. In the air this pen reads 80.
    let hidden = |p| PenReport { buttons: Some(1), ..pen(p, None) };
    let air = pen(80, Some(false));
    let got = run(CFG, &[air, pen(600, Some(true)), hidden(80), air, hidden(80), hidden(85)]);
    assert_eq!(tips(&got), [false, true, false, false, false, false, false]);
    // Pressed during a stroke, the button does not cut it.
    let got = run(CFG, &[air, pen(600, Some(true)), hidden(610), hidden(590), hidden(82)]);
    assert_eq!(tips(&got), [false, true, true, true, false, false]);
}

//! What the simulated devices of the demo do: a pen shapes a form, a hand follows, and a serial pen
//! finishes.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Vec2, vec2, vec3};

use super::hand::{HandKey, HandScript, Performer};
use super::pen::{PenScript, Shape, Stroke};

/// Actions of every simulated device, from the start of the simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal {
    /// On a tablet of [`Journal::area_mm`].
    pub pen: PenScript,
    /// On another of the same size.
    pub serial_pen: PenScript,
    /// Script of the hands over the tracker.
    pub hands: HandScript,
    /// Width and height of the tablets in mm.
    pub area_mm: Vec2,
    /// End of the last script, in microseconds.
    pub duration_us: u64,
}

/// A5, the most common size of tablet, lying across.
const AREA: Vec2 = Vec2::new(210.0, 148.0);

/// About 20 s: 0 to 9 s the pen (ring, wave, spiral, dots), 7 to 15 s the hand (dips in, pinches,
/// makes a fist, leaves), 14 to 20 s the serial pen (two arcs and a smile). They overlap, so that
/// each is seen beside another.
pub fn journal() -> Journal {
    let (pen, serial_pen, hands) = (PenScript::new(pen()), PenScript::new(serial()), hands());
    let duration_us = pen.end_us().max(serial_pen.end_us()).max(hands.end_us());
    Journal { pen, serial_pen, hands, area_mm: AREA, duration_us }
}

fn stroke(from_s: f32, to_s: f32, shape: Shape, pressure: f32, tilt: Vec2) -> Stroke {
    let us = |s: f32| (f64::from(s) * 1e6) as u64;
    Stroke {
        from_us: us(from_s),
        to_us: us(to_s),
        shape,
        pressure,
        tilt,
        eraser: false,
        buttons: 0,
    }
}

fn pen() -> Vec<Stroke> {
    let c = AREA * 0.5;
    let mut all = vec![
        stroke(
            0.3,
            2.3,
            Shape::Turn { centre: c, radius: [34.0, 34.0], angle: [0.0, TAU] },
            0.7,
            vec2(0.3, 0.2),
        ),
        stroke(
            2.6,
            4.2,
            Shape::Wave {
                from: c - vec2(30.0, 0.0),
                to: c + vec2(30.0, 0.0),
                swing: 12.0,
                times: 3.0,
            },
            0.9,
            vec2(-0.2, 0.4),
        ),
        // The other end of the pen takes a little away again.
        Stroke {
            eraser: true,
            ..stroke(
                4.5,
                5.3,
                Shape::Line(c - vec2(24.0, 22.0), c + vec2(24.0, -22.0)),
                0.6,
                Vec2::ZERO,
            )
        },
        stroke(
            6.0,
            7.8,
            Shape::Turn { centre: c, radius: [6.0, 30.0], angle: [0.0, 2.5 * TAU] },
            0.5,
            vec2(0.1, 0.5),
        ),
    ];
    // Taps all around: the shortest contacts there are.
    all.extend((0..8).map(|i| {
        let a = TAU * i as f32 / 8.0;
        let at = c + 40.0 * vec2(a.cos(), a.sin());
        let t = 8.0 + 0.13 * i as f32;
        stroke(t, t + 0.06, Shape::Line(at, at + vec2(0.5, 0.0)), 1.0, Vec2::ZERO)
    }));
    all
}

fn serial() -> Vec<Stroke> {
    let c = AREA * 0.5;
    let eye =
        |x: f32| Shape::Turn { centre: c + vec2(x, -14.0), radius: [5.0, 5.0], angle: [0.0, TAU] };
    vec![
        stroke(14.3, 15.6, eye(-16.0), 0.8, Vec2::ZERO),
        stroke(15.9, 17.2, eye(16.0), 0.8, Vec2::ZERO),
        Stroke {
            buttons: 1,
            ..stroke(
                17.6,
                19.6,
                Shape::Turn { centre: c, radius: [26.0, 26.0], angle: [PI, 0.0] },
                0.6,
                Vec2::ZERO,
            )
        },
    ]
}

fn hands() -> HandScript {
    let s = |s: f32| (f64::from(s) * 1e6) as u64;
    let over = |t: f32, x: f32, y: f32, z: f32| HandKey::flat(s(t), vec3(x, y, z));
    let right = vec![
        over(7.0, 120.0, 330.0, 60.0),
        over(8.0, 40.0, 260.0, 20.0).pointing(),
        // In, along, and out.
        over(9.0, 20.0, 185.0, 0.0).pointing(),
        over(10.2, -25.0, 180.0, -10.0).pointing(),
        over(10.8, -30.0, 250.0, 0.0),
        over(11.3, -30.0, 215.0, 0.0).pinched(1.0),
        over(12.3, 10.0, 240.0, 0.0).pinched(1.0).turned(0.5, 0.1, 0.3),
        over(12.8, 10.0, 240.0, 0.0),
        over(13.3, 0.0, 215.0, 0.0).curled(1.0),
        over(14.0, 0.0, 215.0, 40.0).curled(1.0).turned(0.0, 0.0, FRAC_PI_2 * 0.5),
        over(14.6, 60.0, 280.0, 60.0),
        over(15.2, 160.0, 350.0, 90.0).gone(),
    ];
    let left = vec![
        over(10.5, -160.0, 320.0, 60.0),
        over(11.3, -90.0, 240.0, 0.0),
        over(12.6, -80.0, 225.0, 0.0).turned(-0.3, 0.0, -0.6),
        over(13.4, -170.0, 330.0, 60.0).gone(),
    ];
    HandScript {
        performers: vec![
            Performer { left: false, keys: right },
            Performer { left: true, keys: left },
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_journal_stays_on_its_tablet_and_has_everything_in_it() {
        let j = journal();
        assert!((19_000_000..22_000_000).contains(&j.duration_us));
        let (mut both_hands, mut eraser, mut with_pen) = (0, 0, 0);
        for t in (0..j.duration_us).step_by(5_000) {
            for p in [j.pen.at(t), j.serial_pen.at(t)] {
                assert!(
                    !p.in_range || (p.pos_mm.cmpge(Vec2::ZERO).all() && p.pos_mm.cmple(AREA).all()),
                    "{p:?}"
                );
                assert!((0.0..=1.0).contains(&p.pressure) && (p.tip || p.pressure == 0.0));
            }
            let hands = j.hands.at(t, 0);
            both_hands += usize::from(hands.count == 2);
            eraser += usize::from(j.pen.at(t).tip && j.pen.at(t).eraser);
            with_pen += usize::from(hands.count > 0 && j.pen.at(t).tip);
        }
        assert!(
            both_hands > 100 && eraser > 100 && with_pen > 20,
            "{both_hands} {eraser} {with_pen}"
        );
    }
}

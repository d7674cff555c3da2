//! Where a simulated pen is: a script of strokes, as a pure function of time.

use glam::{Vec2, vec2};

/// Height of the pen over the surface between strokes, as a share of the device's sensing range.
const HOVER: f32 = 0.5;
/// A pause longer than this is spent out of range: the hand rests.
const REST_US: u64 = 1_200_000;
/// A pen comes into range this long before a stroke, and stays this long after it.
const HOVER_US: u64 = 150_000;
/// Pressure rises and falls over this time.
const PRESS_US: u64 = 90_000;

/// A curve on the tablet, in mm from its top left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A straight line from one place to another.
    Line(Vec2, Vec2),
    /// Centre, first and last radius, first and last angle in radians: a circle, an arc or a
    /// spiral.
    Turn {
        /// Centre in mm.
        centre: Vec2,
        /// First and last radius in mm.
        radius: [f32; 2],
        /// First and last angle in radians.
        angle: [f32; 2],
    },
    /// From, to, and a sideways swing of so many mm, so many times.
    Wave {
        /// First place in mm.
        from: Vec2,
        /// Last place in mm.
        to: Vec2,
        /// Amplitude of the sideways swing, in mm.
        swing: f32,
        /// Number of swings.
        times: f32,
    },
}

impl Shape {
    /// The place at `s`, 0 to 1.
    pub fn at(&self, s: f32) -> Vec2 {
        match *self {
            Shape::Line(a, b) => a.lerp(b, s),
            Shape::Turn { centre, radius: [r0, r1], angle: [a0, a1] } => {
                let (r, a) = (r0 + (r1 - r0) * s, a0 + (a1 - a0) * s);
                centre + r * vec2(a.cos(), a.sin())
            }
            Shape::Wave { from, to, swing, times } => {
                let side = (to - from).perp().normalize_or_zero();
                from.lerp(to, s) + side * swing * (s * times * std::f32::consts::TAU).sin()
            }
        }
    }
}

/// One touch of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Time of the tip's contact, in microseconds.
    pub from_us: u64,
    /// Time of the lift, in microseconds.
    pub to_us: u64,
    /// The way of the tip.
    pub shape: Shape,
    /// Between the fading in and out, 0 to 1.
    pub pressure: f32,
    /// Radians, as in [`crate::Pen::tilt`].
    pub tilt: Vec2,
    /// The eraser and not the tip.
    pub eraser: bool,
    /// Barrel buttons held down during the stroke.
    pub buttons: u32,
}

/// A pen at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PenPose {
    /// The tablet senses the pen.
    pub in_range: bool,
    /// The tip touches.
    pub tip: bool,
    /// The eraser points down.
    pub eraser: bool,
    /// Place in mm from the top left.
    pub pos_mm: Vec2,
    /// 0 to 1; 0 without contact.
    pub pressure: f32,
    /// Radians, as in [`crate::Pen::tilt`].
    pub tilt: Vec2,
    /// Of the range that the device can sense, 0 on the surface.
    pub height: f32,
    /// Barrel buttons, bit 0 the lower one.
    pub buttons: u32,
}

/// Strokes in order of time, none overlapping another.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PenScript {
    strokes: Vec<Stroke>,
}

impl PenScript {
    /// Sorts the strokes; one that begins before its predecessor's end is left out.
    pub fn new(mut strokes: Vec<Stroke>) -> Self {
        strokes.sort_by_key(|s| s.from_us);
        let mut kept: Vec<Stroke> = Vec::with_capacity(strokes.len());
        for s in strokes {
            if s.to_us > s.from_us && kept.last().is_none_or(|k| s.from_us >= k.to_us) {
                kept.push(s);
            }
        }
        PenScript { strokes: kept }
    }

    /// The same on a surface of another size: as large as fits, in its middle.
    pub fn fitted(&self, from_mm: Vec2, to_mm: Vec2) -> Self {
        let k = (to_mm / from_mm).min_element();
        let at = |p: Vec2| to_mm * 0.5 + (p - from_mm * 0.5) * k;
        let mut out = self.clone();
        for s in &mut out.strokes {
            s.shape = match s.shape {
                Shape::Line(a, b) => Shape::Line(at(a), at(b)),
                Shape::Turn { centre, radius, angle } => {
                    Shape::Turn { centre: at(centre), radius: radius.map(|r| r * k), angle }
                }
                Shape::Wave { from, to, swing, times } => {
                    Shape::Wave { from: at(from), to: at(to), swing: swing * k, times }
                }
            };
        }
        out
    }

    /// The strokes, in order of time.
    pub fn strokes(&self) -> &[Stroke] {
        &self.strokes
    }

    /// Returns the time at which the pen has left for good.
    pub fn end_us(&self) -> u64 {
        self.strokes.last().map_or(0, |s| s.to_us + HOVER_US + 1)
    }

    /// The pen at `t_us`.
    pub fn at(&self, t_us: u64) -> PenPose {
        let next = self.strokes.partition_point(|s| s.to_us <= t_us);
        if let Some(s) = self.strokes.get(next)
            && s.from_us <= t_us
        {
            return touching(s, t_us);
        }
        let (before, after) =
            (next.checked_sub(1).map(|i| &self.strokes[i]), self.strokes.get(next));
        hovering(before, after, t_us)
    }
}

fn touching(s: &Stroke, t_us: u64) -> PenPose {
    let share = (t_us - s.from_us) as f32 / (s.to_us - s.from_us) as f32;
    let edge = (t_us - s.from_us).min(s.to_us - t_us) as f32 / PRESS_US as f32;
    // A sixth of the pressure at once: a pen is on the surface before it is pressed.
    let pressure = s.pressure * (0.17 + 0.83 * smooth(edge));
    PenPose {
        in_range: true,
        tip: true,
        eraser: s.eraser,
        pos_mm: s.shape.at(smooth(share)),
        pressure,
        tilt: s.tilt,
        height: 0.0,
        buttons: s.buttons,
    }
}

fn hovering(before: Option<&Stroke>, after: Option<&Stroke>, t_us: u64) -> PenPose {
    let since = before.map_or(u64::MAX, |b| t_us - b.to_us);
    let until = after.map_or(u64::MAX, |a| a.from_us - t_us);
    let one_visit = before
        .zip(after)
        .is_some_and(|(b, a)| a.from_us - b.to_us <= REST_US && a.eraser == b.eraser);
    let in_range = one_visit || since < HOVER_US || until <= HOVER_US;
    let (from, to) = (before.map(|b| b.shape.at(1.0)), after.map(|a| a.shape.at(0.0)));
    let share = if one_visit { since as f32 / (since + until) as f32 } else { 0.0 };
    let pos_mm = match (from, to) {
        (Some(f), Some(t)) if one_visit => f.lerp(t, smooth(share)),
        (Some(f), _) if since < HOVER_US => f,
        (_, Some(t)) if until <= HOVER_US => t,
        (Some(f), _) => f,
        _ => Vec2::ZERO,
    };
    let nearest = if since < until { before } else { after };
    let lift = smooth(since.min(until) as f32 / HOVER_US as f32);
    PenPose {
        in_range,
        pos_mm,
        eraser: nearest.is_some_and(|s| s.eraser),
        tilt: nearest.map_or(Vec2::ZERO, |s| s.tilt),
        height: HOVER * lift,
        ..PenPose::default()
    }
}

/// From 0 to 1 with no jerk at the ends; clamped.
pub(super) fn smooth(s: f32) -> f32 {
    let s = s.clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_touches_hovers_rests_and_leaves() {
        let stroke = |from_us, to_us| Stroke {
            from_us,
            to_us,
            shape: Shape::Line(vec2(10.0, 10.0), vec2(20.0, 10.0)),
            pressure: 0.8,
            tilt: Vec2::ZERO,
            eraser: false,
            buttons: 0,
        };
        let s = PenScript::new(vec![
            stroke(4_000_000, 5_000_000),
            stroke(1_000_000, 2_000_000),
            stroke(1_500_000, 3_000_000),
        ]);
        assert_eq!(s.strokes().len(), 2, "overlap is left out");
        for (t, in_range, tip) in [
            (0, false, false),
            (900_000, true, false),
            (1_500_000, true, true),
            (2_100_000, true, false),
            (3_000_000, false, false),
            (4_500_000, true, true),
            (s.end_us(), false, false),
        ] {
            let p = s.at(t);
            assert_eq!((p.in_range, p.tip), (in_range, tip), "at {t}");
        }
        assert_eq!(s.at(1_500_000).pressure, 0.8);
        assert!((s.at(1_500_000).pos_mm - vec2(15.0, 10.0)).length() < 1e-3);
    }
}

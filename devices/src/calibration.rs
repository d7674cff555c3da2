//! What a person sets for one tablet: the active area, its rotation, and a pressure curve.
//!
//! Settings are stored by the device's serial number, so that two tablets of one model have their
//! own; where a device has no serial number, by its name.

use std::collections::BTreeMap;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Vec2, vec2};
use serde::{Deserialize, Serialize};

use crate::sample::{Body, Pen, Sample};

/// The smallest side of an active area, in mm: less than a fingertip is a slip of the hand in a
/// config file.
const LEAST_SIDE: f32 = 5.0;

/// Everything a person may set for one tablet. The default changes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Calibration {
    /// The part of the tablet that counts: left, top, width, height in mm. Beyond it the pen is at
    /// its edge.
    pub area_mm: Option<[f32; 4]>,
    /// Quarter turns clockwise by which the tablet lies turned, 0 to 3.
    pub quarter_turns: u8,
    /// The tablet lies with its keys to the right: half a turn, on top of `quarter_turns`.
    pub left_handed: bool,
    /// Width over height of what is drawn on. The area is cut to it, about its middle, so that a
    /// circle stays a circle.
    pub lock_aspect: Option<f32>,
    /// Pressure curve. The default changes nothing.
    pub pressure: PressureCurve,
}

/// From the pen's pressure to the hand's intent: nothing up to `start`, all from `full` on, bent by
/// `gamma` in between.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PressureCurve {
    /// 0 to less than `full`.
    pub start: f32,
    /// Up to 1.
    pub full: f32,
    /// Above 1 a light hand gets finer steps, below 1 a heavy one.
    pub gamma: f32,
}

impl Default for PressureCurve {
    fn default() -> Self {
        PressureCurve { start: 0.0, full: 1.0, gamma: 1.0 }
    }
}

/// All tablets' settings, by serial number, ids, model or port.
pub type Calibrations = BTreeMap<String, Calibration>;

/// The setting of the first of a tablet's names that has one: its serial number first, what it
/// shares with others last.
pub fn find<'a>(all: &Calibrations, names: impl IntoIterator<Item = &'a str>) -> Calibration {
    names.into_iter().find_map(|n| all.get(n)).copied().unwrap_or_default()
}

/// A setting that makes no sense; the text names it and says what is expected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct CalibrationError(String);

impl PressureCurve {
    /// `pressure` and the result in 0..1; rising, 0 stays 0 and 1 stays 1.
    pub fn apply(&self, pressure: f32) -> f32 {
        let span = (self.full - self.start).max(f32::EPSILON);
        ((pressure - self.start) / span).clamp(0.0, 1.0).powf(self.gamma)
    }
}

impl Calibration {
    /// Checks that every figure is valid; the error names the one that is not.
    ///
    /// # Errors
    /// A figure that is not finite, an area without size, a curve that does not rise.
    pub fn check(&self) -> Result<(), CalibrationError> {
        let fail = |what: String| Err(CalibrationError(what));
        if let Some([x, y, w, h]) = self.area_mm
            && !([x, y].iter().all(|v| (0.0..5000.0).contains(v))
                && [w, h].iter().all(|v| (LEAST_SIDE..5000.0).contains(v)))
        {
            return fail(format!(
                "area_mm = [{x}, {y}, {w}, {h}]: expected left and top from 0, sides from \
                 {LEAST_SIDE} mm"
            ));
        }
        if self.quarter_turns > 3 {
            return fail(format!("quarter_turns = {}: expected 0 to 3", self.quarter_turns));
        }
        if let Some(a) = self.lock_aspect.filter(|a| !(0.1..=10.0).contains(a)) {
            return fail(format!("lock_aspect = {a}: expected 0.1 to 10"));
        }
        let PressureCurve { start, full, gamma } = self.pressure;
        let rises = (0.0..1.0).contains(&start) && full > start && full <= 1.0;
        if !(rises && (0.1..=10.0).contains(&gamma)) {
            return fail(format!(
                "pressure = start {start}, full {full}, gamma {gamma}: expected 0 <= start < \
                 full <= 1 and gamma from 0.1 to 10"
            ));
        }
        Ok(())
    }

    /// Nothing is set.
    pub fn is_plain(&self) -> bool {
        *self == Calibration::default()
    }

    /// Brings a sample from the tablet's own frame to the person's. Hands and keys are left as they
    /// are.
    pub fn apply(&self, sample: &mut Sample) {
        if let Body::Pen(pen) = &mut sample.body {
            self.pen(pen);
        }
    }

    fn pen(&self, pen: &mut Pen) {
        let (origin, size) = self.part(pen.area_mm);
        let local = (pen.pos_mm - origin).clamp(Vec2::ZERO, size);
        let turns = (self.quarter_turns + if self.left_handed { 2 } else { 0 }) % 4;
        // The tablet lies turned clockwise, so what it calls right is the person's down: each place
        // turns along.
        let turn = |v: Vec2| match turns {
            0 => v,
            1 => vec2(-v.y, v.x),
            2 => -v,
            _ => vec2(v.y, -v.x),
        };
        let turned = turn(local - size * 0.5);
        pen.area_mm = turn(size).abs();
        pen.pos_mm = (turned + pen.area_mm * 0.5).clamp(Vec2::ZERO, pen.area_mm);
        pen.tilt = pen.tilt.map(turn);
        pen.twist = pen.twist.map(|t| (t + FRAC_PI_2 * f32::from(turns) + PI).rem_euclid(TAU) - PI);
        pen.pressure = pen.pressure.map(|p| self.pressure.apply(p));
    }

    /// The part of the tablet that counts: its top left corner and its size, in the tablet's own
    /// frame.
    fn part(&self, whole: Vec2) -> (Vec2, Vec2) {
        let (mut origin, mut size) = (Vec2::ZERO, whole);
        if let Some([x, y, w, h]) = self.area_mm {
            origin = vec2(x, y).clamp(Vec2::ZERO, whole);
            size = vec2(w, h).min(whole - origin).max(Vec2::splat(LEAST_SIDE).min(whole));
            origin = origin.min(whole - size);
        }
        if let Some(aspect) = self.lock_aspect {
            // The screen is upright; on a rotated tablet its width is the tablet's height.
            let aspect = if self.quarter_turns % 2 == 1 { 1.0 / aspect } else { aspect };
            let cut = vec2(size.x.min(size.y * aspect), size.y.min(size.x / aspect));
            origin += (size - cut) * 0.5;
            size = cut;
        }
        (origin, size)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::sample::DeviceId;

    fn at(c: &Calibration, x: f32, y: f32) -> Pen {
        let pen = Pen {
            pos_mm: vec2(x, y),
            area_mm: vec2(200.0, 100.0),
            pressure: Some(0.5),
            tilt: Some(vec2(0.5, 0.0)),
            twist: Some(3.0),
            ..Pen::default()
        };
        let mut s =
            Sample { device: DeviceId(0), t_us: 0, device_t_us: None, body: Body::Pen(pen) };
        c.apply(&mut s);
        let Body::Pen(pen) = s.body else { panic!() };
        pen
    }

    #[test]
    fn nothing_set_changes_nothing() {
        let p = at(&Calibration::default(), 30.0, 40.0);
        assert_eq!(
            (p.pos_mm, p.area_mm, p.pressure, p.tilt),
            (vec2(30.0, 40.0), vec2(200.0, 100.0), Some(0.5), Some(vec2(0.5, 0.0)))
        );
        assert!(Calibration::default().is_plain());
    }

    #[test]
    fn turned_tablets_turn_places_tilt_and_twist() {
        let c = Calibration { quarter_turns: 1, ..Calibration::default() };
        let p = at(&c, 0.0, 0.0);
        assert_eq!(
            (p.area_mm, p.pos_mm),
            (vec2(100.0, 200.0), vec2(100.0, 0.0)),
            "its top left is the person's top right"
        );
        assert_eq!(p.tilt, Some(vec2(0.0, 0.5)), "leaning right became leaning toward the person");
        assert!((p.twist.unwrap() - (3.0 + FRAC_PI_2 - TAU)).abs() < 1e-5);
        let left = Calibration { left_handed: true, ..Calibration::default() };
        assert_eq!(at(&left, 10.0, 20.0).pos_mm, vec2(190.0, 80.0));
        let both = Calibration { quarter_turns: 3, left_handed: true, ..Calibration::default() };
        assert_eq!(
            at(&both, 10.0, 20.0).pos_mm,
            at(&c, 10.0, 20.0).pos_mm,
            "three and two quarters are one"
        );
    }

    #[test]
    fn a_part_of_the_tablet_and_its_edge() {
        let c = Calibration { area_mm: Some([50.0, 20.0, 100.0, 50.0]), ..Calibration::default() };
        assert_eq!(
            (at(&c, 60.0, 30.0).pos_mm, at(&c, 60.0, 30.0).area_mm),
            (vec2(10.0, 10.0), vec2(100.0, 50.0))
        );
        assert_eq!(at(&c, 0.0, 99.0).pos_mm, vec2(0.0, 50.0));
        let square = Calibration { lock_aspect: Some(1.0), ..Calibration::default() };
        assert_eq!(
            (at(&square, 100.0, 50.0).pos_mm, at(&square, 1.0, 1.0).area_mm),
            (vec2(50.0, 50.0), vec2(100.0, 100.0))
        );
    }

    #[test]
    fn a_config_reads_by_serial_number_and_nonsense_is_named() {
        let text = "[\"7AB01\"]\nquarter_turns = 2\n[\"7AB01\".pressure]\nstart = 0.1\n\
                    full = 0.8\n[\"Wacom One\"]\nleft_handed = true\n";
        let all: Calibrations = toml::from_str(text).unwrap();
        assert_eq!(find(&all, ["7AB01", "Wacom One"]).quarter_turns, 2);
        assert!(find(&all, ["other", "Wacom One"]).left_handed);
        assert!(find(&all, ["another"]).is_plain());
        assert!(
            toml::from_str::<Calibrations>("[a]\nrotation = 1\n")
                .unwrap_err()
                .to_string()
                .contains("rotation")
        );
        let bad = [
            Calibration { quarter_turns: 4, ..Calibration::default() },
            Calibration { area_mm: Some([0.0, 0.0, 0.0, 10.0]), ..Calibration::default() },
            Calibration { area_mm: Some([f32::NAN, 0.0, 10.0, 10.0]), ..Calibration::default() },
            Calibration { lock_aspect: Some(-1.0), ..Calibration::default() },
            Calibration {
                pressure: PressureCurve { start: 0.5, full: 0.4, gamma: 1.0 },
                ..Calibration::default()
            },
        ];
        assert!(bad.iter().all(|c| c.check().is_err()) && Calibration::default().check().is_ok());
    }

    proptest! {
        #[test]
        fn the_pen_stays_on_its_area_and_pressure_in_its_range(
            x in 0f32..=200.0, y in 0f32..=100.0, turns in 0u8..4, left: bool,
            area in prop::option::of([0f32..300.0, 0f32..300.0, 5f32..300.0, 5f32..300.0]),
            aspect in prop::option::of(0.1f32..10.0), start in 0f32..0.5, full in 0.6f32..1.0,
            gamma in 0.1f32..10.0,
        ) {
            let pressure = PressureCurve { start, full, gamma };
            let c = Calibration {
                area_mm: area,
                quarter_turns: turns,
                left_handed: left,
                lock_aspect: aspect,
                pressure,
            };
            prop_assert!(c.check().is_ok());
            let p = at(&c, x, y);
            let (low, high) = (Vec2::ZERO, p.area_mm);
            prop_assert!(p.pos_mm.cmpge(low).all() && p.pos_mm.cmple(high).all(), "{:?}", p);
            prop_assert!((0.0..=1.0).contains(&p.pressure.unwrap()));
            prop_assert!(p.area_mm.min_element() > 0.0);
            prop_assert_eq!((pressure.apply(0.0), pressure.apply(1.0)), (0.0, 1.0));
        }
    }
}

//! The state of a pen, the same for every family: proximity, contact, tool, buttons.
//!
//! Rules:
//! * Every visit ends: by a report, by silence (in the air only in families that send no such
//!   report, in contact in all of them), or by unplugging.
//! * Hover never presses; a contact ends before or with its visit; buttons let go when the pen
//!   leaves.
//! * The tool is decided as the pen enters. A change of tool within a visit ends it and begins
//!   another.
//! * Pressure is clamped to 0..1; nothing wraps. A pen whose tip touches and whose pressure has
//!   never been anything but 0 has none.

use glam::Vec2;

use crate::pressure_use::PressureUse;
use crate::report::PenReport;
use crate::sample::{Body, DeviceId, Pen, Sample, Tool};

/// Contact begins at this share of the pressure range where there is no tip switch (libinput's
/// figures).
const DOWN: f32 = 0.05;
/// ... and ends below this one.
const UP: f32 = 0.01;
/// A rest pressure above this is a hand pressing, not a worn pen.
const MOST_OFFSET: f32 = 0.5;

/// Microseconds of silence after which a pen in contact was pulled away. The figure is libinput's.
/// The rule applies where the pen cannot be resting: on tablets that repeat the reports of a
/// resting pen, and after a movement faster than `TOO_FAST_TO_REST`. Other tablets send only
/// changes, and recordings of them have pens that press for seconds without a report.
pub const CONTACT_SILENCE_US: u64 = 50_000;
/// No pen stops from this speed without slower reports in between, mm/s. In recordings of tablets
/// that send only changes, pens that came to rest had at most 22 mm/s in the last report.
const TOO_FAST_TO_REST: f32 = 60.0;
/// Interval of the fastest common tablets, about 500 reports a second, in microseconds.
const LEAST_INTERVAL_US: u64 = 2_000;
/// Repeated reports that prove a tablet to repeat them; a chance one proves nothing.
const REPEATS: u32 = 8;
/// Reports in contact without pressure that prove a pen to have none, if it never had any.
const NO_PRESSURE: u32 = 4;

/// Part of an axis by which a pen at the edge may be beyond it.
const EDGE_SHARE: i64 = 100;
/// Reports above the stated full pressure that prove it wrong; fewer are taken for noise.
const PROOF: u32 = 3;
/// Counts above this are noise and no pressure: no pen has more than 16 bits.
const MOST_PRESSURE: u32 = 0xffff;

/// Configuration for the model's pen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PenConfig {
    /// Device id of the samples.
    pub device: DeviceId,
    /// Scale of its counts.
    pub scale: PenScale,
    /// Microseconds of silence after which the pen has left; `None` where a report always says it.
    pub silence_us: Option<u64>,
    /// Microseconds of silence after which a pen in contact has left, whatever its family says.
    pub contact_silence_us: u64,
    /// The family always reports tilt: it is 0 until the first report.
    pub tilts: bool,
}

/// Units of the counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PenScale {
    /// First and last count of the active area.
    pub min: [i32; 2],
    /// Last count of the active area.
    pub max: [i32; 2],
    /// Width and height of the active area in mm.
    pub area_mm: Vec2,
    /// 0: the device has no pressure.
    pub max_pressure: u32,
    /// 0: unknown or none.
    pub max_distance: u32,
}

/// One pen on one device.
#[derive(Debug, Clone)]
pub struct PenState {
    cfg: PenConfig,
    pen: Pen,
    last_us: u64,
    /// The first report of a visit is held back from pressing: its pressure is often the last
    /// visit's.
    fresh: bool,
    /// The rest pressure of a worn pen, as a share.
    offset: f32,
    /// The tip switch of this report, if it has one.
    switch: Option<bool>,
    /// Pressure while the tip switch last said that nothing touches, as a share. A report that
    /// hides the switch behind a button is judged by what is above it.
    resting: f32,
    /// Reports in contact that were equal to the one before.
    repeats: u32,
    /// The last report in contact moved the pen faster than [`TOO_FAST_TO_REST`].
    fast: bool,
    /// Reports in contact without pressure, while the pen never had any.
    unpressed: u32,
    /// The pen has had pressure.
    pressed: bool,
    /// Reports above the stated full pressure, and the highest of them.
    over: (u32, u32),
    /// Full pressure as reports have proved it, where it is more than the stated one.
    proved_pressure: u32,
    /// Positions outside the area or pressures above the stated maximum, and all positions.
    outside: (u64, u64),
    pressure_use: PressureUse,
}

impl PenState {
    /// A pen out of range.
    pub fn new(cfg: PenConfig) -> Self {
        let pressure = (cfg.scale.max_pressure > 0).then_some(0.0);
        let tilt = cfg.tilts.then_some(Vec2::ZERO);
        let pen = Pen { area_mm: cfg.scale.area_mm, pressure, tilt, ..Pen::default() };
        PenState {
            cfg,
            pen,
            last_us: 0,
            fresh: true,
            offset: 0.0,
            switch: None,
            resting: 0.0,
            repeats: 0,
            fast: false,
            unpressed: 0,
            pressed: false,
            over: (0, 0),
            proved_pressure: 0,
            outside: (0, 0),
            pressure_use: PressureUse::default(),
        }
    }

    /// Returns true if the pen is in proximity.
    pub fn in_range(&self) -> bool {
        self.pen.in_range
    }

    /// Positions outside the area or pressures above the stated maximum, and all positions.
    pub fn outside(&self) -> (u64, u64) {
        self.outside
    }

    /// Returns how the pen has used its pressure range so far.
    pub fn pressure_use(&self) -> PressureUse {
        self.pressure_use
    }

    /// Only a firmware's reports show whether it says when the pen leaves.
    pub fn set_silence(&mut self, silence_us: Option<u64>) {
        self.cfg.silence_us = silence_us;
    }

    /// Another report of the same device has other ranges; a visit does not go from one to the
    /// other.
    pub fn set_scale(&mut self, scale: PenScale, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        if scale != self.cfg.scale {
            self.leave(t_us, emit);
            self.cfg.scale = scale;
            self.pen.area_mm = scale.area_mm;
            self.pen.pressure = (scale.max_pressure > 0).then_some(0.0);
        }
    }

    /// Returns the time at which silence will end the visit.
    pub fn due_us(&self) -> Option<u64> {
        let ends = self.pen.tip && (self.fast || self.repeats >= REPEATS);
        let contact = ends.then_some(self.cfg.contact_silence_us);
        let silence = [self.cfg.silence_us, contact].into_iter().flatten().min()?;
        self.pen.in_range.then(|| self.last_us.saturating_add(silence))
    }

    /// Ends the visit if the pen has been silent for too long. The sample's time is when the
    /// silence was over.
    pub fn tick(&mut self, now_us: u64, emit: &mut dyn FnMut(Sample)) {
        if let Some(due) = self.due_us().filter(|&due| due <= now_us) {
            self.leave(due, emit);
        }
    }

    /// The pen left, or its device was unplugged.
    pub fn leave(&mut self, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.switch = None;
        self.resting = 0.0;
        self.fresh = true;
        if !self.pen.in_range {
            return;
        }
        let p = &mut self.pen;
        p.in_range = false;
        p.tip = false;
        p.buttons = 0;
        p.distance = None;
        p.pressure = p.pressure.map(|_| 0.0);
        self.emit(t_us, emit);
        // The next visit may be another pen's.
        self.pen.tilt = self.pen.tilt.map(|_| Vec2::ZERO);
        self.pen.twist = self.pen.twist.map(|_| 0.0);
        self.offset = 0.0;
    }

    /// A report of a pen in range. A reader that stalled is no silent pen: the caller knows which,
    /// and calls [`PenState::tick`] first where the time since the last report was silence.
    pub fn report(&mut self, r: &PenReport, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        if let Some(tool) = r.tool {
            if self.pen.in_range && tool != self.pen.tool {
                self.leave(t_us, emit);
            }
            self.pen.tool = tool;
        }
        let entering = !self.pen.in_range;
        if entering && r.pos.is_none() {
            return; // Its position is not known.
        }
        let (before, before_us) = (self.pen, self.last_us);
        self.pen.in_range = true;
        self.last_us = t_us;
        self.count_outside(r);
        self.place(r);
        if let Some(d) = r.distance {
            self.pen.distance = Some(d as f32);
        }
        if let Some(b) = r.buttons {
            self.pen.buttons = b;
        }
        self.switch = r.tip;
        self.press(r, entering);
        self.rest_since(&before, t_us.saturating_sub(before_us));
        let maximum = self.cfg.scale.max_pressure.max(self.proved_pressure);
        self.pressure_use.take(r.pressure, self.pen.tip, maximum);
        self.fresh = false;
        self.emit(t_us, emit);
    }

    /// Records whether silence after this report can mean that the pen rests.
    fn rest_since(&mut self, before: &Pen, took_us: u64) {
        let both = before.tip && self.pen.tip;
        self.repeats += u32::from(both && took_us > 0 && *before == self.pen);
        let moved_mm = self.pen.pos_mm.distance(before.pos_mm);
        // Reports that were read together seem to lie less than their interval apart.
        let took_us = took_us.max(LEAST_INTERVAL_US);
        self.fast = both && moved_mm > TOO_FAST_TO_REST * took_us as f32 * 1e-6;
    }

    fn count_outside(&mut self, r: &PenReport) {
        let PenScale { min, max, max_pressure, .. } = self.cfg.scale;
        if let Some(pos) = r.pos {
            // A pen at the edge may be a little beyond it.
            let beyond = |i: usize| {
                let slack = (i64::from(max[i]) - i64::from(min[i])) / EDGE_SHARE;
                let at = i64::from(pos[i]);
                at < i64::from(min[i]) - slack || at > i64::from(max[i]) + slack
            };
            let over = max_pressure > 0 && r.pressure.is_some_and(|p| p > max_pressure);
            self.outside.0 += u64::from(beyond(0) || beyond(1) || over);
            self.outside.1 += 1;
        }
    }

    /// Counts at full pressure: as stated, or as reports have proved it. A vendor's figure is wrong
    /// more often than a pen's: counts above it show the next power of two to be the true one.
    fn full_pressure(&mut self, counts: u32) -> u32 {
        let stated = self.cfg.scale.max_pressure;
        if counts > stated && counts <= MOST_PRESSURE {
            self.over = (self.over.0 + 1, self.over.1.max(counts));
            if self.over.0 >= PROOF {
                self.proved_pressure = self.over.1.next_power_of_two() - 1;
            }
        }
        stated.max(self.proved_pressure)
    }

    fn place(&mut self, r: &PenReport) {
        let p = &mut self.pen;
        if let Some(pos) = r.pos {
            p.raw = pos;
            let axis = |i: usize| {
                let span = (i64::from(self.cfg.scale.max[i]) - i64::from(self.cfg.scale.min[i]))
                    .max(1) as f64;
                let share = (i64::from(pos[i]) - i64::from(self.cfg.scale.min[i])) as f64 / span;
                (share.clamp(0.0, 1.0) * f64::from(self.cfg.scale.area_mm[i])) as f32
            };
            p.pos_mm = Vec2::new(axis(0), axis(1));
        }
        if let Some([x, y]) = r.tilt {
            let rad = |d: f32| d.clamp(-90.0, 90.0).to_radians();
            p.tilt = Some(Vec2::new(rad(x), rad(y)));
        }
        if let Some(t) = r.twist.filter(|t| t.is_finite()) {
            p.twist = Some(wrapped(t));
        }
    }

    fn press(&mut self, r: &PenReport, entering: bool) {
        if let (Some(counts), true) = (r.pressure, self.cfg.scale.max_pressure > 0) {
            let full = self.full_pressure(counts);
            let share = (f64::from(counts) / f64::from(full)).min(1.0) as f32;
            if entering {
                self.learn_offset(r, share);
            } else if share < self.offset {
                self.offset = share;
            }
            if r.tip == Some(false) && share <= MOST_OFFSET {
                self.resting = share;
            }
            // Pressure is passed on as it is measured, also in the air: `tip` says whether the pen
            // touches.
            self.pen.pressure = Some(if self.pen.tool == Tool::Mouse { 0.0 } else { share });
        }
        let rest = if self.switch.is_none() { self.offset.max(self.resting) } else { self.offset };
        let felt = self.pen.pressure.map(|p| ((p - rest) / (1.0 - rest)).max(0.0));
        let spike = self.fresh && felt.is_some_and(|p| p >= 1.0);
        if spike {
            self.pen.pressure = Some(0.0);
        }
        self.pen.tip = match (self.pen.tool, self.switch, felt) {
            (Tool::Mouse, ..) => false,
            _ if spike => false,
            (_, Some(switch), _) => switch,
            (_, None, Some(p)) => p >= if self.pen.tip { UP } else { DOWN },
            (_, None, None) => false,
        };
        self.without_pressure(r);
    }

    /// Some pens send a pressure that is always 0, and would draw nothing.
    fn without_pressure(&mut self, r: &PenReport) {
        self.pressed |= r.pressure.is_some_and(|p| p > 0);
        let touches = r.tip == Some(true) && r.pressure == Some(0);
        if self.pressed || self.pen.tool == Tool::Mouse {
            self.unpressed = 0;
        } else if touches {
            self.unpressed = self.unpressed.saturating_add(1);
        }
        if self.unpressed >= NO_PRESSURE {
            self.pen.pressure = None;
        }
    }

    /// A worn pen reports pressure while it hovers. The offset is learned only high over the
    /// surface and without a tip switch.
    fn learn_offset(&mut self, r: &PenReport, share: f32) {
        let high = match (r.distance, self.cfg.scale.max_distance) {
            (Some(d), max) if max > 0 => d * 2 >= max,
            _ => false,
        };
        if high && self.switch.is_none() && share <= MOST_OFFSET {
            self.offset = share;
        }
    }

    fn emit(&self, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        emit(Sample {
            device: self.cfg.device,
            t_us,
            device_t_us: None,
            body: Body::Pen(self.pen),
        });
    }
}

/// Into `-π..π`.
fn wrapped(t: f32) -> f32 {
    use std::f32::consts::{PI, TAU};
    let w = (t + PI).rem_euclid(TAU) - PI;
    if w < PI { w } else { -PI }
}

#[cfg(test)]
mod tests;

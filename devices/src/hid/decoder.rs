//! Decodes the reports of one interface: a parser with its memory, the state of the pen and of the
//! pad. The same type decodes live, recorded and simulated bytes.

use glam::Vec2;

use super::digitiser;
use super::family::Engine;
use super::pad_state::PadState;
use super::pen_firmware::PenFirmware;
use crate::catalogue::{Found, Scale, by_descriptor};
use crate::descriptor::{Descriptor, PadFields, PenLayout};
use crate::pen_state::{CONTACT_SILENCE_US, PenConfig, PenScale, PenState};
use crate::pressure_use::PressureUse;
use crate::report::{Batch, Parsed};
use crate::sample::{DeviceId, Sample};

/// Longest time over which the frames of one report are spread, in microseconds: seven frames at
/// 200 a second.
const MAX_SPREAD_US: u64 = 35_000;

/// Counts of the reports passed to the decoder so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Reports passed to the decoder.
    pub reports: u64,
    /// Reports that are cut short or contradict themselves.
    pub broken: u64,
    /// Reports of another id: touch, mouse, battery.
    pub ignored: u64,
    /// Positions outside the model's area and pressures above its maximum: a sign that the model is
    /// another one.
    pub outside: u64,
    /// Positions that were read.
    pub placed: u64,
}

/// Reads the reports of one interface.
#[derive(Debug, Clone)]
pub struct Decoder {
    engine: Engine,
    firmware: PenFirmware,
    pen: PenState,
    pad: PadState,
    skip: usize,
    /// A described tablet's ranges differ by report id.
    scales: Vec<(Option<u8>, PenScale)>,
    /// Pad reports that the descriptor describes and the family's parser does not know.
    pads: Vec<PadFields>,
    /// A tablet that is not yet switched to its vendor's protocol sends what its descriptor says.
    plain: Option<Box<Decoder>>,
    /// Time of the last report.
    last_us: u64,
    counts: Counts,
}

impl Decoder {
    /// `descriptor`: of the interface; empty where it is unknown. Only [`Family::Digitiser`] cannot
    /// do without it.
    ///
    /// [`Family::Digitiser`]: crate::tablet::Family::Digitiser
    pub fn new(found: &Found, descriptor: &[u8], device: DeviceId) -> Decoder {
        let (tablet, id) = (&found.tablet, found.id());
        let engine = Engine::new(tablet, id, descriptor);
        let area = tablet.area;
        let size = Vec2::new(area.width_mm as f32, area.height_mm as f32);
        let pen = PenState::new(PenConfig {
            device,
            scale: PenScale {
                min: [area.min_x, area.min_y],
                max: [area.max_x, area.max_y],
                area_mm: size,
                max_pressure: found.stated_pressure.unwrap_or(tablet.pen.max_pressure),
                max_distance: tablet.pen.max_distance,
            },
            silence_us: engine.silence_us(),
            contact_silence_us: CONTACT_SILENCE_US,
            tilts: engine.has_tilt(),
        });
        let d = Descriptor::parse(descriptor).unwrap_or_default();
        let (mut scales, mut plain) = (Vec::new(), None);
        if found.described || engine.follows_descriptor() {
            // Counts are the report's own. The size is the model's. Full pressure is what the
            // parameter string states; else the larger of the report's and the model's.
            let full = |p: u32| match found.stated_pressure {
                Some(stated) if p > 0 => stated,
                _ if p > 0 => p.max(tablet.pen.max_pressure),
                _ => 0,
            };
            let scale = |p: &PenLayout| {
                let scale = scale_of(p, size)?;
                Some(PenScale { max_pressure: full(scale.max_pressure), ..scale })
            };
            scales = d.pens.iter().filter_map(|p| Some((p.report_id, scale(p)?))).collect();
        } else if let Some(mut other) = by_descriptor(id.vid, id.pid, descriptor) {
            other.sized_like(found);
            plain = Some(Box::new(Decoder::new(&other, descriptor, device)));
        }
        Decoder {
            firmware: PenFirmware::new(engine.firmware_rules()),
            engine,
            pen,
            pad: PadState::new(device),
            skip: usize::from(id.skip),
            scales,
            pads: d.pads,
            plain,
            last_us: 0,
            counts: Counts::default(),
        }
    }

    /// Returns the counts of the reports so far.
    pub fn counts(&self) -> Counts {
        let mut counts = self.counts;
        (counts.outside, counts.placed) = self.pen.outside();
        if let Some(plain) = &self.plain {
            let other = plain.counts();
            counts.outside += other.outside;
            counts.placed += other.placed;
            counts.broken += other.broken;
            counts.ignored += other.ignored;
        }
        counts
    }

    /// Returns how the pen has used its pressure range so far.
    pub fn pressure_use(&self) -> PressureUse {
        let other = self.plain.as_ref().map(|p| p.pressure_use()).unwrap_or_default();
        self.pen.pressure_use().and(other)
    }

    /// Reads one report, its id first where it has one. `t_us` is when it was read; the frames of a
    /// report that holds several are spread evenly over the time since the last report.
    pub fn feed(&mut self, report: &[u8], t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.counts.reports += 1;
        let b = report.get(self.skip..).unwrap_or(&[]);
        let mut batch = Batch::default();
        self.engine.parse(b, &mut batch);
        self.pen.set_silence(self.engine.silence_us());
        let own = |id: Option<u8>| id.is_none_or(|id| b.first() == Some(&id));
        if batch.as_slice().is_empty()
            && let Some(fields) = self.pads.iter().find(|p| own(p.report_id))
        {
            digitiser::pad(b, fields, &mut batch);
        }
        if let Some((_, scale)) = self.scales.iter().find(|(id, _)| own(*id)) {
            self.pen.set_scale(*scale, t_us, emit);
        }
        if batch.as_slice().is_empty() {
            match &mut self.plain {
                Some(plain) => plain.feed(b, t_us, emit),
                None => self.counts.ignored += 1,
            }
        }
        let frames = batch.as_slice().iter().filter(|p| !matches!(p, Parsed::Pad(_))).count();
        let since = t_us.saturating_sub(self.last_us).min(MAX_SPREAD_US);
        let mut frame = 0;
        for parsed in batch.as_slice() {
            if !matches!(parsed, Parsed::Pad(_)) {
                frame += 1;
            }
            let left = (frames - frame) as u64;
            let at_us = t_us - since * left / frames.max(1) as u64;
            match &self.firmware.repair(*parsed) {
                Parsed::Nothing => {}
                Parsed::Broken => self.counts.broken += 1,
                Parsed::Pen(r) => self.pen.report(r, at_us, emit),
                Parsed::Away => self.pen.leave(at_us, emit),
                Parsed::Pad(r) => self.pad.report(r, t_us, emit),
            }
        }
        self.last_us = t_us;
    }

    /// The feature report that names the pen that is near, in families whose reports name it only
    /// as it enters.
    pub fn names_tool(&self) -> Option<u8> {
        self.engine.names_tool()
    }

    /// Returns true if the pen is in proximity.
    pub fn in_range(&self) -> bool {
        self.pen.in_range() || self.plain.as_ref().is_some_and(|p| p.in_range())
    }

    /// Returns the time at which silence will end the pen's visit.
    pub fn due_us(&self) -> Option<u64> {
        let other = self.plain.as_ref().and_then(|p| p.due_us());
        [self.pen.due_us(), other].into_iter().flatten().min()
    }

    /// Ends the pen's visit if it has been silent for too long. Call it while no report comes.
    pub fn tick(&mut self, now_us: u64, emit: &mut dyn FnMut(Sample)) {
        let near = self.pen.in_range();
        self.pen.tick(now_us, emit);
        if near && !self.pen.in_range() {
            self.firmware.forget();
        }
        if let Some(plain) = &mut self.plain {
            plain.tick(now_us, emit);
        }
    }

    /// The device was unplugged: its pen leaves, and its keys and buttons are released.
    pub fn leave(&mut self, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.firmware.forget();
        self.pen.leave(t_us, emit);
        self.pad.leave(t_us, emit);
        if let Some(plain) = &mut self.plain {
            plain.leave(t_us, emit);
        }
    }
}

fn scale_of(pen: &PenLayout, area_mm: Vec2) -> Option<PenScale> {
    let scale = Scale::of(pen)?;
    let a = scale.area;
    Some(PenScale {
        min: [a.min_x, a.min_y],
        max: [a.max_x, a.max_y],
        area_mm,
        max_pressure: scale.max_pressure,
        max_distance: scale.max_distance,
    })
}

//! One interface of one device: parser, its memory, the pen's and the pad's state. The same object
//! reads live, recorded and simulated bytes.

use glam::Vec2;

use super::family::Engine;
use super::pad_state::PadState;
use crate::catalogue::{Found, Scale, by_descriptor};
use crate::descriptor::{Descriptor, PenLayout};
use crate::pen_state::{PenConfig, PenScale, PenState};
use crate::report::Parsed;
use crate::sample::{DeviceId, Sample};

/// What became of the reports fed so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    pub reports: u64,
    /// Cut short or self-contradicting.
    pub broken: u64,
    /// Other report ids, touch, mouse.
    pub ignored: u64,
}

#[derive(Debug, Clone)]
pub struct Decoder {
    engine: Engine,
    pen: PenState,
    pad: PadState,
    skip: usize,
    /// A described tablet's ranges differ by report id.
    scales: Vec<(Option<u8>, PenScale)>,
    /// A tablet not yet switched to its maker's protocol speaks as its descriptor says.
    plain: Option<Box<Decoder>>,
    pub counts: Counts,
}

impl Decoder {
    /// `descriptor`: of the interface; empty where it is unknown. Only the digitiser cannot do
    /// without it.
    pub fn new(found: &Found, descriptor: &[u8], device: DeviceId) -> Decoder {
        let (tablet, id) = (&found.tablet, found.id());
        let engine = Engine::new(tablet, id, descriptor);
        let area = tablet.area;
        let pen = PenState::new(PenConfig {
            device,
            scale: PenScale {
                min: [area.min_x, area.min_y],
                max: [area.max_x, area.max_y],
                area_mm: Vec2::new(area.width_mm as f32, area.height_mm as f32),
                max_pressure: tablet.pen.max_pressure,
                max_distance: tablet.pen.max_distance,
            },
            silence_us: engine.silence_us(),
            tilts: engine.has_tilt(),
        });
        let (mut scales, mut plain) = (Vec::new(), None);
        if found.described || engine.follows_descriptor() {
            let d = Descriptor::parse(descriptor).unwrap_or_default();
            // Counts are the report's own; the size is the model's, where the model is known.
            let size = Vec2::new(area.width_mm as f32, area.height_mm as f32);
            scales =
                d.pens.iter().filter_map(|p| Some((p.report_id, scale_of(p, size)?))).collect();
        } else if let Some(mut other) = by_descriptor(id.vid, id.pid, descriptor) {
            other.sized_like(found);
            plain = Some(Box::new(Decoder::new(&other, descriptor, device)));
        }
        let pad = PadState::new(device);
        Decoder {
            engine,
            pen,
            pad,
            skip: usize::from(id.skip),
            scales,
            plain,
            counts: Counts::default(),
        }
    }

    /// One report, its id first where it has one.
    pub fn feed(&mut self, report: &[u8], t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.counts.reports += 1;
        let b = report.get(self.skip..).unwrap_or(&[]);
        let (parsed, first, second) = self.engine.parse(b);
        self.pen.set_silence(self.engine.silence_us());
        let own = |id: &Option<u8>| id.is_none_or(|id| b.first() == Some(&id));
        if let Some((_, scale)) = self.scales.iter().find(|(id, _)| own(id)) {
            self.pen.set_scale(*scale, t_us, emit);
        }
        match parsed {
            Parsed::Nothing if first.is_none() => match &mut self.plain {
                Some(plain) => plain.feed(b, t_us, emit),
                None => self.counts.ignored += 1,
            },
            Parsed::Nothing => {}
            Parsed::Broken => self.counts.broken += 1,
            Parsed::Pen(r) => self.pen.report(&r, t_us, emit),
            Parsed::Away => self.pen.leave(t_us, emit),
            Parsed::Pad(r) => self.pad.report(&r, t_us, emit),
        }
        for r in [first, second].into_iter().flatten() {
            self.pad.report(&r, t_us, emit);
        }
    }

    /// The feature report that names the pen that is near, in families whose reports name it only
    /// as it enters.
    pub fn names_tool(&self) -> Option<u8> {
        self.engine.names_tool()
    }

    pub fn in_range(&self) -> bool {
        self.pen.in_range() || self.plain.as_ref().is_some_and(|p| p.in_range())
    }

    /// When silence will end the pen's visit.
    pub fn due_us(&self) -> Option<u64> {
        let other = self.plain.as_ref().and_then(|p| p.due_us());
        [self.pen.due_us(), other].into_iter().flatten().min()
    }

    pub fn tick(&mut self, now_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.pen.tick(now_us, emit);
        if let Some(plain) = &mut self.plain {
            plain.tick(now_us, emit);
        }
    }

    /// The device went: whatever was in range leaves, whatever was held is let go.
    pub fn leave(&mut self, t_us: u64, emit: &mut dyn FnMut(Sample)) {
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

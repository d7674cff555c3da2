//! One interface of one device: parser, its memory, the pen's state. The same object reads live, recorded and simulated bytes.

use glam::Vec2;

use super::descriptor::Descriptor;
use super::report::Parsed;
use super::{digitiser, wacom_intuos};
use crate::catalogue::Found;
use crate::pen_state::{PenConfig, PenState};
use crate::sample::{DeviceId, Sample};
use crate::tablet::{Family, Quirk};

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
enum Engine {
    WacomIntuos(wacom_intuos::Traits, wacom_intuos::Memory),
    Digitiser(Box<Descriptor>),
}

#[derive(Debug, Clone)]
pub struct Decoder {
    engine: Engine,
    pen: PenState,
    skip: usize,
    pub counts: Counts,
}

impl Decoder {
    /// `descriptor`: of the interface, where it is known; families other than the digitiser do not need it.
    pub fn new(found: &Found, descriptor: &[u8], device: DeviceId) -> Decoder {
        let (tablet, id) = (&found.tablet, found.id());
        let quirk = |q| id.quirks.contains(&q);
        let engine = match id.parser {
            Family::WacomIntuosV1 => Engine::WacomIntuos(
                wacom_intuos::Traits {
                    halved: quirk(Quirk::Halved),
                    halved_pressure: tablet.pen.max_pressure < 2047,
                    needs_ready: quirk(Quirk::NeedsReady),
                    height_inverted: quirk(Quirk::HeightInverted),
                    max_distance: tablet.pen.max_distance,
                },
                wacom_intuos::Memory::default(),
            ),
            Family::Digitiser => {
                Engine::Digitiser(Box::new(Descriptor::parse(descriptor).unwrap_or_default()))
            }
        };
        let area = tablet.area;
        let pen = PenState::new(PenConfig {
            device,
            min: [area.min_x, area.min_y],
            max: [area.max_x, area.max_y],
            area_mm: Vec2::new(area.width_mm as f32, area.height_mm as f32),
            max_pressure: tablet.pen.max_pressure,
            max_distance: tablet.pen.max_distance,
            silence_us: engine.silence_us(),
        });
        Decoder { engine, pen, skip: usize::from(id.skip), counts: Counts::default() }
    }

    /// One report, its id first where it has one.
    pub fn feed(&mut self, report: &[u8], t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.counts.reports += 1;
        let b = report.get(self.skip..).unwrap_or(&[]);
        let parsed = match &mut self.engine {
            Engine::WacomIntuos(traits, memory) => wacom_intuos::parse(b, traits, memory),
            Engine::Digitiser(d) => digitiser::parse(b, d),
        };
        match parsed {
            Parsed::Nothing => self.counts.ignored += 1,
            Parsed::Broken => self.counts.broken += 1,
            Parsed::Pen(r) => self.pen.report(&r, t_us, emit),
            Parsed::Away => self.pen.leave(t_us, emit),
            Parsed::Pad(_) => self.counts.ignored += 1,
        }
    }

    pub fn in_range(&self) -> bool {
        self.pen.in_range()
    }

    /// When silence will end the pen's visit.
    pub fn due_us(&self) -> Option<u64> {
        self.pen.due_us()
    }

    pub fn tick(&mut self, now_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.pen.tick(now_us, emit);
    }

    /// The device went: whatever was in range leaves.
    pub fn leave(&mut self, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.pen.leave(t_us, emit);
    }
}

impl Engine {
    /// libinput's 50 ms for families that never say that the pen left.
    fn silence_us(&self) -> Option<u64> {
        const SILENCE: u64 = 50_000;
        match self {
            Engine::WacomIntuos(..) => None,
            Engine::Digitiser(d) => d.pens.iter().any(|p| p.in_range.is_none()).then_some(SILENCE),
        }
    }
}

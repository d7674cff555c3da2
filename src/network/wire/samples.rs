//! Samples on the wire: integers, and the change of the change from sample to sample.
//!
//! A shared sculpture is sculpted with the sent samples, by the sender too. So a sample is rounded
//! once, before it is ordered, and every replica steps the same bits: position to 5 µm, pressure to
//! 1/1023, angles to 1/128 rad. A pen takes two to three bytes a sample ([`super::range_coder`]).
//!
//! Data that only the sender's daemon uses is left out: device counts, the device's clock, and the
//! time, which becomes that of the tick.

use glam::Vec2;

use super::bytes::BadBytes;
use super::frame::PersonId;
use super::hands::HandsCodec;
use super::range_coder::{BitModel, Coder, NumberModel};
use sculptd_devices::{Body, DeviceId, Hands, Pen, Sample, Tool};

/// Steps a mm. Tablets resolve 2540 or 5080 lines an inch: 100 to 200 a mm.
const PER_MM: f32 = 200.0;
const PRESSURES: f32 = 1023.0;
const PER_RADIAN: f32 = 128.0;
const PER_DISTANCE: f32 = 4.0;

/// A pen in whole numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct WholePen {
    /// Tool, range, tip, and flags of the optional fields present.
    kind: u8,
    area: [i32; 2],
    buttons: u32,
    pos: [i32; 2],
    pressure: i32,
    tilt: [i32; 2],
    twist: i32,
    distance: i32,
}

const TOOL: u8 = 0b11;
const IN_RANGE: u8 = 1 << 2;
const TIP: u8 = 1 << 3;
const PRESSURE: u8 = 1 << 4;
const TILT: u8 = 1 << 5;
const TWIST: u8 = 1 << 6;
const DISTANCE: u8 = 1 << 7;

/// The largest whole number: 5 m. It comes back from a float as it was.
const MAX_WHOLE: i32 = 1_000_000;
/// Pens of one message.
const MAX_PENS: usize = 1024;

fn quantised(value: f32, steps: f32) -> i32 {
    // A float that is none becomes 0, and one that is too large the largest.
    (value * steps).round().clamp(-MAX_WHOLE as f32, MAX_WHOLE as f32) as i32
}

impl WholePen {
    fn of(pen: &Pen) -> WholePen {
        let tool = match pen.tool {
            Tool::Pen => 0,
            Tool::Eraser => 1,
            Tool::Mouse => 2,
            Tool::Touch => 3,
        };
        let mut kind = tool;
        let mut set = |bit, on: bool| kind |= if on { bit } else { 0 };
        set(IN_RANGE, pen.in_range);
        set(TIP, pen.tip);
        set(PRESSURE, pen.pressure.is_some());
        set(TILT, pen.tilt.is_some());
        set(TWIST, pen.twist.is_some());
        set(DISTANCE, pen.distance.is_some());
        let pair = |v: Vec2, steps| [quantised(v.x, steps), quantised(v.y, steps)];
        WholePen {
            kind,
            area: pair(pen.area_mm, PER_MM),
            buttons: pen.buttons,
            pos: pair(pen.pos_mm, PER_MM),
            pressure: quantised(pen.pressure.unwrap_or(0.0).clamp(0.0, 1.0), PRESSURES),
            tilt: pair(pen.tilt.unwrap_or_default(), PER_RADIAN),
            twist: quantised(pen.twist.unwrap_or(0.0), PER_RADIAN),
            distance: quantised(pen.distance.unwrap_or(0.0), PER_DISTANCE),
        }
    }

    fn pen(&self) -> Pen {
        let has = |bit| self.kind & bit != 0;
        let pair = |v: [i32; 2], steps: f32| Vec2::new(v[0] as f32, v[1] as f32) / steps;
        Pen {
            tool: match self.kind & TOOL {
                0 => Tool::Pen,
                1 => Tool::Eraser,
                2 => Tool::Mouse,
                _ => Tool::Touch,
            },
            in_range: has(IN_RANGE),
            tip: has(TIP) && has(IN_RANGE),
            pos_mm: pair(self.pos, PER_MM),
            area_mm: pair(self.area, PER_MM),
            raw: [0; 2],
            pressure: has(PRESSURE).then_some(self.pressure as f32 / PRESSURES),
            tilt: has(TILT).then(|| pair(self.tilt, PER_RADIAN)),
            twist: has(TWIST).then_some(self.twist as f32 / PER_RADIAN),
            distance: has(DISTANCE).then_some(self.distance as f32 / PER_DISTANCE),
            buttons: self.buttons,
        }
    }
}

/// The sample as it is sent and as everybody steps it; `None` of a tablet's own keys, which their
/// daemon has turned into commands. Rounding twice changes nothing.
pub fn rounded(sample: &Sample) -> Option<Sample> {
    let body = match &sample.body {
        Body::Pen(pen) => Body::Pen(WholePen::of(pen).pen()),
        Body::Hands(hands) => Body::Hands(super::hands::rounded(hands)),
        Body::Pad(_) => return None,
    };
    Some(Sample { device: sample.device, t_us: 0, device_t_us: None, body })
}

/// Last state of a pen in a message, or in the frames before it.
#[derive(Debug, Clone, Copy)]
struct LastPen {
    person: PersonId,
    device: u8,
    pen: WholePen,
    /// From the sample before it.
    moved: [i32; 2],
}

impl LastPen {
    fn follow(&mut self, now: WholePen) {
        // The first motion is from nowhere.
        let known = self.pen.area != [0; 2];
        self.moved = [0, 1].map(|k| if known { now.pos[k] - self.pen.pos[k] } else { 0 });
        self.pen = now;
    }
}

/// Probability models, learned from one message alone, of all its people together.
#[derive(Debug)]
struct SampleModels {
    hands: BitModel,
    other_device: BitModel,
    kind: BitModel,
    rest: BitModel,
    pos: [NumberModel; 2],
    pressure: NumberModel,
    tilt: [NumberModel; 2],
    twist: NumberModel,
    others: NumberModel,
}

impl Default for SampleModels {
    fn default() -> Self {
        let number = NumberModel::default;
        SampleModels {
            hands: BitModel::RARE,
            other_device: BitModel::RARE,
            kind: BitModel::RARE,
            rest: BitModel::RARE,
            pos: [number(), number()],
            pressure: number(),
            tilt: [number(), number()],
            twist: number(),
            others: number(),
        }
    }
}

/// Writes and reads the samples of one message in order: each as its difference to what the one
/// before it of the same device lets expect.
#[derive(Debug, Default)]
pub struct SampleCodec {
    models: Box<SampleModels>,
    /// Pens in the order of their last samples, the newest last.
    pens: Vec<LastPen>,
    hands: HandsCodec,
}

impl SampleCodec {
    /// A sample that the other side has too is before the message.
    pub fn follow(&mut self, person: PersonId, sample: &Sample) {
        match &sample.body {
            Body::Pen(pen) => {
                self.last(person, sample.device.0 as u8).follow(WholePen::of(pen));
            }
            Body::Hands(hands) => self.hands.follow(person, hands),
            Body::Pad(_) => {}
        }
    }

    /// The state of a device, moved to the end.
    fn last(&mut self, person: PersonId, device: u8) -> &mut LastPen {
        let at = self.pens.iter().rposition(|l| l.person == person && l.device == device);
        let last = at.map(|at| self.pens.remove(at));
        let (pen, moved) = (WholePen::default(), [0; 2]);
        self.pens.push(last.unwrap_or(LastPen { person, device, pen, moved }));
        let end = self.pens.len() - 1;
        &mut self.pens[end]
    }

    /// Writes a rounded sample of a person, or reads one.
    ///
    /// # Errors
    /// [`BadBytes`] where the bytes are of none.
    pub fn code(
        &mut self,
        c: &mut impl Coder,
        person: PersonId,
        sample: &Sample,
    ) -> Result<Sample, BadBytes> {
        let expected = self.pens.iter().rfind(|l| l.person == person).map_or(0, |l| l.device);
        let (mut device, models) = (sample.device.0 as u8, &mut *self.models);
        if c.bit(&mut models.other_device, device != expected)? {
            device = c.bits(u64::from(device), 8)? as u8;
        } else {
            device = expected;
        }
        let of =
            |body| Sample { device: DeviceId(device.into()), t_us: 0, device_t_us: None, body };
        let hands = if let Body::Hands(hands) = &sample.body { Some(hands) } else { None };
        if c.bit(&mut models.hands, hands.is_some())? {
            let hands = self.hands.code(c, person, hands.unwrap_or(&Hands::default()))?;
            return Ok(of(Body::Hands(hands)));
        }
        if self.pens.len() > MAX_PENS {
            return Err(BadBytes);
        }
        let written = if let Body::Pen(pen) = &sample.body { *pen } else { Pen::default() };
        let written = WholePen::of(&written);
        let last = *self.last(person, device);
        let (models, mut now) = (&mut *self.models, last.pen);
        if c.bit(&mut models.kind, written.kind != last.pen.kind)? {
            now.kind = c.bits(u64::from(written.kind), 8)? as u8;
        }
        let difference = |c: &mut _, model: &mut NumberModel, to: &mut i32, value: i32| {
            let read = code_difference(c, model, value, *to)?;
            *to = read;
            Ok::<_, BadBytes>(())
        };
        for k in 0..2 {
            now.pos[k] = (last.pen.pos[k] + last.moved[k]).clamp(-MAX_WHOLE, MAX_WHOLE);
            difference(c, &mut models.pos[k], &mut now.pos[k], written.pos[k])?;
        }
        difference(c, &mut models.pressure, &mut now.pressure, written.pressure)?;
        for k in 0..2 {
            difference(c, &mut models.tilt[k], &mut now.tilt[k], written.tilt[k])?;
        }
        difference(c, &mut models.twist, &mut now.twist, written.twist)?;
        let rest = |p: &WholePen| (p.area, p.buttons, p.distance);
        if c.bit(&mut models.rest, rest(&written) != rest(&last.pen))? {
            for k in 0..2 {
                difference(c, &mut models.others, &mut now.area[k], written.area[k])?;
            }
            difference(c, &mut models.others, &mut now.distance, written.distance)?;
            now.buttons = c.number(&mut models.others, written.buttons)?;
        }
        if !(0..=PRESSURES as i32).contains(&now.pressure) {
            return Err(BadBytes);
        }
        self.last(person, device).follow(now);
        Ok(of(Body::Pen(now.pen())))
    }
}

/// Writes or reads a value by its difference to the expected one.
fn code_difference(
    c: &mut impl Coder,
    model: &mut NumberModel,
    value: i32,
    expected: i32,
) -> Result<i32, BadBytes> {
    let difference = c.signed(model, value.saturating_sub(expected))?;
    let value = expected.checked_add(difference).ok_or(BadBytes)?;
    if value.abs() <= MAX_WHOLE { Ok(value) } else { Err(BadBytes) }
}

#[cfg(test)]
mod tests {
    use super::super::bytes::ByteReader;
    use super::super::range_coder::{Decoder, Encoder};
    use super::*;
    use proptest::prelude::*;

    const NONE: Sample = Sample {
        device: DeviceId(0),
        t_us: 0,
        device_t_us: None,
        body: Body::Pad(sculptd_devices::Pad { keys: 0, wheels: [0; 2], strips: [None; 2] }),
    };

    fn written(samples: &[Sample]) -> Vec<u8> {
        let (mut codec, mut encoder) = (SampleCodec::default(), Encoder::default());
        for s in samples {
            assert_eq!(codec.code(&mut encoder, 3, s), Ok(*s));
        }
        let mut bytes = Vec::new();
        encoder.finish(&mut bytes);
        bytes
    }

    fn pen() -> impl Strategy<Value = Pen> {
        let numbers = (-10.0f32..300.0, 0.0f32..200.0, 0.0f32..1.0, -1.5f32..1.5, -1.5f32..1.5);
        (numbers, any::<[bool; 5]>(), 0u32..8, 0u8..4).prop_map(|(n, has, buttons, tool)| Pen {
            tool: [Tool::Pen, Tool::Eraser, Tool::Mouse, Tool::Touch][usize::from(tool)],
            in_range: has[0],
            tip: has[0] && has[1],
            pos_mm: Vec2::new(n.0, n.1),
            area_mm: Vec2::new(224.0, 148.0),
            raw: [7, 9],
            pressure: has[2].then_some(n.2),
            tilt: has[3].then_some(Vec2::new(n.3, n.4)),
            twist: has[4].then_some(n.3),
            distance: has[1].then_some(n.0),
            buttons,
        })
    }

    proptest! {
        #[test]
        fn rounded_samples_come_back_to_the_bit(
            pens in proptest::collection::vec((0u16..3, pen()), 0..40),
        ) {
            let samples: Vec<Sample> = pens
                .iter()
                .filter_map(|(d, p)| {
                    let body = Body::Pen(*p);
                    rounded(&Sample { device: DeviceId(*d), t_us: 5, device_t_us: None, body })
                })
                .collect();
            for s in &samples {
                prop_assert_eq!(rounded(s), Some(*s), "rounding twice");
            }
            let bytes = written(&samples);
            let mut decoder = Decoder::new(ByteReader::new(&bytes)).expect("whole");
            let mut codec = SampleCodec::default();
            for s in &samples {
                prop_assert_eq!(codec.code(&mut decoder, 3, &NONE), Ok(*s));
            }
            prop_assert_eq!(decoder.end(), Ok(()));
        }

        #[test]
        fn any_bytes_are_read_without_a_panic(
            bytes in proptest::collection::vec(any::<u8>(), 0..200),
        ) {
            let mut codec = SampleCodec::default();
            if let Ok(mut decoder) = Decoder::new(ByteReader::new(&bytes)) {
                while let Ok(read) = codec.code(&mut decoder, 3, &NONE) {
                    prop_assert_eq!(rounded(&read), Some(read));
                }
            }
        }
    }

    #[test]
    fn an_even_stroke_takes_few_bytes() {
        let mut samples = Vec::new();
        for k in 0..100 {
            let pen = Pen {
                in_range: true,
                tip: true,
                pos_mm: Vec2::new(50.0 + k as f32 * 0.4, 60.0 + (k as f32 * 0.1).sin() * 5.0),
                area_mm: Vec2::new(224.0, 148.0),
                pressure: Some(0.5 + 0.3 * (k as f32 * 0.05).sin()),
                ..Pen::default()
            };
            let body = Body::Pen(pen);
            let sample = Sample { device: DeviceId(20), t_us: 0, device_t_us: None, body };
            samples.push(rounded(&sample).expect("a pen"));
        }
        let bytes = written(&samples);
        assert!(bytes.len() < 200, "{} bytes for 100 samples", bytes.len());
    }
}

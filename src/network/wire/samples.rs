//! Samples on the wire: integers, and the change of the change from sample to sample.
//!
//! A shared sculpture is sculpted with what was sent, by the sender too. So a sample is rounded
//! once, before it is ordered, and every replica steps the same bits: position to 5 µm, pressure
//! to 1/1023, angles to 1/128 rad. A pen that moves evenly takes about six bytes a sample.
//!
//! What nobody but its own daemon uses is left out: device counts, the device's clock, and the
//! time, which becomes that of the tick.

use glam::{Vec2, Vec3};

use super::bytes::{BadBytes, ByteReader, put_bytes, put_number, put_signed};
use sculptd_devices::{Body, DeviceId, Hands, Pen, Sample, Tool};

/// Steps a mm. Tablets resolve 2540 or 5080 lines an inch: 100 to 200 a mm.
const PER_MM: f32 = 200.0;
const PRESSURES: f32 = 1023.0;
const PER_RADIAN: f32 = 128.0;
const PER_DISTANCE: f32 = 4.0;
/// Bytes that the hands of one frame take at most.
const MAX_HANDS_BYTES: usize = 4096;

/// A pen in whole numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct WholePen {
    /// Tool, range, tip, and which of the optional fields are there.
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

/// What of a pen follows in the bytes.
const CHANGED_KIND: u8 = 1;
const CHANGED_POS: u8 = 1 << 1;
const CHANGED_PRESSURE: u8 = 1 << 2;
const CHANGED_TILT: u8 = 1 << 3;
const CHANGED_REST: u8 = 1 << 4;
/// A frame of hands and no pen.
const HANDS: u8 = 1 << 7;

fn whole(value: f32, steps: f32) -> i32 {
    // A float that is none becomes 0, and one that is too large the largest.
    (value * steps).round().clamp(-8e6, 8e6) as i32
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
        let pair = |v: Vec2, steps| [whole(v.x, steps), whole(v.y, steps)];
        WholePen {
            kind,
            area: pair(pen.area_mm, PER_MM),
            buttons: pen.buttons,
            pos: pair(pen.pos_mm, PER_MM),
            pressure: whole(pen.pressure.unwrap_or(0.0).clamp(0.0, 1.0), PRESSURES),
            tilt: pair(pen.tilt.unwrap_or_default(), PER_RADIAN),
            twist: whole(pen.twist.unwrap_or(0.0), PER_RADIAN),
            distance: whole(pen.distance.unwrap_or(0.0), PER_DISTANCE),
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

/// Whether all numbers of the hands are some: a tracker's parser gives no others.
fn is_finite(hands: &Hands) -> bool {
    let place = |v: Vec3| v.is_finite();
    let places = |v: Option<Vec3>| v.is_none_or(place);
    let number = |x: Option<f32>| x.is_none_or(f32::is_finite);
    hands.as_slice().iter().all(|h| {
        let fingers = h.fingers.iter().flatten().all(|f| {
            place(f.tip)
                && places(f.direction)
                && number(f.width)
                && f.joints.iter().all(|j| places(*j))
        });
        let all = [h.palm_normal, h.direction, h.palm_velocity, h.wrist, h.elbow];
        let numbers = [h.grab, h.pinch, h.confidence, h.time_visible, h.palm_width];
        place(h.palm)
            && all.into_iter().all(places)
            && numbers.into_iter().all(number)
            && h.orientation.is_none_or(|q| q.is_finite())
            && fingers
    })
}

/// The sample as it is sent and as everybody steps it; `None` of a tablet's own keys, which their
/// daemon has turned into commands. Rounding twice changes nothing.
pub fn rounded(sample: &Sample) -> Option<Sample> {
    let body = match &sample.body {
        Body::Pen(pen) => Body::Pen(WholePen::of(pen).pen()),
        Body::Hands(hands) => {
            let mut hands = *hands;
            hands.count = (hands.as_slice().len()) as u8;
            // Entries beyond the count have no meaning, and must not cost bytes.
            let (count, default) = (usize::from(hands.count), Hands::default().hands);
            hands.hands[count..].copy_from_slice(&default[count..]);
            Body::Hands(hands)
        }
        Body::Pad(_) => return None,
    };
    Some(Sample { device: sample.device, t_us: 0, device_t_us: None, body })
}

/// Writes and reads the samples of one message in order: each as its difference to the one before
/// it of the same device.
#[derive(Debug, Default)]
pub struct SampleCodec {
    /// The last of each device, and its motion.
    last: Vec<(u16, WholePen, [i32; 2])>,
}

impl SampleCodec {
    fn last_mut(&mut self, device: u16) -> &mut (u16, WholePen, [i32; 2]) {
        let at = self.last.iter().position(|l| l.0 == device).unwrap_or_else(|| {
            self.last.push((device, WholePen::default(), [0; 2]));
            self.last.len() - 1
        });
        &mut self.last[at]
    }

    /// Appends a rounded sample.
    pub fn put(&mut self, out: &mut Vec<u8>, sample: &Sample) {
        match &sample.body {
            Body::Pen(pen) => {
                let now = WholePen::of(pen);
                let (device, last, moved) = self.last_mut(sample.device.0);
                let rest = |p: &WholePen| (p.area, p.buttons, p.twist, p.distance);
                let mut changed = 0;
                let mut set = |bit, on: bool| changed |= if on { bit } else { 0 };
                set(CHANGED_KIND, now.kind != last.kind);
                set(CHANGED_POS, now.pos != last.pos || *moved != [0; 2]);
                set(CHANGED_PRESSURE, now.pressure != last.pressure);
                set(CHANGED_TILT, now.tilt != last.tilt);
                set(CHANGED_REST, rest(&now) != rest(last));
                out.push(changed);
                put_number(out, u64::from(*device));
                if changed & CHANGED_KIND != 0 {
                    out.push(now.kind);
                }
                let mut differences = |now: &[i32], last: &[i32]| {
                    for (a, b) in now.iter().zip(last) {
                        put_signed(out, i64::from(*a) - i64::from(*b));
                    }
                };
                if changed & CHANGED_POS != 0 {
                    let expected = [0, 1].map(|k| last.pos[k] + moved[k]);
                    differences(&now.pos, &expected);
                }
                if changed & CHANGED_PRESSURE != 0 {
                    differences(&[now.pressure], &[last.pressure]);
                }
                if changed & CHANGED_TILT != 0 {
                    differences(&now.tilt, &last.tilt);
                }
                if changed & CHANGED_REST != 0 {
                    differences(&now.area, &last.area);
                    differences(&[now.twist, now.distance], &[last.twist, last.distance]);
                    put_number(out, u64::from(now.buttons));
                }
                // The first motion is from nowhere.
                let known = last.area != [0; 2];
                *moved = [0, 1].map(|k| if known { now.pos[k] - last.pos[k] } else { 0 });
                *last = now;
            }
            Body::Hands(hands) => {
                out.push(HANDS);
                put_number(out, u64::from(sample.device.0));
                put_bytes(out, &postcard::to_stdvec(hands).unwrap_or_default());
            }
            Body::Pad(_) => {}
        }
    }

    /// The next sample.
    ///
    /// # Errors
    /// [`BadBytes`] where they are of none.
    pub fn take(&mut self, bytes: &mut ByteReader<'_>) -> Result<Sample, BadBytes> {
        let changed = bytes.byte()?;
        let device = bytes.at_most(u64::from(u16::MAX))? as u16;
        let sample = |body| Sample { device: DeviceId(device), t_us: 0, device_t_us: None, body };
        if changed == HANDS {
            let hands = postcard::from_bytes(bytes.bytes(MAX_HANDS_BYTES)?);
            let hands: Hands = hands.ok().filter(is_finite).ok_or(BadBytes)?;
            return rounded(&sample(Body::Hands(hands))).ok_or(BadBytes);
        }
        if changed & !0b1_1111 != 0 || self.last.len() >= 256 {
            return Err(BadBytes);
        }
        let (_, last, moved) = self.last_mut(device);
        let mut now = *last;
        if changed & CHANGED_KIND != 0 {
            now.kind = bytes.byte()?;
        }
        let mut add = |to: &mut i32, base: i32| {
            let value = i64::from(base).checked_add(bytes.signed()?).ok_or(BadBytes)?;
            *to = i32::try_from(value).ok().filter(|v| v.abs() <= 8_000_000).ok_or(BadBytes)?;
            Ok(())
        };
        if changed & CHANGED_POS != 0 {
            for k in 0..2 {
                add(&mut now.pos[k], last.pos[k] + moved[k])?;
            }
        }
        if changed & CHANGED_PRESSURE != 0 {
            add(&mut now.pressure, last.pressure)?;
        }
        if changed & CHANGED_TILT != 0 {
            for k in 0..2 {
                add(&mut now.tilt[k], last.tilt[k])?;
            }
        }
        if changed & CHANGED_REST != 0 {
            for k in 0..2 {
                add(&mut now.area[k], last.area[k])?;
            }
            add(&mut now.twist, last.twist)?;
            add(&mut now.distance, last.distance)?;
            now.buttons = bytes.at_most(u64::from(u32::MAX))? as u32;
        }
        if !(0..=PRESSURES as i32).contains(&now.pressure) {
            return Err(BadBytes);
        }
        let known = last.area != [0; 2];
        *moved = [0, 1].map(|k| if known { now.pos[k] - last.pos[k] } else { 0 });
        *last = now;
        Ok(sample(Body::Pen(now.pen())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
            let (mut bytes, mut codec) = (Vec::new(), SampleCodec::default());
            samples.iter().for_each(|s| codec.put(&mut bytes, s));
            let (mut reader, mut codec) = (ByteReader::new(&bytes), SampleCodec::default());
            for s in &samples {
                prop_assert_eq!(codec.take(&mut reader), Ok(*s));
            }
            prop_assert_eq!(reader.end(), Ok(()));
        }

        #[test]
        fn any_bytes_are_read_without_a_panic(
            bytes in proptest::collection::vec(any::<u8>(), 0..200),
        ) {
            let (mut reader, mut codec) = (ByteReader::new(&bytes), SampleCodec::default());
            while codec.take(&mut reader).is_ok() {}
        }
    }

    #[test]
    fn an_even_stroke_takes_few_bytes() {
        let (mut bytes, mut codec) = (Vec::new(), SampleCodec::default());
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
            codec.put(&mut bytes, &rounded(&sample).expect("a pen"));
        }
        assert!(bytes.len() < 700, "{} bytes for 100 samples", bytes.len());
    }
}

//! A pen's pose as packets, and the replies that a tablet gives to questions.

use glam::Vec2;

use crate::serial::{Protocol, SerialFacts, SerialLayout, isdv4, summa_mm, wacom_iv, wacom_v};
use crate::sim::pen::PenPose;

const TILT_LIMIT: f32 = 60.0;

/// A tablet of one protocol: its answers to the host and the packets for a pose.
#[derive(Debug, Clone)]
pub(super) struct Model {
    pub(super) facts: SerialFacts,
    protocol: Protocol,
    eraser_in: Option<bool>,
}

fn counts_of(area_mm: Vec2, per_mm: f32) -> [i32; 2] {
    (area_mm * per_mm).round().as_ivec2().to_array()
}

impl Model {
    pub(super) fn new(protocol: Protocol, area_mm: Vec2) -> Self {
        let (per_mm, max_pressure) = match protocol {
            Protocol::Isdv4 => (isdv4::PER_MM, 255),
            Protocol::WacomIv => (50.0, 255),
            Protocol::WacomV => (100.0, wacom_v::MAX_PRESSURE),
            Protocol::SummaMm => (summa_mm::PER_INCH / 25.4, 0),
        };
        let max = counts_of(area_mm, per_mm);
        let layout = match protocol {
            Protocol::Isdv4 => {
                let query = isdv4::Isdv4Query {
                    max,
                    max_pressure,
                    max_tilt: [TILT_LIMIT as u32; 2],
                    version: 1,
                };
                SerialLayout::Isdv4(isdv4::Isdv4Layout::new(query, None, false))
            }
            Protocol::WacomIv => {
                SerialLayout::WacomIv(wacom_iv::WacomIvLayout::new("UD", (1, 4), max))
            }
            Protocol::WacomV => SerialLayout::WacomV(wacom_v::WacomVLayout::new(max)),
            Protocol::SummaMm => SerialLayout::SummaMm,
        };
        let facts = SerialFacts { model: "simulated".into(), max, area_mm, max_pressure, layout };
        Model { facts, protocol, eraser_in: None }
    }

    /// The packets for one instant. Empty while the pen is out of range, after the packet that says
    /// so.
    pub(super) fn packets(&mut self, pose: &PenPose) -> Vec<Vec<u8>> {
        let mut out = Vec::new();
        if self.eraser_in.is_some_and(|e| !pose.in_range || e != pose.eraser) {
            self.eraser_in = None;
            out.push(self.away());
        }
        if !pose.in_range {
            return out;
        }
        if self.eraser_in.is_none() {
            self.eraser_in = Some(pose.eraser);
            if self.protocol == Protocol::WacomV {
                let id: u32 = if pose.eraser { 0x82a } else { 0x822 };
                out.push(vec![0xc0, (id >> 5) as u8, ((id & 0x1f) << 2) as u8, 1, 2, 3, 4, 5, 6]);
            }
        }
        out.push(self.packet(pose));
        out
    }

    fn counts(&self, pose: &PenPose) -> (u32, u32, u32) {
        let share = (pose.pos_mm / self.facts.area_mm).clamp(Vec2::ZERO, Vec2::ONE);
        let at = |i: usize| (share[i] * self.facts.max[i] as f32).round() as u32;
        (
            at(0),
            at(1),
            (pose.pressure.clamp(0.0, 1.0) * self.facts.max_pressure as f32).round() as u32,
        )
    }

    fn packet(&self, pose: &PenPose) -> Vec<u8> {
        let (x, y, p) = self.counts(pose);
        let degrees = |r: f32| r.to_degrees().round().clamp(-TILT_LIMIT, TILT_LIMIT) as i32 as u32;
        let (tx, ty) = (degrees(pose.tilt.x), degrees(pose.tilt.y));
        let (tip, side, second) = (u32::from(pose.tip), pose.buttons & 1, pose.buttons >> 1 & 1);
        let eraser = u32::from(pose.eraser);
        let seven = |head: u32, rest: &[u32]| {
            let mut b = vec![head as u8 | 0x80];
            b.extend(rest.iter().map(|v| (v & 0x7f) as u8));
            b
        };
        match self.protocol {
            Protocol::Isdv4 => seven(
                0xa0 | (eraser | second) << 2 | side << 1 | tip,
                &[x >> 9, x >> 2, y >> 9, y >> 2, p, (x & 3) << 5 | (y & 3) << 3 | p >> 7, tx, ty],
            ),
            Protocol::WacomIv => {
                let z = p ^ 0x80;
                let keys = tip | side << 1 | (eraser | second) << 2;
                let pressed = u32::from(keys != 0);
                seven(
                    0xe0 | pressed << 3 | x >> 14,
                    &[x >> 7, x, keys << 3 | (z & 1) << 2 | y >> 14, y >> 7, y, z >> 1, tx, ty],
                )
            }
            Protocol::WacomV => seven(
                0xe0 | second << 2 | side << 1,
                &[
                    x >> 9,
                    x >> 2,
                    (x & 3) << 5 | y >> 11,
                    y >> 4,
                    (y & 0xf) << 3 | p >> 7,
                    p,
                    tx,
                    ty,
                ],
            ),
            Protocol::SummaMm => {
                seven(0x98 | second << 2 | side << 1 | tip, &[x, x >> 7, y, y >> 7])
            }
        }
    }

    fn away(&self) -> Vec<u8> {
        match self.protocol {
            Protocol::Isdv4 | Protocol::WacomV => vec![0x80, 0, 0, 0, 0, 0, 0, 0, 0],
            Protocol::WacomIv => vec![0xa0, 0, 0, 0, 0, 0, 0, 0, 0],
            Protocol::SummaMm => vec![0xd8, 0, 0, 0, 0],
        }
    }

    /// The answer to what the host has written so far, which is taken out of `said`; and whether
    /// the stream is on.
    pub(super) fn answer(&self, said: &mut Vec<u8>, streaming: &mut bool) -> Vec<u8> {
        let (mut reply, words) = (Vec::new(), std::mem::take(said));
        let [x, y] = self.facts.max.map(|m| m as u32);
        let mut rest = &words[..];
        let is = |word: &[u8], rest: &mut &[u8]| match rest.strip_prefix(word) {
            Some(tail) => {
                *rest = tail;
                true
            }
            None => false,
        };
        while !rest.is_empty() {
            match self.protocol {
                Protocol::Isdv4 if is(b"0", &mut rest) => *streaming = false,
                Protocol::Isdv4 if is(b"1", &mut rest) => *streaming = true,
                Protocol::Isdv4 if is(b"*", &mut rest) => {
                    let p = self.facts.max_pressure;
                    let low = (x & 3) << 5 | (y & 3) << 3 | p >> 7;
                    let t = TILT_LIMIT as u32;
                    let fields = [x >> 9, x >> 2, y >> 9, y >> 2, p, low, t, t, 0, 1];
                    reply.push(0xc0);
                    reply.extend(fields.map(|v| (v & 0x7f) as u8));
                }
                Protocol::Isdv4 if is(b"%", &mut rest) => {
                    reply.extend([0xc0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])
                }
                Protocol::WacomIv if is(b"~#", &mut rest) => {
                    reply.extend(b"~#UD-0608-R00,V1.4-4\r")
                }
                Protocol::WacomV if is(b"~#", &mut rest) => reply.extend(b"~#GD-0608-R,V1.2-0\r"),
                Protocol::WacomIv | Protocol::WacomV if is(b"~C\r", &mut rest) => {
                    reply.extend(format!("~C{x},{y}\r").bytes());
                }
                Protocol::WacomIv if is(b"~R\r", &mut rest) => {
                    reply.extend(b"~RE202C910,002,02,1270,1270\r")
                }
                Protocol::WacomIv | Protocol::WacomV if is(b"ST\r", &mut rest) => *streaming = true,
                Protocol::WacomIv | Protocol::WacomV if is(b"\r#", &mut rest) => *streaming = false,
                Protocol::SummaMm if is(b"z?", &mut rest) => reply.extend(b"MM1201"),
                Protocol::SummaMm if is(b"ha", &mut rest) => {
                    reply.extend([
                        0x98,
                        (x & 0x7f) as u8,
                        (x >> 7) as u8,
                        (y & 0x7f) as u8,
                        (y >> 7) as u8,
                    ]);
                }
                Protocol::SummaMm if is(b"@", &mut rest) => *streaming = true,
                Protocol::SummaMm if is(b"B", &mut rest) => *streaming = false,
                // A question that has not wholly come yet is kept; a word that is none of the
                // questions is read over.
                _ if rest.len() < 3
                    && [&b"~"[..], b"~C", b"~R", b"S", b"ST", b"\r", b"z", b"h"]
                        .contains(&rest) =>
                {
                    said.extend_from_slice(rest);
                    break;
                }
                _ => rest = &rest[1..],
            }
        }
        reply
    }
}

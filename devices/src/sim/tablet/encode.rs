//! A pen's pose as HID reports, by family: the inverse of what the parsers in `hid/` read.

use glam::Vec2;

use crate::catalogue::Found;
use crate::sim::pen::PenPose;
use crate::tablet::{Area, Family};

/// Most that any family's tilt fields carry, in degrees.
const TILT_LIMIT: f32 = 60.0;

#[derive(Debug, Clone)]
pub(super) struct Encoder {
    family: Family,
    area: Area,
    max_pressure: u32,
    max_distance: u32,
    /// Bytes before each report, as the maker's Windows driver puts them.
    skip: usize,
    /// `Some(eraser)` while the pen is in range.
    inside: Option<bool>,
}

/// A pose in counts.
struct Counts {
    x: u32,
    y: u32,
    p: u32,
    tilt: [i32; 2],
    height: u32,
    buttons: u32,
}

impl Encoder {
    pub(super) fn new(found: &Found) -> Option<Self> {
        let (tablet, id) = (&found.tablet, found.id());
        Self::writes(id.parser).then_some(Encoder {
            family: id.parser,
            area: tablet.area,
            max_pressure: tablet.pen.max_pressure,
            max_distance: tablet.pen.max_distance,
            skip: usize::from(id.skip),
            inside: None,
        })
    }

    pub(super) fn writes(family: Family) -> bool {
        family != Family::Digitiser
    }

    /// The reports for one instant; none while the pen is away and that has been said.
    pub(super) fn reports(&mut self, pose: &PenPose) -> Vec<Vec<u8>> {
        let mut out = Vec::new();
        if self.inside.is_some_and(|e| !pose.in_range || e != pose.eraser) {
            self.inside = None;
            out.push(self.away());
        }
        if pose.in_range {
            if self.inside.is_none() {
                self.inside = Some(pose.eraser);
                out.extend(self.enter(pose.eraser));
            }
            out.push(self.report(&self.counts(pose)));
        }
        if self.skip > 0 {
            out.iter_mut().for_each(|r| {
                r.splice(0..0, std::iter::repeat_n(0, self.skip));
            });
        }
        out
    }

    fn counts(&self, pose: &PenPose) -> Counts {
        let a = &self.area;
        let size = Vec2::new(a.width_mm as f32, a.height_mm as f32);
        let share = (pose.pos_mm / size).clamp(Vec2::ZERO, Vec2::ONE);
        let axis = |s: f32, min: i32, max: i32| (min as f32 + s * (max - min) as f32).round() as u32;
        let degrees = |r: f32| r.to_degrees().round().clamp(-TILT_LIMIT, TILT_LIMIT) as i32;
        Counts {
            x: axis(share.x, a.min_x, a.max_x),
            y: axis(share.y, a.min_y, a.max_y),
            p: (pose.pressure.clamp(0.0, 1.0) * self.max_pressure as f32).round() as u32,
            tilt: [degrees(pose.tilt.x), degrees(pose.tilt.y)],
            height: (pose.height.clamp(0.0, 1.0) * self.max_distance as f32).round() as u32,
            buttons: pose.buttons,
        }
    }

    /// What a family says as a pen enters, before its first place.
    fn enter(&self, eraser: bool) -> Option<Vec<u8>> {
        match self.family {
            Family::WacomIntuosV1 => {
                let id: u32 = if eraser { 0x80a } else { 0x802 };
                Some(vec![0x02, 0xc2, (id >> 4) as u8, ((id & 0xf) << 4) as u8, 0, 0, 0, 0, 0, 0])
            }
            _ => None,
        }
    }

    fn away(&self) -> Vec<u8> {
        vec![0x02, 0x80, 0, 0, 0, 0, 0, 0, 0, 0]
    }

    fn report(&self, c: &Counts) -> Vec<u8> {
        let p = if self.max_pressure < 2047 { c.p << 1 } else { c.p };
        let (x, y) = (c.x >> 1, c.y >> 1);
        let tilt = c.tilt.map(|t| (t + 64) as u32);
        let b1 = 0xe0 | c.buttons << 1 & 6 | p & 1;
        let b9 = c.height << 2 | (c.x & 1) << 1 | c.y & 1;
        let bytes = [
            0x02,
            b1,
            x >> 8,
            x,
            y >> 8,
            y,
            p >> 3,
            p << 5 & 0xc0 | tilt[0] >> 1,
            tilt[0] << 7 | tilt[1],
            b9,
        ];
        bytes.map(|b| b as u8).to_vec()
    }
}

//! A pen's pose as HID reports, by family: the inverse of the parsers in `hid/`, which document the
//! facts and sources.

use glam::Vec2;

use super::reports::{self, PoseCounts};
use crate::catalogue::Found;
use crate::sim::pen::PenPose;
use crate::tablet::{Area, Family, Quirk};

/// Most that any family's tilt fields carry, in degrees.
const TILT_LIMIT: f32 = 60.0;

#[derive(Debug, Clone)]
pub(super) struct Encoder {
    pub(super) family: Family,
    area: Area,
    max_pressure: u32,
    max_distance: u32,
    quirks: Vec<Quirk>,
    /// Longest report as the model's file has it.
    length: usize,
    /// Bytes that the vendor's Windows driver puts before each report.
    skip: usize,
    /// `Some(eraser)` while the pen is in range.
    inside: Option<bool>,
}

impl Encoder {
    pub(super) fn new(found: &Found) -> Self {
        let (tablet, id) = (&found.tablet, found.id());
        Encoder {
            family: id.parser,
            area: tablet.area,
            max_pressure: tablet.pen.max_pressure,
            max_distance: tablet.pen.max_distance,
            quirks: id.quirks.clone(),
            length: usize::from(id.length).saturating_sub(usize::from(id.skip)),
            skip: usize::from(id.skip),
            inside: None,
        }
    }

    /// Returns true if this model's reports show when the pen leaves; else only silence does.
    pub(super) fn says_away(&self) -> bool {
        reports::away(self.family).is_some()
    }

    /// The reports for one instant. Empty while the pen is out of range, after the report that says
    /// so.
    pub(super) fn reports(&mut self, pose: &PenPose) -> Vec<Vec<u8>> {
        let mut out = Vec::new();
        if self.inside.is_some_and(|e| !pose.in_range || e != pose.eraser) {
            self.inside = None;
            out.extend(reports::away(self.family));
        }
        if pose.in_range {
            if self.inside.is_none() {
                self.inside = Some(pose.eraser);
                out.extend(self.enter(pose.eraser));
            }
            out.push(self.report(pose));
        }
        if self.skip > 0 {
            for report in &mut out {
                report.splice(0..0, std::iter::repeat_n(0, self.skip));
            }
        }
        out
    }

    /// The report that a family sends as a pen enters, before the first position.
    fn enter(&self, eraser: bool) -> Option<Vec<u8>> {
        (self.family == Family::WacomIntuosV1).then(|| {
            // Numbers of an Intuos 4 pen and of its other end.
            let id: u32 = if eraser { 0x1080a } else { 0x10802 };
            let bytes = [0x02, 0xc2, id >> 4, id << 4, 0, 0, 0, id >> 16, 0, 0];
            bytes.map(|b| b as u8).to_vec()
        })
    }

    fn report(&self, pose: &PenPose) -> Vec<u8> {
        let counts = self.counts(pose);
        let quirk = |q| self.quirks.contains(&q);
        match self.family {
            Family::WacomIntuosV1 => reports::intuos(&PoseCounts {
                p: if self.max_pressure < 2047 { counts.p << 1 } else { counts.p },
                height: match () {
                    () if quirk(Quirk::HeightInverted) => self.max_distance - counts.height,
                    () if quirk(Quirk::Halved) => counts.height << 1,
                    () => counts.height,
                },
                x: if quirk(Quirk::Halved) { counts.x << 1 } else { counts.x },
                y: if quirk(Quirk::Halved) { counts.y << 1 } else { counts.y },
                ..counts
            }),
            Family::WacomSimple => reports::simple(&counts, self.max_distance),
            Family::WacomPl => reports::pl(&counts, self.max_pressure),
            Family::UcLogic | Family::XpPenOffset => {
                // The short forms cannot carry the coordinates of a large tablet.
                let least = if self.area.max_x.max(self.area.max_y) > 0xffff { 12 } else { 8 };
                reports::uclogic(
                    &counts,
                    self.length.clamp(least, 12),
                    self.family == Family::XpPenOffset,
                )
            }
            family => reports::other(family, &counts),
        }
    }

    fn counts(&self, pose: &PenPose) -> PoseCounts {
        let a = &self.area;
        let size = Vec2::new(a.width_mm as f32, a.height_mm as f32);
        let share = (pose.pos_mm / size).clamp(Vec2::ZERO, Vec2::ONE);
        let axis =
            |s: f32, min: i32, max: i32| (min as f32 + s * (max - min) as f32).round() as u32;
        let degrees = |r: f32| r.to_degrees().round().clamp(-TILT_LIMIT, TILT_LIMIT) as i32;
        PoseCounts {
            x: axis(share.x, a.min_x, a.max_x),
            y: axis(share.y, a.min_y, a.max_y),
            p: (pose.pressure.clamp(0.0, 1.0) * self.max_pressure as f32).round() as u32,
            tilt: [degrees(pose.tilt.x), degrees(pose.tilt.y)],
            height: (pose.height.clamp(0.0, 1.0) * self.max_distance as f32).round() as u32,
            tip: pose.tip,
            eraser: pose.eraser,
            buttons: pose.buttons & 3,
        }
    }
}

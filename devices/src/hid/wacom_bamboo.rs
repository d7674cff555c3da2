//! Wacom's simple reports: Bamboo Pen, Pen & Touch, One by Wacom, Intuos (2013), and the Bamboo
//! Pad. Layouts from Linux `wacom_wac.c` (`wacom_bpt_pen`); agrees with its decode of real
//! recordings. Bamboo Pad: OpenTabletDriver.

use crate::report::{Parsed, PenReport, byte, u16_at};
use crate::sample::Tool;

/// State kept between reports: the tool of this visit, known once the pen was placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BambooMemory {
    tool: Option<Tool>,
}

/// `max_distance` turns the count, which grows toward the surface, into height.
pub fn parse(b: &[u8], max_distance: u32, memory: &mut BambooMemory) -> Parsed {
    if b.first() != Some(&2) {
        return Parsed::Nothing;
    }
    if b.len() < 9 {
        return Parsed::Broken;
    }
    // Longer reports are for touch.
    if b.len() > 10 {
        return Parsed::Nothing;
    }
    let flags = b[1];
    let (range, placed, ready) = (flags & 0x80 != 0, flags & 0x40 != 0, flags & 0x20 != 0);
    if !range {
        memory.tool = None;
        return Parsed::Away;
    }
    if placed {
        // An eraser is one for the whole visit.
        memory.tool.get_or_insert(if flags & 8 != 0 { Tool::Eraser } else { Tool::Pen });
    }
    let Some(tool) = memory.tool else { return Parsed::Nothing };
    Parsed::Pen(PenReport {
        tool: Some(tool),
        tip: Some(ready && flags & 1 != 0),
        pos: placed.then(|| [u16_at(b, 2) as i32, u16_at(b, 4) as i32]),
        pressure: Some(if ready { u16_at(b, 6) } else { 0 }),
        distance: (max_distance > 0).then(|| max_distance.saturating_sub(u32::from(b[8]))),
        buttons: Some(if ready { u32::from(flags >> 1 & 3) } else { 0 }),
        ..PenReport::default()
    })
}

/// Bamboo Pad: report 10, kind 01.
pub fn bamboo_pad(b: &[u8]) -> Parsed {
    if b.first() != Some(&0x10) || byte(b, 1) != 1 {
        return Parsed::Nothing;
    }
    if b.len() < 9 {
        return Parsed::Broken;
    }
    Parsed::Pen(PenReport {
        tool: Some(if b[2] & 8 != 0 { Tool::Eraser } else { Tool::Pen }),
        pos: Some([u16_at(b, 3) as i32, u16_at(b, 5) as i32]),
        pressure: Some(u16_at(b, 7)),
        buttons: Some(u32::from(b[2] >> 1 & 1)),
        ..PenReport::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_visit_from_sensed_to_gone() {
        let mut m = BambooMemory::default();
        let sensed = [2, 0x80, 0, 0, 0, 0, 0, 0, 0];
        assert_eq!(parse(&sensed, 31, &mut m), Parsed::Nothing, "sensed, never placed");
        let Parsed::Pen(p) = parse(&[2, 0xf1, 0x10, 0x27, 1, 0, 0xff, 3, 30], 31, &mut m) else {
            panic!()
        };
        assert_eq!(
            (p.pos, p.pressure, p.distance, p.tip),
            (Some([10_000, 1]), Some(1023), Some(1), Some(true))
        );
        let Parsed::Pen(p) = parse(&sensed, 31, &mut m) else { panic!("still in range") };
        assert_eq!((p.pos, p.pressure, p.distance, p.tip), (None, Some(0), Some(31), Some(false)));
        assert_eq!(parse(&[2, 0, 0, 0, 0, 0, 0, 0, 0], 31, &mut m), Parsed::Away);
    }
}

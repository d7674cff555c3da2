//! Wacom Graphire, the first Bamboos, Volito, PenStation and PenPartner. Layouts from Linux
//! `wacom_wac.c` (`wacom_graphire_irq`, `wacom_penpartner_irq`); agrees with its decode of real
//! recordings.

use crate::report::{PadReport, Parsed, PenReport, byte, u16_at};
use crate::sample::Tool;

/// Encoding of pressure and pad in one tablet of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GraphireKind {
    /// Graphire 1 to 3.
    #[default]
    Graphire,
    /// Graphire 4: keys and wheel in byte 7.
    Graphire4,
    /// First Bamboos with a touch ring (byte 8) and four keys.
    Ring,
    /// Graphire Bluetooth: report 03, bit 8 of pressure in byte 1.
    Bluetooth,
}

/// Reads the pen or the puck of one report.
pub fn parse(b: &[u8], kind: GraphireKind) -> Parsed {
    let id = if kind == GraphireKind::Bluetooth { 0x03 } else { 0x02 };
    if b.first() != Some(&id) {
        return Parsed::Nothing;
    }
    if b.len() < 8 {
        return Parsed::Broken;
    }
    let flags = b[1];
    if flags & 0x80 == 0 {
        return Parsed::Away;
    }
    let tool = match flags >> 5 & 3 {
        0 => Tool::Pen,
        1 => Tool::Eraser,
        _ => Tool::Mouse,
    };
    let mut pen = PenReport {
        tool: Some(tool),
        tip: Some(false),
        pos: Some([u16_at(b, 2) as i32, u16_at(b, 4) as i32]),
        ..PenReport::default()
    };
    if tool == Tool::Mouse {
        pen.buttons = Some(u32::from(flags & 7));
    } else {
        pen.tip = Some(flags & 1 != 0);
        pen.buttons = Some(u32::from(flags >> 1 & 3));
        pen.pressure = Some(match kind {
            GraphireKind::Bluetooth => u32::from(b[6]) | u32::from(flags & 8) << 5,
            _ => u32::from(b[6]) | u32::from(b[7] & 3) << 8,
        });
    }
    Parsed::Pen(pen)
}

/// The pad shares its reports with the pen.
pub fn pad(b: &[u8], kind: GraphireKind) -> Option<PadReport> {
    if b.len() < 8 {
        return None;
    }
    match kind {
        GraphireKind::Graphire => None,
        GraphireKind::Graphire4 => {
            let steps = i32::from(b[7] >> 3 & 3) - i32::from(b[7] >> 3 & 4);
            Some(PadReport {
                keys: Some(u32::from(b[7] >> 6)),
                turned: (steps != 0).then_some((0, steps)),
                strip: None,
            })
        }
        GraphireKind::Ring => {
            let ring = byte(b, 8);
            let place = (ring & 0x80 != 0).then_some(f32::from(ring & 0x7f) / 71.0);
            Some(PadReport {
                keys: Some(u32::from(b[7] >> 3 & 0x0f)),
                turned: None,
                strip: Some((0, place.map(|p| p.min(1.0)))),
            })
        }
        GraphireKind::Bluetooth => {
            Some(PadReport { keys: Some(u32::from(b[7] & 3)), ..PadReport::default() })
        }
    }
}

/// PenPartner: report 01 says when the pen leaves, report 02 (older) never does.
pub fn pen_partner(b: &[u8]) -> Parsed {
    let id = byte(b, 0);
    if !matches!(id, 1 | 2) {
        return Parsed::Nothing;
    }
    if b.len() < 7 {
        return Parsed::Broken;
    }
    let (flags, press) = (b[5], i32::from(b[6] as i8));
    if id == 1 && flags & 0x80 == 0 {
        return Parsed::Away;
    }
    let tip = if id == 1 { press > -127 } else { press > -80 && flags & 0x20 == 0 };
    Parsed::Pen(PenReport {
        tool: Some(if id == 1 && flags & 0x20 != 0 { Tool::Eraser } else { Tool::Pen }),
        tip: Some(tip),
        pos: Some([u16_at(b, 1) as i32, u16_at(b, 3) as i32]),
        pressure: Some((press + 127).max(0) as u32),
        buttons: Some(u32::from(flags >> 6 & 1)),
        ..PenReport::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tools_are_told_apart_and_leave() {
        let tool_of = |flags: u8| match parse(&[2, flags, 1, 0, 2, 0, 9, 1], GraphireKind::Graphire)
        {
            Parsed::Pen(p) => (p.tool, p.tip, p.pressure),
            other => panic!("{other:?}"),
        };
        assert_eq!(tool_of(0x91), (Some(Tool::Pen), Some(true), Some(265)));
        assert_eq!(tool_of(0xb1), (Some(Tool::Eraser), Some(true), Some(265)));
        assert_eq!(tool_of(0xd1), (Some(Tool::Mouse), Some(false), None));
        assert_eq!(parse(&[2, 0x10, 0, 0, 0, 0, 0, 0], GraphireKind::Graphire), Parsed::Away);
        assert_eq!(parse(&[2, 0x91, 0], GraphireKind::Graphire), Parsed::Broken);
    }
}

//! Wacom's older pen displays and tablet PCs: PL, PTU, DTU, DTUS and the USB form of ISDV4. Layouts
//! from Linux `wacom_wac.c` (`wacom_pl_irq`, `wacom_ptu_irq`, `wacom_dtu_irq`, `wacom_dtus_irq`,
//! `wacom_tpc_pen`).

use crate::report::{PadReport, Parsed, PenReport, be16_at, byte, u16_at};
use crate::sample::Tool;

/// Report layout of the tablet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DisplayKind {
    /// PL and DTF: 7-bit bytes.
    Pl,
    /// PTU: little-endian axes, pressure of nine bits.
    Ptu,
    /// DTU: little-endian axes.
    Dtu,
    /// DTU-1031 and its kind: report 11, big-endian axes.
    Dtus,
    /// Tablet PCs: report 02.
    TabletPc,
}

/// State of a PL: the tool, decided as the pen enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DisplayMemory {
    tool: Option<Tool>,
}

/// Reads one report, its id first. `max_pressure` is the model's.
pub fn parse(b: &[u8], kind: DisplayKind, max_pressure: u32, memory: &mut DisplayMemory) -> Parsed {
    match (kind, byte(b, 0)) {
        (DisplayKind::Dtus, 0x11) => checked(b, 8, |b| dtus(b, memory)),
        (DisplayKind::Dtus, 0x15) if b.len() >= 2 => {
            Parsed::Pad(PadReport { keys: Some(u32::from(b[1] & 0x0f)), ..PadReport::default() })
        }
        (DisplayKind::Pl, 2) => checked(b, 8, |b| pl(b, max_pressure, memory)),
        (DisplayKind::Ptu, 2) => checked(b, 8, ptu),
        (DisplayKind::Dtu, 2) => checked(b, 8, |b| entered(b, 1, memory)),
        (DisplayKind::TabletPc, 2) => checked(b, 8, |b| entered(b, 7, memory)),
        _ => Parsed::Nothing,
    }
}

fn checked(b: &[u8], least: usize, read: impl FnOnce(&[u8]) -> Parsed) -> Parsed {
    if b.len() < least { Parsed::Broken } else { read(b) }
}

fn pl(b: &[u8], max_pressure: u32, memory: &mut DisplayMemory) -> Parsed {
    if b[1] & 0x40 == 0 {
        memory.tool = None;
        return Parsed::Away;
    }
    let both = b[4] & 0x20 != 0;
    let tool = *memory.tool.get_or_insert(if both { Tool::Eraser } else { Tool::Pen });
    // An eraser always sets the second button's bit: without it the tool is a pen.
    let tool = if tool == Tool::Eraser && !both { Tool::Pen } else { tool };
    memory.tool = Some(tool);
    let mut p = i32::from((b[7] << 1 | (b[4] >> 2 & 1)) as i8);
    if max_pressure > 255 {
        p = p << 1 | i32::from(b[4] >> 6 & 1);
    }
    p += (max_pressure as i32 + 1) / 2;
    let axis =
        |hi: u8, mid: u8, low: u8| i32::from(hi & 3) << 14 | i32::from(mid) << 7 | i32::from(low);
    let second = tool == Tool::Pen && both;
    Parsed::Pen(PenReport {
        tool: Some(tool),
        tip: Some(b[4] & 8 != 0),
        pos: Some([axis(b[1], b[2], b[3]), axis(b[4], b[5], b[6])]),
        pressure: Some(p.max(0) as u32),
        buttons: Some(u32::from(b[4] >> 4 & 1) | u32::from(second) << 1),
        ..PenReport::default()
    })
}

fn ptu(b: &[u8]) -> Parsed {
    if b[1] & 0x20 == 0 {
        return Parsed::Away;
    }
    let eraser = b[1] & 4 != 0;
    Parsed::Pen(PenReport {
        tool: Some(if eraser { Tool::Eraser } else { Tool::Pen }),
        tip: Some(b[1] & if eraser { 8 } else { 1 } != 0),
        pos: Some([u16_at(b, 2) as i32, u16_at(b, 4) as i32]),
        pressure: Some(u16_at(b, 6)),
        buttons: Some(u32::from(b[1] >> 1 & 1) | u32::from(b[1] >> 4 & 1) << 1),
        ..PenReport::default()
    })
}

/// DTU and tablet PC differ in how many high bits of pressure there are.
fn entered(b: &[u8], high: u8, memory: &mut DisplayMemory) -> Parsed {
    if b[1] & 0x20 == 0 {
        memory.tool = None;
        return Parsed::Away;
    }
    let tool = *memory.tool.get_or_insert(if b[1] & 0x0c != 0 { Tool::Eraser } else { Tool::Pen });
    Parsed::Pen(PenReport {
        tool: Some(tool),
        tip: Some(b[1] & 5 != 0),
        pos: Some([u16_at(b, 2) as i32, u16_at(b, 4) as i32]),
        pressure: Some(u32::from(b[6]) | u32::from(b[7] & high) << 8),
        buttons: Some(u32::from(b[1] >> 1 & 1) | u32::from(b[1] >> 4 & 1) << 1),
        ..PenReport::default()
    })
}

fn dtus(b: &[u8], memory: &mut DisplayMemory) -> Parsed {
    if b[1] & 0x80 == 0 {
        memory.tool = None;
        return Parsed::Away;
    }
    match b[1] >> 3 & 3 {
        1 => memory.tool = Some(Tool::Eraser),
        2 => memory.tool = Some(Tool::Pen),
        _ => {}
    }
    Parsed::Pen(PenReport {
        tool: Some(memory.tool.unwrap_or(Tool::Pen)),
        pos: Some([be16_at(b, 3) as i32, be16_at(b, 5) as i32]),
        pressure: Some(u32::from(b[1] & 3) << 8 | u32::from(b[2])),
        buttons: Some(u32::from(b[1] >> 5 & 3)),
        ..PenReport::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pl_pen_is_decided_at_entry() {
        let mut m = DisplayMemory::default();
        let hover = |b4: u8, b7: u8| [2, 0x41, 2, 3, b4, 5, 6, b7];
        let Parsed::Pen(p) = parse(&hover(0x20, 0x40), DisplayKind::Pl, 511, &mut m) else {
            panic!()
        };
        assert_eq!((p.tool, p.buttons), (Some(Tool::Eraser), Some(0)));
        assert_eq!(p.pos, Some([1 << 14 | 2 << 7 | 3, 5 << 7 | 6]));
        let Parsed::Pen(p) = parse(&hover(0x00, 0x40), DisplayKind::Pl, 511, &mut m) else {
            panic!()
        };
        assert_eq!(p.tool, Some(Tool::Pen), "it never was an eraser");
        let Parsed::Pen(p) = parse(&hover(0x20, 0x3f), DisplayKind::Pl, 511, &mut m) else {
            panic!()
        };
        assert_eq!((p.tool, p.buttons, p.pressure), (Some(Tool::Pen), Some(2), Some(508)));
        assert_eq!(parse(&[2, 0, 0, 0, 0, 0, 0, 0], DisplayKind::Pl, 511, &mut m), Parsed::Away);
    }
}

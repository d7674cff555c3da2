//! Smaller families, one function each. Layouts from OpenTabletDriver (facts) unless a line says
//! otherwise.

use crate::report::{PadReport, Parsed, PenReport, be16_at, byte, s8_at, u16_at, u24_at};
use crate::sample::Tool;

fn tool(eraser: bool) -> Option<Tool> {
    Some(if eraser { Tool::Eraser } else { Tool::Pen })
}

fn at(x: u32, y: u32) -> Option<[i32; 2]> {
    Some([x as i32, y as i32])
}

/// VEIKK, 13 bytes; `short` is the A15's form with 16-bit axes in 9 bytes.
pub fn veikk(b: &[u8], short: bool) -> Parsed {
    if b.len() < 9 {
        return if matches!(byte(b, 1), 0x41) { Parsed::Broken } else { Parsed::Nothing };
    }
    match (b[1], b[2]) {
        (0x42, _) => Parsed::Pad(PadReport { keys: Some(u16_at(b, 4)), ..PadReport::default() }),
        (0x43, _) => Parsed::Nothing,
        (_, f) if f & 0x20 == 0 => Parsed::Away,
        (_, f) => {
            let long = !short && b.len() >= 11;
            let (pos, pressure) = if long {
                (at(u24_at(b, 3), u24_at(b, 6)), u16_at(b, 9))
            } else {
                (at(u16_at(b, 3), u16_at(b, 5)), u16_at(b, 7))
            };
            Parsed::Pen(PenReport {
                tool: tool(false),
                tip: Some(f & 1 != 0),
                pos,
                pressure: Some(pressure),
                tilt: (long && b.len() >= 13).then(|| [s8_at(b, 11), s8_at(b, 12)]),
                buttons: Some(u32::from(f >> 1 & 3)),
                ..PenReport::default()
            })
        }
    }
}

/// Acepen: VEIKK's frame with its axes at 3 and 5 and tilt at 9.
pub fn acepen(b: &[u8]) -> Parsed {
    match (byte(b, 1), byte(b, 2)) {
        (0x41, _) if b.len() < 11 => Parsed::Broken,
        (0x41, f) if f & 0xf0 == 0xa0 => Parsed::Pen(PenReport {
            tool: tool(false),
            tip: Some(f & 1 != 0),
            pos: at(u16_at(b, 3), u16_at(b, 5)),
            pressure: Some(u16_at(b, 7)),
            tilt: Some([s8_at(b, 9), s8_at(b, 10)]),
            buttons: Some(u32::from(f >> 1 & 3)),
            ..PenReport::default()
        }),
        (0x41, _) => Parsed::Away,
        _ => Parsed::Nothing,
    }
}

/// Genius and KYE, report 02: tip in bit 2 of byte 5. Lifetec is alike.
pub fn kye(b: &[u8]) -> Parsed {
    match byte(b, 0) {
        0x02 => {}
        0x05 if b.len() >= 4 => {
            return Parsed::Pad(PadReport { keys: Some(u16_at(b, 1)), ..PadReport::default() });
        }
        _ => return Parsed::Nothing,
    }
    if b.len() < 8 {
        return Parsed::Broken;
    }
    let f = b[5];
    let tip = f & 4 != 0;
    Parsed::Pen(PenReport {
        tool: tool(false),
        tip: Some(tip),
        pos: at(u16_at(b, 1), u16_at(b, 3)),
        pressure: Some(if tip { u16_at(b, 6) } else { 0 }),
        buttons: Some(u32::from(f >> 3 & 3)),
        ..PenReport::default()
    })
}

/// 10moons: big-endian, pressure counted down from 0x672; a pressed button adds 50.
pub fn ten_moons(b: &[u8]) -> Parsed {
    if b.len() < 7 {
        return Parsed::Nothing;
    }
    let buttons = byte(b, 9) & 6;
    let raw = i64::from(be16_at(b, 5)) - if buttons != 0 { 50 } else { 0 };
    let y = (be16_at(b, 3) as u16 as i16).max(0);
    Parsed::Pen(PenReport {
        tool: tool(false),
        pos: at(be16_at(b, 1), y as u32),
        pressure: Some((0x672 - raw).max(0) as u32),
        buttons: Some(match buttons {
            4 => 1,
            6 => 2,
            _ => 0,
        }),
        ..PenReport::default()
    })
}

/// The plain layout: flags at 1, axes at 2 and 4, pressure at 6. No report says that the pen
/// leaves.
pub fn plain_layout(b: &[u8]) -> Parsed {
    if b.len() < 8 {
        return Parsed::Broken;
    }
    Parsed::Pen(PenReport {
        tool: tool(false),
        pos: at(u16_at(b, 2), u16_at(b, 4)),
        pressure: Some(u16_at(b, 6)),
        buttons: Some(u32::from(b[1] >> 1 & 3)),
        ..PenReport::default()
    })
}

/// XENX: report 01; an empty flag byte is a pen that has left.
pub fn xenx(b: &[u8]) -> Parsed {
    match (byte(b, 0), byte(b, 1)) {
        (1, _) if b.len() < 8 => Parsed::Broken,
        (1, 0) => Parsed::Away,
        (1, f) => Parsed::Pen(PenReport {
            tool: tool(f & 0x40 != 0),
            pos: at(u16_at(b, 2), u16_at(b, 4)),
            pressure: Some(u16_at(b, 6)),
            buttons: Some(u32::from(f >> 1 & 3)),
            ..PenReport::default()
        }),
        (2, _) => Parsed::Pad(PadReport { keys: Some(u16_at(b, 1)), ..PadReport::default() }),
        _ => Parsed::Nothing,
    }
}

/// RobotPen: kind 42 places, any other means that the pen has left.
pub fn robot_pen(b: &[u8]) -> Parsed {
    match byte(b, 1) {
        0x42 if b.len() < 12 => Parsed::Broken,
        0x42 => Parsed::Pen(PenReport {
            tool: tool(false),
            pos: at(u16_at(b, 6), u16_at(b, 8)),
            pressure: Some(u16_at(b, 10) & 0x0fff),
            buttons: Some(u32::from(b[11] >> 1 & 1)),
            ..PenReport::default()
        }),
        _ => Parsed::Away,
    }
}

/// ViewSonic WoodPad: 32-bit axes of which 16 count; bits 0 and 1 of byte 9 say in range.
pub fn wood_pad(b: &[u8]) -> Parsed {
    if b.len() < 12 {
        return Parsed::Broken;
    }
    let f = b[9];
    if f & 3 != 3 {
        return Parsed::Away;
    }
    let tip = f & 4 != 0;
    Parsed::Pen(PenReport {
        tool: tool(false),
        tip: Some(tip),
        pos: at(u16_at(b, 1), u16_at(b, 5)),
        pressure: Some(if tip { u16_at(b, 10) } else { 0 }),
        tilt: (b.len() >= 14).then(|| [s8_at(b, 12), s8_at(b, 13)]),
        buttons: Some(u32::from(f >> 3 & 3)),
        ..PenReport::default()
    })
}

/// Signature pads of Signotec and ViewSonic, report 02: in range is bit 1 and the tip bit 2 of byte
/// 5. A pen that hovers has five counts of pressure (Linux `hid-viewsonic.c`, recordings).
pub fn signature(b: &[u8]) -> Parsed {
    if byte(b, 0) != 0x02 {
        return Parsed::Nothing;
    }
    if b.len() < 8 {
        return Parsed::Broken;
    }
    if b[5] & 2 == 0 {
        return Parsed::Away;
    }
    let tip = b[5] & 4 != 0;
    Parsed::Pen(PenReport {
        tool: tool(false),
        tip: Some(tip),
        pos: at(u16_at(b, 1), u16_at(b, 3)),
        pressure: Some(if tip { u16_at(b, 6) } else { 0 }),
        ..PenReport::default()
    })
}

/// KYE's newer form, report 10: the plain layout with the tip in bit 0 and proximity in bit 7 of
/// byte 1 (the descriptors of Linux `hid-kye.c`).
pub fn kye_plain(b: &[u8]) -> Parsed {
    if byte(b, 0) != 0x10 {
        return Parsed::Nothing;
    }
    match plain_layout(b) {
        Parsed::Pen(_) if b[1] & 0x80 == 0 => Parsed::Away,
        Parsed::Pen(pen) => Parsed::Pen(PenReport { tip: Some(b[1] & 1 != 0), ..pen }),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_moons_counts_down_and_never_below_zero() {
        let read = |p: u16, f: u8| {
            let [hi, lo] = p.to_be_bytes();
            match ten_moons(&[6, 1, 2, 0, 5, hi, lo, 0, 0, f]) {
                Parsed::Pen(p) => (p.pos, p.pressure, p.buttons),
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(read(0x672, 0), (Some([0x102, 5]), Some(0), Some(0)));
        assert_eq!(read(0x600, 4), (Some([0x102, 5]), Some(0x72 + 50), Some(1)));
        assert_eq!(read(0xffff, 0).1, Some(0));
    }

    #[test]
    fn a_signature_pad_hovers_presses_and_leaves() {
        let read = |f: u8, p: u16| {
            let [lo, hi] = p.to_le_bytes();
            match signature(&[2, 0xac, 0x57, 0x2b, 0x0a, f, lo, hi, 0, 0]) {
                Parsed::Pen(p) => Some((p.pos, p.tip, p.pressure)),
                _ => None,
            }
        };
        let pos = Some([0x57ac, 0x0a2b]);
        assert_eq!(read(3, 5), Some((pos, Some(false), Some(0))));
        assert_eq!(read(7, 1239), Some((pos, Some(true), Some(1239))));
        assert_eq!(read(1, 0), None);
    }

    #[test]
    fn no_length_panics() {
        let bytes = [0xffu8, 0x42, 0x41, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
        for n in 0..bytes.len() {
            for first in [0u8, 1, 2, 5, 0x10] {
                let mut b = bytes[..n].to_vec();
                if let Some(b0) = b.first_mut() {
                    *b0 = first;
                }
                let all =
                    [plain_layout, kye, acepen, xenx, robot_pen, wood_pad, ten_moons, kye_plain];
                for f in all.into_iter().chain([signature as fn(&[u8]) -> Parsed]) {
                    f(&b);
                }
                veikk(&b, true);
                veikk(&b, false);
            }
        }
    }
}

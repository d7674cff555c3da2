//! Wacom's current pens: Intuos Pro 2 and Intuos 2018 (report 10, "V2"), Intuos Pro 2025 (report
//! 1E, "V3"), Wacom One (report 1F). Layouts from OpenTabletDriver and from these tablets' own
//! report descriptors.

use crate::report::{Batch, PadReport, Parsed, PenReport, byte, s8_at, s16_at, u16_at, u24_at};
use crate::sample::Tool;

/// Report layout of the tablet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProKind {
    /// Report 10: Intuos Pro of 2017, Intuos of 2018.
    V2,
    /// Report 1E: Intuos Pro of 2025.
    V3,
    /// Report 1F: Wacom One.
    One,
}

/// Reads a report of the pen, or of the pad that shares its interface.
pub fn parse(b: &[u8], kind: ProKind, out: &mut Batch) {
    out.push(match (kind, byte(b, 0)) {
        (ProKind::V2, 0x10) if b.len() < 12 => Parsed::Broken,
        (ProKind::V2, 0x10) => v2(b),
        (ProKind::V2, 0x11) if b.len() < 5 => Parsed::Broken,
        (ProKind::V2, 0x11) => Parsed::Pad(v2_pad(b)),
        (ProKind::V3, 0x1e) if b.len() < 15 => Parsed::Broken,
        (ProKind::V3, 0x1e) => v3(b),
        (ProKind::One, 0x1f) if byte(b, 1) != 1 => Parsed::Nothing,
        (ProKind::One, 0x1f) if b.len() < 9 => Parsed::Broken,
        (ProKind::One, 0x1f) => one(b),
        _ => Parsed::Nothing,
    });
}

/// Eight keys, the ring's own key as the ninth, and the ring, whose counts run against the clock.
fn v2_pad(b: &[u8]) -> PadReport {
    PadReport {
        keys: Some(u32::from(b[1]) | u32::from(b[3] & 1) << 8),
        strip: Some((0, ring_place(b[4]))),
        ..PadReport::default()
    }
}

/// The place of a finger on the ring of an Intuos Pro 2, clockwise from the left, 0 to 1; `None`
/// while it is not touched. Linux `wacom_intuos_pro2_bt_pad`.
pub(super) fn ring_place(v: u8) -> Option<f32> {
    let place = (71 - i32::from(v & 0x7f) + 3 * 72 / 16).rem_euclid(72);
    (v & 0x80 != 0).then_some(place as f32 / 72.0)
}

/// Bit 3: the eraser touches. Bit 4: the eraser is the end that is near (usages Eraser and Invert
/// of these tablets' descriptors).
fn end_of_pen(flags: u8) -> Tool {
    if flags & 0x18 != 0 { Tool::Eraser } else { Tool::Pen }
}

fn v2(b: &[u8]) -> Parsed {
    let f = b[1];
    if f & 0x60 == 0 {
        return Parsed::Away;
    }
    if f & 0x20 == 0 {
        // Sensed, not yet placed.
        return Parsed::Nothing;
    }
    Parsed::Pen(PenReport {
        tool: Some(end_of_pen(f)),
        tip: Some(f & 9 != 0),
        pos: Some([u24_at(b, 2) as i32, u24_at(b, 5) as i32]),
        pressure: Some(u16_at(b, 8)),
        tilt: Some([s8_at(b, 10), s8_at(b, 11)]),
        distance: (b.len() > 16).then(|| u32::from(b[16])),
        buttons: Some(u32::from(f >> 1 & 3)),
        ..PenReport::default()
    })
}

fn v3(b: &[u8]) -> Parsed {
    let f = b[2];
    if f & 0xc0 == 0 {
        return Parsed::Away;
    }
    if f & 0x40 == 0 {
        return Parsed::Nothing;
    }
    // The descriptor: tilt in whole degrees, twist in fifths of one.
    let tilt = [s16_at(b, 11), s16_at(b, 13)];
    Parsed::Pen(PenReport {
        tool: Some(if f & 0x30 != 0 { Tool::Eraser } else { Tool::Pen }),
        tip: Some(f & 0x11 != 0),
        pos: Some([u24_at(b, 3) as i32, u24_at(b, 6) as i32]),
        pressure: Some(u16_at(b, 9)),
        tilt: Some(tilt),
        twist: (b.len() > 16).then(|| (s16_at(b, 15) / 5.0).to_radians()),
        distance: (b.len() > 19).then(|| u32::from(b[19])),
        buttons: Some(u32::from(f >> 1 & 7)),
    })
}

fn one(b: &[u8]) -> Parsed {
    let f = b[2];
    if f & 0x60 == 0 {
        return Parsed::Away;
    }
    Parsed::Pen(PenReport {
        tool: Some(end_of_pen(f)),
        tip: Some(f & 9 != 0),
        pos: Some([u16_at(b, 3) as i32, u16_at(b, 5) as i32]),
        pressure: Some(u16_at(b, 7)),
        tilt: (b.len() > 12).then(|| [s16_at(b, 9) / 100.0, s16_at(b, 11) / 100.0]),
        distance: (b.len() > 13).then(|| u32::from(b[13])),
        buttons: Some(u32::from(f >> 1 & 3)),
        ..PenReport::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eraser_of_each_layout_hovers_and_touches() {
        // Report, offset of the flags, bits: in range, invert, eraser.
        let layouts = [
            (ProKind::V2, 0x10, 1, [0x60, 0x10, 0x08]),
            (ProKind::V3, 0x1e, 2, [0xc0, 0x20, 0x10]),
            (ProKind::One, 0x1f, 2, [0x60, 0x10, 0x08]),
        ];
        for (kind, id, at, [range, invert, eraser]) in layouts {
            let read = |flags: u8| {
                let mut b = [0u8; 27];
                (b[0], b[1], b[at]) = (id, if at == 2 { 1 } else { 0 }, flags);
                let mut out = Batch::default();
                parse(&b, kind, &mut out);
                match out.as_slice() {
                    [Parsed::Pen(p)] => (p.tool, p.tip),
                    other => panic!("{kind:?}: {other:?}"),
                }
            };
            assert_eq!(read(range), (Some(Tool::Pen), Some(false)));
            assert_eq!(read(range | 1), (Some(Tool::Pen), Some(true)));
            assert_eq!(read(range | invert), (Some(Tool::Eraser), Some(false)), "{kind:?}");
            let touching = (Some(Tool::Eraser), Some(true));
            assert_eq!(read(range | invert | eraser), touching, "{kind:?}");
            assert_eq!(read(range | eraser), touching, "{kind:?}");
        }
    }

    #[test]
    fn a_v2_pen_is_sensed_then_placed_then_gone() {
        let mut b = [0u8; 27];
        let parse = |b: &[u8], kind| {
            let mut out = Batch::default();
            parse(b, kind, &mut out);
            out.as_slice().first().copied().unwrap_or_default()
        };
        b[0] = 0x10;
        assert_eq!(parse(&b, ProKind::V2), Parsed::Away);
        b[1] = 0x40;
        assert_eq!(parse(&b, ProKind::V2), Parsed::Nothing);
        b[1] = 0x61;
        (b[2], b[4], b[10], b[16]) = (1, 1, 0xf6, 5);
        let Parsed::Pen(p) = parse(&b, ProKind::V2) else { panic!() };
        assert_eq!((p.pos, p.tilt, p.distance), (Some([0x10001, 0]), Some([-10.0, 0.0]), Some(5)));
        assert_eq!(parse(&b[..9], ProKind::V2), Parsed::Broken);
        let Parsed::Pad(pad) = parse(&[0x11, 0x81, 0, 1, 0x80 | 84, 0], ProKind::V2) else {
            panic!()
        };
        assert_eq!((pad.keys, pad.strip), (Some(0x181), Some((0, Some(0.0)))));
    }
}

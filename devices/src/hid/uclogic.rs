//! UC-Logic and its many names: XP-Pen, UGEE, Huion, Gaomon, Parblo, Artisul, Yiynova. One layout,
//! 8 to 14 bytes; what differs is which bit says "in range", and how pressure and high coordinate
//! bits are packed.
//!
//! | report id | in range | out |
//! |---|---|---|
//! | 08 (Huion v2) | `80` | `00` |
//! | 0A (Huion default) | `C0` | `00`, `80` |
//! | 02, 07 (XP-Pen, UC-Logic) | `A0` | `C0` |
//! | 07, 09 as a plain digitiser | `C0` | `80` |
//! | 07 once its keys are switched on (UC-Logic v1) | `80` | `C0` |
//! | 09 of a plain mouse form | `80` or none | `00` or silence |
//!
//! The last three share ids, so the bit is learned: a pressed tip proves that its report's bits
//! mean "in range". Sources: Linux `hid-uclogic-params.c`, OpenTabletDriver, and the real
//! recordings of all of these.

use crate::descriptor::{Bits, Descriptor};
use crate::report::{PadReport, Parsed, PenReport, byte, s8_at, u16_at};
use crate::sample::Tool;

/// Number encoding of one tablet of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Packing {
    /// 8 bytes; 10 with tilt at 8 and 9; 12 with high coordinate bytes at 10 and 11.
    #[default]
    XpPen,
    /// As XpPen, pressure counted from 8192.
    XpPenOffset,
    /// 14 bytes, pressure counted from 16384 with its bit 13 in byte 13.
    XpPenGen2,
    /// 12 bytes: high coordinate bits in bytes 8 and 9, tilt at 10 and 11.
    Huion,
    /// FlooGoo: bit 5 alone is the range; tilt in hundredths of a degree at 8 and 10.
    Fma,
}

/// Differences of one tablet from its family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UcLogicTraits {
    /// Number encoding.
    pub packing: Packing,
    /// The descriptor's own in-range bit of byte 1, where it has one: 5, 6 or 7.
    pub range_bit: Option<u8>,
    /// The tablet sends no tilt: the bytes mean something else.
    pub no_tilt: bool,
    /// Report ids, one a bit, that the descriptor describes without tilt.
    pub untilted: u32,
    /// Positions of the buttons in the described report.
    pub bits: UcLogicBits,
}

/// Bits of byte 1 in the report that the descriptor describes. Masks; 0 for a missing bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UcLogicBits {
    /// Id of the described report; 0 for none.
    id: u8,
    /// The second barrel button, where it is not bit 2.
    second: u8,
    /// The eraser touches.
    eraser: u8,
    /// The eraser is the end that is near.
    invert: u8,
    /// The descriptor calls the second button an eraser, and no button by its name; pressing it
    /// makes the pen seem to leave.
    pub second_bounces: bool,
    /// The third button shares the invert bit.
    pub third_is_invert: bool,
    /// Reports 08 are Huion's: bit 3 is the third button, bit 5 the eraser.
    pub huion: bool,
}

impl UcLogicBits {
    /// Reads them from the pen's own report. In the vendor's protocol bits 1 and 2 are the buttons,
    /// whatever the descriptor says; what its usages mean is decided by what the tablets send
    /// (Linux, HID-BPF programs `XPPen__Artist24`, `XPPen__ArtistPro16Gen2`,
    /// `Huion__Kamvas-Pro-19`):
    ///
    /// | usages | bit 2 is | invert is |
    /// |---|---|---|
    /// | Eraser alone | the second button | |
    /// | Eraser, Invert | the second button | the eraser; it touches with the tip's bit |
    /// | Eraser, Tablet Pick, Invert | the eraser's touch | the eraser |
    /// | Secondary Tip, Invert, Eraser | the second button | the third button, or the eraser |
    ///
    /// `bounces`: the vendor is one whose second button, called an eraser, makes the pen seem to
    /// leave.
    pub fn of(d: &Descriptor, bounces: bool, huion: bool) -> UcLogicBits {
        let Some(pen) = d.pens.iter().find(|p| !p.as_mouse && p.report_id.is_some()) else {
            return UcLogicBits { huion, ..UcLogicBits::default() };
        };
        let mask = |bits: &Option<Bits>| {
            let bit = bits.as_ref().and_then(|b| b.start.checked_sub(8)).filter(|b| *b < 8);
            bit.map_or(0, |b| 1u8 << b)
        };
        let (named, eraser) = (mask(&pen.barrel[1]), mask(&pen.eraser));
        let (secondary, invert) = (mask(&pen.secondary_tip), mask(&pen.invert));
        let own_eraser = (secondary == 4 || named & !4 != 0) && invert != 0;
        UcLogicBits {
            id: pen.report_id.unwrap_or(0),
            second: if own_eraser { named } else { 0 },
            eraser: if own_eraser { eraser } else { 0 },
            invert,
            second_bounces: bounces && invert == 0 && eraser == 4 && named == 0 && secondary == 0,
            third_is_invert: secondary == 4 && invert != 0,
            huion,
        }
    }
}

/// State learned from the reports so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UcLogicMemory {
    /// `A0` was seen: `C0` means out.
    classic: bool,
    /// `80` with a pressed tip or in motion was seen: it means in range.
    inverted: bool,
    /// `C0` with a pressed tip was seen: `80` means out.
    plain: bool,
    /// Any of the three high bits was ever seen: bare zero means out.
    ranged: bool,
    /// Place of the last `80` report.
    last: Option<[i32; 2]>,
    wheel: Option<u8>,
}

/// Reads one report, its id first.
pub fn parse(b: &[u8], traits: &UcLogicTraits, memory: &mut UcLogicMemory) -> Parsed {
    let id = byte(b, 0);
    if !matches!(id, 0x01 | 0x02 | 0x07 | 0x08 | 0x09 | 0x0a | 0x10) {
        return Parsed::Nothing;
    }
    if b.len() < 8 {
        return Parsed::Broken;
    }
    let flags = b[1];
    if traits.packing == Packing::Fma {
        return if flags & 0x20 == 0 { Parsed::Away } else { Parsed::Pen(pen(b, traits)) };
    }
    if flags & 0xe0 == 0xe0 || (matches!(id, 0x02) && flags & 0x10 != 0) {
        return pad(b, memory);
    }
    let pen = pen(b, traits);
    if in_range(id, flags, &pen, traits, memory) { Parsed::Pen(pen) } else { Parsed::Away }
}

fn in_range(
    id: u8,
    flags: u8,
    pen: &PenReport,
    traits: &UcLogicTraits,
    memory: &mut UcLogicMemory,
) -> bool {
    let pressed = flags & 1 != 0 && pen.pressure.is_some_and(|p| p > 0);
    let high = flags & 0xe0;
    memory.ranged |= high != 0;
    match high {
        0xa0 | 0x20 => {
            memory.classic = true;
            true
        }
        0x00 => match id {
            0x08 | 0x0a | 0x02 => false,
            _ => !memory.ranged,
        },
        0x80 => {
            let moved = memory
                .last
                .replace(pen.pos.unwrap_or_default())
                .is_some_and(|p| Some(p) != pen.pos);
            let plain = memory.plain || matches!(traits.range_bit, Some(5 | 6));
            match id {
                0x08 => true,
                0x0a => pressed,
                _ => {
                    memory.inverted |= pressed || (moved && !memory.classic && !memory.plain);
                    !plain || memory.inverted
                }
            }
        }
        // C0
        _ => {
            memory.last = None;
            let out =
                memory.classic || memory.inverted || traits.range_bit == Some(5) || id == 0x02;
            memory.plain |= pressed;
            id == 0x0a || pressed || !out
        }
    }
}

impl UcLogicMemory {
    /// No report so far could say that the pen leaves, so silence decides.
    pub fn is_mute(&self) -> bool {
        !self.ranged
    }
}

fn pen(b: &[u8], traits: &UcLogicTraits) -> PenReport {
    let flags = b[1];
    // Report 08 has Huion's layout in every tablet that sends it; shorter reports have the common
    // one.
    let packing = match (b[0], traits.packing) {
        (0x08, _) => Packing::Huion,
        (_, Packing::Huion) if b.len() < 12 => Packing::XpPen,
        (_, packing) => packing,
    };
    let (mut x, mut y) = (u16_at(b, 2), u16_at(b, 4));
    let mut p = u16_at(b, 6);
    let mut tilt = None;
    match packing {
        Packing::Huion => {
            x |= u32::from(byte(b, 8) & 1) << 16;
            y |= u32::from(byte(b, 9) & 1) << 16;
            if b.len() >= 12 {
                // Linux negates the y tilt of this layout, too.
                tilt = Some([s8_at(b, 10), -s8_at(b, 11)]);
            }
        }
        Packing::Fma => {
            tilt = Some([crate::report::s16_at(b, 8) / 100.0, crate::report::s16_at(b, 10) / 100.0])
        }
        _ => {
            if b.len() >= 12 {
                x |= u32::from(b[10]) << 16;
                y |= u32::from(b[11]) << 16;
            }
            if b.len() >= 10 {
                tilt = Some([s8_at(b, 8), s8_at(b, 9)]);
            }
        }
    }
    match packing {
        Packing::XpPenOffset => p &= 0x1fff,
        Packing::XpPenGen2 => p = p & 0xbfff | u32::from(byte(b, 13) & 1) << 13,
        _ => {}
    }
    if traits.no_tilt || traits.untilted >> (b[0] & 31) & 1 == 1 {
        tilt = None;
    }
    let (eraser, tip, buttons) = switches(b[0], flags, &traits.bits);
    PenReport {
        tool: Some(if eraser { Tool::Eraser } else { Tool::Pen }),
        tip: Some(tip),
        pos: Some([x as i32, y as i32]),
        pressure: Some(p),
        tilt,
        buttons: Some(buttons),
        ..PenReport::default()
    }
}

/// Returns the eraser's proximity, the contact of either end, and the barrel buttons.
fn switches(id: u8, flags: u8, bits: &UcLogicBits) -> (bool, bool, u32) {
    let first = u32::from(flags >> 1 & 1);
    let set = |mask: u8| u32::from(flags & mask != 0);
    match id {
        // Huion's own protocol: bit 3 is the third button of its newer pens, bit 5 the eraser.
        0x08 if bits.huion => {
            (flags & 0x20 != 0, flags & 1 != 0, first | set(4) << 1 | set(8) << 2)
        }
        _ if id == bits.id && bits.invert != 0 => {
            let eraser = flags & (bits.invert | bits.eraser) != 0;
            let second = if bits.second != 0 { bits.second } else { 4 };
            (eraser, flags & (1 | bits.eraser) != 0, first | set(second) << 1)
        }
        _ => (flags & 8 != 0, flags & 1 != 0, first | set(4) << 1),
    }
}

/// Keys, dials and rings come in reports of the pen's id.
fn pad(b: &[u8], memory: &mut UcLogicMemory) -> Parsed {
    let none = PadReport::default();
    match (b[0], b[1]) {
        (0x08, 0xf0) => {
            // A ring: places from 1, clockwise; 0 when let go.
            let place = b[5];
            let turned = match (memory.wheel, place) {
                (Some(was), now) if was != 0 && now != 0 => {
                    let d = i32::from(now) - i32::from(was);
                    let around = 12;
                    Some(if d > around / 2 {
                        d - around
                    } else if d < -around / 2 {
                        d + around
                    } else {
                        d
                    })
                }
                _ => None,
            };
            memory.wheel = Some(place);
            Parsed::Pad(PadReport { turned: turned.filter(|&d| d != 0).map(|d| (0, d)), ..none })
        }
        (_, 0xf1) => {
            let step = match b[5] {
                1 => 1,
                2 => -1,
                _ => return Parsed::Nothing,
            };
            Parsed::Pad(PadReport { turned: Some((b[3].min(1), step)), ..none })
        }
        (_, 0xf2) => Parsed::Nothing,
        (0x02, _) => {
            Parsed::Pad(PadReport { keys: Some(u16_at(b, 2) | u32::from(b[4]) << 16), ..none })
        }
        (_, 0xe0) if byte(b, 3) == 0x10 => Parsed::Nothing,
        _ => Parsed::Pad(PadReport { keys: Some(u16_at(b, 4) | u32::from(b[6]) << 16), ..none }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn away(id: u8, sequence: &[u8], traits: UcLogicTraits) -> Vec<bool> {
        let mut memory = UcLogicMemory::default();
        let one = |(i, &f): (usize, &u8)| {
            let pressure = if f & 1 != 0 { 100 } else { 0 };
            parse(&[id, f, i as u8, 1, 2, 3, pressure, 0], &traits, &mut memory) == Parsed::Away
        };
        sequence.iter().enumerate().map(one).collect()
    }

    #[test]
    fn each_firmware_leaves_in_its_own_way() {
        let t = |range_bit| UcLogicTraits { range_bit, ..UcLogicTraits::default() };
        assert_eq!(
            away(0x02, &[0xa0, 0xa1, 0xa0, 0xc0], t(None)),
            [false, false, false, true],
            "XP-Pen"
        );
        assert_eq!(
            away(0x07, &[0xa0, 0xa1, 0xc0], t(Some(5))),
            [false, false, true],
            "UC-Logic v1"
        );
        assert_eq!(
            away(0x07, &[0xc0, 0xc1, 0x80], t(Some(6))),
            [false, false, true],
            "plain digitiser"
        );
        assert_eq!(
            away(0x07, &[0x81, 0x80, 0xc0], t(Some(6))),
            [false, false, true],
            "v1 with keys on"
        );
        assert_eq!(
            away(0x0a, &[0xc0, 0xc1, 0x00, 0x80], t(Some(6))),
            [false, false, true, true],
            "Huion default"
        );
        assert_eq!(away(0x08, &[0x80, 0x81, 0x00], t(None)), [false, false, true], "Huion v2");
        assert_eq!(
            away(0x09, &[0x00, 0x01, 0x00], t(None)),
            [false, false, false],
            "never says it"
        );
        assert_eq!(away(0x09, &[0x80, 0x81, 0x00], t(Some(7))), [false, false, true], "bit 7");
    }

    #[test]
    fn pressure_and_coordinates_are_unpacked() {
        let read =
            |b: &[u8], packing| pen(b, &UcLogicTraits { packing, ..UcLogicTraits::default() });
        let long = [2, 0xa1, 1, 0, 2, 0, 0xff, 0x3f, 10, 0xf6, 1, 2];
        let p = read(&long, Packing::XpPenOffset);
        assert_eq!(
            (p.pos, p.pressure, p.tilt),
            (Some([0x10001, 0x20002]), Some(0x1fff), Some([10.0, -10.0]))
        );
        let gen2 = [2, 0xa1, 1, 0, 2, 0, 1, 0x40, 0, 0, 0, 0, 0, 1];
        assert_eq!(read(&gen2, Packing::XpPenGen2).pressure, Some(0x2001));
        let huion = [8, 0x81, 1, 0, 2, 0, 5, 0, 1, 1, 7, 9];
        let p = read(&huion, Packing::Huion);
        assert_eq!((p.pos, p.tilt), (Some([0x10001, 0x10002]), Some([7.0, -9.0])));
    }
}

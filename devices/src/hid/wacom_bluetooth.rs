//! Wacom's current pens over Bluetooth: Intuos Pro 2 (seven frames a report), Intuos 2018 (four).
//!
//! Layouts and the meaning of each flag: Linux `wacom_wac.c` (`wacom_intuos_pro2_bt_pen`,
//! `wacom_intuos_pro2_bt_pad`, `wacom_intuos_gen3_bt_pad`). Reports 80 and 81 are alike.

use super::wacom_pro::ring_place;
use crate::report::{Batch, PadReport, Parsed, PenReport, byte, s8_at, s16_at, u16_at};
use crate::sample::Tool;

/// Largest height of these tablets, in counts.
const MAX_DISTANCE: u32 = 63;

/// Tablet that sends the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BluetoothKind {
    /// Intuos Pro 2: seven frames of 14 bytes, tilt and twist, nine keys and a ring.
    Pro,
    /// Intuos 2018: four frames of 8 bytes, four keys.
    Intuos,
}

/// State kept between reports: the tool is decided as the pen comes into range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BluetoothMemory {
    tool: Option<Tool>,
}

/// Reads every frame of the pen that a report holds, in order, then its pad.
pub fn parse(b: &[u8], kind: BluetoothKind, memory: &mut BluetoothMemory, out: &mut Batch) {
    if !matches!(byte(b, 0), 0x80 | 0x81) {
        return;
    }
    let (length, frames) = match kind {
        BluetoothKind::Pro => (14, 7),
        BluetoothKind::Intuos => (8, 4),
    };
    if b.len() < 1 + length * frames {
        return out.push(Parsed::Broken);
    }
    for frame in b[1..].chunks_exact(length).take(frames) {
        // Not every frame is filled.
        if frame[0] & 0x80 == 0 {
            continue;
        }
        if frame[0] & 0x40 == 0 {
            memory.tool = None;
            out.push(Parsed::Away);
            // The frames after it are old.
            break;
        }
        out.push(pen(frame, kind, memory));
    }
    match kind {
        BluetoothKind::Pro if b.len() > 285 => out.push(Parsed::Pad(PadReport {
            keys: Some(u32::from(b[282]) | u32::from(b[281] & 0x40) << 2),
            strip: Some((0, ring_place(b[285]))),
            ..PadReport::default()
        })),
        BluetoothKind::Intuos if b.len() > 44 => {
            out.push(Parsed::Pad(PadReport {
                keys: Some(u32::from(b[44])),
                ..PadReport::default()
            }));
        }
        _ => {}
    }
}

fn pen(frame: &[u8], kind: BluetoothKind, memory: &mut BluetoothMemory) -> Parsed {
    let flags = frame[0];
    let placed = flags & 0x20 != 0;
    if placed {
        memory.tool.get_or_insert(if flags & 0x10 != 0 { Tool::Eraser } else { Tool::Pen });
    }
    let Some(tool) = memory.tool else { return Parsed::Nothing };
    let pro = placed && kind == BluetoothKind::Pro;
    let height = if kind == BluetoothKind::Pro { 13 } else { 7 };
    Parsed::Pen(PenReport {
        tool: Some(tool),
        tip: Some(flags & 0x09 != 0),
        pos: placed.then(|| [u16_at(frame, 1) as i32, u16_at(frame, 3) as i32]),
        pressure: Some(u16_at(frame, 5)),
        tilt: pro.then(|| [s8_at(frame, 7), s8_at(frame, 8)]),
        // Fifths of a degree.
        twist: pro.then(|| (s16_at(frame, 9) / 5.0).to_radians()),
        distance: Some(if placed { u32::from(frame[height]) } else { MAX_DISTANCE }),
        buttons: Some(u32::from(flags >> 1 & 3)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(kind: BluetoothKind, frames: &[[u8; 8]]) -> Vec<u8> {
        let (length, size) = if kind == BluetoothKind::Pro { (14, 361) } else { (8, 51) };
        let mut b = vec![0; size];
        b[0] = 0x80;
        for (i, frame) in frames.iter().enumerate() {
            b[1 + length * i..][..8].copy_from_slice(frame);
        }
        b
    }

    fn read(b: &[u8], kind: BluetoothKind) -> Vec<Parsed> {
        let mut out = Batch::default();
        parse(b, kind, &mut BluetoothMemory::default(), &mut out);
        out.as_slice().to_vec()
    }

    #[test]
    fn every_frame_is_read_in_order() {
        let frame = |i: u8| [0xe1, i, 1, 2, 0, 100 + i, 0, 0xf6];
        let b = report(BluetoothKind::Pro, &[0, 1, 2, 3, 4, 5, 6].map(frame));
        let all = read(&b, BluetoothKind::Pro);
        let pens: Vec<_> = all
            .iter()
            .filter_map(|p| if let Parsed::Pen(p) = p { Some((p.pos, p.pressure)) } else { None })
            .collect();
        let expected: Vec<_> =
            (0..7).map(|i| (Some([0x100 + i, 2]), Some(100 + i as u32))).collect();
        assert_eq!(pens, expected);
        assert!(matches!(all.last(), Some(Parsed::Pad(_))) && all.len() == 8);
        let Parsed::Pen(first) = all[0] else { panic!() };
        assert_eq!((first.tip, first.tilt), (Some(true), Some([-10.0, 0.0])));
    }

    #[test]
    fn an_empty_frame_says_nothing_and_a_pen_that_left_ends_the_report() {
        let near = [0xe0, 1, 0, 1, 0, 0, 0, 20];
        let b = report(BluetoothKind::Intuos, &[near, [0; 8], [0x80, 0, 0, 0, 0, 0, 0, 0], near]);
        let all = read(&b, BluetoothKind::Intuos);
        assert!(matches!(all[..], [Parsed::Pen(_), Parsed::Away, Parsed::Pad(_)]), "{all:?}");
        assert_eq!(read(&b[..20], BluetoothKind::Intuos), [Parsed::Broken]);
        assert_eq!(read(&[0x10; 60], BluetoothKind::Intuos), []);
    }

    #[test]
    fn keys_and_the_ring_come_with_the_pen() {
        let mut b = report(BluetoothKind::Pro, &[]);
        (b[281], b[282], b[285]) = (0x40, 0x05, 0x80 | 66);
        let [Parsed::Pad(pad)] = read(&b, BluetoothKind::Pro)[..] else { panic!() };
        assert_eq!((pad.keys, pad.strip), (Some(0x105), Some((0, Some(0.25)))));
    }
}

//! Wacom protocol V: serial Intuos and Intuos 2. 9 bytes; the lowest bit of the first is the
//! channel.

use super::{low7, signed7};
use crate::report::{Parsed, PenReport};
use crate::sample::Tool;

/// Bytes of a packet.
pub const LENGTH: usize = 9;
/// Full pressure in counts.
pub const MAX_PRESSURE: u32 = 1023;

/// Packet layout, and the tool that is near.
#[derive(Debug, Clone, PartialEq)]
pub struct WacomVLayout {
    max: [i32; 2],
    /// Tool on each channel. A tablet follows two tools at once; the first to come has priority.
    tools: [Option<Tool>; 2],
    leading: Option<usize>,
}

impl WacomVLayout {
    /// A layout for a tablet with these largest coordinates.
    pub fn new(max: [i32; 2]) -> Self {
        WacomVLayout { max, tools: [None; 2], leading: None }
    }

    /// Reads one whole packet.
    pub fn parse(&mut self, b: &[u8]) -> Parsed {
        if b.len() < LENGTH {
            return Parsed::Broken;
        }
        let channel = usize::from(b[0] & 1);
        if b[0] & 0xfc == 0xc0 {
            self.tools[channel] = Some(tool(low7(b, 1) << 5 | low7(b, 2) >> 2));
            return Parsed::Nothing;
        }
        if b[0] & 0xfe == 0x80 {
            self.tools[channel] = None;
            if self.leading == Some(channel) {
                self.leading = None;
                return Parsed::Away;
            }
            return Parsed::Nothing;
        }
        // A pen packet has 101 above, an airbrush's second 10110 with its wheel where the pressure
        // is; mice and lens cursors (101 with bits 3 or 4 set) only move.
        if b[0] & 0xa0 != 0xa0 || *self.leading.get_or_insert(channel) != channel {
            return Parsed::Nothing;
        }
        let x = low7(b, 1) << 9 | low7(b, 2) << 2 | low7(b, 3) >> 5 & 3;
        let y = (low7(b, 3) & 0x1f) << 11 | low7(b, 4) << 4 | low7(b, 5) >> 3 & 0xf;
        let pos = [x as i32, y as i32];
        if pos[0] > self.max[0] || pos[1] > self.max[1] {
            return Parsed::Broken;
        }
        if b[0] & 0x40 == 0 {
            self.leading = None;
            return Parsed::Away;
        }
        let (pen, airbrush) = (b[0] & 0xb8 == 0xa0, b[0] & 0xbe == 0xb4);
        if !pen && !airbrush {
            return Parsed::Pen(PenReport {
                tool: Some(Tool::Mouse),
                pos: Some(pos),
                ..PenReport::default()
            });
        }
        Parsed::Pen(PenReport {
            tool: Some(self.tools[channel].unwrap_or_default()),
            pos: Some(pos),
            pressure: pen.then(|| (low7(b, 5) & 7) << 7 | low7(b, 6)),
            tilt: Some([signed7(b, 7), signed7(b, 8)]),
            buttons: pen.then(|| u32::from(b[0]) >> 1 & 3),
            ..PenReport::default()
        })
    }
}

/// By the twelve bits of the tool's type: pens and their like end in 2 with bit 3 clear, erasers in
/// A, mice in 4, 6 or 7.
fn tool(id: u32) -> Tool {
    match id & 0xf {
        0xa..=0xb => Tool::Eraser,
        4 | 6 | 7 | 0xc => Tool::Mouse,
        _ => Tool::Pen,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn enter(id: u32, channel: u8) -> [u8; 9] {
        [0xc0 | channel, (id >> 5) as u8, ((id & 0x1f) << 2) as u8, 0, 0, 0, 0, 0, 0]
    }

    #[test]
    fn a_tool_enters_moves_and_leaves_and_the_first_has_the_word() {
        let mut l = WacomVLayout::new([30480, 24060]);
        assert_eq!(l.parse(&enter(0x82a, 0)), Parsed::Nothing);
        let pen = [0xe2, 20, 5, 0b0101010, 9, 0b010_1011, 77, 0x7b, 5];
        let Parsed::Pen(r) = l.parse(&pen) else { panic!() };
        assert_eq!(r.pos, Some([20 << 9 | 5 << 2 | 1, 10 << 11 | 9 << 4 | 5]));
        assert_eq!(
            (r.tool, r.pressure, r.buttons),
            (Some(Tool::Eraser), Some(3 << 7 | 77), Some(1))
        );
        assert_eq!(r.tilt, Some([-5.0, 5.0]));
        l.parse(&enter(0x822, 1));
        assert_eq!(
            l.parse(&[0xe1, 1, 1, 1, 1, 1, 1, 1, 1]),
            Parsed::Nothing,
            "the other channel waits"
        );
        assert_eq!(l.parse(&[0x80, 0, 0, 0, 0, 0, 0, 0, 0]), Parsed::Away);
        assert!(matches!(
            l.parse(&[0xe1, 1, 1, 1, 1, 1, 1, 1, 1]),
            Parsed::Pen(PenReport { tool: Some(Tool::Pen), .. })
        ));
    }
}

//! Positions of a pad's keys, wheels and rings in one input report.

use hidreport::{FieldAttributes, VariableField};

use super::bits::Bits;
use super::page_id;

/// Keys past this one are not reported: a state holds 32.
const MAX_KEYS: u32 = 32;

/// A control that turns or slides.
#[derive(Debug, Clone, PartialEq)]
pub struct PadAxis {
    /// Position of its value.
    pub bits: Bits,
    /// The value is a number of steps since the last report, and not a position.
    pub relative: bool,
}

/// One input report that carries a pad's controls and no pen.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PadFields {
    /// The report's id; `None` where the descriptor uses no report ids.
    pub report_id: Option<u8>,
    /// Key number, from 0, and its bit.
    pub keys: Vec<(u32, Bits)>,
    /// Rings, strips, dials and wheels, in the order of the descriptor.
    pub turns: Vec<PadAxis>,
    /// A finger is on the ring or strip, where the report says it.
    pub touched: Option<Bits>,
}

impl PadFields {
    /// Adds a field if it is in a pad's collection: tablet function keys (0x0D:0x39) or a keypad
    /// (0x01:0x07), as Linux `hid-uclogic`, the HID-BPF fixes and Wacom describe pads. Usages of
    /// Wacom's page (0xFF0D): Linux `wacom_wac.h`.
    pub(super) fn take(&mut self, f: &VariableField) {
        let of_pad = |usage: u32| matches!(page_id(usage), (0x0d | 0xff0d, 0x39) | (0x01, 0x07));
        let usages = f.collections.iter().flat_map(|c| c.usages());
        if !usages.map(u32::from).any(of_pad) {
            return;
        }
        match page_id(u32::from(&f.usage)) {
            (0x09, button @ 1..=MAX_KEYS) if f.bits.len() == 1 => {
                self.add_key(button - 1, f);
            }
            (0x0d | 0xff0d, 0x33) | (0xff0d, 0x139) if self.touched.is_none() => {
                self.touched = Some(Bits::of(f));
            }
            // Wacom's page: express keys, then the controls after the keys of the frame.
            (0xff0d, key @ 0x910..=0x91f) if f.bits.len() == 1 => {
                self.add_key(key - 0x910, f);
            }
            (0xff0d, key @ 0x980..=0x983) if f.bits.len() == 1 => {
                self.add_key(16 + key - 0x980, f);
            }
            (0xff0d, key @ 0x990..=0x995) if f.bits.len() == 1 => {
                self.add_key(20 + key - 0x990, f);
            }
            // Wacom's own page: strips, rings, finger wheels.
            (0xff0d, 0x136..=0x138 | 0xd03) => {
                self.turns.push(PadAxis { bits: Bits::of(f), relative: f.is_relative() });
            }
            // Dial, wheel, and the horizontal wheel of the consumer page.
            (0x01, 0x37 | 0x38) | (0x0c, 0x238) => {
                self.turns.push(PadAxis { bits: Bits::of(f), relative: f.is_relative() });
            }
            _ => {}
        }
    }

    /// Adds a key under its number, or under the next free one: some descriptors name two ranges of
    /// buttons alike, or one usage for several keys.
    fn add_key(&mut self, number: u32, f: &VariableField) {
        let taken = |n: u32| self.keys.iter().any(|(k, _)| *k == n);
        let free = if taken(number) {
            self.keys.iter().map(|(k, _)| k + 1).max().unwrap_or(0)
        } else {
            number
        };
        if free < MAX_KEYS {
            self.keys.push((free, Bits::of(f)));
        }
    }

    /// Returns true if the report has no control of a pad.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty() && self.turns.is_empty()
    }
}

//! What a family's parser reads in one report: facts in device counts. Contact, proximity, stuck
//! buttons and spikes are decided by [`crate::pen_state`], in the same way for every family.

use crate::sample::Tool;

/// One report, read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Parsed {
    /// Not about a pen or a pad: touch, mouse, battery, another report id.
    #[default]
    Nothing,
    /// Too short for its family. It is counted and nothing is read from it.
    Broken,
    /// A pen in range.
    Pen(PenReport),
    /// The device says that the pen has left.
    Away,
    /// Keys, wheels, rings or strips.
    Pad(PadReport),
}

/// Most facts in one report: seven frames of a Bluetooth pen and two halves of its pad.
const MAX_BATCH: usize = 10;

/// Content of one report, in order. Some carry several frames of the pen, and its pad.
#[derive(Debug, Clone, Copy, Default)]
pub struct Batch {
    items: [Parsed; MAX_BATCH],
    count: usize,
}

impl Batch {
    /// Adds what was read. [`Parsed::Nothing`] adds nothing; what is over the limit is left out.
    pub fn push(&mut self, parsed: Parsed) {
        if parsed != Parsed::Nothing && self.count < MAX_BATCH {
            self.items[self.count] = parsed;
            self.count += 1;
        }
    }

    /// Everything that was added.
    pub fn as_slice(&self) -> &[Parsed] {
        &self.items[..self.count]
    }
}

/// A pen in range. `None`: this report does not say, and the last value stays.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PenReport {
    /// End of the pen, or another tool.
    pub tool: Option<Tool>,
    /// The tip switch; families without one leave contact to the pressure.
    pub tip: Option<bool>,
    /// Counts from the device's own origin.
    pub pos: Option<[i32; 2]>,
    /// Counts, 0 to the model's maximum (a report may exceed it: vendors are wrong about theirs).
    pub pressure: Option<u32>,
    /// Degrees from the vertical, +x right, +y toward the user.
    pub tilt: Option<[f32; 2]>,
    /// Radians about the pen's own axis, clockwise seen from above.
    pub twist: Option<f32>,
    /// Counts of height.
    pub distance: Option<u32>,
    /// Barrel buttons, bit 0 the lower one.
    pub buttons: Option<u32>,
}

/// Keys, wheels and strips. `None`: this report does not say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PadReport {
    /// Pressed keys, bit 0 the first.
    pub keys: Option<u32>,
    /// Index of a wheel, and its steps since the last report, clockwise positive.
    pub turned: Option<(u8, i32)>,
    /// Index of a ring or strip, and the finger's position, 0 to 1; inner `None` when released.
    pub strip: Option<(u8, Option<f32>)>,
}

/// Little-endian 16 bits at `i`; 0 past the end, because real reports contradict their declared
/// size.
pub fn u16_at(b: &[u8], i: usize) -> u32 {
    u32::from(byte(b, i)) | u32::from(byte(b, i + 1)) << 8
}

/// Little-endian 24 bits at `i`.
pub fn u24_at(b: &[u8], i: usize) -> u32 {
    u16_at(b, i) | u32::from(byte(b, i + 2)) << 16
}

/// Big-endian 16 bits at `i`.
pub fn be16_at(b: &[u8], i: usize) -> u32 {
    u32::from(byte(b, i)) << 8 | u32::from(byte(b, i + 1))
}

/// The byte at `i`; 0 past the end.
pub fn byte(b: &[u8], i: usize) -> u8 {
    b.get(i).copied().unwrap_or(0)
}

/// A signed byte as degrees.
pub fn s8_at(b: &[u8], i: usize) -> f32 {
    f32::from(byte(b, i) as i8)
}

/// Signed little-endian 16 bits.
pub fn s16_at(b: &[u8], i: usize) -> f32 {
    f32::from(u16_at(b, i) as u16 as i16)
}

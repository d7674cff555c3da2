//! Repairs that real report descriptors need before the parser library can read them.
//!
//! Items and their encoding: HID 1.11, section 6.2.2.

use super::error::DescriptorError;

/// Most bits in one report that are believed. The longest real report seen has 1,101 bytes.
const MAX_REPORT_BITS: u64 = 65_536;
/// Most usages in all ranges together: enough for a few vendor ranges of a whole page each.
const MAX_USAGES: u64 = 1 << 18;

/// Rewrites a descriptor into a form that the parser library reads as Linux reads the original.
///
/// * Sizes that would make a reader allocate without bound are refused.
/// * Each usage is written with its page, and the values that a `Pop` restores are written out.
/// * A maximum that was written in too few bytes is unsigned if its minimum is not negative.
/// * A field that names no usage gets one from the vendor range, because the library refuses it
///   otherwise (seen: XP-Pen Artist 22R Pro).
pub(super) fn repaired(bytes: &[u8]) -> Result<Vec<u8>, DescriptorError> {
    let mut out = Vec::with_capacity(bytes.len() + 16);
    let mut globals = Globals::default();
    // There is always a page, so that nothing depends on its absence.
    item(&mut out, 0x04, 0);
    let (mut stack, mut total) = (Vec::new(), 0u64);
    let (mut low, mut high, mut listed) = (0u64, 0u64, 0u64);
    let mut named = false;
    let mut i = 0;
    while i < bytes.len() {
        let at = i;
        let prefix = bytes[i];
        if prefix == 0xfe {
            // Long items are reserved: no device has one, and readers disagree on where it ends.
            return Err(DescriptorError::Bad(format!("a long item at byte {at}")));
        }
        let n = [0, 1, 2, 4][usize::from(prefix & 3)];
        let value = (0..n).fold(0u64, |v, k| {
            v | u64::from(bytes.get(i + 1 + k).copied().unwrap_or(0)) << (8 * k)
        });
        i = (i + 1 + n).min(bytes.len());
        let tag = prefix & 0xfc;
        match tag {
            // A usage belongs to the page before it, also when the page changes before the field it
            // names.
            0x08 if (1..=2).contains(&n) => item(&mut out, tag, globals.of(0x04) << 16 | value),
            0x24 | 0x44 if n < 4 && globals.of(tag - 0x10) & NEGATIVE == 0 => {
                globals.set(tag, value);
                item(&mut out, tag, value);
            }
            0x04..=0x94 if tag & 0x0c == 4 => {
                // Negative numbers are written out in full, so that a size need not be remembered.
                let negative =
                    n > 0 && n < 4 && (0x14..=0x54).contains(&tag) && value >> (8 * n - 1) & 1 == 1;
                let full = if negative { value | u64::MAX << (8 * n) } else { value } & 0xffff_ffff;
                globals.set(tag, full);
                item(&mut out, tag, full);
            }
            0xa4 if stack.len() < 64 => stack.push(globals),
            0xa4 => return Err(DescriptorError::Absurd(at)),
            0xb4 => {
                let was = stack.pop().unwrap_or(globals);
                for tag in (0x04..=0x94).step_by(0x10).filter(|t| was.of(*t) != globals.of(*t)) {
                    item(&mut out, tag, was.of(tag));
                }
                globals = was;
            }
            0x80 | 0x90 | 0xb0 if !named && value & 1 == 0 => {
                item(&mut out, 0x08, UNKNOWN_USAGE);
                out.extend_from_slice(&bytes[at..i]);
            }
            _ => out.extend_from_slice(&bytes[at..i]),
        }
        named = match tag {
            0x08 | 0x18 | 0x28 => true,
            0x80 | 0x90 | 0xa0 | 0xb0 | 0xc0 => false,
            _ => named,
        };
        match tag {
            0x18 => low = value,
            0x28 => high = value,
            0x80 | 0x90 | 0xa0 | 0xb0 => {
                let (size, count) = (globals.of(0x74), globals.of(0x94));
                // A collection has usages, and no bits.
                let field = tag != 0xa0;
                total = total.saturating_add(if field { size.saturating_mul(count) } else { 0 });
                let wide = field && (size > 4096 * 8 || count > MAX_REPORT_BITS)
                    || total > 8 * MAX_REPORT_BITS;
                // A range of usages is listed one by one.
                listed += high.saturating_sub(low);
                if wide || listed > MAX_USAGES {
                    return Err(DescriptorError::Absurd(at));
                }
                (low, high) = (0, 0);
            }
            0xc0 => (low, high) = (0, 0),
            _ => {}
        }
    }
    Ok(out)
}

/// The usage of a field that names none: on a vendor page, so that nothing is made of it.
const UNKNOWN_USAGE: u64 = 0xff00_0000;

/// Top bit of an item's value, written out in full.
const NEGATIVE: u64 = 1 << 31;

/// Writes an item with a four-byte value. A report id is one byte by definition.
fn item(out: &mut Vec<u8>, tag: u8, value: u64) {
    if tag == 0x84 {
        out.extend_from_slice(&[tag | 1, value as u8]);
    } else {
        out.push(tag | 3);
        out.extend_from_slice(&(value as u32).to_le_bytes());
    }
}

/// The global items' values, tag 0x04 first, 0x94 last.
#[derive(Debug, Clone, Copy, Default)]
struct Globals([u64; 10]);

impl Globals {
    fn of(&self, tag: u8) -> u64 {
        self.0.get(usize::from(tag >> 4)).copied().unwrap_or(0)
    }

    fn set(&mut self, tag: u8, value: u64) {
        if let Some(slot) = self.0.get_mut(usize::from(tag >> 4)) {
            *slot = value;
        }
    }
}

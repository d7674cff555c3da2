//! Report descriptors: what an interface is, and where its pen fields lie.
//!
//! Parsing is by `hidreport`, with the mends that real descriptors need: stray zero bytes at the
//! end are stripped, absurd sizes are refused before anything is allocated for them, and bits are
//! read here, so that a report shorter than its descriptor says is survived. Usages: HID Usage
//! Tables 1.4, page 0x0D; Wacom's own page 0xFF0D mirrors it (Linux `wacom_wac.h`).

use hidreport::{Field, FieldAttributes, Report as _, ReportDescriptor, VariableField};

/// Longest descriptor read; the kernel's own limit is 4096.
const MAX_DESCRIPTOR: usize = 4096;
/// Most bits in one report that are believed; the longest real one seen has 1,101 bytes.
const MAX_REPORT_BITS: u64 = 65_536;
/// Usages in all ranges together: a few vendors' ranges of a whole page each.
const MAX_USAGES: u64 = 1 << 18;

/// What an application collection is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Pen,
    Touch,
    Mouse,
    Keyboard,
    Consumer,
    Vendor,
    Other,
}

/// A run of bits in a report, the report id's byte included where there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct Bits {
    pub start: usize,
    pub len: usize,
    pub min: i32,
    pub max: i32,
    /// Physical range, where it is stated and not empty.
    pub physical: Option<(i32, i32)>,
    /// Unit code and power of ten, HID 1.11 section 6.2.2.7.
    pub unit: u32,
    pub exponent: i32,
}

/// One input report that places a pen.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PenLayout {
    pub report_id: Option<u8>,
    pub x: Option<Bits>,
    pub y: Option<Bits>,
    pub tip: Option<Bits>,
    pub in_range: Option<Bits>,
    /// Sensed, though too far to be placed: Wacom's own usage.
    pub sense: Option<Bits>,
    pub invert: Option<Bits>,
    pub eraser: Option<Bits>,
    pub barrel: [Option<Bits>; 3],
    pub pressure: Option<Bits>,
    pub tilt: [Option<Bits>; 2],
    pub twist: Option<Bits>,
    pub distance: Option<Bits>,
}

/// A variable field as facts, for comparison with other parsers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fact {
    pub report_id: Option<u8>,
    pub usage: u32,
    pub start: usize,
    pub len: usize,
    pub min: i64,
    pub max: i64,
}

#[derive(Debug, Clone, Default)]
pub struct Descriptor {
    pub kinds: Vec<Kind>,
    pub pens: Vec<PenLayout>,
    /// Id and length in bytes (with the id's byte) of each input report.
    pub input_lengths: Vec<(Option<u8>, usize)>,
    pub facts: Vec<Fact>,
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DescriptorError {
    #[error("the report descriptor is empty")]
    Empty,
    #[error("the report descriptor has {0} bytes, more than {MAX_DESCRIPTOR}")]
    TooLong(usize),
    #[error("the report descriptor declares an absurd size at byte {0}")]
    Absurd(usize),
    #[error("the report descriptor cannot be read: {0}")]
    Bad(String),
}

impl Descriptor {
    pub fn parse(bytes: &[u8]) -> Result<Descriptor, DescriptorError> {
        if bytes.is_empty() {
            return Err(DescriptorError::Empty);
        }
        if bytes.len() > MAX_DESCRIPTOR {
            return Err(DescriptorError::TooLong(bytes.len()));
        }
        let bytes = mended(bytes)?;
        let read = read(&bytes).or_else(|first| {
            let kept = bytes.iter().rposition(|&b| b != 0).map_or(0, |i| i + 1);
            read(&bytes[..kept]).map_err(|_| first)
        })?;
        let mut out = Descriptor::default();
        for report in read.input_reports() {
            let id = report.report_id().as_ref().map(|&id| u8::from(id));
            out.input_lengths.push((id, report.size_in_bytes()));
            let mut pen = PenLayout { report_id: id, ..PenLayout::default() };
            let mut mouse = Placed::default();
            for field in report.fields() {
                let kind = kind_of(field);
                if let Some(kind) = kind {
                    out.kinds.push(kind);
                }
                let Field::Variable(f) = field else { continue };
                let (min, max) = (i32::from(f.logical_minimum), i32::from(f.logical_maximum));
                out.facts.push(Fact {
                    report_id: id,
                    usage: u32::from(&f.usage),
                    start: f.bits.start,
                    len: f.bits.len(),
                    min: min.into(),
                    max: if min >= 0 { i64::from(max as u32) } else { max.into() },
                });
                match kind {
                    Some(Kind::Pen) => pen.take(f),
                    Some(Kind::Mouse) => mouse.take(f),
                    _ => {}
                }
            }
            if pen.x.is_none() && mouse.is_pen() {
                pen = PenLayout { report_id: id, ..mouse.0 };
            }
            if pen.x.is_some() && pen.y.is_some() {
                out.pens.push(pen);
            }
        }
        out.kinds.sort_unstable();
        out.kinds.dedup();
        Ok(out)
    }

    /// Longest input report in bytes; 0 when there is none.
    pub fn longest_input(&self) -> usize {
        self.input_lengths.iter().map(|l| l.1).max().unwrap_or(0)
    }

    pub fn declares_length(&self, n: usize) -> bool {
        self.input_lengths.iter().any(|l| l.1 == n)
    }
}

/// The library's reading. It panics on some nonsense; to us that is one more descriptor that cannot
/// be read.
fn read(bytes: &[u8]) -> Result<ReportDescriptor, DescriptorError> {
    match std::panic::catch_unwind(|| ReportDescriptor::try_from(bytes)) {
        Ok(read) => read.map_err(|e| DescriptorError::Bad(e.to_string())),
        Err(_) => Err(DescriptorError::Bad("it makes no sense to the parser".to_owned())),
    }
}

/// Refuses sizes that would make a reader allocate without bound. Writes out each usage with its
/// page, and what a pop restores. Rewrites maxima that were written in too few bytes: after a
/// minimum that is not negative a maximum is unsigned, whatever its top bit (Linux reads it so).
/// Items: HID 1.11 section 6.2.2.
fn mended(bytes: &[u8]) -> Result<Vec<u8>, DescriptorError> {
    let mut out = Vec::with_capacity(bytes.len() + 16);
    let mut globals = Globals::default();
    // There is always a page, so that nothing depends on its absence.
    item(&mut out, 0x04, 0);
    let (mut stack, mut total) = (Vec::new(), 0u64);
    let (mut low, mut high, mut listed) = (0u64, 0u64, 0u64);
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
            _ => out.extend_from_slice(&bytes[at..i]),
        }
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

fn page_id(usage: u32) -> (u32, u32) {
    (usage >> 16, usage & 0xffff)
}

fn kind_of(field: &Field) -> Option<Kind> {
    let mut kind = None;
    for c in field.collections() {
        for u in c.usages() {
            let (page, id) = page_id(u32::from(u));
            let this = match (page, id) {
                (0x0d | 0xff0d, 0x22 | 0x04 | 0x05) => Some(Kind::Touch),
                (0x0d | 0xff0d, 0x01 | 0x02 | 0x20) => Some(Kind::Pen),
                (0x0d, 0x03) => Some(Kind::Pen),
                (0x01, 0x02) => Some(Kind::Mouse),
                (0x01, 0x06) => Some(Kind::Keyboard),
                (0x0c, _) => Some(Kind::Consumer),
                (p, _) if p >= 0xff00 => Some(Kind::Vendor),
                _ => None,
            };
            kind = match (kind, this) {
                // A finger inside a digitiser is a finger; a stylus inside a touch screen is a
                // stylus.
                (_, Some(Kind::Touch)) => Some(Kind::Touch),
                (Some(Kind::Touch), Some(Kind::Pen)) if id == 0x20 => Some(Kind::Pen),
                (None, this) => this,
                (Some(Kind::Vendor), Some(this)) => Some(this),
                (kept, _) => kept,
            };
        }
    }
    kind.or(Some(Kind::Other))
}

impl Bits {
    fn of(f: &VariableField) -> Bits {
        let physical = match (f.physical_minimum, f.physical_maximum) {
            (Some(lo), Some(hi)) => Some((i32::from(lo), i32::from(hi))).filter(|(lo, hi)| hi > lo),
            _ => None,
        };
        // A maximum below its minimum says nothing: the field's own width does.
        let (min, mut max) = (i32::from(f.logical_minimum), i32::from(f.logical_maximum));
        if max <= min && min >= 0 {
            max = if f.bits.len() >= 31 { i32::MAX } else { (1 << f.bits.len()) - 1 };
        }
        Bits {
            start: f.bits.start,
            len: f.bits.len().min(32),
            min,
            max,
            physical,
            unit: f.unit.map_or(0, u32::from),
            exponent: f.unit_exponent.map_or(0, |e| i32::from(e.exponent())),
        }
    }

    /// The field's value, or `None` where the report ends before it.
    pub fn read(&self, report: &[u8]) -> Option<i32> {
        if self.len == 0 || self.start + self.len > report.len() * 8 {
            return None;
        }
        let mut v = 0u64;
        for k in 0..self.len {
            let bit = self.start + k;
            v |= u64::from(report[bit / 8] >> (bit % 8) & 1) << k;
        }
        if self.min < 0 && v >> (self.len - 1) & 1 == 1 {
            v |= u64::MAX << self.len.min(63);
        }
        Some(v as i64 as i32)
    }

    pub fn set(&self, report: &[u8]) -> Option<bool> {
        self.read(report).map(|v| v != 0)
    }

    /// Length of the logical range in mm, where the unit is a length. A wrong power in the unit
    /// code (`0x33` is a common slip for inches) is read as length.
    pub fn span_mm(&self) -> Option<f64> {
        let (lo, hi) = self.physical?;
        let unit = match self.unit & 0xf {
            1 => 10.0,
            3 => 25.4,
            _ => return None,
        };
        if self.unit & 0xf0 == 0 {
            return None;
        }
        let mm = (f64::from(hi) - f64::from(lo)) * unit * 10f64.powi(self.exponent);
        Some(mm).filter(|mm| (5.0..5000.0).contains(mm))
    }

    /// The value in degrees: by the stated unit, else taken as degrees when the range fits them,
    /// else scaled to `full`.
    pub fn degrees(&self, v: i32, full: f64) -> f64 {
        let span = (f64::from(self.max) - f64::from(self.min)).max(1.0);
        if let Some((lo, hi)) = self.physical {
            let p = f64::from(lo)
                + (f64::from(v) - f64::from(self.min)) * (f64::from(hi) - f64::from(lo)) / span;
            let p = p * 10f64.powi(self.exponent);
            match self.unit & 0xff {
                0x14 => return p,
                0x12 => return p.to_degrees(),
                _ => {}
            }
        }
        let most = f64::from(self.max).abs().max(f64::from(self.min).abs());
        if most <= full { f64::from(v) } else { f64::from(v) * full / most }
    }
}

impl PenLayout {
    fn take(&mut self, f: &VariableField) {
        if f.is_relative() {
            return;
        }
        let keep = |slot: &mut Option<Bits>| {
            if slot.is_none() {
                *slot = Some(Bits::of(f));
            }
        };
        match page_id(u32::from(&f.usage)) {
            (0x01, 0x30) | (0xff0d, 0x130) => keep(&mut self.x),
            (0x01, 0x31) | (0xff0d, 0x131) => keep(&mut self.y),
            (0x01, 0x32) | (0xff0d, 0x132) => keep(&mut self.distance),
            (0xff0d, 0x36) => keep(&mut self.sense),
            (0x0d | 0xff0d, id) => match id {
                0x30 => keep(&mut self.pressure),
                0x32 => keep(&mut self.in_range),
                0x3c => keep(&mut self.invert),
                0x3d => keep(&mut self.tilt[0]),
                0x3e => keep(&mut self.tilt[1]),
                0x41 => keep(&mut self.twist),
                0x42 => keep(&mut self.tip),
                0x44 => keep(&mut self.barrel[0]),
                0x45 => keep(&mut self.eraser),
                0x5a => keep(&mut self.barrel[1]),
                _ => {}
            },
            _ => {}
        }
    }
}

/// Old tablets describe their pen as a mouse with absolute axes and a pressure or an in-range bit:
/// button 1 is the tip.
#[derive(Debug, Default)]
struct Placed(PenLayout);

impl Placed {
    fn take(&mut self, f: &VariableField) {
        if f.is_relative() {
            return;
        }
        match page_id(u32::from(&f.usage)) {
            (0x09, 1) => self.0.tip = Some(Bits::of(f)),
            (0x09, 2) => self.0.barrel[0] = Some(Bits::of(f)),
            (0x09, 3) => self.0.barrel[1] = Some(Bits::of(f)),
            _ => self.0.take(f),
        }
    }

    fn is_pen(&self) -> bool {
        self.0.x.is_some() && (self.0.pressure.is_some() || self.0.in_range.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine bytes that name three thousand million usages: a reader that lists them needs
    /// gigabytes.
    #[test]
    fn a_range_of_usages_without_end_is_refused_wherever_it_is_used() {
        for main in [0xa0u8, 0x80, 0x90, 0xb0] {
            let bytes = [0x1a, 0x20, 0xab, 0x2b, 0xab, 0xab, 0xab, 0xab, main];
            assert_eq!(
                Descriptor::parse(&bytes).err(),
                Some(DescriptorError::Absurd(8)),
                "{main:#x}"
            );
        }
        // What a collection or its end has used up counts no more.
        let whole = [0x05, 0x0d, 0x1a, 0, 0, 0x2a, 0xff, 0xff];
        let kept = [&whole[..], &[0xa1, 0x01, 0xc0]].concat().repeat(3);
        assert!(Descriptor::parse(&kept).is_ok());
        assert_eq!(
            Descriptor::parse(&kept.repeat(2))
                .err()
                .map(|e| matches!(e, DescriptorError::Absurd(_))),
            Some(true)
        );
    }
}

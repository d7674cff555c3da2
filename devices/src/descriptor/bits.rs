//! A run of bits in a report, and how its value is read.

use hidreport::VariableField;

/// A run of bits in a report, and the meaning of its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Bits {
    /// First bit, counted from the first bit of the report, its id included.
    pub start: usize,
    /// Number of bits, at most 32.
    pub len: usize,
    /// Logical minimum. A negative one makes the field signed.
    pub min: i32,
    /// Logical maximum.
    pub max: i32,
    /// Physical minimum and maximum, where they are stated and not empty.
    pub physical: Option<(i32, i32)>,
    /// Unit code, HID 1.11 section 6.2.2.7.
    pub unit: u32,
    /// Power of ten by which the physical values are multiplied.
    pub exponent: i32,
}

impl Bits {
    pub(super) fn of(f: &VariableField) -> Bits {
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

    /// Sets the field in a report; bits beyond the report's end are left out.
    pub fn write(&self, report: &mut [u8], value: i32) {
        for k in 0..self.len {
            let bit = self.start + k;
            if let Some(byte) = report.get_mut(bit / 8) {
                let mask = 1 << (bit % 8);
                *byte = if value >> k.min(31) & 1 == 1 { *byte | mask } else { *byte & !mask };
            }
        }
    }

    /// Returns true if the field is not zero, or `None` if the report ends before it.
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

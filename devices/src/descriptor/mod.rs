//! Report descriptors: what an interface is for, and where the fields of a pen or a pad lie.
//!
//! The `hidreport` library reads the items, after `repair` made the descriptor readable. Bits are
//! extracted here, so that a report that is shorter than its descriptor says is survived. Usages:
//! HID Usage Tables 1.4, page 0x0D. Wacom's own page 0xFF0D mirrors it (Linux `wacom_wac.h`).

mod bits;
mod error;
mod pad;
mod pen;
mod repair;
mod usage;

use hidreport::{Field, ReportDescriptor};

pub use bits::Bits;
pub use error::DescriptorError;
pub use pad::{PadAxis, PadFields};
pub use pen::{PenLayout, Selector};
pub use usage::CollectionKind;

use pen::AbsoluteMouse;
use usage::kind_of;

/// Longest descriptor that is read, in bytes: the limit of Linux.
const MAX_DESCRIPTOR: usize = 4096;

/// A variable field as plain numbers, for comparison with other parsers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fact {
    /// The report that holds the field; `None` where the descriptor uses no report ids.
    pub report_id: Option<u8>,
    /// Usage page in the upper 16 bits, usage in the lower 16.
    pub usage: u32,
    /// First bit, counted from the first bit of the report, its id included.
    pub start: usize,
    /// Number of bits.
    pub len: usize,
    /// Logical minimum.
    pub min: i64,
    /// Logical maximum.
    pub max: i64,
}

/// The content of a report descriptor that concerns pens and pads.
#[derive(Debug, Clone, Default)]
pub struct Descriptor {
    /// Kinds of the application collections: sorted, each kind once.
    pub kinds: Vec<CollectionKind>,
    /// Every input report that places a pen, in the order of the descriptor.
    pub pens: Vec<PenLayout>,
    /// Every input report that carries keys, wheels or rings of a pad.
    pub pads: Vec<PadFields>,
    /// Id and length in bytes, the id's byte included, of each input report.
    pub input_lengths: Vec<(Option<u8>, usize)>,
    /// Every variable field.
    pub facts: Vec<Fact>,
}

impl Descriptor {
    /// Reads a descriptor as the device or the kernel shows it.
    ///
    /// # Errors
    /// The descriptor is empty, too long, declares sizes without bound, or cannot be parsed even
    /// after repair. Bytes of any kind never panic.
    pub fn parse(bytes: &[u8]) -> Result<Descriptor, DescriptorError> {
        if bytes.is_empty() {
            return Err(DescriptorError::Empty);
        }
        if bytes.len() > MAX_DESCRIPTOR {
            return Err(DescriptorError::TooLong(bytes.len()));
        }
        let bytes = repair::repaired(bytes)?;
        let parsed = library_parse(&bytes).or_else(|first| {
            let kept = bytes.iter().rposition(|&b| b != 0).map_or(0, |i| i + 1);
            library_parse(&bytes[..kept]).map_err(|_| first)
        })?;
        let mut out = Descriptor::default();
        for report in parsed.input_reports() {
            out.add_report(report);
        }
        out.drop_dummy_keys();
        out.kinds.sort_unstable();
        out.kinds.dedup();
        Ok(out)
    }

    /// Removes the dummy key of a ring or dial. `hid-uclogic` gives them a separate report with one
    /// key that is never pressed, so that libinput takes the device for a pad. It is unrelated to
    /// the real keys.
    fn drop_dummy_keys(&mut self) {
        if self.pads.iter().any(|p| p.keys.len() > 1) {
            for pad in self.pads.iter_mut().filter(|p| p.keys.len() == 1) {
                pad.keys.clear();
            }
        }
    }

    fn add_report(&mut self, report: &impl hidreport::Report) {
        let id = report.report_id().as_ref().map(|&id| u8::from(id));
        self.input_lengths.push((id, report.size_in_bytes()));
        let mut pen = PenLayout { report_id: id, ..PenLayout::default() };
        let mut pad = PadFields { report_id: id, ..PadFields::default() };
        let mut mouse = AbsoluteMouse::default();
        for field in report.fields() {
            let kind = kind_of(field);
            if let Some(kind) = kind {
                self.kinds.push(kind);
            }
            if let (Field::Array(f), Some(CollectionKind::Pen)) = (field, kind) {
                pen.take_array(f);
            }
            let Field::Variable(f) = field else { continue };
            let (min, max) = (i32::from(f.logical_minimum), i32::from(f.logical_maximum));
            self.facts.push(Fact {
                report_id: id,
                usage: u32::from(&f.usage),
                start: f.bits.start,
                len: f.bits.len(),
                min: min.into(),
                max: if min >= 0 { i64::from(max as u32) } else { max.into() },
            });
            pad.take(f);
            match kind {
                Some(CollectionKind::Pen) => pen.take(f),
                Some(CollectionKind::Mouse) => mouse.take(f),
                _ => {}
            }
        }
        if pen.x.is_none() && mouse.is_pen() {
            let bare = mouse.is_bare();
            pen = PenLayout { report_id: id, as_mouse: true, bare, ..mouse.into_layout() };
        }
        if pen.x.is_some() && pen.y.is_some() {
            self.pens.push(pen);
        } else if !pad.is_empty() {
            self.pads.push(pad);
        }
    }

    /// Longest input report in bytes; 0 when there is none.
    pub fn longest_input(&self) -> usize {
        self.input_lengths.iter().map(|l| l.1).max().unwrap_or(0)
    }

    /// Returns true if an input report of `n` bytes, its id included, is declared.
    pub fn declares_length(&self, n: usize) -> bool {
        self.input_lengths.iter().any(|l| l.1 == n)
    }

    /// Returns true if an input report with this id is declared.
    pub fn declares_id(&self, id: u8) -> bool {
        self.input_lengths.iter().any(|l| l.0 == Some(id))
    }
}

/// Calls the library, which panics on some contradictory descriptors: those are errors here.
fn library_parse(bytes: &[u8]) -> Result<ReportDescriptor, DescriptorError> {
    match std::panic::catch_unwind(|| ReportDescriptor::try_from(bytes)) {
        Ok(parsed) => parsed.map_err(|e| DescriptorError::Bad(e.to_string())),
        Err(_) => Err(DescriptorError::Bad("the parser gave it up".to_owned())),
    }
}

/// Usage page and usage of a 32-bit usage.
fn page_id(usage: u32) -> (u32, u32) {
    (usage >> 16, usage & 0xffff)
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
        // Usages consumed by a collection or its end no longer count.
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

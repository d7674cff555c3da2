//! The report descriptor as a second witness of a family's parser.
//!
//! A descriptor that states a tip, an eraser, buttons, axes and a pressure says what the bits of a
//! report mean. `contradictions` writes one report for each statement, reads it with the parser
//! that the catalogue has chosen, and returns every statement that is read as something else.
//! Descriptors lie, too; which of the two is right is decided once for each class, in the tests
//! over the public descriptors.

use crate::catalogue::Found;
use crate::descriptor::{Bits, Descriptor, PenLayout};
use crate::hid::decoder::Decoder;
use crate::sample::{Body, DeviceId, Pen, Sample, Tool};
use crate::tablet::Family;

/// Statement of a descriptor about one report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Statement {
    /// A pen in range over the tablet touches nothing.
    Hover,
    /// The tip switch is a contact of the pen.
    Tip,
    /// The invert bit turns the pen over.
    Invert,
    /// The eraser bit is a contact of the eraser.
    Eraser,
    /// The first barrel button.
    Barrel,
    /// The second barrel button.
    SecondBarrel,
    /// The third barrel button.
    ThirdBarrel,
    /// The largest count of both axes is the area's far corner.
    FarCorner,
    /// The largest pressure is full pressure.
    FullPressure,
}

/// A statement of a descriptor that the parser reads as something else.
#[derive(Debug, Clone, PartialEq)]
pub struct Contradiction {
    /// The report; `None` where the descriptor uses no report ids.
    pub report_id: Option<u8>,
    /// The descriptor's statement.
    pub statement: Statement,
    /// The parser's different reading, as text for people.
    pub read_as: String,
}

impl Contradiction {
    /// One line for people.
    pub fn in_words(&self) -> String {
        let report = self.report_id.map_or(String::new(), |id| format!("report {id:02x}: "));
        let what = match self.statement {
            Statement::Hover => "a hovering pen",
            Statement::Tip => "the tip switch",
            Statement::Invert => "the invert bit",
            Statement::Eraser => "the eraser bit",
            Statement::Barrel => "the barrel button",
            Statement::SecondBarrel => "the second barrel button",
            Statement::ThirdBarrel => "the third barrel button",
            Statement::FarCorner => "the far corner",
            Statement::FullPressure => "full pressure",
        };
        format!("{report}{what} of the descriptor is read as {}", self.read_as)
    }
}

/// Counts and contradictions of a cross-check.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CrossCheck {
    /// Statements that were compared.
    pub compared: usize,
    /// Statements that the parser reads as something else.
    pub contradictions: Vec<Contradiction>,
}

/// Decides which side is right if a parser contradicts a descriptor, once for each class. Returns
/// the reason if the parser is right, or `None` if nothing is decided.
pub fn decision(found: &Found, contradiction: &Contradiction) -> Option<&'static str> {
    use Statement::{Barrel, Eraser, FarCorner, Invert};
    let id = found.id();
    match (id.parser, contradiction.statement) {
        (Family::UcLogic | Family::Huion, Eraser) => Some(
            "what these descriptors call an eraser is the second button (Linux, HID-BPF program \
             XPPen__Artist24)",
        ),
        // Secondary tip, then barrel: the first and the second button.
        (Family::UcLogic, Barrel) if id.vid == 0x5543 => {
            Some("the first button is called a secondary tip switch, the second a barrel switch")
        }
        (Family::KyePlain, Eraser | Invert) => {
            Some("invert is the second button, and there is no eraser (Linux hid-kye.c)")
        }
        (Family::KyePlain, FarCorner) if id.pid == 0x501a => {
            Some("the tablet sends up to 40,960 counts (Linux hid-kye.c)")
        }
        _ => None,
    }
}

/// Adds every contradiction that is not decided to the note of a model, for people.
pub fn note_undecided(found: &mut Found, descriptor: &[u8]) {
    let all = cross_check(found, descriptor).contradictions;
    let open = all.iter().filter(|c| decision(found, c).is_none()).map(Contradiction::in_words);
    let lines: Vec<String> = found.note.clone().into_iter().chain(open).collect();
    found.note = (!lines.is_empty()).then(|| lines.join("; "));
}

/// Greatest distance of the far corner from the area's corner, as a share of the area.
const CORNER: f32 = 0.02;
/// Least share that counts as full pressure: models of one descriptor differ by one count.
const FULL: f32 = 0.99;

/// Compares the parser of a model with the descriptor of its interface.
///
/// Reports that the parser does not read are left out: other interfaces and modes send them.
pub fn cross_check(found: &Found, descriptor: &[u8]) -> CrossCheck {
    let mut out = CrossCheck::default();
    let Ok(d) = Descriptor::parse(descriptor) else { return out };
    for layout in d.pens.iter().filter(|p| !p.as_mouse && !p.bare && p.in_range.is_some()) {
        let length = d.input_lengths.iter().find(|l| l.0 == layout.report_id).map_or(0, |l| l.1);
        let witness = Witness { found, descriptor, layout, length };
        if witness.is_read() {
            witness.compare(&mut out);
        }
    }
    out
}

/// One described report, and the parser under test.
struct Witness<'a> {
    found: &'a Found,
    descriptor: &'a [u8],
    layout: &'a PenLayout,
    length: usize,
}

impl<'a> Witness<'a> {
    /// Returns true if the family's parser, and not the descriptor, reads this report.
    fn is_read(&self) -> bool {
        let mut engine =
            super::family::Engine::new(&self.found.tablet, self.found.id(), self.descriptor);
        let mut batch = crate::report::Batch::default();
        engine.parse(&self.report(&[]), &mut batch);
        batch.as_slice().iter().any(|p| matches!(p, crate::report::Parsed::Pen(_)))
    }

    /// A report of a pen in range in the middle of the tablet with these fields set.
    fn report(&self, fields: &[(&Bits, i32)]) -> Vec<u8> {
        let mut report = vec![0; self.length];
        if let (Some(id), Some(first)) = (self.layout.report_id, report.first_mut()) {
            *first = id;
        }
        let set = |bits: &Option<Bits>, report: &mut [u8]| {
            if let Some(bits) = bits {
                bits.write(report, 1);
            }
        };
        set(&self.layout.in_range, &mut report);
        set(&self.layout.sense, &mut report);
        for axis in [&self.layout.x, &self.layout.y].into_iter().flatten() {
            axis.write(&mut report, axis.min / 2 + axis.max / 2);
        }
        for (bits, value) in fields {
            bits.write(&mut report, *value);
        }
        report
    }

    /// The pen after three equal reports with these fields, in a visit that began by hovering.
    fn read(&self, fields: &[(&Bits, i32)]) -> Option<Pen> {
        let mut decoder = Decoder::new(self.found, self.descriptor, DeviceId(0));
        let mut pen = None;
        let mut take = |s: Sample| {
            if let Body::Pen(p) = s.body {
                pen = Some(p);
            }
        };
        // An eraser is decided as the pen enters: it hovers turned over before it touches.
        let turned: Vec<_> = fields
            .iter()
            .filter(|(bits, _)| self.layout.invert.as_ref() == Some(bits))
            .copied()
            .collect();
        let reports = [self.report(&turned), self.report(&turned), self.report(fields)];
        for (i, report) in reports.iter().chain([&reports[2]; 2]).enumerate() {
            decoder.feed(report, i as u64 * 5_000, &mut take);
        }
        pen
    }

    fn compare(&self, out: &mut CrossCheck) {
        let l = self.layout;
        let press = l.pressure.as_ref().map(|p| (p, p.max));
        let with = |bits: [Option<&'a Bits>; 2]| -> Vec<(&'a Bits, i32)> {
            bits.into_iter().flatten().map(|b| (b, 1)).chain(press).collect()
        };
        let mut check = |statement, fields: &[(&Bits, i32)], holds: &dyn Fn(&Pen) -> bool| {
            out.compared += 1;
            let pen = self.read(fields);
            if pen.as_ref().is_none_or(|p| !holds(p)) {
                let read_as = pen.map_or_else(|| "nothing".to_owned(), |p| in_words(&p));
                let report_id = l.report_id;
                out.contradictions.push(Contradiction { report_id, statement, read_as });
            }
        };
        let is = |tool: Tool, tip: bool| {
            move |p: &Pen| p.in_range && p.tool == tool && p.tip == tip && p.buttons == 0
        };
        check(Statement::Hover, &[], &is(Tool::Pen, false));
        if l.tip.is_some() {
            check(Statement::Tip, &with([l.tip.as_ref(), None]), &is(Tool::Pen, true));
        }
        if let Some(invert) = &l.invert {
            check(Statement::Invert, &[(invert, 1)], &is(Tool::Eraser, false));
        }
        if l.eraser.is_some() {
            let fields = with([l.invert.as_ref(), l.eraser.as_ref()]);
            check(Statement::Eraser, &fields, &is(Tool::Eraser, true));
        }
        let barrels = [Statement::Barrel, Statement::SecondBarrel, Statement::ThirdBarrel];
        for (i, (statement, bits)) in barrels.into_iter().zip(&l.barrel).enumerate() {
            if let Some(bits) = bits {
                let holds = move |p: &Pen| {
                    p.in_range && p.tool == Tool::Pen && !p.tip && p.buttons == 1 << i
                };
                check(statement, &[(bits, 1)], &holds);
            }
        }
        if let (Some(x), Some(y)) = (&l.x, &l.y) {
            let far = |p: &Pen| (p.pos_mm / p.area_mm - 1.0).abs().max_element() <= CORNER;
            check(Statement::FarCorner, &[(x, x.max), (y, y.max)], &far);
        }
        if let (Some(_), Some(_)) = (&l.tip, &l.pressure) {
            let full = |p: &Pen| p.pressure.is_some_and(|v| v >= FULL);
            check(Statement::FullPressure, &with([l.tip.as_ref(), None]), &full);
        }
    }
}

fn in_words(p: &Pen) -> String {
    if !p.in_range {
        return "a pen that has left".to_owned();
    }
    let tool = if p.tool == Tool::Eraser { "an eraser" } else { "a pen" };
    let tip = if p.tip { "in contact" } else { "in the air" };
    let at = p.pos_mm / p.area_mm * 100.0;
    let pressure = p.pressure.map_or("none".to_owned(), |v| format!("{:.0} %", v * 100.0));
    format!(
        "{tool} {tip}, buttons {:03b}, pressure {pressure}, at {:.0} % and {:.0} % of the area",
        p.buttons, at.x, at.y
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{Catalogue, Identification, Identity};

    /// Tip, two barrel buttons, eraser, invert, in range, sense; axes of 24 bits and pressure: the
    /// report of an Intuos Pro, as its descriptor states it.
    const INTUOS_PRO: &[u8] = &[
        0x05, 0x0d, 0x09, 0x02, 0xa1, 0x01, 0x85, 0x10, 0x09, 0x20, 0xa1, 0x00, 0x09, 0x42, 0x09,
        0x44, 0x09, 0x5a, 0x09, 0x45, 0x09, 0x3c, 0x09, 0x32, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01,
        0x95, 0x06, 0x81, 0x02, 0x06, 0x0d, 0xff, 0x09, 0x36, 0x95, 0x01, 0x81, 0x02, 0x81, 0x03,
        0x05, 0x01, 0x75, 0x18, 0x09, 0x30, 0x27, 0x80, 0xaf, 0x00, 0x00, 0x81, 0x02, 0x09, 0x31,
        0x27, 0xd8, 0x73, 0x00, 0x00, 0x81, 0x02, 0x05, 0x0d, 0x09, 0x30, 0x75, 0x10, 0x26, 0xff,
        0x1f, 0x81, 0x02, 0x75, 0x08, 0x95, 0x11, 0x81, 0x03, 0xc0, 0xc0,
    ];

    fn intuos_pro() -> Found {
        let who = Identity {
            vid: 0x056a,
            pid: 0x0357,
            seen_lengths: vec![27],
            descriptor: INTUOS_PRO.to_vec(),
            ..Identity::default()
        };
        match Catalogue::builtin().unwrap().identify(&who) {
            Identification::Identified(found) => found,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_parser_that_agrees_has_nothing_noted_and_one_that_does_not_has() {
        let mut found = intuos_pro();
        assert_eq!(found.id().parser, Family::WacomIntuosV2);
        let check = cross_check(&found, INTUOS_PRO);
        assert_eq!((check.compared, check.contradictions), (8, Vec::new()));
        // The same descriptor with eraser and invert exchanged.
        let mut exchanged = INTUOS_PRO.to_vec();
        exchanged.swap(19, 21);
        let all = cross_check(&found, &exchanged).contradictions;
        let stated: Vec<_> = all.iter().map(|c| c.statement).collect();
        assert_eq!(stated, [Statement::Invert]);
        note_undecided(&mut found, &exchanged);
        let note = found.note.unwrap();
        assert!(note.contains("the invert bit of the descriptor is read as an eraser in contact"));
    }
}

//! Any pen and any pad that a report descriptor describes.

use crate::descriptor::{Bits, Descriptor, PadFields, PenLayout};
use crate::report::{Batch, PadReport, Parsed, PenReport};
use crate::sample::Tool;

/// Usages of the digitiser page that a selector may press.
const TIP: u32 = 0x000d_0042;
const BARREL: u32 = 0x000d_0044;
const SECOND_BARREL: [u32; 2] = [0x000d_005a, 0x000d_0046];

/// Report of Huion's protocol, version 2, as `hid-uclogic` hands it out.
const HUION_V2: u8 = 0x08;

/// A ring or strip with fewer places than this has no place 0.
const FEW_PLACES: i32 = 16;

/// Reads one report, its id first where it has one, by the descriptor.
pub fn parse(b: &[u8], descriptor: &Descriptor, out: &mut Batch) {
    let own = |id: Option<u8>| id.is_none_or(|id| b.first() == Some(&id));
    if let Some(layout) = descriptor.pens.iter().find(|l| own(l.report_id)) {
        return out.push(pen(b, layout));
    }
    if let Some(fields) = descriptor.pads.iter().find(|p| own(p.report_id)) {
        pad(b, fields, out);
    }
}

fn set(bits: &Option<Bits>, b: &[u8]) -> Option<bool> {
    bits.as_ref().and_then(|f| f.set(b))
}

fn read(bits: &Option<Bits>, b: &[u8]) -> Option<i32> {
    bits.as_ref().and_then(|f| f.read(b))
}

/// The field's value in degrees; `full` is its range where the descriptor states no unit.
fn degrees(bits: &Option<Bits>, b: &[u8], full: f64) -> Option<f32> {
    bits.as_ref().and_then(|f| f.read(b).map(|v| f.degrees(v, full) as f32))
}

/// Returns true if this is the last report of a pen that leaves a Huion under `hid-uclogic`. The
/// tablet sends flags of 0 then, and bit 7 in all others. The driver inverts bit 6 and calls it "in
/// range" (Linux `hid-uclogic-params.c`, `UCLOGIC_PARAMS_PEN_INRANGE_INVERTED`), so that the pen
/// stays in range for every reader of that bit alone. Its 24-bit coordinates distinguish the
/// driver's reports from others with this id.
fn leaves_huion(b: &[u8], layout: &PenLayout) -> bool {
    let wide = layout.x.as_ref().is_some_and(|x| x.len == 24);
    let inverted = layout.in_range.as_ref().is_some_and(|i| i.start == 14);
    layout.report_id == Some(HUION_V2)
        && wide
        && inverted
        && b.get(1).is_some_and(|f| f & 0x80 == 0)
}

fn pen(b: &[u8], layout: &PenLayout) -> Parsed {
    if leaves_huion(b, layout) {
        return Parsed::Away;
    }
    if set(&layout.in_range, b) == Some(false) {
        // A pen that is sensed stays near, as it does in the kernel's generic Wacom driver.
        return if set(&layout.sense, b) == Some(true) { Parsed::Nothing } else { Parsed::Away };
    }
    let (Some(x), Some(y)) = (read(&layout.x, b), read(&layout.y, b)) else {
        return Parsed::Broken;
    };
    let (tip, eraser) = (set(&layout.tip, b), set(&layout.eraser, b));
    let inverted = set(&layout.invert, b).unwrap_or(false) || eraser.unwrap_or(false);
    let pressed = layout.selector.as_ref().map(|s| s.pressed(b));
    let selected = |usage: u32| pressed.map(|p| p == Some(usage));
    let barrel = |i: usize| u32::from(set(&layout.barrel[i], b).unwrap_or(false)) << i;
    let second = SECOND_BARREL.iter().any(|u| selected(*u) == Some(true));
    let buttons = u32::from(selected(BARREL) == Some(true)) | u32::from(second) << 1;
    let tilt = match (degrees(&layout.tilt[0], b, 90.0), degrees(&layout.tilt[1], b, 90.0)) {
        (Some(x), Some(y)) => Some([x, y]),
        _ => None,
    };
    Parsed::Pen(PenReport {
        tool: Some(if inverted { Tool::Eraser } else { Tool::Pen }),
        tip: match (tip, eraser) {
            // A selector names one control: a pressed barrel button hides the tip, so that a tip
            // that is not selected says nothing.
            (None, None) => selected(TIP).filter(|tip| *tip || buttons == 0),
            (a, b) => Some(a.unwrap_or(false) || b.unwrap_or(false)),
        },
        pos: Some([x, y]),
        pressure: layout
            .pressure
            .as_ref()
            .and_then(|f| f.read(b).map(|v| v.saturating_sub(f.min).max(0) as u32)),
        tilt,
        twist: degrees(&layout.twist, b, 360.0).map(f32::to_radians),
        distance: read(&layout.distance, b).map(|d| d.max(0) as u32),
        buttons: Some(barrel(0) | barrel(1) | barrel(2) | buttons),
    })
}

/// Keys first, then each control that turns: the first two relative ones are wheels, the first two
/// absolute ones are rings or strips.
pub(super) fn pad(b: &[u8], fields: &PadFields, out: &mut Batch) {
    if !fields.keys.is_empty() {
        let bit = |(n, bits): &(u32, Bits)| u32::from(bits.set(b).unwrap_or(false)) << n;
        let keys = fields.keys.iter().map(bit).fold(0, |all, one| all | one);
        out.push(Parsed::Pad(PadReport { keys: Some(keys), ..PadReport::default() }));
    }
    let (mut wheels, mut strips) = (0u8, 0u8);
    for turn in &fields.turns {
        let Some(v) = turn.bits.read(b) else { continue };
        if turn.relative {
            if v != 0 {
                let turned = Some((wheels, v));
                out.push(Parsed::Pad(PadReport { turned, ..PadReport::default() }));
            }
            wheels += 1;
        } else {
            let span = (f64::from(turn.bits.max) - f64::from(turn.bits.min)).max(1.0);
            let place = ((f64::from(v) - f64::from(turn.bits.min)) / span) as f32;
            let touched = match &fields.touched {
                Some(bits) => bits.set(b).unwrap_or(false),
                // Outside its range the control says that it is not touched. The rings of
                // `hid-uclogic` have a few places and say it with 0.
                None if turn.bits.min == 0 && turn.bits.max < FEW_PLACES => v > 0,
                None => (turn.bits.min..=turn.bits.max).contains(&v),
            };
            let strip = Some((strips, touched.then_some(place)));
            out.push(Parsed::Pad(PadReport { strip, ..PadReport::default() }));
            strips += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tip, barrel, eraser, invert, in range, three bits of padding; X and Y in 16 bits, pressure
    /// in 16, X tilt in 8.
    const PEN: &[u8] = &[
        0x05, 0x0d, 0x09, 0x02, 0xa1, 0x01, 0x85, 0x07, 0x09, 0x20, 0xa1, 0x00, 0x09, 0x42, 0x09,
        0x44, 0x09, 0x45, 0x09, 0x3c, 0x09, 0x32, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x05,
        0x81, 0x02, 0x95, 0x03, 0x81, 0x03, 0x05, 0x01, 0x09, 0x30, 0x75, 0x10, 0x95, 0x01, 0xa4,
        0x55, 0x0d, 0x65, 0x13, 0x35, 0x00, 0x46, 0x10, 0x27, 0x26, 0x40, 0x9c, 0x81, 0x02, 0x09,
        0x31, 0x46, 0x70, 0x17, 0x26, 0xc0, 0x5d, 0x81, 0x02, 0xb4, 0x05, 0x0d, 0x09, 0x30, 0x26,
        0xff, 0x07, 0x81, 0x02, 0x09, 0x3d, 0x09, 0x3e, 0x15, 0xc4, 0x25, 0x3c, 0x75, 0x08, 0x95,
        0x02, 0x81, 0x02, 0xc0, 0xc0,
    ];

    fn first(report: &[u8], descriptor: &Descriptor) -> Parsed {
        let mut out = Batch::default();
        parse(report, descriptor, &mut out);
        out.as_slice().first().copied().unwrap_or_default()
    }

    fn read(report: &[u8]) -> Parsed {
        first(report, &Descriptor::parse(PEN).unwrap())
    }

    #[test]
    fn fields_are_found_where_they_are_described() {
        let Parsed::Pen(p) = read(&[7, 0x13, 0x40, 0x9c, 1, 0, 0xff, 7, 0xf6, 10]) else {
            panic!()
        };
        assert_eq!((p.tool, p.tip, p.buttons), (Some(Tool::Pen), Some(true), Some(1)));
        assert_eq!((p.pos, p.pressure), (Some([40_000, 1]), Some(2047)));
        assert_eq!(p.tilt, Some([-10.0, 10.0]));
        let Parsed::Pen(p) = read(&[7, 0x14, 0, 0, 0, 0, 0, 0, 0, 0]) else { panic!() };
        assert_eq!((p.tool, p.tip), (Some(Tool::Eraser), Some(true)));
        let Parsed::Pen(p) = read(&[7, 0x18, 0, 0, 0, 0, 0, 0, 0, 0]) else { panic!() };
        assert_eq!((p.tool, p.tip), (Some(Tool::Eraser), Some(false)), "turned over, in the air");
    }

    #[test]
    fn a_pen_leaves_a_report_is_cut_or_is_not_ours() {
        assert_eq!(read(&[7, 0x01, 0, 0, 0, 0, 0, 0, 0, 0]), Parsed::Away);
        assert_eq!(read(&[7, 0x10, 0, 0, 0]), Parsed::Broken);
        assert_eq!(read(&[8, 0x10, 0, 0, 0, 0, 0, 0, 0, 0]), Parsed::Nothing);
        assert_eq!(read(&[]), Parsed::Nothing);
        // Cut after the axes: what is there is read.
        let Parsed::Pen(p) = read(&[7, 0x11, 1, 0, 2, 0]) else { panic!() };
        assert_eq!((p.pos, p.pressure, p.tilt), (Some([1, 2]), None, None));
    }

    /// Keys 1 to 3, then two buttons with the same usages, and a ring in a separate report.
    const PAD: &[u8] = &[
        0x05, 0x01, 0x09, 0x07, 0xa1, 0x01, 0x85, 0xf7, 0x05, 0x0d, 0x09, 0x39, 0xa1, 0x00, 0x05,
        0x09, 0x19, 0x01, 0x29, 0x03, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x03, 0x81, 0x02,
        0x19, 0x01, 0x29, 0x02, 0x95, 0x02, 0x81, 0x02, 0x95, 0x03, 0x81, 0x03, 0xc0, 0xc0, 0x05,
        0x01, 0x09, 0x07, 0xa1, 0x01, 0x85, 0xf8, 0x05, 0x0d, 0x09, 0x39, 0xa1, 0x00, 0x05, 0x09,
        0x09, 0x01, 0x75, 0x01, 0x95, 0x01, 0x81, 0x02, 0x95, 0x07, 0x81, 0x03, 0x05, 0x01, 0x09,
        0x38, 0x25, 0x0b, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02, 0x09, 0x38, 0x15, 0xff, 0x25, 0x01,
        0x81, 0x06, 0xc0, 0xc0,
    ];

    #[test]
    fn keys_rings_and_wheels_are_found_where_they_are_described() {
        let d = Descriptor::parse(PAD).unwrap();
        let pads = |report: &[u8]| {
            let mut out = Batch::default();
            parse(report, &d, &mut out);
            let pad = |p: &Parsed| if let Parsed::Pad(p) = p { Some(*p) } else { None };
            out.as_slice().iter().filter_map(pad).collect::<Vec<_>>()
        };
        let keys = |b: u8| pads(&[0xf7, b])[0].keys;
        assert_eq!((keys(0b101), keys(0b1_1000)), (Some(0b101), Some(0b1_1000)), "five keys");
        let ring = pads(&[0xf8, 1, 11, 0xff]);
        assert_eq!(ring.iter().find_map(|p| p.keys), None, "its one key is no key");
        assert_eq!(ring.iter().find_map(|p| p.strip), Some((0, Some(1.0))));
        assert_eq!(ring.iter().find_map(|p| p.turned), Some((0, -1)));
        let away = pads(&[0xf8, 0, 0, 0]);
        assert_eq!(away.iter().find_map(|p| p.strip), Some((0, None)), "let go");
        assert_eq!(away.iter().find_map(|p| p.turned), None);
    }

    #[test]
    fn sizes_are_as_stated_and_a_maximum_written_short_is_unsigned() {
        let d = Descriptor::parse(PEN).unwrap();
        let (x, y) = (d.pens[0].x.as_ref().unwrap(), d.pens[0].y.as_ref().unwrap());
        assert_eq!((x.max, y.max), (40_000, 24_000));
        // 10 by 6 inches, in thousandths.
        assert!(
            (x.span_mm().unwrap() - 254.0).abs() < 0.1
                && (y.span_mm().unwrap() - 152.4).abs() < 0.1
        );
        assert_eq!(d.pens[0].pressure.as_ref().map(|p| p.max), Some(2047));
    }

    #[test]
    fn a_huion_under_the_kernels_driver_leaves() {
        let bits = |start, len| {
            Some(Bits { start, len, min: 0, max: 50_000, physical: None, unit: 0, exponent: 0 })
        };
        let layout = PenLayout {
            report_id: Some(8),
            x: bits(16, 24),
            y: bits(40, 24),
            tip: bits(8, 1),
            in_range: bits(14, 1),
            pressure: bits(64, 16),
            ..PenLayout::default()
        };
        let near = [8, 0xc1, 1, 0, 0, 2, 0, 0, 9, 0, 0, 0];
        assert!(matches!(pen(&near, &layout), Parsed::Pen(p) if p.tip == Some(true)));
        let away = [8, 0x40, 1, 0, 0, 2, 0, 0, 0, 0, 0, 0];
        assert_eq!(pen(&away, &layout), Parsed::Away);
        // The same flags of another device's report.
        let narrow = PenLayout { x: bits(16, 16), ..layout };
        assert!(matches!(pen(&away, &narrow), Parsed::Pen(_)));
    }

    #[test]
    fn stray_zeros_are_mended_and_absurd_sizes_refused() {
        let mut padded = PEN.to_vec();
        padded.extend([0; 7]);
        assert_eq!(Descriptor::parse(&padded).unwrap().pens.len(), 1);
        let huge = [
            0x05, 0x0d, 0x09, 0x02, 0xa1, 0x01, 0x77, 0xff, 0xff, 0xff, 0x7f, 0x97, 0xff, 0xff,
            0xff, 0x7f, 0x81, 2,
        ];
        assert!(Descriptor::parse(&huge).is_err());
        assert!(Descriptor::parse(&[]).is_err());
        assert!(Descriptor::parse(&vec![0x05; 5000]).is_err());
    }
}

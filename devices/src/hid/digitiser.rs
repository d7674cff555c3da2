//! Any pen that its report descriptor describes.

use crate::descriptor::{Descriptor, PenLayout};
use crate::report::{Parsed, PenReport};
use crate::sample::Tool;

pub fn parse(b: &[u8], descriptor: &Descriptor) -> Parsed {
    let of_id = |l: &&PenLayout| l.report_id.is_none_or(|id| b.first() == Some(&id));
    let Some(layout) = descriptor.pens.iter().find(of_id) else { return Parsed::Nothing };
    let set = |bits: &Option<crate::descriptor::Bits>| bits.as_ref().and_then(|f| f.set(b));
    if set(&layout.in_range) == Some(false) {
        // The kernel's generic Wacom driver keeps such a pen near, too.
        return if set(&layout.sense) == Some(true) { Parsed::Nothing } else { Parsed::Away };
    }
    let read = |bits: &Option<crate::descriptor::Bits>| bits.as_ref().and_then(|f| f.read(b));
    let (Some(x), Some(y)) = (read(&layout.x), read(&layout.y)) else { return Parsed::Broken };
    let (tip, eraser) = (set(&layout.tip), set(&layout.eraser));
    let inverted = set(&layout.invert).unwrap_or(false) || eraser.unwrap_or(false);
    let barrel = |i: usize| u32::from(set(&layout.barrel[i]).unwrap_or(false)) << i;
    let degrees = |bits: &Option<crate::descriptor::Bits>, full: f64| {
        bits.as_ref().and_then(|f| f.read(b).map(|v| f.degrees(v, full) as f32))
    };
    let tilt = match (degrees(&layout.tilt[0], 90.0), degrees(&layout.tilt[1], 90.0)) {
        (Some(x), Some(y)) => Some([x, y]),
        _ => None,
    };
    Parsed::Pen(PenReport {
        tool: Some(if inverted { Tool::Eraser } else { Tool::Pen }),
        tip: match (tip, eraser) {
            (None, None) => None,
            (a, b) => Some(a.unwrap_or(false) || b.unwrap_or(false)),
        },
        pos: Some([x, y]),
        pressure: layout
            .pressure
            .as_ref()
            .and_then(|f| f.read(b).map(|v| v.saturating_sub(f.min).max(0) as u32)),
        tilt,
        twist: degrees(&layout.twist, 360.0).map(f32::to_radians),
        distance: read(&layout.distance).map(|d| d.max(0) as u32),
        buttons: Some(barrel(0) | barrel(1) | barrel(2)),
    })
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

    fn read(report: &[u8]) -> Parsed {
        parse(report, &Descriptor::parse(PEN).unwrap())
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

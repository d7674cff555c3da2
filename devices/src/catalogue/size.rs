//! Which physical sizes are believed.
//!
//! Descriptors state a size in the physical range of the axes, and many state nonsense there: 2.048
//! inches square for every Huion, 21 x 28 mm for an XP-Pen of 9 inches, 832 x 832 mm for a Genius.

use crate::descriptor::{Bits, PenLayout};

/// Smallest diagonal of a tablet, in mm. The smallest real one seen has 89 mm (Volito 2, 3 inches).
const LEAST_DIAGONAL: f64 = 60.0;
/// Largest side of a tablet, in mm: interactive whiteboards of 86 inches.
const MOST_SIDE: f64 = 2000.0;
/// Largest side of a tablet of a maker of tablets and pen displays, in mm: displays of 32 inches.
const MOST_SIDE_OF_TABLET: f64 = 720.0;
/// By how much the resolutions of both axes may differ on a tablet with square counts.
const SQUARE: f64 = 1.06;
/// Unit code that vendors write where they mean inches: it is an angle of the English system.
const MISTAKEN_INCHES: u32 = 0x33;
/// Resolutions of tablets in lines an inch, the commonest first.
const RESOLUTIONS: [f64; 3] = [5080.0, 2540.0, 1000.0];
/// Widths, in mm, that a guessed resolution may lead to: from A6 to a display of 22 inches.
const GUESSED_WIDTH: std::ops::RangeInclusive<f64> = 100.0..=500.0;
/// The size taken where nothing is known: 10 by 6.25 inches, the commonest of all.
const USUAL: (f64, f64) = (254.0, 158.75);

/// Width and height in mm that a descriptor states, where they can be believed.
///
/// `uc_logic`: the vendor is one whose tablets have square counts, so that a difference between the
/// axes shows that the physical range is made up.
pub(super) fn believed(x: &Bits, y: &Bits, uc_logic: bool) -> Option<(f64, f64)> {
    let (width, height) = x.span_mm().zip(y.span_mm())?;
    let (rx, ry) = (range(x), range(y));
    let aspect = width / height;
    // One range for both axes, and one physical range: normalised, not measured.
    let normalised = rx == ry && x.physical == y.physical;
    // The physical range is a copy of the logical one, under a unit that is none.
    let copied = |b: &Bits| b.unit & 0xff == MISTAKEN_INCHES && b.physical == Some((b.min, b.max));
    let square = {
        let ratio = (rx / width) / (ry / height);
        rx == ry || (1.0 / SQUARE..SQUARE).contains(&ratio)
    };
    let plausible = width.hypot(height) >= LEAST_DIAGONAL
        && width.max(height) <= if uc_logic { MOST_SIDE_OF_TABLET } else { MOST_SIDE }
        && (0.2..5.0).contains(&aspect);
    let good = plausible && !normalised && !copied(x) && !copied(y) && (square || !uc_logic);
    good.then_some((width, height))
}

/// Width and height in mm for a report without a believed size, and how they were found. For
/// people.
pub(super) fn guessed(pen: &PenLayout, x: &Bits, y: &Bits) -> ((f64, f64), String) {
    let (rx, ry) = (range(x), range(y));
    let power_of_two = |r: f64| (r as u64).is_power_of_two() || (r as u64 + 1).is_power_of_two();
    if !pen.as_mouse && rx != ry && !power_of_two(rx) && !power_of_two(ry) {
        let mm = |counts: f64, lines: f64| counts * 25.4 / lines;
        if let Some(lines) = RESOLUTIONS.iter().find(|l| GUESSED_WIDTH.contains(&mm(rx, **l))) {
            let note = format!("size guessed from {lines} lines an inch");
            return ((mm(rx, *lines), mm(ry, *lines)), note);
        }
    }
    (USUAL, format!("size unknown, taken as {} x {} mm", USUAL.0, USUAL.1))
}

fn range(b: &Bits) -> f64 {
    f64::from(b.max) - f64::from(b.min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(max: i32, physical: i32, unit: u32, exponent: i32) -> Bits {
        let physical = Some((0, physical));
        Bits { start: 16, len: 16, min: 0, max, physical, unit, exponent }
    }

    fn size(x: (i32, i32), y: (i32, i32), unit: u32, exponent: i32) -> Option<(i64, i64)> {
        let (x, y) = (bits(x.0, x.1, unit, exponent), bits(y.0, y.1, unit, exponent));
        believed(&x, &y, true).map(|(w, h)| (w.round() as i64, h.round() as i64))
    }

    #[test]
    fn real_sizes_are_believed_and_made_up_ones_are_not() {
        assert_eq!(size((32_000, 8000), (20_000, 5000), 0x13, -3), Some((203, 127)), "Huion K58");
        assert_eq!(size((16_000, 8000), (12_000, 6000), 0x33, -3), Some((203, 152)), "WP8060U");
        assert_eq!(size((32_767, 10_092), (32_767, 5675), 0x13, -3), Some((256, 144)), "13.3 Pro");
        for (what, x, y, unit) in [
            ("52 x 52 mm", (32_767, 2048), (32_767, 2048), 0x33),
            ("21 x 28 mm", (45_720, 820), (29_210, 1101), 0x13),
            ("18 x 11 mm", (40_640, 715), (25_400, 422), 0x13),
            ("832 x 780 mm", (32_767, 32_767), (30_720, 30_720), 0x33),
            ("832 x 832 mm", (32_767, 32_767), (32_767, 32_767), 0x13),
            ("1032 x 645 mm", (40_640, 40_640), (25_400, 25_400), 0x13),
            ("416 x 416 mm", (16_383, 16_383), (16_383, 16_383), 0x33),
        ] {
            assert_eq!(size(x, y, unit, -3), None, "{what}");
        }
    }

    #[test]
    fn a_guess_is_a_plausible_size() {
        let guess = |x: i32, y: i32, as_mouse| {
            let pen = PenLayout { as_mouse, ..PenLayout::default() };
            guessed(&pen, &bits(x, 0, 0, 0), &bits(y, 0, 0, 0)).0
        };
        assert_eq!(guess(50_800, 31_750, false), (254.0, 158.75));
        assert_eq!(guess(17_920, 10_752, false).0.round(), 179.0);
        assert_eq!(guess(32_767, 32_767, false), USUAL);
        assert_eq!(guess(20_000, 12_000, true), USUAL);
    }
}

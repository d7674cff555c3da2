//! Keys, rings and strips of Wacom's Intuos and Cintiq tablets: reports 0C, 03 and 11. Layouts from
//! Linux `wacom_wac.c` (`wacom_intuos_pad`).

use crate::report::{PadReport, byte};
use crate::tablet::PadLayout;

/// Places on a ring.
const RING: f32 = 71.0;

/// The pad's state if this report is the pad's. A layout has up to two strips; a report here gives
/// the first, `second` the other.
pub fn parse(b: &[u8], layout: PadLayout) -> Option<[PadReport; 2]> {
    if !matches!(byte(b, 0), 0x0c | 0x03 | 0x11) || b.len() < 10 {
        return None;
    }
    let at = |i: usize| u32::from(byte(b, i));
    let ring = |v: u32| (v & 0x80 != 0).then(|| ((v & 0x7f) as f32 / RING).min(1.0));
    let strip = |i: usize| {
        let bits = (at(i) & 0x1f) << 8 | at(i + 1);
        (bits != 0).then(|| (31 - bits.leading_zeros()) as f32 / 12.0)
    };
    let (keys, first, second) = match layout {
        PadLayout::Intuos3 => {
            let keys =
                (at(6) & 0x10) << 5 | (at(5) & 0x10) << 4 | (at(6) & 0x0f) << 4 | at(5) & 0x0f;
            (keys, strip(1), strip(3))
        }
        PadLayout::Intuos4 => (at(3) << 1 | at(2) & 1, ring(at(1)), None),
        PadLayout::Intuos5 => (at(4) << 1 | at(3) & 1, ring(at(2)), None),
        PadLayout::Cintiq13 => (at(4) << 1 | at(3) & 1, None, None),
        PadLayout::Cintiq22 => {
            (at(8) << 10 | (at(7) & 1) << 9 | at(6) << 1 | at(5) & 1, strip(1), strip(3))
        }
        PadLayout::Cintiq24 => (at(8) << 8 | at(6), ring(at(1)), ring(at(2))),
        PadLayout::Dtk => (at(6), None, None),
    };
    let report =
        |keys, i: u8, place| PadReport { keys: Some(keys), turned: None, strip: Some((i, place)) };
    Some([report(keys, 0, first), report(keys, 1, second)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_and_keys() {
        let [first, _] =
            parse(&[0x0c, 0x80 | 71, 1, 2, 0, 0, 0, 0, 0, 0], PadLayout::Intuos4).unwrap();
        assert_eq!((first.keys, first.strip), (Some(5), Some((0, Some(1.0)))));
        assert_eq!(parse(&[0x02, 0, 0, 0, 0, 0, 0, 0, 0, 0], PadLayout::Intuos4), None);
        let [first, second] =
            parse(&[0x0c, 0x10, 0, 0, 1, 0, 0, 0, 0, 0], PadLayout::Intuos3).unwrap();
        assert_eq!((first.strip, second.strip), (Some((0, Some(1.0))), Some((1, Some(0.0)))));
    }
}

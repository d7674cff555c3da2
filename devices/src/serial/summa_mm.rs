//! SummaSketch in MM format: 5 bytes, no pressure. Its proximity bit is turned over: set means
//! away.

use super::low7;
use crate::report::{Parsed, PenReport};
use crate::sample::Tool;

/// Bytes of a packet.
pub const LENGTH: usize = 5;
/// SerialCounts an inch, as the session asks for.
pub const PER_INCH: f32 = 500.0;

/// Two 14-bit coordinates, low seven bits first.
pub fn place(b: &[u8]) -> [i32; 2] {
    [(low7(b, 2) << 7 | low7(b, 1)) as i32, (low7(b, 4) << 7 | low7(b, 3)) as i32]
}

/// Reads one whole packet.
pub fn parse(b: &[u8]) -> Parsed {
    if b.len() < LENGTH {
        return Parsed::Broken;
    }
    if b[0] & 0x40 != 0 {
        return Parsed::Away;
    }
    Parsed::Pen(PenReport {
        tool: Some(Tool::Pen),
        tip: Some(b[0] & 1 != 0),
        pos: Some(place(b)),
        buttons: Some(u32::from(b[0]) >> 1 & 3),
        ..PenReport::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packet_reads_and_set_means_away() {
        let Parsed::Pen(r) = parse(&[0x9b, 5, 40, 6, 20]) else { panic!() };
        assert_eq!(
            (r.pos, r.tip, r.buttons),
            (Some([40 << 7 | 5, 20 << 7 | 6]), Some(true), Some(1))
        );
        assert_eq!(parse(&[0xdb, 5, 40, 6, 20]), Parsed::Away);
        assert_eq!(parse(&[0x9b, 5, 40, 6]), Parsed::Broken);
    }
}

//! The parameters that UC-Logic's tablets keep in USB strings 200 and 100. Layout: Linux
//! `hid-uclogic-params.c`.

use super::identity::Identity;

/// Parameters that a tablet states for its pen. Accepted only if every figure is plausible.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Params {
    /// Counts at the right edge.
    pub max_x: u32,
    /// Counts at the bottom edge.
    pub max_y: u32,
    /// Counts at full pressure.
    pub max_pressure: u32,
    /// Lines an inch, the same along both axes.
    pub resolution: u32,
}

impl Params {
    /// From string 200 where there is one, else from string 100. `None` where both are absent, too
    /// short, or hold something else.
    pub fn of(who: &Identity) -> Option<Params> {
        Params::all(who).first().copied()
    }

    /// Returns true if string 200 holds parameters: the tablet uses the second protocol.
    pub fn is_long(who: &Identity) -> bool {
        who.strings.iter().any(|(i, b)| *i == 200 && Params::long(b).is_some())
    }

    /// Returns the parameters of string 200, then those of string 100: a tablet may have both, for
    /// its two protocols.
    pub fn all(who: &Identity) -> Vec<Params> {
        let raw =
            |index: u8| who.strings.iter().find(|(i, _)| *i == index).map(|(_, b)| b.as_slice());
        let long = raw(200).and_then(Params::long);
        long.into_iter().chain(raw(100).and_then(Params::short)).collect()
    }

    fn long(b: &[u8]) -> Option<Params> {
        (b.len() >= 12)
            .then(|| {
                let u24 = |i: usize| {
                    u32::from(b[i]) | u32::from(b[i + 1]) << 8 | u32::from(b[i + 2]) << 16
                };
                Params {
                    max_x: u24(2),
                    max_y: u24(5),
                    max_pressure: u16(b, 8),
                    resolution: u16(b, 10),
                }
            })?
            .checked()
    }

    fn short(b: &[u8]) -> Option<Params> {
        (b.len() >= 12)
            .then(|| Params {
                max_x: u16(b, 2),
                max_y: u16(b, 4),
                max_pressure: u16(b, 8),
                resolution: u16(b, 10),
            })?
            .checked()
    }

    /// A version text in place of parameters reads as nonsense; it is not believed.
    fn checked(self) -> Option<Params> {
        let axis = |v: u32| (1000..=200_000).contains(&v);
        let good = axis(self.max_x)
            && axis(self.max_y)
            && (255..=32_767).contains(&self.max_pressure)
            && (500..=20_000).contains(&self.resolution);
        good.then_some(self)
    }

    /// Width and height of the active area in mm.
    pub fn size_mm(&self) -> (f64, f64) {
        let mm = |v: u32| f64::from(v) * 25.4 / f64::from(self.resolution);
        (mm(self.max_x), mm(self.max_y))
    }
}

fn u16(b: &[u8], i: usize) -> u32 {
    u32::from(b[i]) | u32::from(b[i + 1]) << 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_strings_are_read_and_text_is_not() {
        let who = |index, b: &[u8]| Identity {
            strings: vec![(index, b.to_vec())],
            ..Identity::default()
        };
        let long = [
            0x13, 3, 0x70, 0xc6, 0, 6, 0x7c, 0, 0xff, 0x1f, 0xd8, 0x13, 3, 0x0d, 0x10, 1, 4, 0x3c,
            0x3e,
        ];
        let p = Params::of(&who(200, &long)).unwrap();
        assert_eq!((p.max_x, p.max_y, p.max_pressure, p.resolution), (50_800, 31_750, 8191, 5080));
        assert_eq!(p.size_mm().0.round(), 254.0);
        let short = [0x0c, 3, 0x40, 0x9c, 0xc0, 0x5d, 3, 0, 0xff, 7, 0xa0, 0x0f];
        assert_eq!(Params::of(&who(100, &short)).unwrap().max_x, 40_000);
        assert_eq!(Params::of(&who(200, &[10, 3, b'V', 0, b'1', 0, b'.', 0, b'0', 0])), None);
        assert_eq!(Params::of(&who(200, &[2])), None);
    }
}

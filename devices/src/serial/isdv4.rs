//! Wacom ISDV4, as in tablet PCs (the kernel's "W8001"): 9-byte pen packets, touch packets of 5, 7
//! or 13 bytes, control packets of 11.

use super::{low7, signed7};
use crate::report::{Parsed, PenReport};
use crate::sample::Tool;

/// Bytes of a pen's packet.
pub const PEN_LENGTH: usize = 9;
/// Bytes of an answer.
pub const CONTROL_LENGTH: usize = 11;
/// Counts a mm. The protocol fixes it; the device does not state it.
pub const PER_MM: f32 = 100.0;

/// The reply to `*`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Isdv4Query {
    /// Largest coordinates.
    pub max: [i32; 2],
    /// Full pressure in counts.
    pub max_pressure: u32,
    /// Both 0: no tilt.
    pub max_tilt: [u32; 2],
    /// Version of the firmware.
    pub version: u32,
}

impl Isdv4Query {
    /// Reads a control packet; `None` if it is none.
    pub fn parse(b: &[u8]) -> Option<Isdv4Query> {
        let &[b0, .., v0, v1] = b.first_chunk::<CONTROL_LENGTH>()?;
        if b0 & 0xc0 != 0xc0 {
            return None;
        }
        let (max, max_pressure) = place(b);
        let version = u32::from(v0 & 0x7f) << 7 | u32::from(v1 & 0x7f);
        (max[0] > 0 && max[1] > 0).then_some(Isdv4Query {
            max,
            max_pressure,
            max_tilt: [low7(b, 7), low7(b, 8)],
            version,
        })
    }
}

/// The reply to `%`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchQuery {
    /// 0 to 5; it says how long a touch packet is.
    pub sensor: u8,
    /// Largest coordinates of a finger.
    pub max: [i32; 2],
}

impl TouchQuery {
    /// Reads a control packet; `None` if it is none, or says that there is no touch.
    pub fn parse(b: &[u8]) -> Option<TouchQuery> {
        let b: &[u8; CONTROL_LENGTH] = b.first_chunk()?;
        // Tablets without touch answer too, with nothing in the second byte.
        if b[0] & 0xc0 != 0xc0 || b[1] & 0x7f == 0 {
            return None;
        }
        let x = low7(b, 3) << 9 | low7(b, 4) << 2 | low7(b, 2) >> 5 & 3;
        let y = low7(b, 5) << 9 | low7(b, 6) << 2 | low7(b, 2) >> 3 & 3;
        // The first touch models state a number of bits instead.
        let max =
            if x == 0 && y == 0 { [1 << low7(b, 1).min(14); 2] } else { [x as i32, y as i32] };
        Some(TouchQuery { sensor: b[2] & 7, max })
    }

    fn length(&self) -> usize {
        match self.sensor {
            0 | 2 => 5,
            1 | 3 | 4 => 7,
            _ => 13,
        }
    }
}

fn place(b: &[u8]) -> ([i32; 2], u32) {
    let x = low7(b, 1) << 9 | low7(b, 2) << 2 | low7(b, 6) >> 5 & 3;
    let y = low7(b, 3) << 9 | low7(b, 4) << 2 | low7(b, 6) >> 3 & 3;
    ([x as i32, y as i32], (low7(b, 6) & 7) << 7 | low7(b, 5))
}

/// Data learned from the replies, and the state that the third button needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Isdv4Layout {
    query: Isdv4Query,
    touch: Option<TouchQuery>,
    /// Fingers become samples; else they are read over.
    fingers: bool,
    visit: FingerVisit,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FingerVisit {
    Nothing,
    Pen,
    Eraser,
    Finger,
}

impl Isdv4Layout {
    /// A layout for a tablet that answered so. `fingers`: touch becomes samples, too.
    pub fn new(query: Isdv4Query, touch: Option<TouchQuery>, fingers: bool) -> Self {
        Isdv4Layout { query, touch, fingers, visit: FingerVisit::Nothing }
    }

    /// Both maxima must be stated.
    pub fn tilts(&self) -> bool {
        self.query.max_tilt.iter().all(|t| *t > 0)
    }

    /// Bytes of a packet that begins with `first`.
    pub fn length(&self, first: u8) -> usize {
        match (first & 0x40 != 0, first & 0x10 != 0) {
            (_, true) => self.touch.map_or(PEN_LENGTH, |t| t.length()),
            (true, false) => CONTROL_LENGTH,
            (false, false) => PEN_LENGTH,
        }
    }

    /// Reads one whole packet.
    pub fn parse(&mut self, b: &[u8]) -> Parsed {
        let Some(&b0) = b.first() else { return Parsed::Broken };
        if b.len() < self.length(b0) {
            return Parsed::Broken;
        }
        if b0 & 0x10 != 0 {
            return self.finger(b);
        }
        if b0 & 0x40 != 0 {
            return Parsed::Nothing;
        }
        if b0 & 0x20 == 0 {
            let away = self.visit != FingerVisit::Nothing;
            self.visit = FingerVisit::Nothing;
            return if away { Parsed::Away } else { Parsed::Nothing };
        }
        let (pos, pressure) = place(b);
        if pos[0] > self.query.max[0] || pos[1] > self.query.max[1] {
            return Parsed::Broken;
        }
        let f2 = b0 & 4 != 0;
        // One bit means two things: set as the pen enters it is the eraser, set later the second
        // button. If the eraser's bit disappears during the visit, the tool was a pen from the
        // start.
        self.visit = match self.visit {
            FingerVisit::Nothing | FingerVisit::Finger if f2 => FingerVisit::Eraser,
            FingerVisit::Eraser if f2 => FingerVisit::Eraser,
            _ => FingerVisit::Pen,
        };
        let eraser = self.visit == FingerVisit::Eraser;
        let second = f2 && !eraser;
        Parsed::Pen(PenReport {
            tool: Some(if eraser { Tool::Eraser } else { Tool::Pen }),
            tip: Some(b0 & 1 != 0),
            pos: Some(pos),
            pressure: Some(pressure),
            tilt: self.tilt(b),
            buttons: Some(u32::from(b0 & 2 != 0) | u32::from(second) << 1),
            ..PenReport::default()
        })
    }

    /// Sources disagree on whether tilt is signed: a stated maximum under 64 can only be that of a
    /// signed one, as the sensor leans further than 64 degrees from end to end; a greater one is
    /// the whole span.
    fn tilt(&self, b: &[u8]) -> Option<[f32; 2]> {
        let [x, y] = self.query.max_tilt;
        if !self.tilts() {
            return None;
        }
        let one = |i: usize, max: u32| {
            if max < 64 { signed7(b, i) } else { low7(b, i) as f32 - max.div_ceil(2) as f32 }
        };
        Some([one(7, x), one(8, y)])
    }

    /// The first finger, on the pen's scale. A pen in range takes precedence.
    fn finger(&mut self, b: &[u8]) -> Parsed {
        let Some(touch) = self.touch.filter(|_| self.fingers) else { return Parsed::Nothing };
        if matches!(self.visit, FingerVisit::Pen | FingerVisit::Eraser) {
            return Parsed::Nothing;
        }
        if b[0] & 1 == 0 {
            let away = self.visit == FingerVisit::Finger;
            self.visit = FingerVisit::Nothing;
            return if away { Parsed::Away } else { Parsed::Nothing };
        }
        self.visit = FingerVisit::Finger;
        let on = |at: usize, axis: usize| {
            let counts = (low7(b, at) << 7 | low7(b, at + 1)) as i32;
            counts.min(touch.max[axis]) * self.query.max[axis] / touch.max[axis].max(1)
        };
        Parsed::Pen(PenReport {
            tool: Some(Tool::Touch),
            tip: Some(true),
            pos: Some([on(1, 0), on(3, 1)]),
            // A finger has none; half stands for it.
            pressure: Some(self.query.max_pressure / 2),
            buttons: Some(0),
            ..PenReport::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Maxima 25000 x 18000, pressure 255, no tilt.
    const REPLY: [u8; 11] = [0xc0, 48, 106, 35, 20, 127, 0b0000001, 0, 0, 1, 5];

    fn layout(touch: Option<TouchQuery>) -> Isdv4Layout {
        Isdv4Layout::new(Isdv4Query::parse(&REPLY).unwrap(), touch, true)
    }

    #[test]
    fn the_query_reply_reads_and_nonsense_does_not() {
        let q = Isdv4Query::parse(&REPLY).unwrap();
        assert_eq!((q.max, q.max_pressure, q.version), ([25000, 18000], 255, 133));
        assert_eq!(Isdv4Query::parse(&REPLY[..10]), None);
        assert_eq!(Isdv4Query::parse(&[0x80; 11]), None);
        let touch = [0xc0, 10, 0b0110_0101, 7, 1, 3, 2, 0, 0, 0, 0];
        assert_eq!(TouchQuery::parse(&touch), Some(TouchQuery { sensor: 5, max: [3591, 1544] }));
        assert_eq!(
            TouchQuery::parse(&[0xc0, 10, 1, 0, 0, 0, 0, 0, 0, 0, 0]).unwrap().max,
            [1024; 2]
        );
        assert_eq!(TouchQuery::parse(&[0xc0, 0, 1, 7, 1, 3, 2, 0, 0, 0, 0]), None, "no touch here");
    }

    #[test]
    fn the_third_bit_is_the_eraser_at_entry_and_a_button_later() {
        let mut l = layout(None);
        let mut see = |b0: u8| match l.parse(&[b0, 10, 3, 20, 5, 40, 0b0110_1001, 0, 0]) {
            Parsed::Pen(r) => (r.tool, r.buttons, r.tip),
            other => panic!("{other:?}"),
        };
        assert_eq!(see(0xa4), (Some(Tool::Eraser), Some(0), Some(false)));
        assert_eq!(see(0xa0), (Some(Tool::Pen), Some(0), Some(false)), "never was one");
        assert_eq!(see(0xa7), (Some(Tool::Pen), Some(3), Some(true)));
        assert_eq!(l.parse(&[0x80; 9]), Parsed::Away);
        assert_eq!(l.parse(&[0x80; 9]), Parsed::Nothing);
        assert!(matches!(
            l.parse(&[0xa4, 0, 0, 0, 0, 0, 0, 0, 0]),
            Parsed::Pen(PenReport { tool: Some(Tool::Eraser), .. })
        ));
    }

    #[test]
    fn coordinates_come_from_five_bytes_and_beyond_the_maximum_are_refused() {
        let mut l = layout(None);
        let Parsed::Pen(r) = l.parse(&[0xa1, 10, 3, 20, 5, 40, 0b0110_1001, 0, 0]) else {
            panic!()
        };
        assert_eq!(r.pos, Some([10 << 9 | 3 << 2 | 3, 20 << 9 | 5 << 2 | 1]));
        assert_eq!((r.pressure, r.tilt), (Some(1 << 7 | 40), None));
        assert_eq!(l.parse(&[0xa1, 127, 127, 20, 5, 40, 0, 0, 0]), Parsed::Broken);
    }

    #[test]
    fn a_finger_is_read_only_while_no_pen_is_there() {
        let mut l = layout(Some(TouchQuery { sensor: 1, max: [1000, 1000] }));
        let down = [0x91, 3, 116, 2, 0, 0, 0];
        let Parsed::Pen(r) = l.parse(&down) else { panic!() };
        assert_eq!((r.tool, r.pos), (Some(Tool::Touch), Some([12500, 4608])));
        assert_eq!(l.parse(&[0x90, 0, 0, 0, 0, 0, 0]), Parsed::Away);
        assert!(matches!(l.parse(&[0xa0, 1, 1, 1, 1, 0, 0, 0, 0]), Parsed::Pen(_)));
        assert_eq!(l.parse(&down), Parsed::Nothing);
        assert_eq!(
            [0, 1, 2, 3, 4, 5].map(|sensor| TouchQuery { sensor, max: [1; 2] }.length()),
            [5, 7, 5, 7, 7, 13]
        );
    }
}

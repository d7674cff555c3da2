//! The report layouts, one function or one arm each.

use crate::tablet::Family;

/// A pose in the device's counts.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseCounts {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) p: u32,
    /// Degrees.
    pub(super) tilt: [i32; 2],
    pub(super) height: u32,
    pub(super) tip: bool,
    pub(super) eraser: bool,
    pub(super) buttons: u32,
}

/// The report descriptor of a plain pen, for the parser that reads by descriptor.
pub(super) const GENERIC_DESCRIPTOR: &[u8] = &[
    0x05, 0x0d, 0x09, 0x02, 0xa1, 0x01, 0x85, 0x01, 0x09, 0x20, 0xa1,
    0x00, // Pen, report 1, stylus
    0x09, 0x42, 0x09, 0x44, 0x09, 0x45, 0x09, 0x3c, 0x09,
    0x32, // tip, barrel, eraser, invert, in range
    0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x05, 0x81, 0x02, 0x95, 0x03, 0x81,
    0x03, // one bit each, 3 spare
    0x05, 0x01, 0x26, 0xff, 0x7f, 0x35, 0x00, 0x55, 0x0e, 0x65, 0x11, 0x75, 0x10, 0x95,
    0x01, // 0.1 mm
    0x09, 0x30, 0x46, 0x34, 0x08, 0x81, 0x02, // X: 0 to 32767 over 210 mm
    0x09, 0x31, 0x46, 0xc8, 0x05, 0x81, 0x02, // Y: over 148 mm
    0x05, 0x0d, 0x45, 0x00, 0x65, 0x00, 0x55, 0x00, 0x26, 0xff, 0x1f, 0x09, 0x30, 0x81,
    0x02, // pressure to 8191
    0x15, 0xc4, 0x25, 0x3c, 0x35, 0xc4, 0x45, 0x3c, 0x65, 0x14, 0x75,
    0x08, // degrees, -60 to 60
    0x09, 0x3d, 0x81, 0x02, 0x09, 0x3e, 0x81, 0x02, 0xc0, 0xc0,
];

fn le(v: u32) -> [u8; 2] {
    [v as u8, (v >> 8) as u8]
}

fn be(v: u32) -> [u8; 2] {
    [(v >> 8) as u8, v as u8]
}

fn le24(v: u32) -> [u8; 3] {
    [v as u8, (v >> 8) as u8, (v >> 16) as u8]
}

fn bit(set: bool, value: u8) -> u8 {
    if set { value } else { 0 }
}

impl PoseCounts {
    fn flags(&self) -> u8 {
        u8::from(self.tip) | (self.buttons as u8) << 1
    }

    /// Tip, buttons, eraser touch (bit 3) and invert (bit 4), as Wacom's newer tablets send them.
    fn ends(&self) -> u8 {
        if !self.eraser {
            return self.flags();
        }
        0x10 | bit(self.tip, 8) | (self.buttons as u8) << 1
    }

    fn tilt8(&self) -> [u8; 2] {
        self.tilt.map(|t| t as i8 as u8)
    }

    /// In hundredths of a degree, or as they are.
    fn tilt16(&self, times: i32) -> [u8; 4] {
        let [[a, b], [c, d]] = self.tilt.map(|t| ((t * times) as i16).to_le_bytes());
        [a, b, c, d]
    }
}

/// The report that a family sends as the pen leaves; `None` where it sends none.
pub(super) fn away(family: Family) -> Option<Vec<u8>> {
    let of = |length: usize, start: &[u8]| {
        let mut b = start.to_vec();
        b.resize(length, 0);
        Some(b)
    };
    match family {
        Family::WacomIntuosV1 => of(10, &[0x02, 0x80]),
        Family::WacomSimple => of(10, &[0x02]),
        Family::WacomGraphire | Family::WacomGraphire4 => of(8, &[0x02, 0x10]),
        Family::WacomBamboo => of(9, &[0x02, 0x10]),
        Family::WacomGraphireBluetooth => of(9, &[0x03, 0x10]),
        Family::WacomPenPartner => of(7, &[0x01]),
        Family::WacomPl | Family::WacomPtu | Family::WacomDtu | Family::WacomTabletPc => {
            of(8, &[0x02])
        }
        Family::WacomDtus => of(8, &[0x11]),
        Family::WacomIntuosV2 => of(27, &[0x10]),
        Family::WacomProBluetooth => of(361, &[0x80, 0x80]),
        Family::WacomIntuosBluetooth => of(51, &[0x80, 0x80]),
        Family::WacomIntuosV3 => of(26, &[0x1e]),
        Family::WacomOne => of(14, &[0x1f, 0x01]),
        Family::UcLogic | Family::XpPenOffset => of(12, &[0x02, 0xc0]),
        Family::XpPenGen2 => of(14, &[0x02, 0xc0]),
        Family::Huion => of(12, &[0x08]),
        Family::Floogoo => of(12, &[0x02]),
        Family::Veikk | Family::Acepen => of(13, &[0x09, 0x41, 0xc0]),
        Family::VeikkA15 => of(9, &[0x09, 0x41, 0xc0]),
        Family::KyePlain => of(8, &[0x10]),
        Family::Xenx => of(8, &[0x01]),
        Family::RobotPen => of(12, &[0x02, 0x40]),
        Family::WoodPad => of(14, &[0x02]),
        Family::Signature => of(10, &[0x02]),
        Family::Digitiser => of(10, &[0x01]),
        Family::WacomBambooPad | Family::Kye | Family::TenMoons | Family::Plain => None,
    }
}

pub(super) fn intuos(c: &PoseCounts) -> Vec<u8> {
    let (x, y) = (be(c.x >> 1), be(c.y >> 1));
    let tilt = c.tilt.map(|t| (t + 64) as u32);
    let b1 = 0xe0 | c.buttons << 1 | c.p & 1;
    let b7 = c.p << 5 & 0xc0 | tilt[0] >> 1;
    let b8 = tilt[0] << 7 | tilt[1];
    let b9 = c.height << 2 | (c.x & 1) << 1 | c.y & 1;
    let [b6, b7, b8, b9] = [c.p >> 3, b7, b8, b9].map(|b| b as u8);
    vec![0x02, b1 as u8, x[0], x[1], y[0], y[1], b6, b7, b8, b9]
}

pub(super) fn simple(c: &PoseCounts, max_distance: u32) -> Vec<u8> {
    let (x, y, p) = (le(c.x), le(c.y), le(c.p));
    let near = max_distance.saturating_sub(c.height) as u8;
    vec![0x02, 0xe0 | bit(c.eraser, 8) | c.flags(), x[0], x[1], y[0], y[1], p[0], p[1], near, 0]
}

/// Pressure is signed here, its low bits spread over two bytes.
pub(super) fn pl(c: &PoseCounts, max_pressure: u32) -> Vec<u8> {
    let mut q = c.p as i32 - (max_pressure as i32 + 1) / 2;
    let mut b4 = (c.y >> 14) as u8 & 3 | bit(c.tip, 8) | bit(c.buttons & 1 != 0, 0x10);
    b4 |= bit(c.eraser || c.buttons & 2 != 0, 0x20);
    if max_pressure > 255 {
        b4 |= bit(q & 1 != 0, 0x40);
        q >>= 1;
    }
    b4 |= bit(q & 1 != 0, 4);
    let seven = |v: u32| (v & 0x7f) as u8;
    let b1 = 0x40 | (c.x >> 14) as u8 & 3;
    vec![
        0x02,
        b1,
        seven(c.x >> 7),
        seven(c.x),
        b4,
        seven(c.y >> 7),
        seven(c.y),
        (q >> 1) as u8 & 0x7f,
    ]
}

/// 8 bytes, 10 with tilt, 12 with high coordinate bytes; pressure may count from 8192.
pub(super) fn uclogic(c: &PoseCounts, length: usize, offset: bool) -> Vec<u8> {
    let (x, y, p, t) = (le24(c.x), le24(c.y), le(c.p | if offset { 0x2000 } else { 0 }), c.tilt8());
    let mut b = vec![0x02, 0xa0 | bit(c.eraser, 8) | c.flags(), x[0], x[1], y[0], y[1], p[0], p[1]];
    b.extend([t[0], t[1], x[2], y[2]]);
    b.truncate(if length < 10 {
        8
    } else if length < 12 {
        10
    } else {
        12
    });
    b
}

pub(super) fn other(family: Family, c: &PoseCounts) -> Vec<u8> {
    let (x, y, p, t) = (le24(c.x), le24(c.y), le(c.p), c.tilt8());
    let f = c.flags();
    match family {
        Family::WacomBambooPad => {
            vec![
                0x10,
                1,
                bit(c.eraser, 8) | bit(c.buttons & 1 != 0, 2),
                x[0],
                x[1],
                y[0],
                y[1],
                p[0],
                p[1],
            ]
        }
        Family::WacomGraphire | Family::WacomGraphire4 | Family::WacomBamboo => {
            let mut b =
                vec![0x02, 0x90 | bit(c.eraser, 0x20) | f, x[0], x[1], y[0], y[1], p[0], p[1] & 3];
            b.resize(if family == Family::WacomBamboo { 9 } else { 8 }, 0);
            b
        }
        Family::WacomGraphireBluetooth => {
            let high = bit(c.p > 255, 8);
            vec![0x03, 0x90 | bit(c.eraser, 0x20) | f | high, x[0], x[1], y[0], y[1], p[0], 0, 0]
        }
        Family::WacomPenPartner => {
            let flags = 0x80 | bit(c.eraser, 0x20) | bit(c.buttons & 1 != 0, 0x40);
            let press = (c.p as i32 - 127).clamp(-127, 127) as i8 as u8;
            vec![0x01, x[0], x[1], y[0], y[1], flags, press]
        }
        Family::WacomPtu => {
            let tip = bit(c.tip, if c.eraser { 8 } else { 1 });
            vec![
                0x02,
                0x20 | bit(c.eraser, 4) | tip | two_buttons(c),
                x[0],
                x[1],
                y[0],
                y[1],
                p[0],
                p[1],
            ]
        }
        Family::WacomDtu | Family::WacomTabletPc => {
            let tip = bit(c.tip, if c.eraser { 4 } else { 1 });
            vec![
                0x02,
                0x20 | bit(c.eraser, 8) | tip | two_buttons(c),
                x[0],
                x[1],
                y[0],
                y[1],
                p[0],
                p[1],
            ]
        }
        Family::WacomDtus => {
            let (x, y, tool) = (be(c.x), be(c.y), if c.eraser { 1 } else { 2 });
            let b1 = 0x80 | tool << 3 | (c.buttons as u8) << 5 | p[1] & 3;
            vec![0x11, b1, p[0], x[0], x[1], y[0], y[1], 0]
        }
        Family::WacomIntuosV2 => {
            let mut b = vec![0x10, 0x60 | c.ends()];
            b.extend(x.into_iter().chain(y).chain(p).chain(t));
            b.resize(27, 0);
            b[16] = c.height as u8;
            b
        }
        // One frame; the report has room for several.
        Family::WacomProBluetooth | Family::WacomIntuosBluetooth => {
            let pro = family == Family::WacomProBluetooth;
            let mut b = vec![0x80, 0xe0 | c.ends()];
            b.extend(le(c.x).into_iter().chain(le(c.y)).chain(p));
            if pro {
                b.extend(t);
            }
            b.resize(if pro { 14 } else { 8 }, 0);
            b.push(c.height as u8);
            b.resize(if pro { 361 } else { 51 }, 0);
            b
        }
        Family::WacomIntuosV3 => {
            let end =
                bit(c.eraser && c.tip, 0x10) | bit(c.eraser, 0x20) | bit(c.tip && !c.eraser, 1);
            let mut b = vec![0x1e, 0x01, 0xc0 | end | (c.buttons as u8) << 1];
            b.extend(x.into_iter().chain(y).chain(p).chain(c.tilt16(1)));
            b.resize(26, 0);
            b[19] = c.height as u8;
            b
        }
        Family::WacomOne => {
            let mut b = vec![0x1f, 0x01, 0x60 | c.ends(), x[0], x[1], y[0], y[1], p[0], p[1]];
            b.extend(c.tilt16(100));
            b.push(c.height as u8);
            b
        }
        Family::XpPenGen2 => {
            let mut b = uclogic(c, 12, false);
            b[7] = b[7] & 0x9f | 0x40;
            b.extend([0, (c.p >> 13) as u8 & 1]);
            b
        }
        Family::Huion => {
            let mut b = vec![
                0x08,
                0x80 | bit(c.eraser, 0x20) | f,
                x[0],
                x[1],
                y[0],
                y[1],
                p[0],
                p[1],
                x[2],
                y[2],
            ];
            b.extend([t[0], -c.tilt[1] as i8 as u8]);
            b
        }
        Family::Floogoo => {
            let mut b = vec![0x02, 0x20 | bit(c.eraser, 8) | f, x[0], x[1], y[0], y[1], p[0], p[1]];
            b.extend(c.tilt16(100));
            b
        }
        Family::Veikk => {
            let mut b = vec![0x09, 0x41, 0xa0 | f];
            b.extend(x.into_iter().chain(y).chain(p).chain(t));
            b
        }
        Family::VeikkA15 => vec![0x09, 0x41, 0xa0 | f, x[0], x[1], y[0], y[1], p[0], p[1]],
        Family::Acepen => {
            vec![0x09, 0x41, 0xa0 | f, x[0], x[1], y[0], y[1], p[0], p[1], t[0], t[1], 0, 0]
        }
        Family::Kye => {
            vec![0x02, x[0], x[1], y[0], y[1], bit(c.tip, 4) | (c.buttons as u8) << 3, p[0], p[1]]
        }
        Family::KyePlain => vec![0x10, 0x80 | f, x[0], x[1], y[0], y[1], p[0], p[1]],
        Family::Plain => vec![0x01, f, x[0], x[1], y[0], y[1], p[0], p[1]],
        Family::Xenx => {
            vec![0x01, 0x80 | bit(c.eraser, 0x40) | f, x[0], x[1], y[0], y[1], p[0], p[1]]
        }
        Family::TenMoons => {
            let pressed = if c.buttons == 0 { 0 } else { 50 };
            let (x, y, p) = (be(c.x), be(c.y), be(0x672u32.saturating_sub(c.p) + pressed));
            let keys = [0, 4, 6, 6][c.buttons as usize];
            vec![0x06, x[0], x[1], y[0], y[1], p[0], p[1], 0, 0, keys]
        }
        Family::RobotPen => vec![0x02, 0x42, 0, 0, 0, 0, x[0], x[1], y[0], y[1], p[0], p[1] & 0x0f],
        Family::Signature => {
            vec![0x02, x[0], x[1], y[0], y[1], 3 | bit(c.tip, 4), p[0], p[1], 0, 0]
        }
        Family::WoodPad => {
            let flags = 3 | bit(c.tip, 4) | (c.buttons as u8) << 3;
            vec![0x02, x[0], x[1], 0, 0, y[0], y[1], 0, 0, flags, p[0], p[1], t[0], t[1]]
        }
        Family::Digitiser => {
            let end = bit(c.tip && !c.eraser, 1) | bit(c.tip && c.eraser, 4) | bit(c.eraser, 8);
            let b1 = 0x10 | end | bit(c.buttons & 1 != 0, 2);
            vec![0x01, b1, x[0], x[1], y[0], y[1], p[0], p[1], t[0], t[1]]
        }
        Family::WacomIntuosV1 => intuos(c),
        Family::WacomSimple => simple(c, c.height),
        Family::WacomPl => pl(c, 255),
        Family::UcLogic => uclogic(c, 12, false),
        Family::XpPenOffset => uclogic(c, 12, true),
    }
}

/// Bits 1 and 4, as tablet PCs have them.
fn two_buttons(c: &PoseCounts) -> u8 {
    bit(c.buttons & 1 != 0, 2) | bit(c.buttons & 2 != 0, 0x10)
}

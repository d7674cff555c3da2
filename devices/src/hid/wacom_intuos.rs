//! Wacom's 10-byte reports, ids 02 and 10: Intuos 1 to 5, Intuos Pro, most Cintiqs. Layout and tool
//! numbers from Linux `wacom_wac.c` (`wacom_intuos_general`, `wacom_intuos_inout`); agrees with its
//! decode of real recordings.

use crate::report::{Parsed, PenReport, be16_at};
use crate::sample::Tool;

/// Differences of one tablet from its family.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IntuosTraits {
    /// Intuos 1 halves its coordinates and height.
    pub halved: bool,
    /// 1023 levels: the wire carries twice the pressure.
    pub halved_pressure: bool,
    /// The first Cintiqs send positions that are not ready, without bit 6.
    pub needs_ready: bool,
    /// Intuos HT2: height counts up toward the surface, no tilt.
    pub height_inverted: bool,
    /// Cintiq 21UX 2: pens of the first Intuos 4 do not work on it, and their reports are noise.
    pub needs_new_pen: bool,
    /// Largest height.
    pub max_distance: u32,
}

/// State kept between reports: the tool is named once, when it enters.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IntuosMemory {
    /// A first-generation Intuos follows two tools at once (bit 0 of byte 1 tells them apart); one
    /// is enough for a hand.
    tool: Option<Tool>,
    reporting: bool,
    noise: bool,
}

/// Reads one report, its id first.
pub fn parse(b: &[u8], traits: &IntuosTraits, memory: &mut IntuosMemory) -> Parsed {
    if b.len() < 10 {
        return if matches!(b.first(), Some(0x02 | 0x10)) {
            Parsed::Broken
        } else {
            Parsed::Nothing
        };
    }
    // Feature reports 05, 06 and 08 name the tool that is near.
    if !matches!(b[0], 0x02 | 0x10 | 0x05 | 0x06 | 0x08) {
        return Parsed::Nothing;
    }
    let flags = b[1];
    if flags & 0xfc == 0xc0 {
        let id = tool_id(b);
        memory.tool = Some(tool_named(id));
        memory.noise = traits.needs_new_pen && id & 0x10000 == 0;
        return Parsed::Nothing;
    }
    if flags & 0xfe == 0x20 {
        // Still near but too far to be placed: lifted, at the greatest height.
        return match (memory.tool, memory.reporting) {
            (Some(tool), true) => Parsed::Pen(PenReport {
                tool: Some(tool),
                pressure: Some(0),
                distance: Some(traits.max_distance),
                ..PenReport::default()
            }),
            _ => Parsed::Nothing,
        };
    }
    if flags & 0xfe == 0x80 {
        let known = memory.tool.take();
        memory.reporting = false;
        return if known.is_some() { Parsed::Away } else { Parsed::Nothing };
    }
    // A puck has separate packets. A pen and an eraser share theirs, so the parser waits for the
    // tool's number: it comes as the pen enters, or as the answer to the reader's query.
    let puck = matches!(flags >> 1 & 0x0f, 4 | 6 | 8).then_some(Tool::Mouse);
    let Some(tool) = memory.tool.or(puck) else { return Parsed::Nothing };
    memory.tool = Some(tool);
    if matches!(b[0], 0x05 | 0x06 | 0x08) || memory.noise || traits.needs_ready && flags & 0x40 == 0
    {
        return Parsed::Nothing;
    }
    memory.reporting = true;
    Parsed::Pen(placed(b, tool, traits))
}

fn placed(b: &[u8], tool: Tool, traits: &IntuosTraits) -> PenReport {
    let low = u32::from(b[9]);
    let (mut x, mut y) = (be16_at(b, 2) << 1 | (low >> 1 & 1), be16_at(b, 4) << 1 | (low & 1));
    let mut distance = low >> 2;
    if traits.halved {
        (x, y, distance) = (x >> 1, y >> 1, distance >> 1);
    }
    if traits.height_inverted {
        distance = traits.max_distance.saturating_sub(distance);
    }
    let mut pen = PenReport {
        tool: Some(tool),
        pos: Some([x as i32, y as i32]),
        distance: Some(distance),
        ..PenReport::default()
    };
    match b[1] >> 1 & 0x0f {
        0..=3 => {
            let p = u32::from(b[6]) << 3 | u32::from(b[7] & 0xc0) >> 5 | u32::from(b[1] & 1);
            pen.pressure = Some(if traits.halved_pressure { p >> 1 } else { p });
            if !traits.height_inverted {
                pen.tilt = Some(tilt(b));
            }
            pen.buttons = Some(u32::from(b[1] >> 1 & 3));
        }
        5 if !traits.halved && tool != Tool::Mouse => pen.twist = Some(twist(b)),
        6 => pen.buttons = Some(u32::from(b[6] & 0x1f)),
        8 => pen.buttons = Some(u32::from(b[8] >> 2 & 7)),
        // Second packet of an airbrush.
        10 => pen.tilt = Some(tilt(b)),
        _ => {}
    }
    pen
}

fn tilt(b: &[u8]) -> [f32; 2] {
    let x = (u32::from(b[7]) << 1 & 0x7e) | u32::from(b[8]) >> 7;
    [x as f32 - 64.0, f32::from(b[8] & 0x7f) - 64.0]
}

/// Marker-pen rotation, 1800 steps a turn.
fn twist(b: &[u8]) -> f32 {
    let t = (i32::from(b[6]) << 3) | i32::from(b[7] >> 5 & 7);
    let steps = match (b[7] & 0x20 != 0, t > 900) {
        (true, true) => (t - 1) / 2 - 1350,
        (true, false) => (t - 1) / 2 + 450,
        (false, _) => 450 - t / 2,
    };
    steps as f32 * (std::f32::consts::TAU / 1800.0)
}

fn tool_id(b: &[u8]) -> u32 {
    u32::from(b[2]) << 4
        | u32::from(b[3]) >> 4
        | (u32::from(b[7]) & 0x0f) << 16
        | (u32::from(b[8]) & 0xf0) << 8
}

/// Pucks are listed; bit 3 of any other number says eraser.
fn tool_named(id: u32) -> Tool {
    match id & 0xfff {
        0x006 | 0x007 | 0x017 | 0x094 | 0x096 | 0x097 | 0x09c | 0x806 => Tool::Mouse,
        n if n & 0x8 != 0 => Tool::Eraser,
        _ => Tool::Pen,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTER: [u8; 10] = [0x02, 0xc2, 0x80, 0x42, 0x48, 0x0d, 0xe2, 0x11, 0x00, 0x00];

    #[test]
    fn a_visit_names_its_tool_then_moves_then_leaves() {
        let (traits, mut memory) =
            (IntuosTraits { max_distance: 63, ..IntuosTraits::default() }, IntuosMemory::default());
        assert_eq!(parse(&ENTER, &traits, &mut memory), Parsed::Nothing);
        let moved = [0x02, 0xe0, 0x10, 0x00, 0x08, 0x00, 0x01, 0xc0, 0x00, 0x2b];
        let Parsed::Pen(pen) = parse(&moved, &traits, &mut memory) else { panic!("no pen") };
        assert_eq!(pen.pos, Some([0x2001, 0x1001]));
        assert_eq!((pen.pressure, pen.distance), (Some(0b1110), Some(10)));
        assert_eq!(pen.tilt, Some([-64.0, -64.0]));
        assert_eq!(
            parse(&[0x02, 0x80, 0, 0, 0, 0, 0, 0, 0, 0], &traits, &mut memory),
            Parsed::Away
        );
        assert_eq!(
            parse(&moved, &traits, &mut memory),
            Parsed::Nothing,
            "the next visit has not named its tool"
        );
    }

    #[test]
    fn erasers_and_pucks_are_told_from_pens() {
        for (id, tool) in [
            (0x802, Tool::Pen),
            (0x80a, Tool::Eraser),
            (0x10804, Tool::Pen),
            (0x1080c, Tool::Eraser),
            (0x912, Tool::Pen),
            (0x91a, Tool::Eraser),
            (0x09c, Tool::Mouse),
            (0x806, Tool::Mouse),
        ] {
            assert_eq!(tool_named(id), tool, "{id:#x}");
        }
    }

    #[test]
    fn a_cut_report_is_broken_and_no_length_panics() {
        let mut memory = IntuosMemory::default();
        for n in 0..10 {
            let got = parse(&ENTER[..n], &IntuosTraits::default(), &mut memory);
            assert_eq!(got, if n == 0 { Parsed::Nothing } else { Parsed::Broken });
        }
    }
}

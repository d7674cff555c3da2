//! What the firmware of pens does wrong, by class and not by model: buttons in bits that mean
//! something else, and pens that seem to leave.
//!
//! Each rule works on what a parser has read, so that it holds for every family. Sources: the
//! kernel's HID-BPF programs (`XPPen__Artist24`, `XPPen__ArtistPro16Gen2`, `Huion__Kamvas-Pro-19`,
//! `WALTOP__Batteryless-Tablet`) and `wacom_wac.c` (`WACOM_QUIRK_PEN_BUTTON3`).

use crate::report::{Parsed, PenReport};
use crate::sample::Tool;

/// Bit of the first barrel button in [`PenReport::buttons`].
pub const FIRST: u32 = 1;
/// Bit of the second barrel button.
pub const SECOND: u32 = 2;
/// Bit of the third barrel button.
pub const THIRD: u32 = 4;

/// Rules that apply to a pen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FirmwareRules {
    /// Wacom: the third button is sent as the first two together.
    pub third_is_both: bool,
    /// Huion: the third button is sent as the invert bit. A pen that is turned over leaves before.
    pub third_is_invert: bool,
    /// XP-Pen: the second button makes the pen leave, and come back in the air, before it is sent.
    pub second_bounces: bool,
    /// Waltop: the second button is sent as the tip and the first button together.
    pub second_is_tip_and_first: bool,
}

/// The rules of one pen, with what they remember.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PenFirmware {
    rules: FirmwareRules,
    /// The tool of this visit; `None` while no pen is near.
    tool: Option<Tool>,
    /// Tip and buttons of the last report, as they were sent.
    last: (bool, u32),
    /// The second button is held and sent as tip and first button.
    held_second: bool,
    /// A pen in contact seemed to leave, and no report has confirmed it.
    doubted: bool,
}

impl PenFirmware {
    /// A pen that is not near.
    pub fn new(rules: FirmwareRules) -> PenFirmware {
        PenFirmware { rules, ..PenFirmware::default() }
    }

    /// The pen left, by silence or because its device was unplugged.
    pub fn forget(&mut self) {
        *self = PenFirmware::new(self.rules);
    }

    /// Returns what the pen did; [`Parsed::Nothing`] where the report is the firmware's own noise.
    pub fn repair(&mut self, parsed: Parsed) -> Parsed {
        match parsed {
            Parsed::Pen(report) => self.pen(report).map_or(Parsed::Nothing, Parsed::Pen),
            Parsed::Away => self.away(),
            other => other,
        }
    }

    fn away(&mut self) -> Parsed {
        // A pen cannot leave without lifting: the first such report is doubted. Where no other
        // follows, silence ends the visit.
        if self.rules.second_bounces && self.last.0 && !self.doubted {
            self.doubted = true;
            return Parsed::Nothing;
        }
        self.forget();
        Parsed::Away
    }

    fn pen(&mut self, mut r: PenReport) -> Option<PenReport> {
        let sent = (r.tip.unwrap_or(false), r.buttons.unwrap_or(self.last.1));
        let before = std::mem::replace(&mut self.last, sent);
        self.doubted = false;
        if self.rules.second_bounces {
            let second = (before.1 ^ sent.1) & SECOND != 0;
            if self.tool.is_some() && before.0 != sent.0 && second {
                return None;
            }
        }
        if self.rules.third_is_invert {
            self.invert(&mut r);
        }
        if self.rules.third_is_both && r.buttons == Some(FIRST | SECOND) {
            r.buttons = Some(THIRD);
        }
        if self.rules.second_is_tip_and_first {
            self.tip_and_first(&mut r, before);
        }
        self.tool = r.tool.or(self.tool);
        Some(r)
    }

    /// Within a visit of the pen, the invert bit is its third button.
    fn invert(&mut self, r: &mut PenReport) {
        if r.tool == Some(Tool::Eraser) && self.tool == Some(Tool::Pen) {
            r.tool = Some(Tool::Pen);
            r.buttons = r.buttons.map(|b| b | THIRD);
        }
    }

    /// Both at once, where neither was pressed before, are the second button.
    fn tip_and_first(&mut self, r: &mut PenReport, before: (bool, u32)) {
        let both = r.tip == Some(true) && r.buttons.is_some_and(|b| b & FIRST != 0);
        let begins = both && !before.0 && before.1 & FIRST == 0 && r.pressure == Some(0);
        self.held_second = both && (begins || self.held_second);
        if self.held_second {
            r.tip = Some(false);
            r.buttons = r.buttons.map(|b| b & !FIRST | SECOND);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pen(tool: Tool, tip: bool, buttons: u32) -> Parsed {
        Parsed::Pen(PenReport {
            tool: Some(tool),
            tip: Some(tip),
            pressure: Some(if tip { 900 } else { 0 }),
            buttons: Some(buttons),
            ..PenReport::default()
        })
    }

    /// Tool, tip and buttons of what is left of these reports.
    fn mended(rules: FirmwareRules, all: &[Parsed]) -> Vec<Option<(Tool, bool, u32)>> {
        let mut firmware = PenFirmware::new(rules);
        let mut out = Vec::new();
        for parsed in all {
            match firmware.repair(*parsed) {
                Parsed::Pen(p) => {
                    out.push(Some((p.tool.unwrap(), p.tip.unwrap(), p.buttons.unwrap())));
                }
                Parsed::Away => out.push(None),
                _ => {}
            }
        }
        out
    }

    #[test]
    fn a_second_button_that_bounces_does_not_cut_a_stroke() {
        let rules = FirmwareRules { second_bounces: true, ..FirmwareRules::default() };
        let (touch, held) = (pen(Tool::Pen, true, 0), pen(Tool::Pen, true, 2));
        let (air, air_held) = (pen(Tool::Pen, false, 0), pen(Tool::Pen, false, 2));
        let away = Parsed::Away;
        let all = [air, touch, away, air_held, held, held, away, air, touch, air, away];
        let expected = [
            Some((Tool::Pen, false, 0)),
            Some((Tool::Pen, true, 0)),
            Some((Tool::Pen, true, 2)),
            Some((Tool::Pen, true, 2)),
            Some((Tool::Pen, true, 0)),
            Some((Tool::Pen, false, 0)),
            None,
        ];
        assert_eq!(mended(rules, &all), expected);
        // A pen that is pulled away in contact, by a firmware that repeats it.
        assert_eq!(
            mended(rules, &[touch, away, away]),
            [Some((Tool::Pen, true, 0)), None],
            "the second report confirms it"
        );
    }

    #[test]
    fn an_invert_bit_within_a_visit_is_the_third_button() {
        let rules = FirmwareRules { third_is_invert: true, ..FirmwareRules::default() };
        let (touch, third) = (pen(Tool::Pen, true, 0), pen(Tool::Eraser, true, 0));
        let got = mended(rules, &[touch, third, touch, Parsed::Away, third, touch]);
        let expected = [
            Some((Tool::Pen, true, 0)),
            Some((Tool::Pen, true, THIRD)),
            Some((Tool::Pen, true, 0)),
            None,
            Some((Tool::Eraser, true, 0)),
            Some((Tool::Pen, true, 0)),
        ];
        assert_eq!(got, expected);
    }

    #[test]
    fn two_buttons_of_a_wacom_pen_at_once_are_the_third() {
        let rules = FirmwareRules { third_is_both: true, ..FirmwareRules::default() };
        let got = mended(rules, &[0, 1, 2, 3].map(|b| pen(Tool::Pen, false, b)));
        let buttons: Vec<u32> = got.iter().flatten().map(|p| p.2).collect();
        assert_eq!(buttons, [0, FIRST, SECOND, THIRD]);
    }

    #[test]
    fn tip_and_first_button_at_once_are_the_second_of_a_waltop() {
        let rules = FirmwareRules { second_is_tip_and_first: true, ..FirmwareRules::default() };
        let both = Parsed::Pen(PenReport {
            pressure: Some(0),
            ..match pen(Tool::Pen, true, 1) {
                Parsed::Pen(p) => p,
                _ => unreachable!(),
            }
        });
        let (air, touch) = (pen(Tool::Pen, false, 0), pen(Tool::Pen, true, 0));
        let got = mended(rules, &[air, both, both, air, touch, pen(Tool::Pen, true, 1)]);
        let tips: Vec<(bool, u32)> = got.iter().flatten().map(|p| (p.1, p.2)).collect();
        let held = (false, SECOND);
        assert_eq!(tips, [(false, 0), held, held, (false, 0), (true, 0), (true, 1)]);
    }
}

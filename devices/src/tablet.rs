//! The facts of one tablet, from a TOML file in `tablets/` or in a folder of the user's.
//!
//! An unknown key is an error that names it. Every number is a fact with a source. How reports are
//! read is the business of the parser that `parser` names.

use serde::{Deserialize, Serialize};

use crate::pad_actions::ActionTable;

/// One model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tablet {
    /// Brand and model as printed on it.
    pub name: String,
    /// Source of the facts.
    pub source: String,
    /// The active area.
    pub area: Area,
    /// The pen.
    pub pen: PenFacts,
    /// The pad. Absent where the tablet has none.
    #[serde(default, skip_serializing_if = "PadFacts::is_empty")]
    pub pad: PadFacts,
    /// Default actions of its keys, wheels and pen buttons; see [`crate::pad_actions`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actions: Option<ActionTable>,
    /// Identities of the model on the bus. A model may have several firmwares.
    pub id: Vec<Id>,
}

/// The active area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Area {
    /// Width in mm.
    pub width_mm: f64,
    /// Height in mm.
    pub height_mm: f64,
    /// The size is rounded to whole inches, as libwacom's is: a believable size in the report
    /// descriptor is better.
    #[serde(default, skip_serializing_if = "is_false")]
    pub nominal: bool,
    /// Counts at the left and top edge.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub min_x: i32,
    /// Count at the top edge.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub min_y: i32,
    /// Counts at the right edge. 0 where the report descriptor says it (`parser = "digitiser"`).
    pub max_x: i32,
    /// Counts at the bottom edge; 0 as with `max_x`.
    pub max_y: i32,
}

/// Capabilities of the pen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PenFacts {
    /// Counts at full pressure; 0 for a pen without pressure.
    pub max_pressure: u32,
    /// Buttons on the barrel.
    pub buttons: u8,
    /// Counts at the greatest height; 0 where the pen does not report it.
    #[serde(default, skip_serializing_if = "is_zero_u32")]
    pub max_distance: u32,
}

/// Controls of the pad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PadFacts {
    /// Number of keys.
    #[serde(default)]
    pub keys: u8,
    /// Number of wheels, dials and rings.
    #[serde(default)]
    pub wheels: u8,
    /// Position of the controls in the pad's report, for families with several layouts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<PadLayout>,
}

/// One way in which a model appears on the bus.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Id {
    /// Vendor id.
    pub vid: u16,
    /// Product id.
    pub pid: u16,
    /// Longest input report of the pen's interface in bytes, its id included; 0 where the product
    /// id alone decides.
    pub length: u16,
    /// The parser that reads its reports.
    pub parser: Family,
    /// USB interface number of the pen; absent where any may be it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<u8>,
    /// Bytes that the vendor's Windows driver puts before each report.
    #[serde(default, skip_serializing_if = "is_zero_u8")]
    pub skip: u8,
    /// USB strings that tell models of one id apart, `INDEX=PATTERN`; one of them must match. See
    /// [`StringIs`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub strings: Vec<String>,
    /// Feature reports to send before the pen uses its vendor protocol, in hexadecimal.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub init_feature: Vec<String>,
    /// Output reports to send, as `init_feature`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub init_output: Vec<String>,
    /// USB strings whose reading switches the tablet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub init_strings: Vec<u8>,
    /// Differences of this model from its family.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quirks: Vec<Quirk>,
}

/// A pattern on one USB string: found anywhere, unless `^` holds it to the start or `$` to the end;
/// `#` is any digit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StringIs<'a> {
    /// Index of the USB string.
    pub index: u8,
    /// Pattern of the string.
    pub pattern: &'a str,
}

impl<'a> StringIs<'a> {
    /// Of `INDEX=PATTERN`.
    pub fn parse(text: &'a str) -> Option<Self> {
        let (index, pattern) = text.split_once('=')?;
        Some(StringIs { index: index.parse().ok()?, pattern })
    }

    /// Returns true if a text matches the pattern.
    pub fn matches(&self, text: &str) -> bool {
        let (pattern, start) =
            self.pattern.strip_prefix('^').map_or((self.pattern, false), |p| (p, true));
        let (pattern, end) = pattern.strip_suffix('$').map_or((pattern, false), |p| (p, true));
        let (pattern, text): (Vec<char>, Vec<char>) =
            (pattern.chars().collect(), text.chars().collect());
        let fits = |i: usize| {
            let alike = |(p, t): (&char, &char)| p == t || *p == '#' && t.is_ascii_digit();
            i + pattern.len() <= text.len()
                && pattern.iter().zip(&text[i..]).all(alike)
                && (!start || i == 0)
                && (!end || i + pattern.len() == text.len())
        };
        (0..=text.len()).any(fits)
    }
}

/// The parsers: a closed set. The file of `hid/` that names the family documents its reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Intuos 1 to 5, Intuos Pro, most Cintiqs: report 02 or 10 of 10 bytes.
    WacomIntuosV1,
    /// Bamboo Pen, One by Wacom, Intuos of 2013: report 02 of 9 or 10 bytes.
    WacomSimple,
    /// Bamboo PadFacts: report 10 of kind 01.
    WacomBambooPad,
    /// Graphire 1 to 3: report 02 of 8 bytes.
    WacomGraphire,
    /// Graphire 4: the same with keys and a wheel.
    WacomGraphire4,
    /// The first Bamboo: the same with keys and a ring.
    WacomBamboo,
    /// Graphire over Bluetooth: report 03.
    WacomGraphireBluetooth,
    /// PenPartner: reports 01 and 02.
    WacomPenPartner,
    /// PL and DTF displays.
    WacomPl,
    /// PTU displays.
    WacomPtu,
    /// DTU displays.
    WacomDtu,
    /// DTU-1031 and its kind.
    WacomDtus,
    /// Tablet PCs over USB.
    WacomTabletPc,
    /// Intuos Pro of 2017, Intuos of 2018: report 10.
    WacomIntuosV2,
    /// Intuos Pro of 2017 over Bluetooth: report 80 with seven frames.
    WacomProBluetooth,
    /// Intuos of 2018 over Bluetooth: report 80 with four frames.
    WacomIntuosBluetooth,
    /// Intuos Pro of 2025: report 1E.
    WacomIntuosV3,
    /// Wacom One: report 1F.
    WacomOne,
    /// UC-Logic's layout of 8 to 12 bytes, also XP-Pen, UGEE and Parblo.
    UcLogic,
    /// XP-Pen whose pressure counts from 8192.
    XpPenOffset,
    /// XP-Pen of the second generation: 14 bytes.
    XpPenGen2,
    /// Huion and Gaomon: report 08 of 12 bytes.
    Huion,
    /// FlooGoo.
    Floogoo,
    /// VEIKK: 13 bytes.
    Veikk,
    /// VEIKK A15: 9 bytes.
    VeikkA15,
    /// Acepen.
    Acepen,
    /// Genius and KYE: report 02.
    Kye,
    /// Genius and KYE: report 10.
    KyePlain,
    /// 10moons.
    TenMoons,
    /// Flags, axes and pressure at bytes 1, 2, 4 and 6, and no word when the pen leaves.
    Plain,
    /// XENX.
    Xenx,
    /// RobotPen.
    RobotPen,
    /// ViewSonic WoodPad.
    WoodPad,
    /// Signature pads of Signotec and ViewSonic: report 02.
    Signature,
    /// From the report descriptor alone.
    Digitiser,
}

impl Family {
    /// As it is written in tablet files.
    pub fn name(self) -> String {
        serde_json::to_string(&self).unwrap_or_default().trim_matches('"').to_owned()
    }
}

/// Difference of one model from its family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quirk {
    /// Coordinates and height are halved (Intuos 1).
    Halved,
    /// Positions count only with the ready bit (first Cintiqs).
    NeedsReady,
    /// Pens of the first Intuos 4 are noise here (Cintiq 21UX 2).
    NeedsNewPen,
    /// Height counts up toward the surface.
    HeightInverted,
    /// This model sends other data in place of the family's tilt.
    NoTilt,
}

/// Where Wacom's pads keep their keys, rings and strips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PadLayout {
    /// Eight keys and two strips.
    Intuos3,
    /// Nine keys and a ring.
    Intuos4,
    /// Nine keys and a ring, one byte further on.
    Intuos5,
    /// Nine keys.
    Cintiq13,
    /// Eighteen keys and two strips.
    Cintiq22,
    /// Sixteen keys and two rings.
    Cintiq24,
    /// Four keys.
    Dtk,
}

/// A tablet file that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{file}: {what}")]
pub struct TabletError {
    /// Name of the file.
    pub file: String,
    /// The fault in it.
    pub what: String,
}

impl Tablet {
    /// Reads and checks a tablet file; `file` names it in errors.
    pub fn parse(file: &str, text: &str) -> Result<Tablet, TabletError> {
        let fail = |what: String| TabletError { file: file.to_owned(), what };
        let tablet: Tablet = toml::from_str(text).map_err(|e| fail(e.to_string()))?;
        tablet.check().map_err(fail)?;
        Ok(tablet)
    }

    fn check(&self) -> Result<(), String> {
        let a = &self.area;
        for (name, v) in [("width_mm", a.width_mm), ("height_mm", a.height_mm)] {
            if !(v.is_finite() && (5.0..=5000.0).contains(&v)) {
                return Err(format!("area.{name} = {v}: expected 5 to 5000 mm"));
            }
        }
        let described = self.id.iter().all(|id| id.parser == Family::Digitiser);
        let empty = a.max_x <= a.min_x || a.max_y <= a.min_y;
        if empty && !(described && (a.max_x, a.max_y) == (0, 0)) {
            return Err("area: max_x and max_y must exceed min_x and min_y".to_owned());
        }
        if self.pen.max_pressure > 1 << 20 {
            return Err(format!(
                "pen.max_pressure = {}: more than any pen has",
                self.pen.max_pressure
            ));
        }
        if self.id.is_empty() {
            return Err("no [[id]]: the model could never be found".to_owned());
        }
        if let Some(actions) = &self.actions {
            actions.check()?;
        }
        for id in &self.id {
            if let Some(bad) = id.strings.iter().find(|s| StringIs::parse(s).is_none()) {
                return Err(format!("strings: `{bad}`: expected INDEX=PATTERN"));
            }
            for hex in id.init_feature.iter().chain(&id.init_output) {
                if hex_bytes(hex).is_none_or(|b| b.is_empty()) {
                    return Err(format!(
                        "init report `{hex}`: expected pairs of hexadecimal digits"
                    ));
                }
            }
        }
        Ok(())
    }

    /// The one way this file is written; a test holds every file of the catalogue to it.
    pub fn canonical(&self) -> String {
        let plain = toml::to_string(self).unwrap_or_default();
        let mut out = String::with_capacity(plain.len());
        for line in plain.lines() {
            // Bus ids are known to everybody in hexadecimal.
            let id = line.split_once(" = ").filter(|(key, _)| matches!(*key, "vid" | "pid"));
            match id.and_then(|(key, v)| Some((key, v.parse::<u16>().ok()?))) {
                Some((key, v)) => out.push_str(&format!("{key} = {v:#06x}")),
                None => out.push_str(line),
            }
            out.push('\n');
        }
        out
    }
}

/// Bytes of a hexadecimal string, blanks ignored.
pub fn hex_bytes(text: &str) -> Option<Vec<u8>> {
    let digits: Vec<u8> = text
        .bytes()
        .filter(|b| !b.is_ascii_whitespace())
        .map(|b| (b as char).to_digit(16).map(|d| d as u8))
        .collect::<Option<_>>()?;
    if !digits.len().is_multiple_of(2) {
        return None;
    }
    Some(digits.chunks(2).map(|p| p[0] << 4 | p[1]).collect())
}

impl PadFacts {
    fn is_empty(&self) -> bool {
        *self == PadFacts::default()
    }
}

fn is_false(v: &bool) -> bool {
    !*v
}
fn is_zero(v: &i32) -> bool {
    *v == 0
}
fn is_zero_u32(v: &u32) -> bool {
    *v == 0
}
fn is_zero_u8(v: &u8) -> bool {
    *v == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_written() {
        let like = |pattern: &str, text: &str| {
            StringIs::parse(&format!("201={pattern}")).unwrap().matches(text)
        };
        assert!(like("HUION_T173_######$", "HUION_T173_190124"));
        assert!(!like("HUION_T173_######$", "HUION_T173_19012x"));
        assert!(
            like("M508", "xM508y") && like("^$", "") && !like("^$", "a") && like("^420$", "420")
        );
        assert!(!like("^420$", "H420") && like("", "anything"));
        assert_eq!(StringIs::parse("no index"), None);
    }

    #[test]
    fn unknown_keys_and_absurd_numbers_are_named() {
        let good = "name = \"A\"\nsource = \"B\"\n[area]\nwidth_mm = 100.0\nheight_mm = 60.0\n\
                   max_x = 10\nmax_y = 6\n\
                    [pen]\nmax_pressure = 1023\nbuttons = 2\n[[id]]\nvid = 1\npid = 2\nlength = 8\n\
                    parser = \"uc-logic\"\n";
        assert!(Tablet::parse("t", good).is_ok());
        for (from, to, expect) in [
            ("buttons = 2", "buttons = 2\ncolour = 3", "colour"),
            ("width_mm = 100.0", "width_mm = nan", "width_mm"),
            ("max_x = 10", "max_x = 0", "max_x"),
            ("uc-logic", "no-such", "no-such"),
            ("length = 8", "length = 8\nstrings = [\"x\"]", "INDEX=PATTERN"),
            ("length = 8", "length = 8\ninit_output = [\"0g\"]", "0g"),
        ] {
            let e = Tablet::parse("t.toml", &good.replace(from, to)).unwrap_err().to_string();
            assert!(e.starts_with("t.toml: ") && e.contains(expect), "{e}");
        }
    }
}

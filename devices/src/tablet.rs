//! A tablet is data: one TOML file a model, in `devices/tablets/` or in a folder of the user's.
//!
//! Strict: an unknown key is an error that names it. Every number is a fact with a source; what a driver must *do* is in
//! the parser that `parser` names.

use serde::{Deserialize, Serialize};

/// One model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tablet {
    /// Maker and model as printed on it.
    pub name: String,
    /// Where the facts come from.
    pub source: String,
    pub area: Area,
    pub pen: PenFacts,
    #[serde(default, skip_serializing_if = "Pad::is_empty")]
    pub pad: Pad,
    /// How it shows itself; a model may have several firmwares.
    pub id: Vec<Id>,
}

/// The active area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Area {
    pub width_mm: f64,
    pub height_mm: f64,
    /// Counts at the left and top edge.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub min_x: i32,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub min_y: i32,
    /// Counts at the right and bottom edge.
    pub max_x: i32,
    pub max_y: i32,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PenFacts {
    /// Counts at full pressure; 0 where the pen has none.
    pub max_pressure: u32,
    pub buttons: u8,
    /// Counts at the greatest height; 0 where height is not told.
    #[serde(default, skip_serializing_if = "is_zero_u32")]
    pub max_distance: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pad {
    #[serde(default)]
    pub keys: u8,
    #[serde(default)]
    pub wheels: u8,
    /// Places on a touch ring; 0 where there is none.
    #[serde(default)]
    pub ring: u16,
}

/// One way in which a model shows itself on the bus.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Id {
    pub vid: u16,
    pub pid: u16,
    /// Longest input report of the pen's interface in bytes, its id included.
    pub length: u16,
    pub parser: Family,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<u8>,
    /// Bytes put before each report by the maker's Windows driver.
    #[serde(default, skip_serializing_if = "is_zero_u8")]
    pub skip: u8,
    /// USB strings by index that tell models of one id apart: `#` stands for a digit; one of them must match the start.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub strings: Vec<StringIs>,
    /// Bytes to send before the pen speaks its own protocol, hexadecimal.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub init_feature: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub init_output: Vec<String>,
    /// USB strings whose reading switches the tablet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub init_strings: Vec<u8>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quirks: Vec<Quirk>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StringIs {
    pub index: u8,
    pub like: String,
}

/// The parsers: a closed set, one file each in `hid/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    WacomIntuosV1,
    /// From the report descriptor alone.
    Digitiser,
}

/// What one model does differently from its family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quirk {
    /// Coordinates and height are halved (Intuos 1).
    Halved,
    /// Positions count only with the ready bit (first Cintiqs).
    NeedsReady,
    /// Height counts up toward the surface.
    HeightInverted,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{file}: {what}")]
pub struct TabletError {
    pub file: String,
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
        if a.max_x <= a.min_x || a.max_y <= a.min_y {
            return Err("area: max_x and max_y must exceed min_x and min_y".to_owned());
        }
        if self.pen.max_pressure > 1 << 20 {
            return Err(format!("pen.max_pressure = {}: more than any pen has", self.pen.max_pressure));
        }
        if self.id.is_empty() {
            return Err("no [[id]]: the model could never be found".to_owned());
        }
        for id in &self.id {
            for hex in id.init_feature.iter().chain(&id.init_output) {
                if hex_bytes(hex).is_none_or(|b| b.is_empty()) {
                    return Err(format!("init report `{hex}`: expected pairs of hexadecimal digits"));
                }
            }
        }
        Ok(())
    }

    /// The one way this file is written; a test holds every file of the catalogue to it.
    pub fn canonical(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }
}

/// Bytes of a hexadecimal string, blanks ignored.
pub fn hex_bytes(text: &str) -> Option<Vec<u8>> {
    let digits: Vec<u8> = text
        .bytes()
        .filter(|b| !b.is_ascii_whitespace())
        .map(|b| (b as char).to_digit(16).map(|d| d as u8))
        .collect::<Option<_>>()?;
    if digits.len() % 2 != 0 {
        return None;
    }
    Some(digits.chunks(2).map(|p| p[0] << 4 | p[1]).collect())
}

impl Pad {
    fn is_empty(&self) -> bool {
        *self == Pad::default()
    }
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

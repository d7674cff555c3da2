//! Presets of processes, printers and materials, as TOML; each names its source. Which presets
//! exist is the caller's to decide: this module embeds none. The limits of walls are those of
//! [`sculptd_geometry::thickness::preset`], named by a process or a material.

use serde::{Deserialize, Serialize};

/// The way in which a process makes a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BuildMethod {
    /// In layers, from a plate upwards.
    Layers,
    /// In layers, carried by powder: without plate and supports.
    Powder,
    /// In a mould of two halves.
    Mould,
}

/// The limits of a process. Lengths in millimetres, angles in degrees. A limit that is absent is
/// not checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessPreset {
    /// `process`.
    pub kind: String,
    /// The name on the command line.
    pub name: String,
    /// The displayed name.
    pub title: String,
    /// The way in which the part is made.
    pub method: BuildMethod,
    /// The thickness preset with the limits of walls.
    pub walls: Option<String>,
    /// The material used unless the caller names another.
    pub material: String,
    /// The height of a layer.
    pub layer_height: Option<f64>,
    /// The diameter of the nozzle, or the width of a pixel.
    pub resolution: Option<f64>,
    /// The least diameter of a pin.
    pub pin: Option<f64>,
    /// The least diameter of a hole.
    pub hole: Option<f64>,
    /// The least clearance between two faces.
    pub gap: Option<f64>,
    /// The largest angle of a face that looks down, from the vertical.
    pub overhang: Option<f64>,
    /// Overhangs with a smaller area are not reported, mm2.
    pub overhang_area: Option<f64>,
    /// The longest span of a flat ceiling between two supports.
    pub bridge: Option<f64>,
    /// True to report contours that begin with nothing below them.
    #[serde(default)]
    pub islands: bool,
    /// The largest enclosed volume, mm3.
    pub trapped: Option<f64>,
    /// The largest volume that is sealed while the part is built, mm3.
    pub cup: Option<f64>,
    /// The least angle by which the part can be tilted before it falls.
    pub tip_angle: Option<f64>,
    /// The least area of the first layer, mm2.
    pub contact_area: Option<f64>,
    /// The least angle between a face and the pull direction.
    pub draft: Option<f64>,
    /// Regions without draft that have a smaller area are not reported, mm2.
    pub draft_area: Option<f64>,
    /// The largest area that neither half of a mould releases, mm2.
    pub undercut: Option<f64>,
    /// The least height of a triangle over its longest side.
    pub sliver: Option<f64>,
    /// Material laid down, mm3 a second.
    pub extrusion: Option<f64>,
    /// The time that a layer takes besides, seconds.
    pub layer_seconds: Option<f64>,
    /// The source of the numbers.
    pub source: String,
}

/// A machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrinterPreset {
    /// `printer`.
    pub kind: String,
    /// The name on the command line.
    pub name: String,
    /// The displayed name.
    pub title: String,
    /// The process that it works by.
    pub process: String,
    /// Width, depth and height, millimetres.
    pub build_volume: Option<[f64; 3]>,
    /// The diameter of the nozzle, or the width of a pixel.
    pub resolution: Option<f64>,
    /// The height of a layer.
    pub layer_height: Option<f64>,
    /// The largest clamping force, kN.
    pub clamping_force: Option<f64>,
    /// The largest volume of a shot, mm3.
    pub shot_volume: Option<f64>,
    /// The source of the numbers.
    pub source: String,
}

/// A material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialPreset {
    /// `material`.
    pub kind: String,
    /// The name on the command line.
    pub name: String,
    /// The displayed name.
    pub title: String,
    /// The thickness preset with the limits of its walls.
    pub walls: Option<String>,
    /// Grams a cubic centimetre.
    pub density: f64,
    /// The effective thermal diffusivity, mm2/s.
    pub diffusivity: Option<f64>,
    /// The temperature of the melt, degrees Celsius.
    pub melt: Option<f64>,
    /// The temperature of the mould's wall, degrees Celsius.
    pub mould: Option<f64>,
    /// The temperature at which the part is ejected, degrees Celsius.
    pub eject: Option<f64>,
    /// The mean pressure in the cavity, MPa.
    pub cavity_pressure: Option<f64>,
    /// The source of the numbers.
    pub source: String,
}

/// Any preset of a check.
#[derive(Debug, Clone, PartialEq)]
pub enum CheckPreset {
    /// A process.
    Process(Box<ProcessPreset>),
    /// A machine.
    Printer(Box<PrinterPreset>),
    /// A material.
    Material(Box<MaterialPreset>),
}

/// A preset that means nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CheckPresetError {
    /// The text is not TOML, or a field is missing, unknown or of another type.
    #[error("{name}: {text}")]
    Toml {
        /// The name that the preset was read under.
        name: String,
        /// The parser's words, with the line.
        text: String,
    },
    /// A number is out of range.
    #[error("{name}: {field} is {value}: expected {expected}")]
    Range {
        /// The name that the preset was read under.
        name: String,
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The range.
        expected: &'static str,
    },
}

/// The first field of each file.
#[derive(Deserialize)]
struct Kind {
    kind: PresetKind,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum PresetKind {
    Process,
    Printer,
    Material,
}

impl CheckPreset {
    /// Reads a preset from its text; `name` (the file's, as a rule) is for the error.
    ///
    /// # Errors
    /// Returns an error if the text is no preset, or a number is not within its range.
    pub fn read(name: &str, text: &str) -> Result<CheckPreset, CheckPresetError> {
        fn parsed<T: for<'a> Deserialize<'a>>(
            name: &str,
            text: &str,
        ) -> Result<T, CheckPresetError> {
            toml::from_str(text)
                .map_err(|e| CheckPresetError::Toml { name: name.into(), text: e.to_string() })
        }
        let table: toml::Table = parsed(name, text)?;
        let kind: Kind = table
            .try_into()
            .map_err(|e| CheckPresetError::Toml { name: name.into(), text: e.to_string() })?;
        let preset = match kind.kind {
            PresetKind::Process => CheckPreset::Process(Box::new(parsed(name, text)?)),
            PresetKind::Printer => CheckPreset::Printer(Box::new(parsed(name, text)?)),
            PresetKind::Material => CheckPreset::Material(Box::new(parsed(name, text)?)),
        };
        let bad = |field, value, expected| {
            Err(CheckPresetError::Range { name: name.into(), field, value, expected })
        };
        for (field, value, range) in preset.numbers() {
            let Some(v) = value else { continue };
            let (fits, expected) = match range {
                NumberRange::Positive => (v > 0.0, "a number above 0"),
                NumberRange::NotNegative => (v >= 0.0, "a number of at least 0"),
                NumberRange::Angle => ((0.0..90.0).contains(&v), "0 to 90 degrees, 90 excluded"),
                NumberRange::Any => (true, "a number"),
            };
            if !(fits && v.is_finite()) {
                return bad(field, v, expected);
            }
        }
        if let CheckPreset::Material(m) = &preset
            && let (Some(melt), Some(mould), Some(eject)) = (m.melt, m.mould, m.eject)
            && !(mould < eject && eject < melt)
        {
            return bad("eject", eject, "mould < eject < melt");
        }
        Ok(preset)
    }

    /// The name on the command line.
    pub fn name(&self) -> &str {
        match self {
            CheckPreset::Process(p) => &p.name,
            CheckPreset::Printer(p) => &p.name,
            CheckPreset::Material(m) => &m.name,
        }
    }

    /// The source of the numbers.
    pub fn source(&self) -> &str {
        match self {
            CheckPreset::Process(p) => &p.source,
            CheckPreset::Printer(p) => &p.source,
            CheckPreset::Material(m) => &m.source,
        }
    }

    fn numbers(&self) -> Vec<(&'static str, Option<f64>, NumberRange)> {
        use NumberRange::{Angle, Any, NotNegative, Positive};
        match self {
            CheckPreset::Process(p) => vec![
                ("layer_height", p.layer_height, Positive),
                ("resolution", p.resolution, Positive),
                ("pin", p.pin, Positive),
                ("hole", p.hole, Positive),
                ("gap", p.gap, Positive),
                ("overhang", p.overhang, Angle),
                ("overhang_area", p.overhang_area, NotNegative),
                ("bridge", p.bridge, Positive),
                ("trapped", p.trapped, NotNegative),
                ("cup", p.cup, NotNegative),
                ("tip_angle", p.tip_angle, Angle),
                ("contact_area", p.contact_area, NotNegative),
                ("draft", p.draft, Angle),
                ("draft_area", p.draft_area, NotNegative),
                ("undercut", p.undercut, NotNegative),
                ("sliver", p.sliver, NotNegative),
                ("extrusion", p.extrusion, Positive),
                ("layer_seconds", p.layer_seconds, NotNegative),
            ],
            CheckPreset::Printer(p) => {
                let side = |i: usize| p.build_volume.map(|v| v[i]);
                vec![
                    ("build_volume", side(0), Positive),
                    ("build_volume", side(1), Positive),
                    ("build_volume", side(2), Positive),
                    ("resolution", p.resolution, Positive),
                    ("layer_height", p.layer_height, Positive),
                    ("clamping_force", p.clamping_force, Positive),
                    ("shot_volume", p.shot_volume, Positive),
                ]
            }
            CheckPreset::Material(m) => vec![
                ("density", Some(m.density), Positive),
                ("diffusivity", m.diffusivity, Positive),
                ("melt", m.melt, Any),
                ("mould", m.mould, Any),
                ("eject", m.eject, Any),
                ("cavity_pressure", m.cavity_pressure, Positive),
            ],
        }
    }
}

#[derive(Debug, Clone, Copy)]
enum NumberRange {
    Positive,
    NotNegative,
    Angle,
    Any,
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLA: &str =
        "kind = \"material\"\nname = \"x\"\ntitle = \"X\"\ndensity = 1.2\nsource = \"a test\"\n";

    #[test]
    fn a_preset_that_means_nothing_is_refused() {
        assert!(CheckPreset::read("x", PLA).is_ok());
        for (from, to) in [
            ("1.2", "0.0"),
            ("1.2", "nan"),
            ("density", "destiny"),
            ("\"material\"", "\"colour\""),
            ("kind", "sort"),
            ("source", "melt = 200\nmould = 90\neject = 80\nsource"),
        ] {
            assert!(CheckPreset::read("x", &PLA.replacen(from, to, 1)).is_err(), "{from} {to}");
        }
    }
}

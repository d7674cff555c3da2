//! Limits by process and material, from `config/thickness/*.toml`; each file names its source.

use serde::{Deserialize, Serialize};

/// Limits, millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// What the command line calls it.
    pub name: String,
    pub title: String,
    /// Thinner than this asks for a second look.
    pub warn_below: f32,
    /// Thinner than this fails.
    pub fail_below: f32,
    /// Thicker than this fails (sink marks, cooling time), where the process has such a limit.
    #[serde(default)]
    pub fail_above: Option<f32>,
    /// Largest sensible ratio between neighbouring walls, where the process has one.
    #[serde(default)]
    pub neighbour_ratio: Option<f32>,
    pub source: String,
}

const EMBEDDED: [(&str, &str); 8] = [
    ("fdm.toml", include_str!("../../../config/thickness/fdm.toml")),
    ("sla.toml", include_str!("../../../config/thickness/sla.toml")),
    ("sls.toml", include_str!("../../../config/thickness/sls.toml")),
    ("abs.toml", include_str!("../../../config/thickness/abs.toml")),
    ("pc.toml", include_str!("../../../config/thickness/pc.toml")),
    ("pp.toml", include_str!("../../../config/thickness/pp.toml")),
    ("pa.toml", include_str!("../../../config/thickness/pa.toml")),
    ("pom.toml", include_str!("../../../config/thickness/pom.toml")),
];

/// A preset that means nothing.
#[derive(Debug, thiserror::Error)]
pub enum BadPreset {
    #[error("{file}: {text}")]
    Toml { file: String, text: String },
    #[error("{file}: {what}")]
    Limits { file: String, what: &'static str },
    #[error("no preset is called \"{name}\"; there are {known}")]
    Unknown { name: String, known: String },
}

impl Preset {
    /// From the text of a preset file; `file` is for the error.
    pub fn parse(file: &str, text: &str) -> Result<Preset, BadPreset> {
        let p: Preset = toml::from_str(text)
            .map_err(|e| BadPreset::Toml { file: file.into(), text: e.to_string() })?;
        let bad = |what| Err(BadPreset::Limits { file: file.into(), what });
        if !(p.fail_below > 0.0 && p.fail_below <= p.warn_below && p.warn_below.is_finite()) {
            return bad("expected 0 < fail_below <= warn_below");
        }
        if p.fail_above.is_some_and(|a| !(a > p.warn_below && a.is_finite())) {
            return bad("expected fail_above > warn_below");
        }
        if p.neighbour_ratio.is_some_and(|r| !(r > 1.0 && r.is_finite())) {
            return bad("expected neighbour_ratio > 1");
        }
        Ok(p)
    }

    /// The presets that the program carries.
    pub fn embedded() -> Result<Vec<Preset>, BadPreset> {
        EMBEDDED.iter().map(|(file, text)| Preset::parse(file, text)).collect()
    }

    /// The embedded preset of this name.
    pub fn named(name: &str) -> Result<Preset, BadPreset> {
        let all = Preset::embedded()?;
        let known = all.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
        all.into_iter()
            .find(|p| p.name == name)
            .ok_or(BadPreset::Unknown { name: name.into(), known })
    }
}

#[cfg(test)]
mod tests {
    use super::Preset;

    #[test]
    fn every_embedded_preset_is_sane_and_named_once() {
        let all = Preset::embedded().expect("valid");
        let mut names: Vec<_> = all.iter().map(|p| p.name.clone()).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all.len());
        assert!(all.iter().all(|p| p.source.len() > 10));
        assert!(Preset::named("bronze").is_err());
        assert!(Preset::parse("x", "name = 1").is_err());
    }
}

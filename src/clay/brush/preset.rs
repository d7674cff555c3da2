//! What a brush begins with: `config/brushes/NAME.toml`, embedded.
//!
//! A file says in `about` what the brush does, in `[settings]` what differs from
//! [`BrushSettings::default`], and in `[[extra]]` which numbers of its own it has, each with name,
//! value, range and meaning, in the order of [`BrushSettings::extra`].

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::settings::EXTRAS;
use super::{BrushKind, BrushSettings};

/// One of a brush's own numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extra {
    pub name: String,
    pub value: f32,
    pub min: f32,
    pub max: f32,
    pub about: String,
}

/// A brush's file, read.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    about: String,
    table: toml::Table,
    settings: BrushSettings,
    extras: Vec<Extra>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    about: String,
    #[serde(default)]
    settings: toml::Table,
    #[serde(default)]
    extra: Vec<Extra>,
}

impl Preset {
    fn read(kind: BrushKind) -> Result<Preset, String> {
        let file: File = toml::from_str(kind.file()).map_err(|e| e.to_string())?;
        let mut table = file.settings;
        table.insert("kind".into(), kind.name().into());
        if file.extra.len() > EXTRAS {
            return Err(format!(
                "{} numbers of its own; a brush has at most {EXTRAS}",
                file.extra.len()
            ));
        }
        if !file.extra.is_empty() {
            let mut values = [0.0; EXTRAS];
            for (v, e) in values.iter_mut().zip(&file.extra) {
                *v = e.value;
            }
            let values = values.map(|v| toml::Value::Float(f64::from(v)));
            table.insert("extra".into(), toml::Value::Array(values.to_vec()));
        }
        let settings: BrushSettings =
            table.clone().try_into().map_err(|e| format!("settings: {e}"))?;
        Ok(Preset { about: file.about, table, settings, extras: file.extra })
    }

    /// One line on what the brush does.
    pub fn about(&self) -> &str {
        &self.about
    }

    pub fn settings(&self) -> BrushSettings {
        self.settings
    }

    /// What the file sets, `kind` and `extra` included: to be laid over the defaults and under what
    /// a person wrote.
    pub fn table(&self) -> &toml::Table {
        &self.table
    }

    pub fn extras(&self) -> &[Extra] {
        &self.extras
    }
}

impl BrushKind {
    /// What this brush begins with.
    pub fn preset(self) -> &'static Preset {
        static ALL: OnceLock<Vec<Preset>> = OnceLock::new();
        let all = ALL.get_or_init(|| {
            let read = |kind: BrushKind| {
                // A test reads every file; a build with a broken one falls back to the code's
                // defaults.
                Preset::read(kind).unwrap_or_else(|_| Preset {
                    about: String::new(),
                    table: toml::Table::new(),
                    settings: BrushSettings { kind, ..BrushSettings::default() },
                    extras: Vec::new(),
                })
            };
            BrushKind::ALL.iter().map(|k| read(*k)).collect()
        });
        &all[self as usize]
    }
}

impl BrushSettings {
    /// As the brush's own file has it.
    pub fn of(kind: BrushKind) -> BrushSettings {
        kind.preset().settings()
    }

    /// Another brush in the same hand: its own settings, at this size and with these mirrors.
    #[must_use]
    pub fn switched(&self, kind: BrushKind) -> BrushSettings {
        let new = BrushSettings::of(kind);
        BrushSettings { radius: self.radius, symmetry: self.symmetry, mirror: self.mirror, ..new }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_valid_and_says_what_its_brush_does() {
        for kind in BrushKind::ALL {
            let preset = Preset::read(*kind).unwrap_or_else(|e| panic!("{}: {e}", kind.name()));
            assert!(preset.about.len() > 20, "{}: says too little", kind.name());
            preset.settings.check().unwrap_or_else(|e| panic!("{}: {e}", kind.name()));
            assert_eq!(preset.settings.clamped(), preset.settings, "{}", kind.name());
            assert_eq!(preset.settings.kind, *kind);
            assert_eq!(kind.name().parse(), Ok(*kind));
            for e in &preset.extras {
                assert!(e.min <= e.value && e.value <= e.max && !e.about.is_empty(), "{e:?}");
            }
        }
    }
}

//! User brushes: each is a brush of the table with settings, a name and an optional height picture,
//! stored as TOML text.
//!
//! ```toml
//! kind = "texture"            # the brush that it is made of
//! about = "Bark of an oak"    # one line; may be left out
//! order = 10                  # lower comes first in lists; 0 if left out
//! picture = "oak.png"         # a file beside this one; may be left out
//! [settings]                  # as in [brush] of the configuration; the rest is the preset's
//! strength = 0.3
//! [extra]                     # the brush's own numbers, by their names
//! floor = 0.25
//! ```
//!
//! Nothing here reads or writes files: the program does, and gives the list to
//! [`super::Presets::set_own`].

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Deserialize;
use toml::de::{DeTable, DeValue};

use super::{BrushKind, BrushSettings, Picture};

/// A person's own brush.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnBrush {
    /// Its name: that of its file without the ending.
    pub name: String,
    /// One line on what it is for; may be empty.
    pub about: String,
    /// Lower comes first in lists; equal ones by name.
    pub order: i32,
    /// All its settings.
    pub settings: BrushSettings,
    /// The name of the picture's file, in the same folder.
    pub picture_file: Option<String>,
    /// The picture, once somebody has read it.
    pub picture: Option<Arc<Picture>>,
}

/// A picture of heights in the folder of a person's own brushes, for any of them to press.
#[derive(Debug, Clone, PartialEq)]
pub struct AlphaPicture {
    /// The name of its file, without the ending.
    pub name: String,
    /// The picture.
    pub picture: Arc<Picture>,
}

/// An error in the text of a brush.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {text}")]
pub struct OwnBrushError {
    /// Counted from 1.
    pub line: usize,
    /// The value found, and the value expected.
    pub text: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OwnBrushFile {
    kind: BrushKind,
    #[serde(default)]
    about: String,
    #[serde(default)]
    order: i32,
    picture: Option<String>,
    /// Read for its errors, which name lines; the values are laid over the preset's.
    #[serde(default, rename = "settings")]
    _settings: BrushSettings,
    #[serde(default)]
    extra: BTreeMap<String, f32>,
}

/// Characters of a name at most.
const LONGEST: usize = 64;

/// Checks that a brush may have this name. The name also serves as a file name and must differ from
/// every built-in brush's.
///
/// # Errors
/// Returns a message that says what is wrong with the name.
pub fn check_name(name: &str) -> Result<(), String> {
    let allowed = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | ' ');
    if name.is_empty() || name.chars().count() > LONGEST || !name.chars().all(allowed) {
        return Err(format!(
            "'{name}': expected a name of 1 to {LONGEST} letters, digits, spaces, '-' and '_'"
        ));
    }
    if name.parse::<BrushKind>().is_ok() {
        return Err(format!("'{name}': a brush of the program has this name"));
    }
    Ok(())
}

/// The number of a person's own brush of this name, for [`BrushSettings::preset`]: never 0. FNV-1a
/// (Fowler, Noll, Vo), 32 bits: two of a hundred brushes share one by a chance of one in a million,
/// and then only what the two remember.
pub fn preset_number(name: &str) -> u32 {
    let hash = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    name.bytes().fold(0x811c_9dc5, hash).max(1)
}

/// Lays `over` upon `under`, tables within tables too.
fn merge_tables(under: &mut toml::Table, over: toml::Table) {
    for (key, value) in over {
        match (under.get_mut(&key), value) {
            (Some(toml::Value::Table(under)), toml::Value::Table(over)) => {
                merge_tables(under, over)
            }
            (_, value) => drop(under.insert(key, value)),
        }
    }
}

/// The settings as a table, each number with the digits that a person would write.
fn table_of(settings: &BrushSettings) -> Result<toml::Table, String> {
    let text = toml::to_string(settings).map_err(|e| e.to_string())?;
    text.parse().map_err(|e: toml::de::Error| e.to_string())
}

/// Returns the line, from 1, that sets the last key of a path of tables, or the last key that
/// exists.
fn line_of(text: &str, path: &[&str]) -> usize {
    let Ok(whole) = DeTable::parse(text) else { return 1 };
    let (mut table, mut at) = (whole.get_ref(), 0);
    for key in path {
        let Some((set, value)) = table.iter().find(|(k, _)| k.get_ref() == key) else { break };
        at = set.span().start;
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            _ => break,
        }
    }
    text[..at].matches('\n').count() + 1
}

impl OwnBrush {
    /// Reads the text of a brush with this name. What it does not set is as `preset` has it.
    ///
    /// # Errors
    /// The line, and what is wrong there: TOML that cannot be read, a key that is not known, a
    /// value out of its range, a name that cannot be that of a brush.
    pub fn read(
        name: &str,
        source: &str,
        preset: &dyn Fn(BrushKind) -> BrushSettings,
    ) -> Result<OwnBrush, OwnBrushError> {
        let wrong = |line: usize, text: String| OwnBrushError { line, text };
        check_name(name).map_err(|e| wrong(1, e))?;
        let parse = |e: toml::de::Error| {
            let line = e.span().map_or(1, |s| source[..s.start].matches('\n').count() + 1);
            wrong(line, e.message().to_string())
        };
        let file: OwnBrushFile = toml::from_str(source).map_err(parse)?;
        let mut whole: toml::Table = source.parse().map_err(parse)?;
        let named = match whole.remove("settings") {
            Some(toml::Value::Table(named)) => named,
            _ => toml::Table::new(),
        };
        let elsewhere = ["kind", "extra", "preset"];
        if let Some(key) = elsewhere.into_iter().find(|k| named.contains_key(*k)) {
            let text = match key {
                "preset" => format!("settings.{key}: the file's name tells which brush it is"),
                _ => format!("settings.{key}: this is written outside of [settings]"),
            };
            return Err(wrong(line_of(source, &["settings", key]), text));
        }
        let base = BrushSettings { preset: preset_number(name), ..preset(file.kind) };
        let mut table = table_of(&base).map_err(|e| wrong(1, e))?;
        merge_tables(&mut table, named);
        let mut settings: BrushSettings = table.try_into().map_err(parse)?;
        settings.extra = base.extra;
        for (key, value) in &file.extra {
            let own = file.kind.own_numbers().iter().position(|n| n.name == key);
            let Some(own) = own else {
                let names: Vec<_> = file.kind.own_numbers().iter().map(|n| n.name).collect();
                let text = format!("extra.{key}: expected one of [{}]", names.join(", "));
                return Err(wrong(line_of(source, &["extra", key.as_str()]), text));
            };
            settings.extra[own] = *value;
        }
        settings.check().map_err(|e| {
            let e = e.strip_prefix("brush.").unwrap_or(&e);
            let key = e.split(" =").next().unwrap_or("");
            // `extra (scale)`, or `path.jitter`, or `curve[3]`.
            let line = match key.strip_prefix("extra (") {
                Some(own) => line_of(source, &["extra", own.trim_end_matches(')')]),
                None => {
                    let keys = key.split('[').next().unwrap_or(key).split('.');
                    line_of(source, &Vec::from_iter(["settings"].into_iter().chain(keys)))
                }
            };
            wrong(line, e.to_string())
        })?;
        if let Some(picture) = &file.picture
            && (picture.is_empty() || picture.starts_with('.') || picture.contains(['/', '\\']))
        {
            let text =
                format!("picture = '{picture}': expected the name of a file beside this one");
            return Err(wrong(line_of(source, &["picture"]), text));
        }
        Ok(OwnBrush {
            name: name.into(),
            about: file.about,
            order: file.order,
            settings,
            picture_file: file.picture,
            picture: None,
        })
    }

    /// The text of the brush: every setting, so that it stays what it is when presets change.
    ///
    /// # Errors
    /// Returns an error if a value cannot be written; none is known.
    pub fn write(&self) -> Result<String, String> {
        let mut settings = table_of(&self.settings)?;
        for key in ["kind", "extra", "preset"] {
            settings.remove(key);
        }
        let own = self.settings.kind.own_numbers();
        let extra = BTreeMap::from_iter(own.iter().map(|n| n.name).zip(self.settings.extra));
        let text = toml::to_string(&extra).map_err(|e| e.to_string())?;
        let extra: toml::Table = text.parse().map_err(|e: toml::de::Error| e.to_string())?;
        let mut whole = toml::Table::new();
        whole.insert("kind".into(), self.settings.kind.name().into());
        whole.insert("about".into(), self.about.clone().into());
        whole.insert("order".into(), i64::from(self.order).into());
        if let Some(picture) = &self.picture_file {
            whole.insert("picture".into(), picture.clone().into());
        }
        whole.insert("settings".into(), settings.into());
        if !extra.is_empty() {
            whole.insert("extra".into(), extra.into());
        }
        toml::to_string(&whole).map_err(|e| e.to_string())
    }
}

//! Limits by process and material, as TOML; each preset names its source. Which presets exist is
//! the caller's to decide: this module embeds none.

use serde::{Deserialize, Serialize};

/// Limits of wall thickness, millimetres.
///
/// ```
/// use sculptd_geometry::thickness::preset::Preset;
///
/// let text = r#"
///     name = "cast"
///     title = "Investment casting"
///     warn_below = 2.0
///     fail_below = 1.5
///     source = "the foundry's design guide, 2024, page 12"
/// "#;
/// assert_eq!(Preset::read("cast.toml", text).expect("valid").fail_below, 1.5);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// The name on the command line.
    pub name: String,
    /// The displayed name.
    pub title: String,
    /// A wall thinner than this gives a warning.
    pub warn_below: f32,
    /// A wall thinner than this fails.
    pub fail_below: f32,
    /// A wall thicker than this fails (sink marks, cooling time), where the process has such a
    /// limit.
    #[serde(default)]
    pub fail_above: Option<f32>,
    /// Largest sensible ratio between neighbouring walls, where the process has one.
    #[serde(default)]
    pub neighbour_ratio: Option<f32>,
    /// The source of the numbers.
    pub source: String,
}

/// A preset that means nothing.
#[derive(Debug, thiserror::Error)]
pub enum PresetError {
    /// The text is not TOML, or a field is missing, unknown or of another type.
    #[error("{name}: {text}")]
    Toml {
        /// The name that the preset was read under.
        name: String,
        /// The parser's words, with the line.
        text: String,
    },
    /// The limits contradict each other.
    #[error("{name}: {expected}")]
    Limits {
        /// The name that the preset was read under.
        name: String,
        /// The rule that is broken.
        expected: &'static str,
    },
    /// No preset has this name.
    #[error("no preset is called \"{name}\"; there are {known}")]
    Unknown {
        /// The name that was asked for.
        name: String,
        /// The names that exist, with commas between.
        known: String,
    },
}

impl Preset {
    /// Returns the preset with this name.
    ///
    /// # Errors
    /// Returns [`PresetError::Unknown`], which lists the names, if no preset has this name.
    pub fn named<'a>(name: &str, presets: &'a [Preset]) -> Result<&'a Preset, PresetError> {
        presets.iter().find(|p| p.name == name).ok_or_else(|| {
            let known = presets.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
            PresetError::Unknown { name: name.into(), known }
        })
    }

    /// Reads a preset from its text; `name` (the file's, as a rule) is for the error. Expects
    /// `0 < fail_below <= warn_below < fail_above` and `neighbour_ratio > 1`, all finite.
    pub fn read(name: &str, text: &str) -> Result<Preset, PresetError> {
        let p: Preset = toml::from_str(text)
            .map_err(|e| PresetError::Toml { name: name.into(), text: e.to_string() })?;
        let bad = |expected| Err(PresetError::Limits { name: name.into(), expected });
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_that_contradict_each_other_are_refused() {
        let text = |fail: f32, warn: f32| {
            format!(
                "name = \"x\"\ntitle = \"X\"\nwarn_below = {warn:?}\nfail_below = {fail:?}\n\
                 source = \"a test\"\n"
            )
        };
        assert!(Preset::read("x", &text(1.0, 2.0)).is_ok());
        assert!(matches!(
            Preset::read("x", &text(2.0, 1.0)),
            Err(PresetError::Limits { expected: "expected 0 < fail_below <= warn_below", .. })
        ));
        assert!(matches!(Preset::read("x", "name = 1"), Err(PresetError::Toml { .. })));
    }
}

//! TOML to values and back by way of one table of functions: the reader and the writer are compiled
//! once, and not for every type of the configuration.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Reads one document.
///
/// # Errors
/// Names the line and the column, and what was expected there.
pub fn from_toml<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    let reader = toml::Deserializer::parse(text).map_err(|e| e.to_string())?;
    erased_serde::deserialize(&mut <dyn erased_serde::Deserializer<'_>>::erase(reader))
        .map_err(|e| e.to_string())
}

/// Writes one document.
///
/// # Errors
/// What TOML has no form for: a list as a document, a key that is not text.
pub fn to_toml(value: &impl Serialize) -> Result<String, String> {
    toml::to_string(&value as &dyn erased_serde::Serialize).map_err(|e| e.to_string())
}

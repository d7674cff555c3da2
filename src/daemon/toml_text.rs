//! Values to TOML by way of one table of functions: the writer is compiled once, and not for every
//! type of the configuration. Reading does not go this way: its errors would lose their lines.

use serde::Serialize;

/// Writes one document.
///
/// # Errors
/// What TOML has no form for: a list as a document, a key that is not text.
pub fn to_toml(value: &impl Serialize) -> Result<String, String> {
    toml::to_string(&value as &dyn erased_serde::Serialize).map_err(|e| e.to_string())
}

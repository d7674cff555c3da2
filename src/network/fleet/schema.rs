//! Generates `schema.json` from the types, in tests alone.

use schemars::generate::SchemaSettings;
use serde_json::json;

use super::request::{FleetAnswer, FleetRequest};
use super::state::{InstallationState, SCHEMA_VERSION};

/// The text of `schema.json`, as the types are now.
///
/// # Errors
/// Never for the types of this crate; a schema that is not JSON is a bug of the generator.
pub fn generate() -> serde_json::Result<String> {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let state = generator.subschema_for::<InstallationState>();
    let request = generator.subschema_for::<FleetRequest>();
    let answer = generator.subschema_for::<FleetAnswer>();
    let schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "The fleet of sculptd: what an installation publishes, is asked and answers",
        "version": SCHEMA_VERSION,
        "state": state,
        "request": request,
        "answer": answer,
        "$defs": generator.take_definitions(true),
    });
    Ok(serde_json::to_string_pretty(&schema)? + "\n")
}

#[cfg(test)]
mod tests {
    /// With `SCULPTD_BLESS=1` the file is written instead.
    #[allow(clippy::disallowed_methods)] // The file is under version control.
    #[test]
    fn the_schema_is_the_types() {
        let now = super::generate().expect("JSON");
        if std::env::var_os("SCULPTD_BLESS").is_some() {
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fleet/schema.json");
            std::fs::write(path, &now).expect("written");
            return;
        }
        let value = |text: &str| serde_json::from_str::<serde_json::Value>(text).expect("JSON");
        assert!(
            value(&now) == value(crate::fleet::SCHEMA),
            "src/network/fleet/schema.json is not what the types say; write it with SCULPTD_BLESS=1"
        );
    }
}

//! Generates `schema.json` from the types, in tests alone.

use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use crate::event::EventNotice;
use crate::method::schemas;
use crate::status::Versions;

/// The text of `schema.json`, as the types are now.
///
/// # Errors
/// Never for the types of this crate; a schema that is not JSON is a bug of the generator.
pub fn generate() -> serde_json::Result<String> {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let methods: Map<String, Value> = schemas(&mut generator)
        .into_iter()
        .map(|(m, params, reply)| {
            (m.name.to_owned(), json!({ "about": m.about, "params": params, "reply": reply }))
        })
        .collect();
    let event = generator.subschema_for::<EventNotice>();
    let schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "The control socket of sculptd: JSON-RPC 2.0, one message a line",
        "protocol": Versions::OURS,
        "methods": methods,
        "event": event,
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
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/schema.json");
            std::fs::write(path, &now).expect("written");
            return;
        }
        // Compared as values: the order of fields depends on features of serde_json that another
        // crate of a build may turn on.
        let value = |text: &str| serde_json::from_str::<serde_json::Value>(text).expect("JSON");
        assert!(
            value(&now) == value(crate::SCHEMA),
            "src/control/schema.json is not what the types say; write it with SCULPTD_BLESS=1"
        );
    }
}

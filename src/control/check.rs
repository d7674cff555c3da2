//! Checks parameters against the ranges of the schema, before anything is made of them.
//!
//! The types define the shape of parameters; `schema.json`, which is generated from the same types,
//! defines the ranges of their numbers and the lengths of their lists. One declaration therefore
//! both publishes and checks a number.

use std::sync::LazyLock;

use serde_json::Value;

use crate::scene::PrimitiveShape;
use crate::wire::RpcError;

/// The schema of every method, its parameters and its reply, and of the events (JSON Schema
/// 2020-12; methods under `methods.NAME.params` and `.reply`).
pub const SCHEMA: &str = include_str!("schema.json");

// The file is compared with the types by a test, so it is JSON; an empty schema allows everything.
static PARSED: LazyLock<Value> = LazyLock::new(|| serde_json::from_str(SCHEMA).unwrap_or_default());

/// Refuses a number out of its range, a list or a text out of its length, by its place in the
/// parameters. A wrong type is left to whoever reads them.
pub(crate) fn check_params(method: &str, params: &Value) -> Result<(), RpcError> {
    check(&PARSED["methods"][method]["params"], params, "").map_err(RpcError::bad_params)
}

/// Why parameters are not those of a method: the reader's own words, but for a primitive, where
/// those would name what the reader is made of.
pub(crate) fn in_plain_words(params: &Value, error: &serde_json::Error) -> String {
    let named = params.get("primitive");
    match named.filter(|p| serde_json::from_value::<PrimitiveShape>((*p).clone()).is_err()) {
        Some(found) => format!(
            "primitive = {found}: expected one of {{\"box\": [x, y, z]}}, {{\"ball\": radius}}, \
             {{\"cylinder\": [radius, height]}}, {{\"cone\": [radius, height]}}, \
             {{\"torus\": [ring radius, tube radius]}}, \
             {{\"tube\": [outer radius, inner radius, height]}} and {{\"plane\": [x, z]}}"
        ),
        None => error.to_string(),
    }
}

/// Follows a reference into the definitions.
fn resolve(schema: &Value) -> &Value {
    let named = schema["$ref"].as_str().and_then(|r| r.strip_prefix("#/$defs/"));
    named.map_or(schema, |name| resolve(&PARSED["$defs"][name]))
}

fn check(schema: &Value, value: &Value, place: &str) -> Result<(), String> {
    let schema = resolve(schema);
    for branches in [&schema["anyOf"], &schema["oneOf"]] {
        let fitting = branches.as_array().into_iter().flatten().find(|s| fits(s, value));
        fitting.map_or(Ok(()), |s| check(s, value, place))?;
    }
    match value {
        Value::Number(n) => {
            let (mut min, mut max) = (schema["minimum"].as_f64(), schema["maximum"].as_f64());
            if schema["format"] == "float" {
                // Beyond it a number of single precision is infinite.
                min = min.or(Some(f64::from(f32::MIN)));
                max = max.or(Some(f64::from(f32::MAX)));
            }
            let number = n.as_f64().unwrap_or(f64::NAN);
            bounds(number, min, max).map_err(|range| format!("{place} = {n}: expected {range}"))
        }
        Value::Array(items) => {
            let (min, max) = (schema["minItems"].as_f64(), schema["maxItems"].as_f64());
            bounds(items.len() as f64, min, max).map_err(|range| {
                format!("{place} has {} items: expected {range} of them", items.len())
            })?;
            let each = &schema["items"];
            let mut places = items.iter().enumerate();
            places.try_for_each(|(i, v)| check(each, v, &format!("{place}[{i}]")))
        }
        Value::String(text) => {
            let (min, max) = (schema["minLength"].as_f64(), schema["maxLength"].as_f64());
            let length = text.chars().count();
            bounds(length as f64, min, max)
                .map_err(|range| format!("{place} has {length} characters: expected {range}"))
        }
        Value::Object(fields) => fields.iter().try_for_each(|(key, v)| {
            let place = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
            check(&schema["properties"][key], v, &place)
        }),
        Value::Null | Value::Bool(_) => Ok(()),
    }
}

/// `Err` says the range.
fn bounds(value: f64, min: Option<f64>, max: Option<f64>) -> Result<(), String> {
    let low = min.is_some_and(|least| !(value >= least));
    let high = max.is_some_and(|most| !(value <= most));
    match (low || high, min, max) {
        (false, ..) | (true, None, None) => Ok(()),
        (true, Some(min), Some(max)) => Err(format!("a number from {min} to {max}")),
        (true, Some(min), None) => Err(format!("a number from {min}")),
        (true, None, Some(max)) => Err(format!("a number up to {max}")),
    }
}

/// Returns true if a value has the shape of a branch: its type, its named constants, its fields,
/// its number of items. Ranges are ignored, so that a number out of range is reported as one.
fn fits(schema: &Value, value: &Value) -> bool {
    let schema = resolve(schema);
    if !schema["const"].is_null() && schema["const"] != *value {
        return false;
    }
    if schema["enum"].as_array().is_some_and(|all| !all.contains(value)) {
        return false;
    }
    let is = |name: &str| match value {
        Value::Null => name == "null",
        Value::Bool(_) => name == "boolean",
        Value::Number(_) => name == "number" || name == "integer",
        Value::String(_) => name == "string",
        Value::Array(_) => name == "array",
        Value::Object(_) => name == "object",
    };
    let typed = match &schema["type"] {
        Value::String(name) => is(name),
        Value::Array(names) => names.iter().filter_map(Value::as_str).any(is),
        _ => true,
    };
    let whole = match value {
        Value::Object(fields) => schema["required"]
            .as_array()
            .is_none_or(|all| all.iter().filter_map(Value::as_str).all(|k| fields.contains_key(k))),
        // Branches that are lists are distinguished by their fixed lengths.
        Value::Array(items) if schema["minItems"] == schema["maxItems"] => {
            schema["minItems"].as_u64().is_none_or(|n| n == items.len() as u64)
        }
        _ => true,
    };
    typed && whole
}

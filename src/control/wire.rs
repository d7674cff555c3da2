//! The line protocol: JSON-RPC 2.0, one message a line, single requests, no batches.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Longest request, in bytes without its line end.
pub const MAX_MESSAGE: usize = 64 << 10;
/// Deepest nesting of brackets in a request.
pub const MAX_DEPTH: usize = 16;
/// Clients that are served at the same time. A connection that has said nothing yet is not counted,
/// and [`crate::method::ALWAYS_ANSWERED`] need no place.
pub const MAX_CLIENTS: usize = 32;
/// Requests a second and client. More are answered with [`Code::TooManyRequests`].
pub const MAX_RATE: u32 = 200;
/// Seconds after which a client that sends nothing is disconnected, unless it is subscribed to
/// events.
pub const IDLE_SECONDS: u64 = 60;
/// Longest reply that the client of this crate reads, in bytes.
pub const MAX_REPLY: u64 = 256 << 20;

/// One request as sent on the line, its parameters not yet read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Envelope {
    /// Always `"2.0"`.
    pub jsonrpc: String,
    /// A number or a string. A request without one is a notification and gets no answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<Value>,
    /// The name of the method, as in [`crate::Method::NAME`].
    pub method: String,
    /// The parameters, an object. Absent and `null` mean an empty object.
    #[serde(default)]
    pub params: Value,
}

impl Envelope {
    /// A request with an id.
    pub fn new(id: u64, method: &str, params: Value) -> Self {
        Envelope { jsonrpc: "2.0".into(), id: Some(id.into()), method: method.into(), params }
    }
}

/// The answer to a request: a result or an error, never both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Always `"2.0"`.
    pub jsonrpc: String,
    /// The id of the request; `null` where the line could not be read as one.
    pub id: Value,
    /// The reply of the method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub result: Option<Value>,
    /// Why there is no reply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<RpcError>,
    /// The tick of the request's effect, where it had one: every state from that tick on shows it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tick: Option<u64>,
}

impl Response {
    /// The answer to the request `id`.
    pub fn new(id: Value, result: Result<Value, RpcError>) -> Self {
        let (result, error) = match result {
            Ok(v) => (Some(v), None),
            Err(e) => (None, Some(e)),
        };
        Response { jsonrpc: "2.0".into(), id, result, error, tick: None }
    }

    /// The same, with the tick of the request's effect.
    pub fn with_effect(self, tick: Option<u64>) -> Self {
        Response { tick, ..self }
    }
}

/// Why a request was refused.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{message} ({code})")]
pub struct RpcError {
    /// One of [`Code`].
    pub code: i32,
    /// One sentence for a person: the field, the value and what was expected, where one is wrong.
    pub message: String,
}

impl RpcError {
    /// An error with this code.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        RpcError { code: code as i32, message: message.into() }
    }

    /// The parameters are wrong.
    pub fn bad_params(message: impl Into<String>) -> Self {
        RpcError::new(Code::BadParams, message)
    }

    /// The request was understood and could not be carried out.
    pub fn failed(message: impl Into<String>) -> Self {
        RpcError::new(Code::Failed, message)
    }
}

/// The codes of errors: those of JSON-RPC 2.0, and our own from -32000 down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Code {
    /// The line is not JSON, or not a request.
    Parse = -32700,
    /// The request breaks a rule of the protocol: version, id, size or nesting.
    Invalid = -32600,
    /// No method has this name.
    NoMethod = -32601,
    /// A parameter is missing, unknown, of another type, or out of its range.
    BadParams = -32602,
    /// The request could not be carried out.
    Failed = -32000,
    /// More than [`MAX_RATE`] requests in one second.
    TooManyRequests = -32001,
    /// The client and the daemon speak no version in common.
    Version = -32002,
}

/// Reads one line. Its size and nesting are checked before any of it is built in memory.
///
/// # Errors
/// [`Code::Invalid`] or [`Code::Parse`], with the reason.
///
/// ```
/// let line = br#"{"jsonrpc":"2.0","id":1,"method":"status"}"#;
/// assert_eq!(sculptd_control::wire::parse(line)?.method, "status");
/// # Ok::<(), sculptd_control::RpcError>(())
/// ```
pub fn parse(line: &[u8]) -> Result<Envelope, RpcError> {
    let invalid = |text: String| Err(RpcError::new(Code::Invalid, text));
    if line.len() > MAX_MESSAGE {
        return invalid(format!("a message may have {MAX_MESSAGE} bytes"));
    }
    if depth(line) > MAX_DEPTH {
        return invalid(format!("a message may nest {MAX_DEPTH} deep"));
    }
    let request: Envelope = serde_json::from_slice(line)
        .map_err(|e| RpcError::new(Code::Parse, format!("not a request: {e}")))?;
    if request.jsonrpc != "2.0" {
        return invalid("expected \"jsonrpc\": \"2.0\"".into());
    }
    match request.id {
        None | Some(Value::String(_) | Value::Number(_)) => Ok(request),
        Some(_) => invalid("an id is a number or a string".into()),
    }
}

/// The deepest bracket outside strings.
fn depth(line: &[u8]) -> usize {
    let (mut now, mut deepest, mut text, mut escaped) = (0usize, 0, false, false);
    for &b in line {
        match (text, b) {
            (true, _) if escaped => escaped = false,
            (true, b'\\') => escaped = true,
            (_, b'"') => text = !text,
            (false, b'{' | b'[') => {
                now += 1;
                deepest = deepest.max(now);
            }
            (false, b'}' | b']') => now = now.saturating_sub(1),
            _ => {}
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_counts_brackets_outside_strings_only() {
        assert_eq!(depth(br#"{"a":["[[[[","\"[["]}"#), 2);
        assert_eq!(depth(b"[[[]"), 3);
    }

    #[test]
    fn a_line_that_is_not_a_request_is_refused_with_its_code() {
        let code = |line: &str| parse(line.as_bytes()).expect_err("refused").code;
        assert_eq!(code("hello"), Code::Parse as i32);
        assert_eq!(code(r#"{"jsonrpc":"1.0","id":1,"method":"status"}"#), Code::Invalid as i32);
        assert_eq!(code(r#"{"jsonrpc":"2.0","id":[1],"method":"status"}"#), Code::Invalid as i32);
        assert_eq!(code(&"[".repeat(100)), Code::Invalid as i32);
        assert_eq!(code(&format!("\"{}\"", "x".repeat(MAX_MESSAGE))), Code::Invalid as i32);
        assert!(parse(br#"{"jsonrpc":"2.0","id":1,"method":"status"}"#).is_ok());
    }
}

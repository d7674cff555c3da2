//! JSON-RPC 2.0 as far as the socket speaks it: single requests with an id, no batches.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{MAX_DEPTH, MAX_MESSAGE};

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    pub jsonrpc: String,
    /// A number or a string; a request without one is a notification and gets no answer.
    pub id: Option<Value>,
    pub method: String,
    #[serde(default)]
    pub params: Value,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Response {
    pub jsonrpc: String,
    pub id: Value,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub result: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<RpcError>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RpcError {
    pub code: i32,
    pub message: String,
}

/// The codes of JSON-RPC 2.0, and ours from -32000 down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Code {
    Parse = -32700,
    Invalid = -32600,
    NoMethod = -32601,
    BadParams = -32602,
    /// The work asked for could not be done.
    Failed = -32000,
    /// Too many requests.
    Slow = -32001,
    /// The client speaks another version.
    Version = -32002,
}

impl RpcError {
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        RpcError { code: code as i32, message: message.into() }
    }
}

impl Response {
    pub fn of(id: Value, result: Result<Value, RpcError>) -> Self {
        let (result, error) = match result {
            Ok(v) => (Some(v), None),
            Err(e) => (None, Some(e)),
        };
        Response { jsonrpc: "2.0".into(), id, result, error }
    }
}

/// Reads one line. Size and nesting are looked at before any of it is built in memory.
pub fn parse(line: &[u8]) -> Result<Request, RpcError> {
    if line.len() > MAX_MESSAGE {
        return Err(RpcError::new(
            Code::Invalid,
            format!("a message may have {MAX_MESSAGE} bytes"),
        ));
    }
    if depth(line) > MAX_DEPTH {
        return Err(RpcError::new(Code::Invalid, format!("a message may nest {MAX_DEPTH} deep")));
    }
    let request: Request = serde_json::from_slice(line)
        .map_err(|e| RpcError::new(Code::Parse, format!("not a request: {e}")))?;
    if request.jsonrpc != "2.0" {
        return Err(RpcError::new(Code::Invalid, "expected \"jsonrpc\": \"2.0\""));
    }
    match request.id {
        None | Some(Value::String(_) | Value::Number(_)) => Ok(request),
        Some(_) => Err(RpcError::new(Code::Invalid, "an id is a number or a string")),
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
    fn what_is_no_request_is_named_so() {
        let code = |line: &str| parse(line.as_bytes()).expect_err("refused").code;
        assert_eq!(code("hello"), Code::Parse as i32);
        assert_eq!(code(r#"{"jsonrpc":"1.0","id":1,"method":"status"}"#), Code::Invalid as i32);
        assert_eq!(code(r#"{"jsonrpc":"2.0","id":[1],"method":"status"}"#), Code::Invalid as i32);
        assert_eq!(code(&"[".repeat(100)), Code::Invalid as i32);
        assert_eq!(code(&format!("\"{}\"", "x".repeat(MAX_MESSAGE))), Code::Invalid as i32);
        assert!(parse(br#"{"jsonrpc":"2.0","id":1,"method":"status"}"#).is_ok());
    }
}

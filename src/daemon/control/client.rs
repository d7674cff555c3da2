//! The other end, for `sculptd ctl` and for tests.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Value, json};

use super::protocol::Response;

#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    #[error("no daemon is running (nothing listens on {path}); start one with `sculptd run`")]
    Absent { path: PathBuf },
    #[error("{path}: the daemon did not answer: {source}")]
    Silent { path: PathBuf, source: std::io::Error },
    #[error("the daemon refused: {0}")]
    Refused(String),
    #[error("the daemon's answer makes no sense: {0}")]
    Nonsense(String),
}

/// Asks once. `patience` bounds each read.
pub fn call(
    path: &Path,
    method: &str,
    params: &Value,
    patience: Duration,
) -> Result<Value, ClientError> {
    let stream =
        UnixStream::connect(path).map_err(|_| ClientError::Absent { path: path.into() })?;
    let silent = |source| ClientError::Silent { path: path.into(), source };
    stream.set_read_timeout(Some(patience)).map_err(silent)?;
    let mut line =
        json!({ "jsonrpc": "2.0", "id": 1, "method": method, "params": params }).to_string();
    line.push('\n');
    // A daemon that refuses at once has answered and closed before it was asked: its answer is
    // worth reading.
    let asked = (&stream).write_all(line.as_bytes());
    let mut reply = String::new();
    BufReader::new(&stream).read_line(&mut reply).map_err(silent)?;
    if reply.is_empty() {
        asked.map_err(silent)?;
    }
    let response: Response = serde_json::from_str(&reply)
        .map_err(|e| ClientError::Nonsense(format!("{e}: {}", reply.trim())))?;
    match (response.result, response.error) {
        (Some(value), None) => Ok(value),
        (_, Some(e)) => Err(ClientError::Refused(format!("{} ({})", e.message, e.code))),
        (None, None) => Err(ClientError::Nonsense("neither a result nor an error".into())),
    }
}

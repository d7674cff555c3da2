//! `sculptd ctl`: one request to the running daemon.

use std::path::PathBuf;
use std::time::Duration;

use serde_json::Value;

use super::config::plain_numbers;
use super::{Fail, Outcome, answer};
use sculptd_control::client::{ClientError, call, default_path};

#[derive(Debug, clap::Args)]
pub struct CtlArgs {
    /// The method to call; `methods` lists all.
    pub method: String,
    /// Parameters, a JSON object.
    pub params: Option<String>,
    /// The daemon's socket, if it is not at its usual place.
    #[arg(long, value_name = "PATH")]
    pub socket: Option<PathBuf>,
}

/// Longest wait for an answer: a large file takes its time to load.
const PATIENCE: Duration = Duration::from_secs(120);

pub fn run(args: &CtlArgs, json: bool) -> Outcome {
    let params: Value = match args.params.as_deref() {
        None => Value::Null,
        Some(text) => serde_json::from_str(text)
            .map_err(|e| Fail::Usage(format!("the parameters are not JSON: {e}")))?,
    };
    let path = args.socket.clone().unwrap_or_else(default_path);
    let value = call(&path, &args.method, &params, PATIENCE).map_err(|e| match e {
        ClientError::Absent { .. } => Fail::Device(e.to_string()),
        ClientError::Refused(_) => Fail::Check(e.to_string()),
        e => Fail::Input(e.to_string()),
    })?;
    let mut shown = value.clone();
    plain_numbers(&mut shown);
    answer(json, &value, |out| match &shown {
        Value::Object(fields) => {
            for (key, value) in fields {
                let shown = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                writeln!(out, "{key:<16} {shown}")?;
            }
            Ok(())
        }
        other => writeln!(out, "{other}"),
    });
    Ok(())
}

//! `sculptd window`: opens a window of the running daemon on this screen, if it has none or has
//! lost it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Value, json};

use super::display;
use super::{Fail, Outcome, answer};
use sculptd_control::client::{ClientError, call, default_path};
use sculptd_daemon::window_link::DisplayVariables;

/// Longest wait for one answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// Interval and number of polls for the window: a large session takes time to open.
const ASK: Duration = Duration::from_millis(100);
const ASKED: usize = 1200;

fn status() -> Option<Value> {
    call(&default_path(), "status", &Value::Null, PATIENCE).ok()
}

/// Returns the session of a running daemon that has lost its window.
pub fn lost() -> Option<PathBuf> {
    let status = status()?;
    let session = status["session"].as_str().map(PathBuf::from)?;
    (status["window"] == "lost").then_some(session)
}

/// The screen of this process, as the parameters of `window`.
fn screen() -> Value {
    let variable = |name: &str| std::env::var(name).ok().filter(|v| !v.is_empty());
    // The compositor's socket may be in a folder that is not the daemon's `XDG_RUNTIME_DIR`.
    let wayland = variable("WAYLAND_DISPLAY").map(|name| {
        let folder = variable("XDG_RUNTIME_DIR").unwrap_or_default();
        Path::new(&folder).join(name).display().to_string()
    });
    json!({
        "display": variable("DISPLAY"),
        "wayland_display": wayland,
        "xauthority": variable("XAUTHORITY"),
    })
}

/// Asks the running daemon for a window here, and waits until it is shown.
pub fn run(json: bool) -> Outcome {
    display::available().map_err(Fail::Device)?;
    let reply = call(&default_path(), "window", &screen(), PATIENCE).map_err(|e| match e {
        ClientError::Absent { .. } => Fail::Device(e.to_string()),
        ClientError::Refused(_) => Fail::Check(e.to_string()),
        e => Fail::Input(e.to_string()),
    })?;
    let quiet = crossbeam_channel::never::<()>();
    // Until the daemon has restarted, it still reports the window as lost.
    for _ in 0..ASKED {
        let _ = quiet.recv_timeout(ASK);
        match status().and_then(|s| s["window"].as_str().map(str::to_owned)).as_deref() {
            Some("open") => {
                let session = reply["session"].as_str().unwrap_or_default();
                answer(json, &reply, |out| writeln!(out, "the window shows {session}"));
                return Ok(());
            }
            Some("headless") => {
                let text = "the daemon could not open a window on this screen; its log says why";
                return Err(Fail::Device(text.into()));
            }
            _ => {}
        }
    }
    Err(Fail::Device("the daemon has not shown its window within two minutes".into()))
}

/// Continues a session in a window on another screen. It restarts the process, because a process
/// can create only one window.
#[cfg(unix)]
pub fn go_on(session: &Path, screen: &DisplayVariables, arguments: &[OsString]) -> Outcome {
    use std::os::unix::process::CommandExt;
    let program = std::env::current_exe().map_err(|e| Fail::io(session, &e))?;
    let mut next = std::process::Command::new(&program);
    next.args(arguments);
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "XAUTHORITY"] {
        match screen.get(name) {
            Some(value) => next.env(name, value),
            None => next.env_remove(name),
        };
    }
    Err(Fail::io(&program, &next.exec()))
}

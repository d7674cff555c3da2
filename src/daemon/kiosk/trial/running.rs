//! The program of an installation, as a trial sees it: its process, its environment, its answers.

use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

use super::{TrialEnd, TrialSettings};
use crate::control::client::call;
use sculptd_devices::Clock;

/// Longest wait for one answer.
const ANSWER: Duration = Duration::from_secs(10);
/// Time in which clay that has not moved rests, ms. A film of the attract loop moves it sooner.
const REST_MS: u64 = 700;

pub(super) struct Running<'a> {
    pub settings: &'a TrialSettings<'a>,
    pub clock: &'a Clock,
    pub pid: i32,
    socket: PathBuf,
}

impl<'a> Running<'a> {
    /// Finds the program that listens in the runtime folder, and waits until it answers.
    pub fn find(settings: &'a TrialSettings, clock: &'a Clock) -> Result<Running<'a>, TrialEnd> {
        let socket = settings.runtime.join("sculptd.sock");
        let mut running = Running { settings, clock, pid: 0, socket };
        let found = running.within(|r| {
            r.pid = r.listener()?;
            r.status()
        });
        match found {
            Some(_) => Ok(running),
            None => Err(TrialEnd::Failed(format!(
                "no installation answers at {}",
                running.socket.display()
            ))),
        }
    }

    /// Waits until `so` returns a value; `None` after the settings' patience.
    pub fn within<T>(&mut self, mut so: impl FnMut(&mut Self) -> Option<T>) -> Option<T> {
        let until = self.clock.now_us() + self.settings.patience.as_micros() as u64;
        loop {
            if let Some(found) = so(self) {
                return Some(found);
            }
            if self.clock.now_us() >= until {
                return None;
            }
            pause(50);
        }
    }

    /// The process that listens on the socket, as the kernel names it.
    pub fn listener(&self) -> Option<i32> {
        let stream = UnixStream::connect(&self.socket).ok()?;
        let peer = rustix::net::sockopt::socket_peercred(&stream).ok()?;
        Some(peer.pid.as_raw_nonzero().get())
    }

    pub fn ask(&self, method: &str, params: &Value) -> Option<Value> {
        call(&self.socket, method, params, ANSWER).ok()
    }

    pub fn status(&self) -> Option<Value> {
        self.ask("status", &Value::Null)
    }

    pub fn hash(&self) -> Option<String> {
        self.ask("hash", &Value::Null)?["hash"].as_str().map(str::to_owned)
    }

    /// The fault of the visit's file that the program reports.
    pub fn fault(&self) -> Option<String> {
        self.status()?["journal"]["fault"].as_str().map(str::to_owned)
    }

    /// Sculpts as a visitor and waits until the clay rests. Returns its hash.
    pub fn sculpt(&mut self) -> Result<String, TrialEnd> {
        let before = self.hash();
        let points = [[0.45, 0.5, 0.8, 0.0], [0.55, 0.5, 0.8, 150.0]];
        let moved = self.within(|r| {
            r.ask("stroke", &json!({ "points": points, "space": "view" }))?;
            pause(200);
            (r.hash() != before).then_some(())
        });
        let rests = |r: &mut Self| {
            let before = r.hash()?;
            pause(REST_MS);
            (r.hash().as_ref() == Some(&before)).then_some(before)
        };
        let hash = moved.and_then(|()| self.within(rests));
        hash.ok_or_else(|| TrialEnd::Failed("a stroke did not sculpt".into()))
    }

    /// A variable of the program's environment.
    pub fn variable(&self, name: &str) -> Option<String> {
        let all = std::fs::read(format!("/proc/{}/environ", self.pid)).ok()?;
        let mut all = all.split(|b| *b == 0).map(String::from_utf8_lossy);
        let begin = format!("{name}=");
        let value = all.find_map(|v| v.strip_prefix(&begin).map(str::to_owned))?;
        Some(value).filter(|value| !value.is_empty())
    }

    /// The folder of the file of the visit in progress.
    pub fn visits(&self) -> Option<PathBuf> {
        let data = self.variable("XDG_DATA_HOME").map(PathBuf::from);
        let home = || Some(Path::new(&self.variable("HOME")?).join(".local/share"));
        Some(data.or_else(home)?.join("sculptd/kiosk"))
    }
}

/// Kills a process as a fault does: it can do nothing any more.
pub(super) fn kill(pid: i32) -> Result<(), TrialEnd> {
    let process = Pid::from_raw(pid).ok_or_else(|| TrialEnd::NotTried("no process".into()))?;
    kill_process(process, Signal::KILL)
        .map_err(|e| TrialEnd::NotTried(format!("process {pid} cannot be killed: {e}")))
}

/// Waits without looking.
pub(super) fn pause(ms: u64) {
    let _ = crossbeam_channel::never::<()>().recv_timeout(Duration::from_millis(ms));
}

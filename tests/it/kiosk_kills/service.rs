//! An installation as `sculptd kiosk install` runs it: the command of its service, started again
//! whenever it does not end with 0, as systemd does for `Restart=on-failure`.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};
use sculptd_control::client::call;
use serde_json::{Value, json};

use crate::waiting::{comes, pause, until};

/// Returns the command of the installed service, with other settings and without metrics.
pub fn command_of_the_service(settings: &Path) -> Vec<String> {
    let service = include_str!("../../../src/daemon/kiosk/setup/files/sculptd-kiosk.service");
    let line = service.lines().find_map(|line| line.strip_prefix("ExecStart=sculptd "));
    let line = line.expect("a command").split(" --metrics").next().unwrap_or_default();
    let settings = settings.display().to_string();
    line.replace("/etc/sculptd/kiosk.toml", &settings).split(' ').map(str::to_owned).collect()
}

/// An installation below a loop that does what systemd does for `Restart=on-failure`.
pub struct ServedInstallation {
    home: PathBuf,
    service: Child,
}

impl ServedInstallation {
    /// `lines`: settings beside the gallery and the audit file.
    #[allow(clippy::disallowed_methods)] // Files of a test.
    pub fn begin(home: &Path, lines: &str) -> ServedInstallation {
        let settings = home.join("kiosk.toml");
        let text = format!(
            "gallery = {:?}\naudit = {:?}\n{lines}\n",
            home.join("works"),
            home.join("visits.log")
        );
        std::fs::write(&settings, text).expect("written");
        let log = std::fs::OpenOptions::new().create(true).append(true).open(home.join("log"));
        let mut command = Command::new("sh");
        command
            .args(["-c", "until \"$0\" \"$@\"; do sleep 0.05; done"])
            .arg(env!("CARGO_BIN_EXE_sculptd"))
            .args(command_of_the_service(&settings))
            .arg("--headless")
            .env_remove("DISPLAY")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(log.expect("a file"));
        for name in ["XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_STATE_HOME", "HOME"] {
            command.env(name, home);
        }
        command.env("XDG_DATA_HOME", home.join("data"));
        let service = command.spawn().expect("a shell");
        let begun = ServedInstallation { home: home.into(), service };
        until("it answers", || begun.ask("status", &Value::Null).is_some());
        begun
    }

    pub fn ask(&self, method: &str, params: &Value) -> Option<Value> {
        call(&self.home.join("sculptd.sock"), method, params, Duration::from_secs(10)).ok()
    }

    pub fn hash(&self) -> Option<String> {
        self.ask("hash", &Value::Null)?["hash"].as_str().map(str::to_owned)
    }

    pub fn figure(&self, name: &str) -> u64 {
        self.ask("status", &Value::Null).and_then(|s| s[name].as_u64()).unwrap_or(0)
    }

    /// Times that the log has this text, over all its processes.
    pub fn times(&self, text: &str) -> usize {
        std::fs::read_to_string(self.home.join("log")).unwrap_or_default().matches(text).count()
    }

    pub fn visit_file(&self) -> PathBuf {
        self.home.join("data/sculptd/kiosk/visit.sculpt")
    }

    /// Makes a stroke. Returns true once it is made; false if it was refused, or takes longer than
    /// an answer may.
    pub fn stroke(&self, row: f64) -> bool {
        let points = [[0.4, row, 0.8, 0.0], [0.5, row, 0.8, 60.0], [0.6, row, 0.8, 120.0]];
        self.ask("stroke", &json!({ "points": points, "space": "view" })).is_some()
    }

    /// The hash of clay that rests.
    pub fn rested(&self) -> Option<String> {
        let mut found = None;
        comes(|| {
            let before = self.hash();
            pause(250);
            found = self.hash();
            before.is_some() && found == before
        });
        found
    }

    /// Kills the program; the service starts another one. Returns its process.
    pub fn kill(&self, then: impl FnOnce()) {
        let pid = self.pid().expect("it runs");
        // The loop must not start the next one before the cut is done.
        let service = Pid::from_child(&self.service);
        kill_process(service, Signal::STOP).expect("it runs");
        kill_process(pid, Signal::KILL).expect("it runs");
        until("it has ended", || !is_running(pid));
        then();
        kill_process(service, Signal::CONT).expect("it runs");
        until("another process answers", || self.pid().is_some_and(|now| now != pid));
        until("it answers", || self.hash().is_some());
    }

    /// Nothing is started again from now on.
    pub fn stop_restarting(&self) {
        kill_process(Pid::from_child(&self.service), Signal::STOP).expect("it runs");
    }

    fn pid(&self) -> Option<Pid> {
        let stream =
            std::os::unix::net::UnixStream::connect(self.home.join("sculptd.sock")).ok()?;
        Some(rustix::net::sockopt::socket_peercred(&stream).ok()?.pid)
    }
}

/// A killed process whose parent waits for nobody is a zombie.
fn is_running(pid: Pid) -> bool {
    let state = std::fs::read_to_string(format!("/proc/{}/stat", pid.as_raw_nonzero()));
    state.is_ok_and(|text| !text.rsplit(')').next().is_some_and(|t| t.starts_with(" Z")))
}

impl Drop for ServedInstallation {
    fn drop(&mut self) {
        let _ = self.service.kill();
        let _ = self.service.wait();
        if let Some(pid) = self.pid() {
            let _ = kill_process(pid, Signal::KILL);
        }
    }
}

//! Daemons as processes of their own, for tests over a network and of kills.

use std::io::{BufRead, BufReader};
#[cfg(feature = "network")]
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};

use serde_json::Value;

/// A daemon in a separate home folder. It is killed when dropped.
pub struct Daemon {
    pub child: Child,
    pub home: tempfile::TempDir,
    pub told: Arc<Mutex<Vec<String>>>,
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Daemon {
    /// `sculptd run --headless` with more arguments.
    #[cfg(feature = "network")]
    pub fn run(args: &[&str]) -> Daemon {
        Daemon::run_in(tempfile::tempdir().expect("a folder"), args)
    }

    /// The same, in an existing home folder.
    pub fn run_in(home: tempfile::TempDir, args: &[&str]) -> Daemon {
        Daemon::of_command(home, &[&["run", "--headless"], args].concat())
    }

    /// Another command that sculpts, without a screen.
    pub fn of_command(home: tempfile::TempDir, args: &[&str]) -> Daemon {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
        command.args(args);
        Daemon::of(home, command)
    }

    /// The daemon that a command starts, by itself or through another program.
    pub fn of(home: tempfile::TempDir, mut command: Command) -> Daemon {
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        for name in ["XDG_RUNTIME_DIR", "XDG_DATA_HOME", "XDG_STATE_HOME", "HOME"] {
            command.env(name, home.path());
        }
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("runs");
        let lines = BufReader::new(child.stderr.take().expect("piped"));
        let told = Arc::new(Mutex::new(Vec::new()));
        let all = told.clone();
        std::thread::spawn(move || {
            for line in lines.lines().map_while(Result::ok) {
                all.lock().expect("no panic").push(line);
            }
        });
        Daemon { child, home, told }
    }

    /// Returns true if a line of its log contains this text.
    pub fn has_told(&self, what: &str) -> bool {
        self.told.lock().expect("no panic").iter().any(|l| l.contains(what))
    }

    /// Sends it a request; `None`: it was refused, or not answered.
    pub fn ctl(&self, method: &str, params: Option<&str>) -> Option<Value> {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
        command.args(["--json", "ctl", method]).args(params);
        let out = command.env("XDG_RUNTIME_DIR", self.home.path()).output().expect("runs");
        serde_json::from_slice(&out.stdout).ok()
    }
}

/// An endpoint on the loopback that nobody listens at.
#[cfg(feature = "network")]
pub fn free_endpoint() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    format!("tcp/{}", listener.local_addr().expect("bound"))
}

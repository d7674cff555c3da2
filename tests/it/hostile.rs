//! What the tests against hostile input share: a running daemon, what it holds, waiting.

use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use crate::waiting::{PATIENCE, until};
use sculptd_devices::Clock;

/// As many descriptors as the system gives to this process.
pub fn more_descriptors() {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let now = getrlimit(Resource::Nofile);
    let most = now.maximum.unwrap_or(1 << 16);
    let _ = setrlimit(Resource::Nofile, Rlimit { current: Some(most), maximum: now.maximum });
}

/// Descriptors that a process has open.
pub fn descriptors(id: u32) -> usize {
    std::fs::read_dir(format!("/proc/{id}/fd")).expect("it runs").count()
}

fn status_kib(id: u32, field: &str) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{id}/status")).expect("it runs");
    let line = text.lines().find(|l| l.starts_with(field)).expect("the field");
    line.split_whitespace().nth(1).and_then(|n| n.parse().ok()).expect("a number")
}

/// Memory that a process holds now, KiB.
pub fn memory_kib(id: u32) -> u64 {
    status_kib(id, "VmRSS:")
}

/// The most memory that a process has held, KiB.
pub fn most_memory_kib(id: u32) -> u64 {
    status_kib(id, "VmHWM:")
}

/// Processor time that the threads of this name of a process have used, seconds.
pub fn thread_seconds(id: u32, name: &str) -> f64 {
    let tasks = std::fs::read_dir(format!("/proc/{id}/task")).expect("it runs");
    let ticks: u64 = tasks
        .filter_map(|t| std::fs::read_to_string(t.ok()?.path().join("stat")).ok())
        .filter(|stat| stat.contains(&format!("({name})")))
        // Fields 14 and 15 of proc_pid_stat(5); the name before them may hold spaces.
        .filter_map(|stat| {
            let rest: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
            Some(rest[11].parse::<u64>().ok()? + rest[12].parse::<u64>().ok()?)
        })
        .sum();
    // USER_HZ is 100 on every machine that this runs on.
    ticks as f64 / 100.0
}

/// A running daemon with separate folders; killed when dropped.
pub struct Daemon {
    child: Child,
    folder: tempfile::TempDir,
    figures: Option<SocketAddr>,
}

impl Daemon {
    /// Starts the program with these arguments and settings, and waits until its control socket
    /// exists (and its metrics, if they were requested).
    pub fn start(arguments: &[&str], settings: &str) -> Daemon {
        Daemon::start_in(arguments, settings, &[])
    }

    /// The same, with these variables in its environment.
    pub fn start_in(arguments: &[&str], settings: &str, vars: &[(&str, &str)]) -> Daemon {
        let folder = tempfile::tempdir().expect("a folder");
        let config = folder.path().join("settings.toml");
        let text = format!("[loop]\nworkers = 1\n{settings}");
        let text =
            if text.contains("[devices]") { text } else { text + "\n[devices]\nhid = false\n" };
        #[allow(clippy::disallowed_methods)] // Nothing is lost if a test's settings are torn.
        std::fs::write(&config, text).expect("written");
        let mut child = Command::new(env!("CARGO_BIN_EXE_sculptd"))
            .args(arguments)
            .arg("--config")
            .arg(&config)
            .env("XDG_RUNTIME_DIR", folder.path())
            .env("XDG_STATE_HOME", folder.path().join("state"))
            .env_remove("NOTIFY_SOCKET")
            .env_remove("SCULPTD_LOG")
            .envs(vars.iter().copied())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("starts");
        let lines = BufReader::new(child.stderr.take().expect("piped"));
        let (tell, said) = crossbeam_channel::unbounded();
        std::thread::spawn(move || {
            lines.lines().map_while(Result::ok).for_each(|l| drop(tell.send(l)));
        });
        let mut daemon = Daemon { child, folder, figures: None };
        if arguments.contains(&"--metrics") {
            let line = std::iter::from_fn(|| said.recv_timeout(PATIENCE).ok())
                .find(|l| l.contains("figures at"))
                .expect("it says where its figures are");
            let at = line.split("http://").nth(1).and_then(|a| a.split('/').next());
            daemon.figures = Some(at.and_then(|a| a.parse().ok()).expect("an address"));
        }
        // The file is there a moment before anybody listens.
        until("the control socket answers", || UnixStream::connect(daemon.socket()).is_ok());
        daemon
    }

    pub fn id(&self) -> u32 {
        self.child.id()
    }

    pub fn socket(&self) -> PathBuf {
        self.folder.path().join("sculptd.sock")
    }

    pub fn figures_at(&self) -> SocketAddr {
        self.figures.expect("it was told to show its figures")
    }

    /// Sends a signal by its name.
    pub fn signal(&self, name: &str) {
        let id = self.id().to_string();
        let sent = Command::new("kill").args([&format!("-{name}"), &id]).status();
        assert!(sent.is_ok_and(|s| s.success()), "{name}");
    }

    /// Returns true if it is still running.
    pub fn runs(&mut self) -> bool {
        self.child.try_wait().expect("a child").is_none()
    }

    /// SIGTERM, and the seconds until it has ended.
    pub fn end(&mut self) -> f64 {
        let clock = Clock::monotonic();
        self.signal("TERM");
        until("it ends", || !self.runs());
        clock.now_us() as f64 * 1e-6
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

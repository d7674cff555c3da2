//! kill -9 at random moments: the session reopens with all input acknowledged 250 ms before, and
//! replaying it gives the daemon's clay at that tick.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::waiting::{PATIENCE, pause};
use sculptd_daemon::control::client::call;
use sculptd_devices::{Clock, serial, sim};
use serde_json::Value;

struct Daemon {
    child: Child,
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn sculptd() -> Command {
    Command::new(env!("CARGO_BIN_EXE_sculptd"))
}

fn replay(session: &Path, until: Option<u64>) -> Value {
    let mut command = sculptd();
    command.arg("replay").arg(session).arg("--json");
    if let Some(tick) = until {
        command.args(["--until", &tick.to_string()]);
    }
    let out = command.output().expect("replay runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).expect("one JSON object")
}

/// One daemon with a simulated pen on a pseudo-terminal, killed after `ms`. Returns the ticks that
/// it knew and lost.
fn one_kill(ms: u64) -> u64 {
    let dir = tempfile::tempdir().expect("a folder");
    let journal = sim::journal();
    let config = sim::SerialPenConfig {
        repeat_us: Some(journal.duration_us),
        ..sim::SerialPenConfig::new(serial::Protocol::Isdv4, journal.area_mm)
    };
    // The pen's own journal, played by the serial pen: from the first second it is on the clay.
    let pen = sim::SerialPen::new(journal.pen, config).expect("a pseudo-terminal");
    let playing = pen.play(Clock::monotonic()).expect("a thread");
    let toml = dir.path().join("my.toml");
    let settings = format!("[devices]\nhid = false\nserial = [\"{}\"]\n", playing.port);
    #[allow(clippy::disallowed_methods)]
    std::fs::write(&toml, settings).expect("written");
    let session = dir.path().join("s.sculpt");
    let socket = dir.path().join("sculptd.sock");
    let mut daemon = Daemon {
        child: sculptd()
            .args(["run", "--headless", "--config"])
            .arg(&toml)
            .arg("--session")
            .arg(&session)
            .env("XDG_RUNTIME_DIR", dir.path())
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .expect("the daemon starts"),
    };
    let ask = |method: &str| call(&socket, method, &Value::Null, PATIENCE);
    // Until the pen is heard.
    let mut waited = 0;
    while ask("status").ok().and_then(|s| s["dabs"].as_u64()).unwrap_or(0) == 0 {
        pause(20);
        waited += 20;
        assert!(waited < 20_000, "the pen was never heard");
    }
    pause(ms);
    let known = ask("hash").expect("the daemon answers");
    pause(260);
    let status = ask("status").expect("the daemon answers");
    daemon.child.kill().expect("SIGKILL");
    daemon.child.wait().expect("gone");
    let tick = known["tick"].as_u64().expect("a tick");
    let whole = replay(&session, None);
    // The last tick that had input: on a loaded machine the pen itself may be late.
    let (recovered, last) =
        (whole["ticks"].as_u64().expect("ticks"), status["heard"].as_u64().expect("a tick"));
    assert_eq!(whole["loss"], Value::Null);
    // 250 ms at 120 Hz are 30 ticks.
    assert!(recovered + 30 >= last, "recovered up to tick {recovered}, acknowledged {last}");
    assert_eq!(replay(&session, Some(tick))["hash"], known["hash"], "at tick {tick}");
    // Nobody goes on with this session.
    sculptd_daemon::session::catalog::logs_of(&session)
        .iter()
        .for_each(sculptd_daemon::session::shared_memory_log::remove);
    last.saturating_sub(recovered)
}

#[test]
fn a_killed_daemon_loses_a_quarter_of_a_second_at_most() {
    let kills = if std::env::var_os("SCULPTD_LONG").is_some() { 200 } else { 3 };
    let mut rng = sim::faults::Rng::new(7);
    let worst = (0..kills).map(|_| one_kill(rng.below(1500))).max().unwrap_or(0);
    println!(
        "{kills} kills, at most {worst} ticks of 120 a second lost ({} ms)",
        worst * 1000 / 120
    );
}

/// A daemon that is killed while it makes its session leaves a whole one or none: the next start
/// with the same name goes on.
#[test]
fn a_kill_while_the_session_is_made_never_stops_the_next_start() {
    let kills = if std::env::var_os("SCULPTD_LONG").is_some() { 100 } else { 10 };
    let mut rng = sim::faults::Rng::new(23);
    let (mut none, mut whole) = (0, 0);
    for n in 0..kills {
        let dir = tempfile::tempdir().expect("a folder");
        let session = dir.path().join("s.sculpt");
        let start = || {
            sculptd()
                .args(["run", "--headless", "--for", "0.2", "--session"])
                .arg(&session)
                .env("XDG_RUNTIME_DIR", dir.path())
                .env("XDG_CONFIG_HOME", dir.path())
                .stderr(Stdio::piped())
                .stdout(Stdio::null())
                .spawn()
                .expect("the daemon starts")
        };
        let mut daemon = Daemon { child: start() };
        // From the first sign of a file on: the start before it takes as long as the machine
        // likes.
        let seen = || {
            std::fs::read_dir(dir.path()).is_ok_and(|f| {
                f.flatten().any(|e| e.file_name().to_string_lossy().contains("s.sculpt"))
            })
        };
        let mut waited = 0;
        while !seen() && waited < 20_000 {
            pause(1);
            waited += 1;
        }
        pause(rng.below(200));
        let _ = daemon.child.kill();
        daemon.child.wait().expect("gone");
        match session.exists() {
            true => whole += 1,
            false => none += 1,
        }
        let again = start().wait_with_output().expect("ends");
        let said = String::from_utf8_lossy(&again.stderr);
        assert!(again.status.success(), "kill {n}: {said}");
        assert!(!said.contains("damaged"), "kill {n}: {said}");
        let opened = sculptd_daemon::session::open(&session).expect("opens");
        assert_eq!(opened.loss, None, "kill {n}");
    }
    println!("{kills} kills: {none} before the session had its name, {whole} after");
}

#[test]
fn no_daemon_is_said_clearly() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = sculptd()
        .args(["ctl", "status"])
        .env("XDG_RUNTIME_DIR", dir.path())
        .output()
        .expect("runs");
    assert_eq!(out.status.code(), Some(5));
    assert!(String::from_utf8_lossy(&out.stderr).contains("no daemon is running"));
}

//! Random work with a real daemon: whatever was asked of it, its session opens with the hash that
//! was there after a kill and after an ordinary end, a copy of the file has it within seconds, and
//! a replay gives it, from the start and from the newest checkpoint.

use std::path::Path;
use std::process::Command;

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

use crate::daemon_process::Daemon;
use crate::random_requests::{params, prepare, write_files};
use crate::seeded::Random;
use crate::waiting::{PATIENCE, until};
use sculptd_control::METHODS;
use sculptd_daemon::control::client::call;

/// Methods that end the daemon or its connection.
const LEFT_OUT: [&str; 3] = ["subscribe", "window", "shutdown"];

/// What `sculptd --json` says; `Err` with the message of an error.
fn reported(args: &[&str], file: &Path) -> Result<Value, String> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    let out = command.arg("--json").args(args).arg(file).output().expect("runs");
    serde_json::from_slice(&out.stdout).map_err(|_| String::from_utf8_lossy(&out.stderr).into())
}

/// The hash of a copy; `None` for one that was torn, whose readable part opens all the same.
fn of_copy(copy: &Path) -> Option<Value> {
    match reported(&["replay"], copy) {
        Ok(replayed) => Some(replayed["hash"].clone()),
        Err(why) => {
            let saved =
                reported(&["session", "save"], copy).unwrap_or_else(|e| panic!("{why}: {e}"));
            println!("a torn copy: {why}: {saved}");
            let path = saved["path"].as_str().expect("a path");
            let replayed = reported(&["replay", "--from-checkpoint"], path.as_ref());
            assert!(replayed.is_ok(), "{saved}: {replayed:?}");
            std::fs::remove_file(path).expect("removed");
            None
        }
    }
}

/// Asks a running daemon; `None`: it refused.
fn ask(daemon: &Daemon, method: &str, params: &Value) -> Option<Value> {
    call(&daemon.home.path().join("sculptd.sock"), method, params, PATIENCE).ok()
}

fn hash(daemon: &Daemon) -> Option<Value> {
    ask(daemon, "hash", &Value::Null).map(|reply| reply["hash"].clone())
}

/// Ends a daemon and returns its home.
fn ended(mut daemon: Daemon, signal: Signal) -> tempfile::TempDir {
    kill_process(Pid::from_child(&daemon.child), signal).expect("it runs");
    daemon.child.wait().expect("it ends");
    std::mem::replace(&mut daemon.home, tempfile::tempdir().expect("a folder"))
}

fn begun(home: tempfile::TempDir, args: &[&str]) -> Daemon {
    let daemon = Daemon::run_in(home, args);
    until("it answers", || hash(&daemon).is_some());
    daemon
}

/// Returns how many requests were carried out.
fn sequence(seed: u64, requests: u64) -> u64 {
    let mut r = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let home = tempfile::tempdir().expect("a folder");
    let folder = home.path().to_path_buf();
    write_files(&folder);
    let (session, ball) = (folder.join("s.sculpt"), folder.join("ball.ply"));
    let session_text = session.display().to_string();
    let begin = ["--mesh", &ball.display().to_string(), "--session", &session_text];
    let mut daemon = begun(home, &begin);
    let methods: Vec<_> =
        METHODS.iter().map(|m| m.name).filter(|m| !LEFT_OUT.contains(m)).collect();
    let (mut done, mut asked) = (0, Vec::new());
    for round in 0..3 {
        for _ in 0..requests {
            let method = match r.below(3) {
                0 => "stroke",
                _ => r.of(&methods),
            };
            let ask = |method: &str, params: Value| ask(&daemon, method, &params);
            prepare(method, &ask, &folder);
            let params = params(method, &mut r, &ask, &folder);
            let was_done = ask(method, params.clone()).is_some();
            done += u64::from(was_done);
            asked.push(format!("{method} {params} {was_done}"));
        }
        let live = hash(&daemon);
        let case = || format!("seed {seed}, round {round}, after {asked:#?}");
        assert!(live.is_some(), "it answers; {}", case());
        if r.below(4) == 0 {
            // The file alone, while it is written to: it lacks about two seconds at most.
            let copy = folder.join("copy.sculpt");
            until(&format!("a copy has it all; {}", case()), || {
                std::fs::copy(&session, &copy).expect("copied");
                of_copy(&copy) == live
            });
        }
        let signal = if r.below(2) == 0 { Signal::KILL } else { Signal::TERM };
        daemon = begun(ended(daemon, signal), &["--session", &session_text]);
        let opened = hash(&daemon);
        let said = || daemon.told.lock().expect("no panic").join("\n");
        assert_eq!(opened, live, "{signal:?}: {}; {}", said(), case());
        assert!(!daemon.has_told("lost"), "{signal:?}: {}; {}", said(), case());
    }
    let live = hash(&daemon);
    let _home = ended(daemon, Signal::TERM);
    for way in [&["replay"][..], &["replay", "--from-checkpoint"]] {
        let replayed = reported(way, &session).map(|r| r["hash"].clone());
        assert_eq!(replayed.ok(), live, "seed {seed}: {way:?}");
    }
    done
}

/// `SCULPTD_SEED`: the first seed; `SCULPTD_SEEDS`: how many.
#[test]
fn random_work_survives_kills_ends_and_copies() {
    let number = |key: &str| std::env::var(key).ok().and_then(|v| v.parse().ok());
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let (first, seeds) = (
        number("SCULPTD_SEED").unwrap_or(0),
        number("SCULPTD_SEEDS").unwrap_or(if long { 2000 } else { 6 }),
    );
    let mut done = 0;
    for seed in first..first + seeds {
        done += sequence(seed, 8);
        println!("seed {seed}: {done} requests carried out");
    }
    assert!(done > 12 * seeds, "{done} requests of {} were carried out", 24 * seeds);
}

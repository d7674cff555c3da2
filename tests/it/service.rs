//! The daemon as an administrator meets it: its doctor, its socket, its manager, its figures.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::waiting::{PATIENCE, until as wait_until};
use serde_json::Value;

fn sculptd() -> Command {
    Command::new(env!("CARGO_BIN_EXE_sculptd"))
}

#[allow(clippy::disallowed_methods)] // A broken file is what is wanted.
fn file(dir: &Path, name: &str, content: &str) -> PathBuf {
    let path = dir.join(name);
    std::fs::write(&path, content).expect("written");
    path
}

struct Examined {
    code: Option<i32>,
    checks: Vec<Value>,
}

impl Examined {
    fn of(&self, name: &str) -> &Value {
        self.checks
            .iter()
            .find(|c| c["name"] == name)
            .unwrap_or_else(|| panic!("{name}: {:?}", self.checks))
    }
}

fn doctor(dir: &Path, config: &Path, runtime: &Path) -> Examined {
    let out = sculptd()
        .args(["doctor", "--json", "--config"])
        .arg(config)
        .env("XDG_RUNTIME_DIR", runtime)
        .env("XDG_STATE_HOME", dir.join("state"))
        .output()
        .expect("runs");
    let value: Value = serde_json::from_slice(&out.stdout).expect("one JSON object");
    Examined {
        code: out.status.code(),
        checks: value["checks"].as_array().expect("checks").clone(),
    }
}

#[test]
fn the_doctor_finds_nothing_wrong_with_sound_settings() {
    let dir = tempfile::tempdir().expect("a folder");
    // A rate that a busy machine holds too: here the doctor is tested, not the machine.
    let good = file(
        dir.path(),
        "good.toml",
        "[loop]\nrate_hz = 30\nworkers = 1\n[devices]\nhid = false\n",
    );
    let seen = doctor(dir.path(), &good, dir.path());
    // Only a machine with no time at all may fail, by its rate.
    let failed = seen.checks.iter().filter(|c| c["verdict"] == "fail").map(|c| c["name"].clone());
    let failed: Vec<Value> = failed.collect();
    assert!(failed.iter().all(|n| *n == "tick rate"), "{:?}", seen.checks);
    assert_eq!(seen.code, Some(i32::from(!failed.is_empty())));
    for name in ["settings", "control socket", "session folder"] {
        assert!(
            ["pass", "warn"].contains(&seen.of(name)["verdict"].as_str().unwrap_or("")),
            "{:?}",
            seen.of(name)
        );
    }
    for name in ["pen tablets", "hand tracking"] {
        assert_eq!(seen.of(name)["verdict"], "skip");
    }
    assert!(seen.of("tick rate")["cause"].as_str().is_some_and(|c| c.contains("Hz")));
}

#[test]
fn the_doctor_names_what_is_broken_and_the_repair() {
    let dir = tempfile::tempdir().expect("a folder");
    let bad = file(
        dir.path(),
        "bad.toml",
        "[loop]\nrate_hz = 30\n[devices]\nhid = false\nserial = [\"/dev/sculptd-none\"]\nleap = \
            \"ws://127.0.0.1:1/v6.json\"\n",
    );
    let seen = doctor(dir.path(), &bad, &dir.path().join("no/such/folder"));
    assert_eq!(seen.code, Some(1));
    for (name, cause, repair) in [
        ("serial pen", "/dev/sculptd-none", "devices.serial"),
        ("hand tracking", "127.0.0.1:1", "devices.leap"),
        ("control socket", "no/such/folder", "XDG_RUNTIME_DIR"),
    ] {
        let check = seen.of(name);
        assert_eq!(check["verdict"], "fail", "{check}");
        assert!(check["cause"].as_str().is_some_and(|c| c.contains(cause)), "{check}");
        assert!(check["repair"].as_str().is_some_and(|r| r.contains(repair)), "{check}");
    }
    let typo = file(dir.path(), "typo.toml", "[loop]\nrate = 30\n");
    let seen = doctor(dir.path(), &typo, dir.path());
    assert_eq!((seen.code, &seen.of("settings")["verdict"]), (Some(1), &Value::from("fail")));
    assert!(
        seen.of("settings")["cause"]
            .as_str()
            .is_some_and(|c| c.contains("line 2") && c.contains("rate"))
    );
    // A folder that others may write, and a state folder that cannot be made because a file stands
    // there.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let open = dir.path().join("open");
        std::fs::create_dir(&open).expect("made");
        std::fs::set_permissions(&open, std::fs::Permissions::from_mode(0o777)).expect("set");
        file(dir.path(), "state", "not a folder");
        let good = file(dir.path(), "good.toml", "[loop]\nrate_hz = 30\n[devices]\nhid = false\n");
        let seen = doctor(dir.path(), &good, &open);
        assert_eq!(seen.of("control socket")["verdict"], "warn");
        assert_eq!(seen.of("control socket")["repair"], format!("chmod 700 '{}'", open.display()));
        assert_eq!(
            (seen.code, &seen.of("session folder")["verdict"]),
            (Some(1), &Value::from("fail"))
        );
    }
}

/// A running daemon, ended with the test.
#[cfg(unix)]
struct Daemon(Child);

#[cfg(unix)]
impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// As the manager sees it: ready once, alive while it works, its figures for us alone, new settings
/// without a restart, and a word when it stops.
#[cfg(unix)]
#[test]
fn the_service_manager_hears_and_the_figures_are_ours_alone() {
    use std::io::{BufRead, BufReader, Read, Write};
    let dir = tempfile::tempdir().expect("a folder");
    let manager = std::os::unix::net::UnixDatagram::bind(dir.path().join("notify")).expect("bound");
    manager.set_read_timeout(Some(PATIENCE)).expect("set");
    let hear = |wanted: &str| {
        let mut buffer = [0; 512];
        for _ in 0..50 {
            let n = manager.recv(&mut buffer).unwrap_or_else(|e| panic!("no {wanted}: {e}"));
            if String::from_utf8_lossy(&buffer[..n]).contains(wanted) {
                return;
            }
        }
        panic!("no {wanted}");
    };
    let settings = file(dir.path(), "my.toml", "[devices]\nhid = false\n");
    let mut child = sculptd()
        .args(["run", "--headless", "--log-format", "json", "--metrics", "0", "--config"])
        .arg(&settings)
        .env("XDG_RUNTIME_DIR", dir.path())
        .env("NOTIFY_SOCKET", dir.path().join("notify"))
        .env("WATCHDOG_USEC", "400000")
        .env_remove("WATCHDOG_PID")
        .env_remove("SCULPTD_LOG")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut said =
        BufReader::new(child.stderr.take().expect("piped")).lines().map_while(Result::ok);
    let daemon = Daemon(child);
    let mut until =
        |word: &str| said.find(|l| l.contains(word)).unwrap_or_else(|| panic!("never said {word}"));
    let at = until("figures at");
    let address = at
        .split("http://")
        .nth(1)
        .and_then(|a| a.split('/').next())
        .expect("an address")
        .to_owned();
    hear("READY=1");
    hear("WATCHDOG=1");
    hear("WATCHDOG=1");
    let get = |host: &str, more: &str| {
        let mut stream = std::net::TcpStream::connect(&address).expect("connects");
        let request = format!("GET /metrics HTTP/1.1\r\nHost: {host}\r\n{more}\r\n");
        stream.write_all(request.as_bytes()).expect("sent");
        let mut reply = String::new();
        stream.read_to_string(&mut reply).expect("an answer");
        reply
    };
    let page = get(&address, "");
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("\nsculptd_ticks_total "), "{page}");
    assert!(get("evil.example", "").starts_with("HTTP/1.1 403"));
    assert!(get(&address, "Origin: https://evil.example\r\n").starts_with("HTTP/1.1 403"));
    // New settings: a bad file changes nothing, a good one changes the brush.
    let socket = dir.path().join("sculptd.sock");
    let strength = || {
        let v = sculptd_daemon::control::client::call(&socket, "status", &Value::Null, PATIENCE);
        v.expect("answers")["brush"]["strength"].as_f64().expect("a number")
    };
    let before = strength();
    let hangup = || {
        let pid = daemon.0.id().to_string();
        assert!(Command::new("kill").args(["-HUP", &pid]).status().is_ok_and(|s| s.success()));
    };
    file(dir.path(), "my.toml", "[brush]\nstrength = 7.0\n");
    hangup();
    let line = until("old ones stay");
    let object: Value = serde_json::from_str(&line).expect("the log is JSON");
    assert_eq!(object["level"], "ERROR");
    assert_eq!(strength(), before);
    file(
        dir.path(),
        "my.toml",
        "[devices]\nhid = false\n[brush]\nstrength = 0.5\n[loop]\nrate_hz = 60\n",
    );
    hangup();
    let line = until("next start");
    assert!(line.contains("[loop]"), "{line}");
    wait_until("the new settings are in force", || strength() == 0.5);
    let pid = daemon.0.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &pid]).status().is_ok_and(|s| s.success()));
    hear("STOPPING=1");
}

#[test]
fn every_subcommand_has_its_manual_page_and_numbers_read_as_they_were_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = sculptd().args(["man", "--all"]).arg(dir.path()).output().expect("runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    // Every page that the first page refers to exists.
    let first = std::fs::read_to_string(dir.path().join("sculptd.1")).expect("the first page");
    let named: Vec<String> = first
        .split(|c: char| c.is_whitespace())
        .filter_map(|w| w.strip_suffix("(1)"))
        .map(|w| w.replace('\\', ""))
        .filter(|w| w.starts_with("sculptd-"))
        .collect();
    assert!(named.len() > 15, "{named:?}");
    for name in named.iter().chain([&"sculptd-session-prune".to_owned()]) {
        let page = std::fs::read_to_string(dir.path().join(format!("{name}.1")));
        assert!(page.is_ok_and(|p| p.contains(".SH NAME")), "{name}");
    }
    let config = file(dir.path(), "c.toml", "[brush]\nradius = 0.3\n");
    let out = sculptd()
        .args(["config", "show", "--json", "--config"])
        .arg(&config)
        .output()
        .expect("runs");
    let shown: Value = serde_json::from_slice(&out.stdout).expect("one JSON object");
    assert_eq!(shown["brush.radius"]["value"].to_string(), "0.3");
    assert_eq!(shown["undo.history_bytes"]["value"], 4u64 << 30);
}

/// Without a runtime folder the socket is in the temporary directory, where anybody may have
/// created a folder of its name before.
#[cfg(unix)]
#[test]
fn a_fallback_folder_that_others_may_write_is_refused_by_daemon_and_client() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let dir = tempfile::tempdir().expect("a folder");
    let user = std::fs::metadata(dir.path()).expect("ours").uid();
    let folder = dir.path().join(format!("sculptd-{user}"));
    let run = |arguments: &[&str]| {
        let mut command = sculptd();
        command.args(arguments).env("TMPDIR", dir.path()).env_remove("XDG_RUNTIME_DIR");
        let out = command.env("XDG_CONFIG_HOME", dir.path()).output().expect("runs");
        (out.status.code(), String::from_utf8_lossy(&out.stderr).into_owned())
    };
    let start = ["run", "--headless", "--for", "0.1"];
    // Its own folder serves.
    let (code, said) = run(&start);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(std::fs::metadata(&folder).expect("made").mode() & 0o777, 0o700);
    let refused = |what: &str, word: &str| {
        let (code, said) = run(&start);
        assert!(code == Some(4) && said.contains(word), "{what}: {code:?}, {said}");
        let (code, said) = run(&["ctl", "status"]);
        assert!(code != Some(0) && said.contains(word), "{what}: {code:?}, {said}");
    };
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o777)).expect("set");
    refused("a folder that all may write", "open to others");
    std::fs::remove_dir_all(&folder).expect("removed");
    let elsewhere = dir.path().join("elsewhere");
    std::fs::create_dir(&elsewhere).expect("made");
    std::os::unix::fs::symlink(&elsewhere, &folder).expect("linked");
    refused("a link", "another user");
    std::fs::remove_file(&folder).expect("removed");
    std::fs::create_dir(&folder).expect("made");
    // Only root can give a folder away.
    if user == 0 && std::os::unix::fs::chown(&folder, Some(65_534), None).is_ok() {
        refused("a folder of another user", "another user");
    }
}

#[cfg(unix)]
#[test]
fn figures_of_a_run_on_a_simulated_clock_are_refused_and_not_left_out() {
    let out = sculptd()
        .args(["run", "--headless", "--metrics", "0", "--play-device", "none.txt"])
        .output()
        .expect("runs");
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("--metrics"), "{said}");
}

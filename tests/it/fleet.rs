//! A fleet of real processes over Zenoh on the loopback: the list, requests, a roll-out that is
//! kept, one that its canary does not survive, a roll-back, a death.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::daemon_process::{Daemon, free_endpoint};
use crate::waiting::until;
use sculptd_geometry::io::write_beside;

/// The computer of the staff.
struct Staff {
    home: tempfile::TempDir,
    fleet: String,
    endpoint: String,
}

impl Staff {
    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
        command.args(["--json", "fleet", "--no-multicast", "--connect", &self.endpoint]);
        command.args(args);
        for name in ["XDG_RUNTIME_DIR", "XDG_DATA_HOME", "XDG_STATE_HOME", "HOME"] {
            command.env(name, self.home.path());
        }
        command
    }

    /// The exit code and the answer.
    fn ask(&self, args: &[&str]) -> (Option<i32>, Value) {
        let out = self.command(args).output().expect("runs");
        let value = serde_json::from_slice(&out.stdout).unwrap_or_default();
        println!("{args:?}: {value} {}", String::from_utf8_lossy(&out.stderr));
        (out.status.code(), value)
    }

    fn entry(&self, name: &str) -> Value {
        let (_, list) = self.ask(&["list"]);
        let all = list["installations"].as_array().cloned().unwrap_or_default();
        all.into_iter().find(|e| e["name"] == name).unwrap_or_default()
    }
}

fn write(path: &Path, text: &str) {
    write_beside(path, |out| out.write_all(text.as_bytes())).expect("written");
}

/// The settings file of an installation, with a gallery. The first one listens, the others connect
/// to it.
fn installation(staff: &Staff, name: &str, listens: bool) -> PathBuf {
    let path = |ending: &str| staff.home.path().join(format!("{name}{ending}"));
    let key = path(".key").display().to_string();
    assert_eq!(staff.ask(&["key", name, "-o", &key]).0, Some(0));
    let way = if listens { "listen" } else { "connect" };
    let (fleet, endpoint) = (&staff.fleet, &staff.endpoint);
    let gallery = path("-works");
    std::fs::create_dir(&gallery).expect("made");
    let text = format!(
        "idle_s = 45.0\ngallery = {gallery:?}\n\n[fleet]\nname = \"{fleet}\"\nkey = \"{key}\"\n\
         {way} = [\"{endpoint}\"]\nmulticast = false\n"
    );
    write(&path(".toml"), &text);
    path(".toml")
}

fn start(settings: &Path) -> Daemon {
    Daemon::run(&["--kiosk", "--kiosk-config", &settings.display().to_string()])
}

#[test]
fn staff_see_ask_and_roll_out_over_real_processes() {
    let fleet = format!("museum-{}", std::process::id());
    let staff = Staff {
        home: tempfile::tempdir().expect("a folder"),
        fleet: fleet.clone(),
        endpoint: free_endpoint(),
    };
    assert_eq!(staff.ask(&["create", &fleet]).0, Some(0));
    assert_eq!(staff.ask(&["create", &fleet]).0, Some(3), "a key is never written over");
    let files = [("foyer", true), ("hall", false), ("tower", false)]
        .map(|(name, listens)| installation(&staff, name, listens));
    let _foyer = start(&files[0]);
    let mut hall = start(&files[1]);
    let mut tower = start(&files[2]);
    until("all three are there", || staff.ask(&["list"]).1["here"] == 3);
    let entry = staff.entry("hall");
    assert_eq!(entry["state"]["visit"]["stage"], "attract");
    assert!(entry["state"]["disk_free_bytes"].as_u64().is_some_and(|b| b > 0));
    assert!(entry["state"]["ticks"]["p99_ms"].as_f64().is_some_and(|ms| ms > 0.0));
    let old = entry["state"]["settings"]["revision"].clone();

    // Requests.
    let (code, said) = staff.ask(&["message", "The lights, please", "hall", "tower"]);
    // They have no screen, and say so; the log has the message.
    assert_eq!((code, said["answers"][0]["outcome"].as_str()), (Some(1), Some("refused")));
    assert!(said["answers"][0].to_string().contains("it has no screen"), "{said}");
    assert_eq!(staff.ask(&["restart-visit", "hall"]).0, Some(0));
    let (_, logs) = staff.ask(&["logs", "hall", "--lines", "50"]);
    let lines = logs["answers"][0]["lines"].as_array().cloned().unwrap_or_default();
    let message = |l: &Value| l.as_str().is_some_and(|l| l.contains("The lights, please"));
    assert!(lines.iter().any(message), "{lines:?}");
    // The buttons of the staff page, without the page.
    let visit = |name: &str| staff.entry(name)["state"]["visit"].clone();
    assert_eq!(staff.ask(&["clean", "hall"]).0, Some(0));
    until("it is closed", || visit("hall")["closed"] == true);
    assert_eq!(
        (&visit("hall")["cleaning"], &visit("foyer")["closed"]),
        (&true.into(), &false.into())
    );
    assert_eq!(staff.ask(&["open", "hall"]).0, Some(0));
    until("it is open", || visit("hall")["closed"] == false);
    let (code, said) = staff.ask(&["export", "hall", "tower"]);
    assert_eq!((code, said["answers"][0]["outcome"].as_str()), (Some(0), Some("done")), "{said}");
    until("there is a result", || {
        staff.entry("hall")["state"]["exported"].as_str().is_some_and(|t| t.contains("no work"))
    });
    let run = |name: &str| staff.entry(name)["state"]["run"].clone();
    let before = run("hall");
    assert_eq!(staff.ask(&["restart", "hall"]).0, Some(0));
    until("it runs again", || run("hall") != before && staff.ask(&["list"]).1["here"] == 3);
    // Another fleet's key is not heard.
    let stranger = Staff {
        home: tempfile::tempdir().expect("a folder"),
        fleet: fleet.clone(),
        endpoint: staff.endpoint.clone(),
    };
    assert_eq!(stranger.ask(&["create", &fleet]).0, Some(0));
    assert_eq!(stranger.ask(&["list"]).1["here"], 0, "nor is what it hears believed");
    assert_eq!(stranger.ask(&["message", "Out", "hall"]).0, Some(1));
    assert_eq!(stranger.ask(&["end", "hall"]).0, Some(1));

    // Settings that do well.
    let good = staff.home.path().join("good.toml");
    write(&good, "idle_s = 50.0\n");
    let good = good.display().to_string();
    let roll = |file: &str| staff.ask(&["rollout", file, "--canary", "hall", "--watch", "4"]);
    let (code, end) = roll(&good);
    assert_eq!((code, end["result"].as_str()), (Some(0), Some("kept")));
    assert_eq!(end["kept"].as_array().map(Vec::len), Some(3));
    for (name, file) in ["foyer", "hall", "tower"].iter().zip(&files) {
        let state = &staff.entry(name)["state"];
        assert_eq!(state["settings"]["revision"], end["revision"], "{name}");
        assert_eq!(state["settings"]["trial"], false, "{name}");
        let text = std::fs::read_to_string(file).expect("there");
        assert!(text.contains("idle_s = 50.0") && text.contains(&fleet), "{text}");
    }

    // Settings that are refused, and settings that the canary does not survive: whoever watches
    // over it starts it again.
    let bad = staff.home.path().join("bad.toml");
    write(&bad, "idle_s = 55.0\nlanguage = \"xx\"\n");
    let (code, refused) = roll(&bad.display().to_string());
    assert_eq!((code, refused["failed"].as_str()), (Some(1), Some("hall")));
    write(&bad, "idle_s = 55.0\nattract = [\"/nowhere/strokes.hid\"]\n");
    let bad = bad.display().to_string();
    let mut rolls = staff.command(&["rollout", &bad, "--canary", "tower", "--watch", "4"]);
    let rolls = rolls.stdout(std::process::Stdio::piped()).spawn().expect("runs");
    until("the canary dies of it", || tower.child.try_wait().expect("waited for").is_some());
    let mut tower = start(&files[2]);
    let out = rolls.wait_with_output().expect("ends");
    let end: Value = serde_json::from_slice(&out.stdout).expect("an answer");
    println!("{end}");
    assert_eq!((out.status.code(), end["failed"].as_str()), (Some(1), Some("tower")));
    assert!(tower.has_told("were taken back"), "it says so itself");
    for file in &files {
        let text = std::fs::read_to_string(file).expect("there");
        assert!(text.contains("idle_s = 50.0"), "{text}");
    }

    // Back to what was before the good ones.
    assert_eq!(staff.ask(&["rollback", "--all"]).0, Some(0));
    until("all have the first settings again", || {
        let (_, list) = staff.ask(&["list"]);
        let all = list["installations"].as_array().cloned().unwrap_or_default();
        list["here"] == 3 && all.iter().all(|e| e["state"]["settings"]["revision"] == old)
    });

    // A lost installation is reported within ten seconds: the list waits for four.
    tower.child.kill().expect("killed");
    tower.child.wait().expect("ended");
    assert_eq!(staff.ask(&["end", "hall"]).0, Some(0));
    until("it ends for good", || hall.child.try_wait().expect("waited for").is_some());
    let (_, list) = staff.ask(&["list"]);
    assert_eq!(list["here"], 1);
    assert_eq!(staff.entry("tower")["here"], false, "it is remembered");
}

//! An installation as `sculptd kiosk install` sets it up, whose X server is killed repeatedly:
//! loops as those of systemd start server and program again, and the visit goes on.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use sculptd_daemon::control::client::call;
use serde_json::{Value, json};

use super::stage::{Ended, alone, long, pause, wait};

/// Visits that nobody sends away while a test runs.
const SETTINGS: &str =
    "idle_s = 3600\nstaff_pin = \"4711\"\ngallery = \"gallery\"\naudit = \"visits.log\"\n";

struct Installation {
    home: PathBuf,
    display: u32,
    _services: [Ended; 2],
}

impl Installation {
    /// The two services, each as a loop in place of systemd: the screen starts again whenever it
    /// has ended, the program whenever it has failed.
    #[allow(clippy::disallowed_methods)] // Settings of a test.
    fn begin(home: &Path) -> Installation {
        std::fs::write(home.join("kiosk.toml"), SETTINGS).expect("written");
        let taken = |n: &u32| Path::new(&format!("/tmp/.X{n}-lock")).exists();
        let display = (90..200).find(|n| !taken(n)).expect("a free display");
        let screen = format!(
            "while [ ! -e closed ]; do \
             Xvfb :{display} -screen 0 1280x720x24 -nolisten tcp -noreset; sleep 1; done"
        );
        let screen = Command::new("sh")
            .args(["-c", &screen])
            .current_dir(home)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a shell");
        let socket = format!("/tmp/.X11-unix/X{display}");
        wait("the X server listens", || Path::new(&socket).exists().then_some(()));
        let service = include_str!("../../src/daemon/kiosk/setup/files/sculptd-kiosk.service");
        let command = service.lines().find_map(|line| line.strip_prefix("ExecStart="));
        let command = command.expect("a command").split(" --metrics").next().unwrap_or_default();
        let command = command.replace("/etc/sculptd/kiosk.toml", "kiosk.toml");
        let service =
            format!("while [ ! -e closed ]; do {command} && touch closed || sleep 0.5; done");
        let program = Path::new(env!("CARGO_BIN_EXE_sculptd")).parent().expect("a folder");
        let path = std::env::var("PATH").unwrap_or_default();
        let service = Command::new("sh")
            .args(["-c", &service])
            .env("DISPLAY", format!(":{display}"))
            .current_dir(home)
            .env("PATH", format!("{}:{path}", program.display()))
            .env("XDG_RUNTIME_DIR", home)
            .env("XDG_CONFIG_HOME", home)
            .env("XDG_DATA_HOME", home.join("data"))
            .env("XDG_STATE_HOME", home.join("state"))
            .env("HOME", home)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("DBUS_SESSION_BUS_ADDRESS")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(std::fs::File::create(home.join("log")).expect("a file"))
            .spawn()
            .expect("a shell");
        Installation { home: home.into(), display, _services: [Ended(service), Ended(screen)] }
    }

    fn ask(&self, method: &str, params: &Value) -> Option<Value> {
        let patience = std::time::Duration::from_secs(10);
        call(&self.home.join("sculptd.sock"), method, params, patience).ok()
    }

    fn hash(&self) -> Value {
        wait("a hash", || self.ask("hash", &Value::Null))["hash"].clone()
    }

    fn is_shown(&self) -> bool {
        self.ask("status", &Value::Null).is_some_and(|s| s["window"] == "open")
    }

    fn log(&self) -> String {
        std::fs::read_to_string(self.home.join("log")).unwrap_or_default()
    }

    /// Sculpts a little, and waits until the clay rests.
    fn sculpt(&self) {
        let (before, points) = (self.hash(), [[0.45, 0.5, 0.8, 0.0], [0.55, 0.5, 0.8, 150.0]]);
        wait("a stroke sculpts", || {
            self.ask("stroke", &json!({ "points": points, "space": "view" }));
            pause(200);
            (self.hash() != before).then_some(())
        });
        wait("it rests", || {
            let before = self.hash();
            pause(400);
            (self.hash() == before).then_some(())
        });
    }

    /// Kills the X server, as a fault of a driver does.
    fn lose_screen(&self) {
        let lock = format!("/tmp/.X{}-lock", self.display);
        let pid = std::fs::read_to_string(lock).unwrap_or_default();
        let _ = Command::new("kill").args(["-9", pid.trim()]).stderr(Stdio::null()).status();
    }
}

impl Drop for Installation {
    /// Nothing is started again, and what runs ends with its screen.
    fn drop(&mut self) {
        let _ = std::fs::File::create(self.home.join("closed"));
        self.ask("shutdown", &Value::Null);
        self.lose_screen();
        pause(300);
    }
}

#[test]
fn an_installation_comes_back_each_time_its_screen_is_lost() {
    let path = std::env::var_os("PATH").unwrap_or_default();
    if !std::env::split_paths(&path).any(|folder| folder.join("Xvfb").exists()) {
        println!("skipped: Xvfb is not installed");
        return;
    }
    let _alone = alone();
    let dir = tempfile::tempdir().expect("a folder");
    let installation = Installation::begin(dir.path());
    let again = "the last visit was interrupted";
    wait("it is there", || installation.is_shown().then_some(()));
    installation.sculpt();
    let losses = if long() { 50 } else { 2 };
    for loss in 1..=losses {
        installation.sculpt();
        let hash = installation.hash();
        pause(loss * 37 % 500);
        // A start before the X server is there says it too, and ends.
        let times = || installation.log().matches(again).count();
        let before = times();
        installation.lose_screen();
        let is_back = || times() > before && installation.is_shown();
        let came = (0..1200).any(|_| {
            pause(100);
            is_back()
        });
        if !came {
            panic!("not back after loss {loss}: {}", installation.log());
        }
        assert_eq!(installation.hash(), hash, "after loss {loss}: {}", installation.log());
    }
    // The same by the command that staff run before opening day.
    let out = Command::new(env!("CARGO_BIN_EXE_sculptd"))
        .args(["kiosk", "try", "--only", "kill", "--only", "screen", "--runtime"])
        .arg(dir.path())
        .output()
        .expect("runs");
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    println!("{said}");
    let promised = |line: &str| line.starts_with("as promised") && line.contains("window: open");
    assert!(out.status.success() && said.lines().all(promised), "{said}");
    assert_eq!(said.lines().count(), 2, "{said}");
    installation.ask("shutdown", &Value::Null).expect("an answer");
    wait("it stays closed", || dir.path().join("closed").exists().then_some(()));
    let visits = std::fs::read_to_string(dir.path().join("visits.log")).unwrap_or_default();
    assert_eq!(visits.lines().count(), 1, "{visits}\n{}", installation.log());
    let works = sculptd_daemon::kiosk::names::works(&dir.path().join("gallery"));
    assert_eq!(works.map_or(0, |w| w.len()), 1, "the work of the visit is kept");
}

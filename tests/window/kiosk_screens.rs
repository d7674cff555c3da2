//! An installation as the guide sets it up, whose X server is killed again and again: `xinit` and
//! the guide's own start file bring it back, and the visit goes on.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use sculptd_daemon::control::client::call;
use serde_json::{Value, json};

use super::stage::{Ended, alone, long, pause, wait};

/// The text of a file that the guide's chapter writes with `cat >NAME <<'EOF'`.
fn of_the_guide(name: &str) -> String {
    let chapter = include_str!("../../config/guide/src/kiosk.md");
    let begin = format!("cat >{name} <<'EOF'\n");
    let text = chapter.split_once(&begin).expect("the guide writes it").1;
    text.split_once("EOF\n").expect("its end").0.to_owned()
}

struct Installation {
    home: PathBuf,
    display: u32,
    _login: Ended,
}

impl Installation {
    /// A login that starts X and the installation, and again when they have ended.
    #[allow(clippy::disallowed_methods)] // Settings of a test.
    fn begin(home: &Path) -> Installation {
        let closed = home.join("closed").display().to_string();
        let start = of_the_guide("~/sculptd.xinit").replace("/tmp/sculptd-closed", &closed);
        std::fs::write(home.join("sculptd.xinit"), start).expect("written");
        std::fs::write(home.join("kiosk.toml"), of_the_guide("~/kiosk.toml")).expect("written");
        let executable = Command::new("chmod").arg("+x").arg(home.join("sculptd.xinit")).status();
        assert!(executable.is_ok_and(|s| s.success()));
        let taken = |n: &u32| Path::new(&format!("/tmp/.X{n}-lock")).exists();
        let display = (90..200).find(|n| !taken(n)).expect("a free display");
        let server = format!("Xvfb :{display} -screen 0 1280x720x24 -nolisten tcp");
        let login = format!(
            "while [ ! -e '{closed}' ]; do xinit ./sculptd.xinit -- $(command -v Xvfb) {}; done",
            server.trim_start_matches("Xvfb ")
        );
        let program = Path::new(env!("CARGO_BIN_EXE_sculptd")).parent().expect("a folder");
        let path = std::env::var("PATH").unwrap_or_default();
        let login = Command::new("sh")
            .args(["-c", &login])
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
        Installation { home: home.into(), display, _login: Ended(login) }
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
    for tool in ["Xvfb", "xinit"] {
        let path = std::env::var_os("PATH").unwrap_or_default();
        if !std::env::split_paths(&path).any(|folder| folder.join(tool).exists()) {
            println!("skipped: {tool} is not installed");
            return;
        }
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
        installation.lose_screen();
        let is_back = || {
            let times = installation.log().matches(again).count() as u64;
            times == loss && installation.is_shown()
        };
        let came = (0..1200).any(|_| {
            pause(100);
            is_back()
        });
        if !came {
            panic!("not back after loss {loss}: {}", installation.log());
        }
        assert_eq!(installation.hash(), hash, "after loss {loss}: {}", installation.log());
    }
    installation.ask("shutdown", &Value::Null).expect("an answer");
    wait("it stays closed", || dir.path().join("closed").exists().then_some(()));
    let visits = std::fs::read_to_string(dir.path().join("visits.log")).unwrap_or_default();
    assert_eq!(visits.lines().count(), 1, "{visits}\n{}", installation.log());
    let works = sculptd_daemon::kiosk::names::works(&dir.path().join("gallery"));
    assert_eq!(works.map_or(0, |w| w.len()), 1, "the work of the visit is kept");
}

//! Three computers in network namespaces, for tests of networks that are cut.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use super::{ask, join, key};
use crate::daemon_process::Daemon;
use crate::waiting::{comes, until};

pub(super) const PEOPLE: [&str; 3] = ["Ada", "Bob", "Cy"];

/// Three computers on one switch, whose cables can be pulled.
pub(super) struct Switch(String);

fn ip(args: &str) -> bool {
    let run = Command::new("ip").args(args.split(' ')).stderr(Stdio::null()).status();
    run.is_ok_and(|status| status.success())
}

impl Switch {
    pub(super) fn new(name: String) -> Option<Switch> {
        let switch = Switch(name);
        let s = &switch.0;
        let mut up = ip(&format!("netns add {s}"))
            && ip(&format!("-n {s} link add br0 type bridge mcast_snooping 0"))
            && ip(&format!("-n {s} link set br0 up"));
        for k in 0..PEOPLE.len() {
            up = up
                && ip(&format!("netns add {s}-{k}"))
                && ip(&format!("-n {s}-{k} link set lo up"))
                && ip(&format!(
                    "link add eth0 netns {s}-{k} type veth peer name port{k} netns {s}"
                ))
                && ip(&format!("-n {s} link set port{k} master br0 up"))
                && ip(&format!("-n {s}-{k} addr add 10.88.0.{}/24 dev eth0", k + 1))
                && ip(&format!("-n {s}-{k} link set eth0 up"));
        }
        up.then_some(switch)
    }

    pub(super) fn cable(&self, k: usize, state: &str) {
        assert!(ip(&format!("-n {} link set port{k} {state}", self.0)));
    }
}

impl Drop for Switch {
    fn drop(&mut self) {
        for k in 0..PEOPLE.len() {
            ip(&format!("netns del {}-{k}", self.0));
        }
        ip(&format!("netns del {}", self.0));
    }
}

fn endpoint(k: usize) -> String {
    format!("tcp/10.88.0.{}:7447", k + 1)
}

/// The parts of a session that start a daemon of a person.
pub(super) struct Table<'a> {
    pub(super) switch: &'a Switch,
    folder: &'a Path,
    pub(super) name: String,
    /// Role of the third person.
    pub(super) third: &'static str,
}

impl<'a> Table<'a> {
    pub(super) fn new(switch: &'a Switch, folder: &'a Path, name: String) -> Self {
        Table { switch, folder, name, third: "sculptor" }
    }

    pub(super) fn file(&self, k: usize, run: usize) -> PathBuf {
        self.folder.join(format!("{}-run{run}.sculpt", PEOPLE[k]))
    }

    /// The first person hosts, or joins who hosts meanwhile. The others join.
    pub(super) fn start(&self, k: usize, run: usize, home: tempfile::TempDir) -> Daemon {
        let keys = self.folder.join("keys");
        let role = if k == 2 { self.third } else { "sculptor" };
        let (keys_text, invitation) = (keys.display().to_string(), key(&keys, role));
        let at = [0, 1, 2].map(endpoint);
        let file = self.file(k, run).display().to_string();
        let mut args = vec!["run", "--headless", "--session", &file, "--listen", &at[k]];
        match k {
            0 => args.extend(["--host", &self.name, "--keys", &keys_text, "--as", PEOPLE[0]]),
            _ => args.extend(&join(&self.name, &invitation, &at[0], PEOPLE[k])),
        }
        for other in (0..3).filter(|other| *other != k && (k == 0 || *other != 0)) {
            args.extend(["--connect", &at[other]]);
        }
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &format!("{}-{k}", self.switch.0)]);
        command.arg(env!("CARGO_BIN_EXE_sculptd")).args(args);
        Daemon::of(home, command)
    }
}

pub(super) fn link(home: &Path) -> Option<(Value, Value)> {
    let reply = ask(home, "people", "{}").ok()?;
    Some((reply["link"].clone(), reply["own_input"].clone()))
}

/// One hosts, the others follow, and all see the ball.
pub(super) fn together(table: &Table, people: &[Daemon], after: &str) {
    let are_together = comes(|| {
        let state = |d: &Daemon| Some(link(d.home.path())?.0["state"].as_str()?.to_owned());
        let mut states: Vec<_> = people.iter().filter_map(state).collect();
        states.sort_unstable();
        states == ["follows", "follows", "hosts"]
    });
    let told = |d: &Daemon| {
        let told = d.told.lock().expect("no panic");
        let last = told.iter().rev().take(20).rev().cloned().collect::<Vec<_>>().join("\n");
        format!("{:?}\n{last}", link(d.home.path()))
    };
    let name = &table.name;
    let all = || people.iter().map(told).collect::<Vec<_>>().join("\n\n");
    assert!(are_together, "{name}: not together after: {after}:\n{}", all());
    // A newcomer sees the whole ball (radius 1) after the first command.
    until(&format!("{}: all see the ball after: {after}", table.name), || {
        let view = |d: &Daemon| ask(d.home.path(), "camera", "{}").ok()?["distance"].as_f64();
        people.iter().all(|d| view(d).is_some_and(|distance| distance < 20.0))
    });
}

//! Processes that share a sculpture over Zenoh on the loopback: strokes of both, one hash; a
//! viewer; a wrong key; the host killed.

use std::path::Path;

use crate::daemon_process::{Daemon, free_endpoint};
use crate::waiting::{comes, until};

impl Daemon {
    fn hash(&self) -> Option<String> {
        self.ctl("hash", None)?["hash"].as_str().map(String::from)
    }

    fn stroke(&self, y: f32) {
        let at = |k: i32| format!("[{},{y},0.7,{}]", 0.4 + 0.01 * k as f32, k * 10);
        let points: Vec<String> = (0..20).map(at).collect();
        let params = format!(r#"{{"space":"view","points":[{}]}}"#, points.join(","));
        let made = self.ctl("stroke", Some(&params));
        assert!(made.is_some(), "{:?}", self.told.lock().expect("no panic"));
    }

    fn follows(&self, other: &Daemon, not: &str) {
        until("both have the same clay, and other clay than before", || {
            let (a, b) = (self.hash(), other.hash());
            a.is_some() && a == b && a.as_deref() != Some(not)
        });
    }
}

fn join<'a>(name: &'a str, key: &'a str, at: &'a str, person: &'a str) -> Vec<&'a str> {
    vec!["--join", name, "--key", key, "--connect", at, "--as", person]
}

fn key(keys: &Path, role: &str) -> String {
    keys.join(format!("{role}.key")).display().to_string()
}

#[test]
fn processors_with_and_without_vector_code_have_one_sculpture() {
    let folder = tempfile::tempdir().expect("a folder");
    let (keys, at) = (folder.path().join("keys"), free_endpoint());
    let keys_text = keys.display().to_string();
    let name = format!("processors-{}", std::process::id());
    let host =
        Daemon::run(&["--host", &name, "--keys", &keys_text, "--listen", &at, "--as", "Ada"]);
    until("the host answers", || host.hash().is_some());
    let sculptor = key(&keys, "sculptor");
    let mut plain = join(&name, &sculptor, &at, "Bob");
    plain.push("--portable");
    let plain = Daemon::run(&plain);
    until("Bob is there", || plain.hash().is_some());
    plain.follows(&host, "");
    let brushes =
        ["draw", "clay", "clay-strips", "smooth", "crease", "inflate", "grab", "texture", "twist"];
    for (i, kind) in brushes.into_iter().enumerate() {
        for (n, by) in [&host, &plain].into_iter().enumerate() {
            let before = host.hash().expect("a hash");
            let brush = format!(r#"{{"kind":"{kind}"}}"#);
            assert!(by.ctl("brush", Some(&brush)).is_some(), "{kind}");
            by.stroke(0.4 + 0.02 * i as f32 + 0.01 * n as f32);
            plain.follows(&host, &before);
        }
    }
    for one in [&host, &plain] {
        assert!(!one.has_told("differs"), "{:?}", one.told.lock().expect("no panic"));
    }
}

#[test]
fn two_processes_have_one_sculpture_and_one_goes_on_when_the_other_is_killed() {
    let folder = tempfile::tempdir().expect("a folder");
    let (keys, at) = (folder.path().join("keys"), free_endpoint());
    let keys_text = keys.display().to_string();
    // Others on the network may run this test too.
    let dragon = format!("dragon-{}", std::process::id());
    let host = ["--host", &dragon, "--keys", &keys_text, "--listen", &at, "--as", "Ada"];
    let mut ada = Daemon::run(&host);
    until("the host answers", || ada.hash().is_some());
    ada.stroke(0.45);
    let sculptor = key(&keys, "sculptor");
    let bob = Daemon::run(&join(&dragon, &sculptor, &at, "Bob"));
    until("Bob is there", || bob.hash().is_some());
    bob.follows(&ada, "");
    let before = ada.hash().expect("a hash");
    bob.stroke(0.5);
    bob.follows(&ada, &before);
    let before = ada.hash().expect("a hash");
    ada.stroke(0.55);
    bob.follows(&ada, &before);
    assert!(ada.has_told("'Bob' joins as sculptor"));

    // A viewer sees, a stranger does not.
    let viewer = key(&keys, "viewer");
    let mut wall = join(&dragon, &viewer, &at, "Wall");
    wall.extend(["--role", "viewer"]);
    let wall = Daemon::run(&wall);
    until("the wall is there", || wall.hash().is_some());
    wall.follows(&ada, "");
    let bad = folder.path().join("bad.key");
    let text = format!("role = \"sculptor\"\nkey = \"{}\"\n", "07".repeat(32));
    sculptd_geometry::io::write_beside(&bad, |out| out.write_all(text.as_bytes()))
        .expect("written");
    let bad = bad.display().to_string();
    let mut eve = Daemon::run(&join(&dragon, &bad, &at, "Eve"));
    until("Eve is turned away", || eve.child.try_wait().expect("waited for").is_some());
    assert!(eve.has_told("the key is not one of this sculpture"));
    assert!(ada.has_told("was not let in: the key is not one of this sculpture"));

    // The host dies: Bob takes over, and goes on with what was there.
    let before = bob.hash().expect("a hash");
    ada.child.kill().expect("killed");
    until("Bob takes over", || bob.has_told("takes over as the host of turn 2"));
    assert_eq!(bob.hash().as_deref(), Some(&*before));
    bob.stroke(0.6);
    assert!(comes(|| bob.hash().is_some_and(|h| h != before)));
    bob.follows(&wall, &before);
}

/// The hash that a session's file gives.
fn replayed(file: &Path) -> Option<String> {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sculptd"));
    let out = command.args(["--json", "replay"]).arg(file).output().expect("runs");
    let reply: serde_json::Value = serde_json::from_slice(&out.stdout).ok()?;
    reply["hash"].as_str().map(String::from)
}

#[test]
fn everybody_has_a_file_that_gives_the_same_clay() {
    let folder = tempfile::tempdir().expect("a folder");
    let (keys, at) = (folder.path().join("keys"), free_endpoint());
    let keys_text = keys.display().to_string();
    let name = format!("files-{}", std::process::id());
    let file = |name: &str| folder.path().join(name);
    let text = |name: &str| file(name).display().to_string();
    let (ada_file, bob_file) = (text("ada.sculpt"), text("bob.sculpt"));
    let host = ["--host", &name, "--keys", &keys_text, "--listen", &at, "--as", "Ada"];
    let mut ada = Daemon::run(&[&host[..], &["--session", &ada_file]].concat());
    until("the host answers", || ada.hash().is_some());
    // Bob's file begins with this.
    ada.stroke(0.45);
    let sculptor = key(&keys, "sculptor");
    let bob_joins = [&join(&name, &sculptor, &at, "Bob")[..], &["--session", &bob_file]].concat();
    let mut bob = Daemon::run(&bob_joins);
    until("Bob is there", || bob.hash().is_some());
    bob.follows(&ada, "");
    for (n, by) in [&bob, &ada, &bob].into_iter().enumerate() {
        let before = ada.hash().expect("a hash");
        by.stroke(0.5 + 0.04 * n as f32);
        bob.follows(&ada, &before);
    }
    let clay = bob.hash();
    for daemon in [&mut bob, &mut ada] {
        daemon.ctl("shutdown", None);
        until("it has ended", || daemon.child.try_wait().expect("waited for").is_some());
    }
    assert_eq!(replayed(&file("ada.sculpt")), clay);
    assert_eq!(replayed(&file("bob.sculpt")), clay);

    // The file is Bob's own: it opens, and goes on alone.
    let alone = Daemon::run(&["--session", &bob_file]);
    until("Bob goes on alone", || alone.hash() == clay);
    alone.stroke(0.7);
    until("the clay is other clay", || alone.hash() != clay);
    // Nobody joins into a file that is there.
    let mut again = Daemon::run(&bob_joins);
    until("it is refused", || again.child.try_wait().expect("waited for").is_some());
    assert!(again.has_told("name a file that is not there"));
}

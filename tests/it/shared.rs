//! Processes that share a sculpture over Zenoh on the loopback: strokes of both, one hash; a
//! viewer; a wrong key; the host killed; invitations as links; who is here, and undo of one's own.

use std::path::Path;

use std::process::{Command, Output, Stdio};

use serde_json::Value;

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
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    let out = command.args(["--json", "replay"]).arg(file).output().expect("runs");
    let reply: Value = serde_json::from_slice(&out.stdout).ok()?;
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
    // Joining into an existing file fails.
    let mut again = Daemon::run(&bob_joins);
    until("it is refused", || again.child.try_wait().expect("waited for").is_some());
    assert!(again.has_told("name a file that is not there"));
}

/// Runs `sculptd` with these arguments, in a separate home folder, with a text on standard input.
fn sculptd(home: &Path, args: &[&str], input: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.args(args).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    for name in ["XDG_RUNTIME_DIR", "XDG_DATA_HOME", "XDG_STATE_HOME", "HOME"] {
        command.env(name, home);
    }
    let mut child = command.spawn().expect("runs");
    let mut stdin = child.stdin.take().expect("piped");
    std::io::Write::write_all(&mut stdin, input.as_bytes()).expect("written");
    drop(stdin);
    child.wait_with_output().expect("ends")
}

/// The invitation that `sculptd invite` prints.
fn invite(home: &Path, args: &[&str]) -> Value {
    let out = sculptd(home, &[&["--json", "invite"], args].concat(), "");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).expect("JSON")
}

#[test]
fn guests_join_by_a_link_see_each_other_and_take_back_their_own_steps() {
    let folder = tempfile::tempdir().expect("a folder");
    let (keys, at) = (folder.path().join("keys").display().to_string(), free_endpoint());
    let dragon = format!("links-{}", std::process::id());
    let of = ["--keys", &keys, "--connect", &at];
    // Before the host is started, so that it knows Bob's key.
    let bobs = invite(folder.path(), &[&[&*dragon, "--as", "Bob"][..], &of].concat());
    assert_eq!((&bobs["role"], &bobs["person"]), (&"sculptor".into(), &"Bob".into()));
    let link = bobs["link"].as_str().expect("a link");
    let again = invite(folder.path(), &[&[&*dragon, "--as", "Bob"][..], &of].concat());
    assert_eq!(again["link"], bobs["link"], "the same invitation");
    let host = ["--host", &dragon, "--keys", &keys, "--listen", &at, "--as", "Ada"];
    let ada = Daemon::run(&host);
    until("the host answers", || ada.hash().is_some());
    let bob = Daemon::run(&["--join", link]);
    until("Bob is there", || bob.hash().is_some());
    let wall = invite(folder.path(), &[&[&*dragon, "--role", "viewer"][..], &of].concat());
    let wall = Daemon::run(&["--join", wall["link"].as_str().expect("a link"), "--as", "Wall"]);
    until("the wall is there", || wall.hash().is_some());
    let people = |of: &Daemon| of.ctl("people", None).expect("an answer");
    let listed = |of: &Daemon| {
        let list = people(of)["people"].as_array().cloned().unwrap_or_default();
        let text = |p: &Value| {
            let field = |name: &str| p[name].as_str().unwrap_or_default().to_owned();
            format!("{} {} {}", field("name"), field("role"), p["here"])
        };
        list.iter().map(text).collect::<Vec<_>>()
    };
    let all = ["Ada sculptor true", "Bob sculptor true", "Wall viewer true"];
    for one in [&ada, &bob, &wall] {
        until("all three are listed", || listed(one) == all);
    }
    assert_eq!(people(&bob)["own"], 2);
    let colours = people(&ada)["people"]
        .as_array()
        .map(|p| p.iter().map(|p| p["colour"].clone()).collect::<Vec<_>>());
    assert_eq!(
        colours,
        people(&wall)["people"].as_array().map(|p| p.iter().map(|p| p["colour"].clone()).collect())
    );

    // Bob can undo Bob's step, although Ada has sculpted elsewhere since.
    let begin = ada.hash().expect("a hash");
    bob.stroke(0.35);
    bob.follows(&ada, &begin);
    let before = ada.hash().expect("a hash");
    ada.stroke(0.68);
    bob.follows(&ada, &before);
    let both = ada.hash().expect("a hash");
    bob.ctl("undo", None).expect("sent");
    bob.follows(&ada, &both);
    let adas = ada.hash().expect("a hash");
    assert!(adas != begin && adas != before);
    bob.ctl("redo", None).expect("sent");
    until("it is done again", || bob.hash().as_deref() == Some(&*both));
    bob.follows(&ada, &adas);
    // If Ada sculpts over it, Bob's undo is refused.
    ada.stroke(0.35);
    bob.follows(&ada, &both);
    let over = ada.hash().expect("a hash");
    bob.ctl("undo", None).expect("sent");
    until("Bob is told whose step is in the way", || people(&bob)["undo_refused"]["by"] == 1);
    assert_eq!((bob.hash(), ada.hash()), (Some(over.clone()), Some(over)));

    // Bob goes.
    drop(bob);
    until("Bob is gone", || listed(&ada).get(1).is_some_and(|b| b == "Bob sculptor false"));
    // Nobody has printed a key.
    let key = &link[link.find("key=").expect("a key") + 4..][..64];
    for one in [&ada, &wall] {
        assert!(!one.has_told(key));
    }
}

#[test]
fn a_broken_link_is_refused_by_what_is_wrong_and_nothing_of_it_is_shown() {
    let home = tempfile::tempdir().expect("a folder");
    let keys = home.path().join("keys").display().to_string();
    let told = invite(home.path(), &["dragon", "--keys", &keys]);
    let link = told["link"].as_str().expect("a link");
    let key = &link[link.find("key=").expect("a key") + 4..][..64];
    let run = |args: &[&str], input: &str| {
        let out = sculptd(home.path(), &[&["run", "--headless"], args].concat(), input);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(!said.contains(&key[..16]), "{said}");
        (out.status.code(), said)
    };
    let cut = &link[..link.find(&key[40..]).expect("there")];
    let king = link.replace("role=sculptor", "role=king");
    let broken = [
        (cut, "expected key= and 64 hexadecimal digits"),
        (&king, "expected role=sculptor, role=viewer or role=device"),
        ("https://join/dragon?key=00", "expected a link that begins with sculptd://join/"),
    ];
    for (link, why) in broken {
        for (args, input) in [(["--join", link], ""), (["--join", "-"], link)] {
            let (code, said) = run(&args, input);
            assert_eq!(code, Some(2), "{said}");
            assert!(said.contains(why), "{said}");
        }
    }
    let file = home.path().join("keys/sculptor.key").display().to_string();
    assert_eq!(run(&["--join", link, "--key", &file], "").0, Some(2), "two keys");
    assert_eq!(run(&["--join", "dragon"], "").0, Some(2), "no key");
    assert_eq!(run(&["--join", "dra gon", "--key", &file], "").0, Some(2), "no name");
    let (code, said) = run(&["--join", "dragon", "--key", "nothing.key"], "");
    assert_eq!(code, Some(3), "{said}");

    // The code as files; of another kind there is none.
    for (name, head) in [("code.svg", &b"<svg"[..]), ("code.png", b"\x89PNG")] {
        let path = home.path().join(name);
        let file = path.display().to_string();
        let told = invite(home.path(), &["dragon", "--keys", &keys, "-o", &file]);
        assert_eq!((&told["link"], &told["file"]), (&link.into(), &file.clone().into()));
        assert!(std::fs::read(&path).expect("written").starts_with(head));
        #[cfg(unix)]
        {
            let mode = std::fs::metadata(&path).expect("there").permissions();
            assert_eq!(std::os::unix::fs::PermissionsExt::mode(&mode) & 0o077, 0, "for the owner");
        }
    }
    let bad: [&[&str]; 4] = [
        &["dragon", "-o", "code.gif"],
        &["dra/gon"],
        &["dragon", "--connect", "studio"],
        &["dragon", "--role", "king"],
    ];
    for args in bad {
        let out = sculptd(home.path(), &[&["invite"], args].concat(), "");
        assert_eq!(out.status.code(), Some(2), "{args:?}");
    }
    // Without --json: the link alone, where nobody looks at a terminal.
    let out = sculptd(home.path(), &["invite", "dragon", "--keys", &keys], "");
    assert_eq!(String::from_utf8_lossy(&out.stdout).trim(), link);
}

//! Processes that share a sculpture over Zenoh on the loopback: strokes of both, one hash; a
//! viewer; a wrong key; the host killed; invitations as links; who is here, and undo of one's own.

use std::path::Path;

use std::process::{Command, Output, Stdio};

use sculptd_control::client::call;
use serde_json::{Value, json};

use crate::daemon_process::{Daemon, free_endpoint};
use crate::seeded::Random;
use crate::waiting::{PATIENCE, comes, until};

mod answers;
mod computers;
mod faults;
mod meanwhile;

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
    let text = std::fs::read_to_string(keys.join("sculptor.key")).expect("an invitation");
    let line = text.lines().find(|l| l.starts_with("key = ")).expect("a key");
    let text = text.replace(line, &format!("key = \"{}\"", "07".repeat(32)));
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

/// Sends a request: its reply, or the reason for its refusal.
fn ask(home: &Path, method: &str, params: &str) -> Result<Value, String> {
    let params = serde_json::from_str(params).expect("JSON");
    let reply = call(&home.join("sculptd.sock"), method, &params, PATIENCE);
    reply.map_err(|e| e.to_string())
}

const STROKE: &str =
    r#"{"space":"view","points":[[0.45,0.5,0.7,0],[0.5,0.5,0.7,80],[0.55,0.5,0.7,160]]}"#;

fn link_of(of: &Daemon) -> Value {
    ask(of.home.path(), "people", "{}").expect("people")["link"].clone()
}

#[test]
fn what_a_daemon_answers_is_so_for_a_viewer_and_for_who_is_withdrawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let keys = folder.path().join("keys");
    let (keys_text, at) = (keys.display().to_string(), free_endpoint());
    let name = format!("truth-{}", std::process::id());
    let host = ["--host", &*name, "--keys", &keys_text, "--listen", &at, "--as", "Ada"];
    let mut ada = Daemon::run(&host);
    until("the host answers", || ada.hash().is_some());
    // Invited while the host runs.
    let bobs =
        invite(folder.path(), &[&*name, "--as", "Bob", "--keys", &keys_text, "--connect", &at]);
    let file = folder.path().join("bob.sculpt");
    let file_text = file.display().to_string();
    let link = bobs["link"].as_str().expect("a link");
    let mut bob = Daemon::run(&["--join", link, "--session", &file_text]);
    until("Bob is there", || bob.hash().is_some());
    // The invitation says the role.
    let viewer = key(&keys, "viewer");
    let wall = Daemon::run(&join(&name, &viewer, &at, "Wall"));
    until("the wall is there", || wall.hash().is_some());
    for (method, params) in
        [("stroke", STROKE), ("layers.add", "{}"), ("undo", "{}"), ("brush", r#"{"radius":0.1}"#)]
    {
        let why = ask(wall.home.path(), method, params).expect_err(method);
        assert!(why.contains("a viewer of a shared sculpture changes nothing"), "{method}: {why}");
    }
    assert_eq!(link_of(&ada)["state"], "hosts");
    until("Bob follows Ada", || {
        let link = link_of(&bob);
        link["state"] == "follows" && link["host"] == "Ada" && link["waiting"] == 0
    });
    // An answered stroke is in everybody's order: the host has it as soon as it hears of it.
    let before = ada.hash().expect("a hash");
    ask(bob.home.path(), "stroke", STROKE).expect("made");
    assert_ne!(bob.hash().as_deref(), Some(&*before), "it is made when the answer comes");
    bob.follows(&ada, &before);
    let both = ada.hash().expect("a hash");

    // Bob is withdrawn: he gets the reason, goes on alone, keeps that, and the exit code is 1.
    let out =
        sculptd(folder.path(), &["invite", &name, "--withdraw", "Bob", "--keys", &keys_text], "");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    until("Bob is sent away", || link_of(&bob)["state"] == "sent-away");
    assert!(link_of(&bob)["reason"].as_str().is_some_and(|r| r.contains("withdrawn")));
    ask(bob.home.path(), "stroke", &STROKE.replace("0.5,0.7", "0.4,0.7")).expect("made alone");
    let alone = bob.hash().expect("a hash");
    assert_ne!(alone, both, "he goes on alone");
    assert_eq!(ada.hash(), Some(both));
    assert_eq!(
        ask(bob.home.path(), "status", "{}").expect("status")["shared"]["state"],
        "sent-away"
    );
    assert_eq!(end(&mut bob), Some(1));
    assert!(bob.has_told("was sent away: the invitation was withdrawn"));
    assert_eq!(replayed(&file), Some(alone), "his own file has it");
    let mut again = Daemon::run(&["--join", link]);
    until("Bob is turned away", || again.child.try_wait().expect("waited for").is_some());
    assert!(again.has_told("was withdrawn"), "{:?}", again.told.lock().expect("no panic"));
    assert_eq!(end(&mut ada), Some(0));
}

#[test]
fn the_same_command_again_joins_the_sculpture_that_is_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let keys = folder.path().join("keys");
    let (keys_text, at) = (keys.display().to_string(), free_endpoint());
    let name = format!("again-{}", std::process::id());
    let host = ["--host", &*name, "--keys", &keys_text, "--listen", &at, "--as", "Ada"];
    let mut ada = Daemon::run(&host);
    until("the host answers", || ada.hash().is_some());
    let at_bob = free_endpoint();
    let sculptor = key(&keys, "sculptor");
    let mut of_bob = join(&name, &sculptor, &at, "Bob");
    of_bob.extend(["--listen", &at_bob]);
    let bob = Daemon::run(&of_bob);
    until("Bob is there", || bob.hash().is_some());
    ask(bob.home.path(), "stroke", STROKE).expect("made");
    bob.follows(&ada, "");
    ada.child.kill().expect("killed");
    until("Bob takes over", || link_of(&bob)["state"] == "hosts");
    ask(bob.home.path(), "stroke", &STROKE.replace("0.5,0.7", "0.4,0.7")).expect("made");
    let mut again = host.to_vec();
    again.extend(["--connect", &at_bob]);
    let ada = Daemon::run(&again);
    until("Ada is back", || ada.hash().is_some());
    assert!(ada.has_told("is shared already"), "{:?}", ada.told.lock().expect("no panic"));
    ada.follows(&bob, "");
    assert_eq!(
        (&link_of(&ada)["state"], &link_of(&ada)["host"]),
        (&"follows".into(), &"Bob".into())
    );
    // Another owner of the name, who cannot know whose word to believe, has another sculpture.
    let other = folder.path().join("other").display().to_string();
    let others = ["--host", &*name, "--keys", &other, "--connect", &at_bob, "--as", "Eve"];
    let eve = Daemon::run(&others);
    until("Eve hosts", || {
        let people = ask(eve.home.path(), "people", "{}");
        people.is_ok_and(|p| p["link"]["state"] == "hosts")
    });
    assert_ne!(link_of(&eve)["sculpture"], link_of(&ada)["sculpture"]);
    assert_eq!(link_of(&ada)["host"], "Bob");
}

/// Ends a daemon as a person does; its exit code.
fn end(daemon: &mut Daemon) -> Option<i32> {
    ask(daemon.home.path(), "shutdown", "{}").expect("it ends");
    let mut code = None;
    until("it has ended", || {
        code = daemon.child.try_wait().expect("waited for");
        code.is_some()
    });
    code.and_then(|status| status.code())
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
    let why = ask(bob.home.path(), "undo", "{}").expect_err("Ada's step is in the way");
    assert!(why.contains("somebody else changed the same place since"), "{why}");
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
    let digit = if key.starts_with('0') { "1" } else { "0" };
    let wrong = link.replacen(key, &format!("{digit}{}", &key[1..]), 1);
    let broken = [
        (cut, "copy the link as a whole"),
        (&king, "copy the link as a whole"),
        (&wrong, "copy the link as a whole"),
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

/// One of the commands that change a sculpture, with parameters that mean something mostly.
fn any_command(r: &mut Random, home: &Path, file: &Path) -> (&'static str, Value) {
    let of_list = |method: &str, list: &str| {
        let reply = ask(home, method, "{}").unwrap_or_default();
        let all = reply[list].as_array().cloned().unwrap_or_default();
        all.into_iter().map(|o| o["id"].clone()).collect::<Vec<_>>()
    };
    let objects = of_list("scene.list", "objects");
    let one = objects.get(r.below(objects.len().max(1) as u64) as usize).cloned();
    let other = objects.get(r.below(objects.len().max(1) as u64) as usize).cloned();
    let layer = of_list("layers.list", "layers").pop().unwrap_or(json!(0));
    let (x, y) = (0.4 + 0.1 * r.part(), 0.4 + 0.2 * r.part());
    match r.below(20) {
        0..4 => {
            ("stroke", json!({ "space": "view", "points": [[x, y, 1, 0], [x + 0.1, y, 1, 60]] }))
        }
        4 => ("undo", json!({})),
        5 => ("redo", json!({})),
        6 => ("brush", json!({ "radius": 0.1 + 0.3 * r.part(), "kind": r.of(&["draw", "clay"]) })),
        7 => ("mask", json!({ "action": r.of(&["clear", "fill", "invert"]) })),
        8 => ("mask-region", json!({ "region": { "box": [0.3, 0.3, 0.6, 0.6] }, "mask": 0.7 })),
        9 => ("camera", json!({ "yaw": 3.0 * r.part() })),
        10 => ("remesh", json!({ "voxel": 0.06 + 0.05 * r.part() })),
        11 => ("decimate", json!({ "triangles": 1500 })),
        12 => ("trim", json!({ "part": { "box": [0.0, 0.0, 0.4, 1.0] } })),
        13 => {
            ("boolean", json!({ "operation": "union", "path": file, "at": [r.part(), 0.9, 0.0] }))
        }
        14 => ("scene.add", json!({ "primitive": { "ball": 0.4 }, "edge": 0.1 })),
        15 => ("scene.mirror", json!({ "id": one, "axis": "x" })),
        16 => ("scene.boolean", json!({ "operation": "union", "a": one, "b": other })),
        17 => ("layers.add", json!({})),
        18 => ("layers.set", json!({ "layer": layer, "intensity": r.part() })),
        _ => ("load", json!({ "path": file })),
    }
}

/// After each command of each person all have one clay, and in the end every file gives it,
/// replayed and opened. `SCULPTD_SHARED_STEPS`: how many commands.
#[test]
fn every_command_of_each_gives_one_clay_here_there_and_in_every_file() {
    let steps = std::env::var("SCULPTD_SHARED_STEPS").ok().and_then(|t| t.parse().ok());
    let folder = tempfile::tempdir().expect("a folder");
    let keys = folder.path().join("keys");
    let (keys_text, at) = (keys.display().to_string(), free_endpoint());
    let name = format!("commands-{}", std::process::id());
    let small = folder.path().join("small.ply");
    let ball = sculptd_geometry::shapes::sphere_of_about(800);
    sculptd_geometry::io::write_mesh(&small, &ball.to_poly()).expect("written");
    let files = ["ada", "bob"].map(|who| folder.path().join(format!("{who}.sculpt")));
    let texts = files.each_ref().map(|f| f.display().to_string());
    let host = ["--host", &*name, "--keys", &keys_text, "--listen", &at, "--as", "Ada"];
    let mut ada = Daemon::run(&[&host[..], &["--session", &texts[0]]].concat());
    until("the host answers", || ada.hash().is_some());
    ask(ada.home.path(), "load", &json!({ "path": small }).to_string()).expect("loaded");
    let sculptor = key(&keys, "sculptor");
    let of_bob = [&join(&name, &sculptor, &at, "Bob")[..], &["--session", &texts[1]]].concat();
    let mut bob = Daemon::run(&of_bob);
    until("Bob is there", || bob.hash().is_some());
    let mut r = Random(0x9e37_79b9_7f4a_7c15);
    let mut refused = 0;
    let steps = steps.unwrap_or(24);
    for step in 0..steps {
        let by = if r.below(2) == 0 { &ada } else { &bob };
        let (method, params) = any_command(&mut r, by.home.path(), &small);
        let done = ask(by.home.path(), method, &params.to_string());
        refused += usize::from(done.is_err());
        until(&format!("step {step}, {method} {params}: one clay ({done:?})"), || {
            let (a, b) = (ada.hash(), bob.hash());
            a.is_some() && a == b
        });
    }
    assert!(refused < steps / 2, "{refused} of {steps} commands were refused");
    let clay = ada.hash();
    for daemon in [&mut bob, &mut ada] {
        assert_eq!(end(daemon), Some(0), "{:?}", daemon.told.lock().expect("no panic"));
    }
    for (file, text) in files.iter().zip(&texts) {
        assert_eq!(replayed(file), clay, "replay of {text}");
        let again = Daemon::run(&["--session", text]);
        until("it opens", || again.hash().is_some());
        assert_eq!(again.hash(), clay, "{text}, opened");
    }
}

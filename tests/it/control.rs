//! The control socket keeps everybody else out, and everything within its limits.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::daemon_process::Daemon;
use crate::waiting::{PATIENCE, until};
use arc_swap::ArcSwap;
use sculptd_clay::Clay;
use sculptd_control::METHODS;
use sculptd_daemon::command_queue::{CommandAnswer, QueuedCommand, command_queue};
use sculptd_daemon::config::Config;
use sculptd_daemon::control::handler::call as answer;
use sculptd_daemon::control::server::{Server, permitted};
use sculptd_daemon::control::stroke::VirtualPen;
use sculptd_daemon::control::{Host, MAX_CLIENTS, MAX_DEPTH, MAX_MESSAGE, MAX_RATE, PROTOCOL};
use sculptd_daemon::live::Live;
use sculptd_daemon::published::{Published, PublishedFigures};
use sculptd_daemon::session::Health;
use sculptd_daemon::startup;
use sculptd_daemon::tick::Journal;
use sculptd_devices::{Clock, queue};
use sculptd_engine::answer::Answer;
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;
use serde_json::{Value, json};

struct Rig {
    host: Host,
    commands: crossbeam_channel::Receiver<QueuedCommand>,
    dir: tempfile::TempDir,
}

impl Rig {
    fn new() -> Self {
        let config = Config {
            r#loop: sculptd_daemon::config::LoopConfig { workers: 1, ..Default::default() },
            ..Default::default()
        };
        let mesh = Clay::build(&shapes::sphere_of_about(300), &Job::default()).expect("a ball");
        let mut world = startup::world(mesh, &config);
        let published = Published::of(&mut world, PublishedFigures::default());
        let (sender, commands) = command_queue(4096);
        let shown = Arc::new(ArcSwap::from_pointee(published));
        let host = Host::new(sender, shown, sculptd::presets().clone());
        Rig { host, commands, dir: tempfile::tempdir().expect("a folder") }
    }

    fn serve(&self) -> (Server, PathBuf) {
        let path = self.dir.path().join("s.sock");
        (Server::start(&path, self.host.clone()).expect("listens"), path)
    }
}

struct Client {
    out: UnixStream,
    lines: BufReader<UnixStream>,
}

impl Client {
    fn new(path: &Path) -> Self {
        let out = UnixStream::connect(path).expect("connects");
        out.set_read_timeout(Some(PATIENCE)).expect("set");
        let lines = BufReader::new(out.try_clone().expect("cloned"));
        Client { out, lines }
    }

    /// The next answer; `None` once the daemon has closed.
    fn read_reply(&mut self) -> Option<Value> {
        let mut line = String::new();
        match self.lines.read_line(&mut line) {
            Ok(0) | Err(_) => None,
            Ok(_) => Some(serde_json::from_str(&line).expect("JSON")),
        }
    }

    fn ask(&mut self, line: &str) -> Option<Value> {
        let _ = self.out.write_all(format!("{line}\n").as_bytes());
        self.read_reply()
    }

    fn status(&mut self, params: &Value) -> Value {
        let line =
            json!({ "jsonrpc": "2.0", "id": 7, "method": "status", "params": params }).to_string();
        self.ask(&line).expect("an answer")
    }
}

#[test]
fn another_user_is_refused() {
    assert!(permitted(1000, 1000) && permitted(0, 1000));
    assert!(!permitted(1001, 1000) && !permitted(65534, 0) && !permitted(1000, 0));
    // And in truth, where this test may become somebody else.
    use std::os::unix::fs::PermissionsExt;
    use std::os::unix::process::CommandExt;
    let rig = Rig::new();
    let (_server, path) = rig.serve();
    assert_eq!(std::fs::metadata(&path).expect("there").permissions().mode() & 0o777, 0o600);
    let program = rig.dir.path().join("sculptd");
    std::fs::copy(env!("CARGO_BIN_EXE_sculptd"), &program).expect("copied");
    let ask = || {
        let mut command = std::process::Command::new(&program);
        command
            .args(["ctl", "status", "--socket"])
            .arg(&path)
            .current_dir("/")
            .uid(65534)
            .gid(65534);
        command.output()
    };
    if std::fs::set_permissions(rig.dir.path(), std::fs::Permissions::from_mode(0o755)).is_err()
        || ask().is_err()
    {
        println!("skipped in part: this user may not become another");
        return;
    }
    // The file's mode keeps them out,
    let out = ask().expect("runs");
    assert_eq!(out.status.code(), Some(5), "{}", String::from_utf8_lossy(&out.stderr));
    // and if somebody opens it, the kernel's word on who asks.
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o666)).expect("set");
    let out = ask().expect("runs");
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.code() == Some(1) && said.contains("another user"), "{said}");
    assert!(Client::new(&path).status(&json!({}))["result"].is_object());
}

#[test]
fn an_oversized_message_ends_the_talk_and_deep_nesting_does_not() {
    let rig = Rig::new();
    let (_server, path) = rig.serve();
    let mut client = Client::new(&path);
    let deep = format!(
        r#"{{"jsonrpc":"2.0","id":1,"method":"status","params":{}1{}}}"#,
        "[".repeat(MAX_DEPTH),
        "]".repeat(MAX_DEPTH)
    );
    let refused = client.ask(&deep).expect("an answer");
    assert!(refused["error"]["message"].as_str().is_some_and(|m| m.contains("deep")), "{refused}");
    let very = format!("{}{}", "[".repeat(MAX_MESSAGE / 2 - 1), "]".repeat(MAX_MESSAGE / 2 - 1));
    assert_eq!(client.ask(&very).expect("an answer")["error"]["code"], -32600);
    assert!(client.status(&json!({}))["result"].is_object(), "the talk goes on");
    let refused = client.ask(&"x".repeat(MAX_MESSAGE * 4)).expect("an answer");
    assert!(refused["error"]["message"].as_str().is_some_and(|m| m.contains("bytes")), "{refused}");
    assert_eq!(client.read_reply(), None, "and is closed");
    assert!(Client::new(&path).status(&json!({}))["result"].is_object(), "others are served");
}

#[test]
fn a_wrong_version_is_refused_with_both_numbers() {
    let rig = Rig::new();
    let (_server, path) = rig.serve();
    let mut client = Client::new(&path);
    let refused = client.status(&json!({ "version": PROTOCOL + 1 }));
    assert_eq!(refused["error"]["code"], -32002);
    let said = refused["error"]["message"].as_str().expect("words");
    assert!(
        said.contains(&PROTOCOL.to_string()) && said.contains(&(PROTOCOL + 1).to_string()),
        "{said}"
    );
    assert_eq!(client.status(&json!({ "version": PROTOCOL }))["result"]["protocol"], PROTOCOL);
}

#[test]
fn requests_and_clients_are_counted() {
    let rig = Rig::new();
    let (_server, path) = rig.serve();
    let mut client = Client::new(&path);
    // All at once, so that no slow machine stretches them over more than a second each.
    let line = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"hash\"}\n";
    client.out.write_all(line.repeat(4 * MAX_RATE as usize).as_bytes()).expect("sent");
    let answers = (0..4 * MAX_RATE).map(|_| client.read_reply().expect("an answer"));
    let slow: Vec<Value> = answers.filter(|a| a["error"]["code"] == -32001).collect();
    assert!(!slow.is_empty(), "a flood was served");
    assert!(slow.iter().all(|a| a["id"] == 1), "an error carries the request's id");
}

/// "Done" is said once not even a kill takes it back.
#[test]
fn a_reply_waits_until_its_input_outlives_a_kill() {
    let mut rig = Rig::new();
    let health = Health::default();
    health.handed.store(5, std::sync::atomic::Ordering::SeqCst);
    rig.host.journal = Some(health.clone());
    let (_server, path) = rig.serve();
    let status = r#"{"jsonrpc":"2.0","id":1,"method":"hash"}"#;
    let (told, answered) = crossbeam_channel::bounded(1);
    let asking = std::thread::spawn(move || {
        let mut client = Client::new(&path);
        let _ = told.send(client.ask(status).is_some());
    });
    assert!(answered.recv_timeout(Duration::from_millis(60)).is_err(), "answered too early");
    health.safe.store(5, std::sync::atomic::Ordering::SeqCst);
    assert_eq!(answered.recv_timeout(PATIENCE), Ok(true));
    asking.join().expect("no panic");
    // A journal that takes nothing holds nobody up for long.
    health.handed.store(6, std::sync::atomic::Ordering::SeqCst);
    assert!(!health.wait_until_safe());
    health.safe.store(7, std::sync::atomic::Ordering::SeqCst);
    assert!(health.wait_until_safe());
}

/// A refused request does nothing, and `methods` lists what the table has.
#[test]
fn every_method_refuses_what_it_does_not_know() {
    let rig = Rig::new();
    for method in METHODS {
        let name = method.name;
        let e = answer(&rig.host, name, json!({ "no such parameter": 1 })).expect_err(name);
        assert_eq!(e.code, -32602, "{name}: {}", e.message);
    }
    assert!(rig.commands.is_empty(), "a refused request sent a command");
    assert!(!rig.host.stop.load(std::sync::atomic::Ordering::Relaxed));
    assert_eq!(answer(&rig.host, "frobnicate", Value::Null).expect_err("unknown").code, -32601);
    let listed = answer(&rig.host, "methods", Value::Null).expect("a list");
    assert_eq!(listed.as_object().map(|o| o.len()), Some(METHODS.len()));
}

/// The types of the protocol have every setting of the brush and the camera, and lose none.
#[test]
fn settings_come_back_as_they_are() {
    let rig = Rig::new();
    // In the place of the loop: every command is carried out.
    let commands = rig.commands.clone();
    std::thread::spawn(move || {
        for queued in commands {
            let done = CommandAnswer { tick: 1, result: Ok(Answer::Done) };
            queued.answer.into_iter().for_each(|answer| {
                let _ = answer.try_send(done);
            });
        }
    });
    let shown = rig.host.published.load_full();
    assert_eq!(answer(&rig.host, "brush", json!({})).expect("settings"), json!(shown.brush));
    assert_eq!(answer(&rig.host, "camera", json!({})).expect("settings"), json!(shown.camera));
    let wider = answer(&rig.host, "brush", json!({ "radius": 0.5, "tilt": 1 })).expect("settings");
    assert_eq!((&wider["radius"], &wider["tilt"]), (&json!(0.5), &json!(1.0)));
    for (params, named) in [
        (json!({ "radius": 1e308 }), "radius = 1e+308"),
        (json!({ "radius": 2 }), "brush.radius = 2"),
        (json!({ "spacing": 0 }), "brush.spacing"),
        (json!({ "tilt": -3 }), "brush.tilt"),
        (json!({ "colour": [1, 2, 3, 256] }), "256"),
        (json!({ "kind": "broom" }), "broom"),
    ] {
        let e = answer(&rig.host, "brush", params.clone()).expect_err(&params.to_string());
        assert!(e.code == -32602 && e.message.contains(named), "{params}: {}", e.message);
    }
}

/// Numbers that no world can be made of: refused at the door by field, value and range.
#[test]
fn numbers_out_of_range_send_no_command() {
    let rig = Rig::new();
    for (method, params, named) in [
        ("camera", json!({ "target": [1e38, 0, 0] }), "target[0] = 1e+38"),
        ("camera", json!({ "distance": 1e38 }), "distance = 1e+38"),
        ("mask", json!({ "action": { "cavity": -1 } }), "action.cavity = -1"),
        (
            "boolean",
            json!({ "operation": "union", "path": "/none.stl", "at": [1e308, 0, 0] }),
            "at[0] = 1e+308",
        ),
        ("join", json!({ "operation": "ball" }), "ball"),
        ("thickness", json!({ "rays": 5000 }), "rays = 5000"),
    ] {
        let e = answer(&rig.host, method, params.clone()).expect_err(&params.to_string());
        assert!(e.code == -32602 && e.message.contains(named), "{params}: {}", e.message);
    }
    assert!(rig.commands.is_empty());
}

#[test]
fn only_regular_files_within_the_bound_are_loaded() {
    let rig = Rig::new();
    let sparse = rig.dir.path().join("sparse.stl");
    std::fs::File::create(&sparse).and_then(|f| f.set_len(2 << 30)).expect("made");
    let pipe = rig.dir.path().join("pipe.stl");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.is_ok_and(|s| s.success()), "mkfifo");
    let zero = PathBuf::from("/dev/zero");
    for path in [&sparse, &pipe, &zero] {
        for method in ["load", "take-up", "boolean", "picture"] {
            let params = match method {
                "boolean" => json!({ "operation": "union", "path": path }),
                _ => json!({ "path": path }),
            };
            let e = answer(&rig.host, method, params).expect_err("refused");
            let told = e.message.contains("regular file") || e.message.contains("at most");
            assert!(told, "{method} {}: {}", path.display(), e.message);
        }
    }
    assert!(rig.commands.is_empty());
}

#[test]
fn versions_are_agreed_on() {
    let rig = Rig::new();
    let hello = answer(&rig.host, "hello", json!({})).expect("a version");
    assert_eq!(hello["protocol"], PROTOCOL);
    let older = json!({ "versions": { "min": 0, "max": 1 } });
    assert_eq!(answer(&rig.host, "hello", older).expect("a version")["protocol"], 1);
    let newer = json!({ "versions": { "min": PROTOCOL + 1, "max": PROTOCOL + 9 } });
    let e = answer(&rig.host, "hello", newer).expect_err("refused");
    let all = [1, PROTOCOL, PROTOCOL + 1, PROTOCOL + 9].map(|v| v.to_string());
    assert!(e.code == -32002 && all.iter().all(|v| e.message.contains(v)), "{}", e.message);
}

/// Clients that connect and say nothing, or half a line, keep nobody out. Where each place is held
/// for good reason, a newcomer is told so, and the methods that end or cancel are answered.
#[test]
fn half_open_clients_keep_nobody_out() {
    let rig = Rig::new();
    let path = rig.dir.path().join("s.sock");
    let idle = Duration::from_millis(1500);
    let server = Server::start_with_idle(&path, rig.host.clone(), idle).expect("listens");
    let ask = |method: &str| {
        let line = format!(r#"{{"jsonrpc":"2.0","id":"me","method":"{method}"}}"#);
        Client::new(&path).ask(&line).expect("an answer")
    };
    let mut silent: Vec<Client> = (0..2 * MAX_CLIENTS).map(|_| Client::new(&path)).collect();
    silent[0].out.write_all(b"{\"jsonrpc\":").expect("sent");
    assert!(ask("status")["result"].is_object(), "who says nothing has no place");
    assert_eq!(silent[0].read_reply(), None, "half a line is not waited for");
    assert_eq!(silent[2].read_reply(), None, "nothing");
    // Subscribers may be silent.
    let subscribe = r#"{"jsonrpc":"2.0","id":1,"method":"subscribe"}"#;
    let mut subscribed: Vec<Client> = (0..MAX_CLIENTS).map(|_| Client::new(&path)).collect();
    for client in &mut subscribed {
        assert!(client.ask(subscribe).expect("an answer")["result"].is_object());
    }
    let full = ask("status");
    assert!(full["error"]["message"].as_str().is_some_and(|m| m.contains("too many")), "{full}");
    assert_eq!(full["id"], "me");
    assert_eq!(ask("cancel")["result"], json!({ "cancelled": false }));
    assert!(subscribed[1].status(&json!({}))["result"].is_object(), "the subscriber is served");
    subscribed.pop();
    until("there is room again", || ask("status")["result"].is_object());
    assert_eq!(ask("shutdown")["result"], json!({ "stopping": true }));
    assert!(rig.host.stop.load(std::sync::atomic::Ordering::Relaxed));
    drop(server);
}

/// The socket at which [`owner_who_asks`] asks, and how many times.
const OWNER: &str = "SCULPTD_TEST_OWNER";

/// Connects, asks and reads the reply, many times, and prints how long each took. The test below
/// runs it in a separate process, as the owner would be.
#[test]
fn owner_who_asks() {
    let Ok(told) = std::env::var(OWNER) else {
        println!("skipped: it is run beside a flood");
        return;
    };
    let (path, rounds) = told.rsplit_once(' ').expect("a socket and a number");
    let clock = Clock::monotonic();
    for round in 0..rounds.parse::<usize>().expect("a number") {
        let method = ["status", "cancel", "hash"][round % 3];
        let line = format!(r#"{{"jsonrpc":"2.0","id":1,"method":"{method}"}}"#);
        let begun = clock.now_us();
        let reply = Client::new(Path::new(path)).ask(&line).expect("an answer");
        println!("took {} us", clock.now_us() - begun);
        assert!(reply["result"].is_object(), "{method} in round {round}: {reply}");
    }
}

/// Processes that connect many times, or that flood, keep no other process waiting.
#[test]
fn idle_and_flooding_clients_keep_nobody_waiting() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let (idle, floods, rounds) = if long { (1000, 100, 200) } else { (200, 20, 20) };
    let daemon = Daemon::run_in(tempfile::tempdir().expect("a folder"), &[]);
    until("it answers", || daemon.ctl("status", None).is_some());
    let path = daemon.home.path().join("sculptd.sock");
    let room = rustix::process::getrlimit(rustix::process::Resource::Nofile);
    let room = rustix::process::Rlimit { current: room.maximum, ..room };
    rustix::process::setrlimit(rustix::process::Resource::Nofile, room).expect("room for sockets");
    // Some say nothing, some have asked once.
    let mut silent: Vec<Client> = (0..idle).map(|_| Client::new(&path)).collect();
    for client in silent.iter_mut().step_by(3) {
        let _ = client.out.write_all(b"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"hash\"}\n");
    }
    let stop = Arc::new(std::sync::atomic::AtomicBool::new(false));
    let floods: Vec<_> = (0..floods)
        .map(|_| {
            let (path, stop) = (path.clone(), stop.clone());
            std::thread::spawn(move || {
                let line = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"progress\"}\n".repeat(64);
                while !stop.load(std::sync::atomic::Ordering::Relaxed) {
                    let mut client = Client::new(&path);
                    while client.out.write_all(line.as_bytes()).is_ok()
                        && client.read_reply().is_some()
                        && !stop.load(std::sync::atomic::Ordering::Relaxed)
                    {}
                }
            })
        })
        .collect();
    let clock = Clock::monotonic();
    let mut took: Vec<u64> = Vec::new();
    for round in 0..rounds {
        let begun = clock.now_us();
        let method = ["status", "cancel", "hash"][round % 3];
        assert!(daemon.ctl(method, None).is_some(), "{method} is answered in round {round}");
        took.push(clock.now_us() - begun);
    }
    let owner = std::process::Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "control::owner_who_asks", "--nocapture", "--test-threads", "1"])
        .env(OWNER, format!("{} {}", path.display(), rounds * 5))
        .output()
        .expect("runs");
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    floods.into_iter().for_each(|f| f.join().expect("ends"));
    let said = String::from_utf8_lossy(&owner.stdout);
    assert!(owner.status.success(), "{said}{}", String::from_utf8_lossy(&owner.stderr));
    let asked = said.lines().filter_map(|l| l.split_once("took ")?.1.strip_suffix(" us"));
    let asked: Vec<u64> = asked.map(|us| us.parse().expect("a number")).collect();
    assert_eq!(asked.len(), rounds * 5);
    for (what, mut took) in [("and a reply", asked), ("a reply and a new process", took)] {
        took.sort_unstable();
        let at = |share: usize| took[(took.len() - 1) * share / 100] as f64 * 1e-3;
        let (p50, p99, all) = (at(50), at(99), at(100));
        println!("a connection {what}: p50 {p50:.1} ms, p99 {p99:.1} ms, all {all:.1} ms");
    }
}

#[test]
fn paths_with_links_or_steps_upward_are_refused() {
    let rig = Rig::new();
    let link = rig.dir.path().join("link.stl");
    std::os::unix::fs::symlink(rig.dir.path().join("elsewhere.stl"), &link).expect("a link");
    for path in ["relative.stl".into(), rig.dir.path().join("../up.stl"), link] {
        for method in ["export", "load", "take-up"] {
            let e = answer(&rig.host, method, json!({ "path": path })).expect_err("refused");
            assert_eq!(e.code, -32602, "{method} {}: {}", path.display(), e.message);
        }
    }
}

#[test]
fn a_subscriber_hears_each_change_and_answers_still_come_whole() {
    let rig = Rig::new();
    let (_server, path) = rig.serve();
    let mut client = Client::new(&path);
    let said = client.ask(r#"{"jsonrpc":"2.0","id":1,"method":"subscribe"}"#).expect("an answer");
    assert!(said["result"]["events"].as_array().is_some_and(|e| e.len() == 5), "{said}");
    let mut next = (*rig.host.published.load_full()).clone();
    next.undo_steps = 3;
    rig.host.published.store(Arc::new(next.clone()));
    let event = client.read_reply().expect("an event");
    assert_eq!(event["method"], "event");
    assert_eq!(event["params"]["event"], "history");
    assert_eq!(event["params"]["now"], json!({ "undo_steps": 3, "redo_steps": 0 }));
    assert!(event.get("id").is_none());
    // Events and answers take turns, a line each.
    let mut answers = 0;
    for n in 0..40usize {
        next.undo_steps = 4 + n;
        rig.host.published.store(Arc::new(next.clone()));
        let mut line = client.ask(r#"{"jsonrpc":"2.0","id":2,"method":"hash"}"#).expect("a line");
        while line["method"] == "event" {
            line = client.read_reply().expect("a line");
        }
        answers += usize::from(line["result"]["hash"].is_string());
    }
    assert_eq!(answers, 40);
    let wrong = Client::new(&path)
        .ask(r#"{"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"to":1}}"#);
    assert_eq!(wrong.expect("an answer")["error"]["code"], -32602);
}

/// A stroke by `stroke` goes through the law of a pen: it moves clay, is one step of undo, is in
/// the session, and replays to the same mesh. The brush in hand stays.
#[test]
fn a_stroke_by_request_moves_clay_and_replays_to_the_same_hash() {
    let dir = tempfile::tempdir().expect("a folder");
    let (ball, session) = (dir.path().join("ball.ply"), dir.path().join("s.sculpt"));
    write_mesh(&ball, &shapes::icosphere(1.0, 24).to_poly()).expect("written");
    let config = Config {
        r#loop: sculptd_daemon::config::LoopConfig { workers: 1, ..Default::default() },
        ..Default::default()
    };
    let begun = startup::begin(Some(&ball), Some(&session), &config, &Job::default());
    let begun = begun.expect("begins");
    let (writer, thread) = begun.journal.unzip();
    let journal = writer.map(|w| Box::new(w) as Box<dyn Journal>);
    let (factory, receiver) = queue::channel(4096);
    let clock = Clock::monotonic();
    let live = Live::start(begun.world, receiver, clock.clone(), config.r#loop, 4096, journal);
    let live = live.expect("runs");
    let host = Host {
        pen: Some(Arc::new(Mutex::new(VirtualPen::new(&factory, clock)))),
        ..Host::new(live.commands.clone(), live.published.clone(), sculptd::presets().clone())
    };
    let hash = || answer(&host, "hash", Value::Null).expect("a hash")["hash"].clone();
    let before = (hash(), live.published.load().brush);

    let points: Vec<_> =
        (0..=40).map(|i| json!([0.4 + 0.005 * f64::from(i), 0.5, 0.8, 5 * i])).collect();
    let stroke = json!({ "points": points, "space": "view", "brush": { "kind": "draw" } });
    let made = answer(&host, "stroke", stroke).expect("a stroke");
    assert_eq!(made["samples"], 42);
    assert_ne!(hash(), before.0, "nothing moved");
    let shown = live.published.load_full();
    assert_eq!(shown.undo_steps, 1);
    assert!(shown.figures.dabs > 1 && shown.figures.samples == 42);

    // In space: on the side that is seen, with the brush in hand, which came back.
    let view = glam::Vec2::new(0.45, 0.4);
    let hit = shown.mesh.pick(shown.camera.ray(view)).expect("on the ball").position;
    let at = |p: glam::Vec3, ms: f64| json!([p.x, p.y, p.z, 1.0, ms]);
    let world = |points: Vec<Value>| json!({ "points": points, "space": "world" });
    let between = hash();
    answer(&host, "stroke", world(vec![at(hit, 0.0), at(hit, 30.0)])).expect("a stroke");
    assert_ne!(hash(), between, "nothing moved");
    assert_eq!(live.published.load().brush, before.1);
    let behind = world(vec![at(hit, 0.0), at(-hit, 10.0)]);
    let e = answer(&host, "stroke", behind).expect_err("not seen");
    assert!(e.message.starts_with("points[1]: not seen"), "{}", e.message);
    for points in [
        json!([[0.5, 0.5, 1.5, 0.0]]),
        json!([[0.5, 0.5, 1.0, 0.0], [0.5, 0.5, 1.0, 0.4]]),
        json!([[0.5, 0.5, 1.0, 0.0, 0.0]]),
        json!([[99.0, 0.5, 1.0, 0.0]]),
        json!(vec![[0.5, 0.5, 1.0, 0.0]; 1001]),
    ] {
        let e = answer(&host, "stroke", json!({ "points": points, "space": "view" }));
        assert_eq!(e.expect_err("refused").code, -32602);
    }

    let ended = live.stop().expect("ends").world;
    let sculpted = ended.mesh().hash();
    drop(ended);
    assert_eq!(thread.and_then(|t| t.finish()), None);
    let opened = sculptd_daemon::session::open(&session).expect("a session");
    let again = sculptd_daemon::session::replay::replay(
        &opened,
        None,
        sculptd_clay::Workers::new(1),
        &Job::default(),
    );
    assert_eq!(again.expect("replays").world.mesh().hash(), sculpted);
}

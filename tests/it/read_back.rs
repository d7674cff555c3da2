//! A reply means done: whatever a request changed, the very next request of the same client sees
//! it. Every method of the schema is called with random parameters; right after its reply the
//! state is read, and again once the loop has had time for more. Where the two differ, the reply
//! came before its effect.

use std::sync::{Arc, Mutex};

use serde_json::{Value, json};

use crate::random_requests::{params, prepare, write_files};
use crate::seeded::Random;
use crate::waiting::pause;
use sculptd_control::METHODS;
use sculptd_daemon::config::{Config, LoopConfig};
use sculptd_daemon::control::Host;
use sculptd_daemon::control::handler::call;
use sculptd_daemon::control::stroke::VirtualPen;
use sculptd_daemon::live::Live;
use sculptd_daemon::startup;
use sculptd_daemon::tick::Journal;
use sculptd_daemon::web::{GuestList, Web, WebOptions, WebState};
use sculptd_devices::{Clock, queue};
use sculptd_geometry::job::Job;

/// Methods that change nothing that can be read, or end the daemon.
const LEFT_OUT: [&str; 3] = ["subscribe", "window", "shutdown"];
/// What is no part of the sculpture: it has no tick.
const GUESTS: &str = "guests";
/// Ticks after which whatever a request began late would be seen.
const LATER: u64 = 6;

/// Everything that a client can read of the sculpture and its settings.
fn state(host: &Host) -> Value {
    let read = |method: &str| call(host, method, Value::Null).unwrap_or_else(|e| json!(e.message));
    let mut hash = read("hash");
    hash.as_object_mut().expect("an object").remove("tick");
    let shown = host.published.load();
    let held = shown.thing.as_ref().map(|t| (t.plain.positions.len(), t.place.shift.to_array()));
    json!({
        "hash": hash,
        "scene": read("scene.list"),
        "layers": read("layers.list"),
        "sets": read("sets.list"),
        "brush": read("brush"),
        "camera": read("camera"),
        "here": read("history")["here"],
        "held": held,
        "reach": shown.volume.scale,
        "picture": shown.picture.as_ref().map(|p| [p.width, p.height]),
        "undo": [shown.undo_steps, shown.redo_steps],
        GUESTS: read("guests.list"),
    })
}

/// The page for browsers, on a free port of this machine.
fn page(live: &Live, factory: &queue::SenderFactory, clock: &Clock) -> Arc<Web> {
    let options = WebOptions {
        at: ([127, 0, 0, 1], 0).into(),
        name: String::new(),
        files: &[],
        lasts: None,
        own_views: true,
    };
    let state = WebState {
        published: live.published.clone(),
        commands: live.commands.clone(),
        factory: factory.clone(),
        presets: sculptd::presets().clone(),
        clock: clock.clone(),
        stop: Default::default(),
        keys: Default::default(),
        own_views: true,
        downloads: Default::default(),
        walls: Default::default(),
        window: Default::default(),
        guests: GuestList::shown_by(live.guests.clone()),
    };
    Arc::new(Web::start(&options, state).expect("a page"))
}

/// Rounds after the others in which what was always refused is asked again: random objects are not
/// always such that it can be carried out.
const MORE_ROUNDS: usize = 20;

#[test]
fn every_reply_comes_after_its_effect() {
    let dir = tempfile::tempdir().expect("a folder");
    write_files(dir.path());
    let session = dir.path().join("s.sculpt");
    let r#loop = LoopConfig { workers: 1, rate_hz: 240, ..Default::default() };
    let config = Config { r#loop, ..Default::default() };
    let ball = dir.path().join("ball.ply");
    let begun = startup::begin(Some(&ball), Some(&session), &config, &Job::default());
    let begun = begun.expect("begins");
    let (writer, thread) = begun.journal.expect("a session");
    let history = thread.history.as_ref().expect("a history").handle.clone();
    let (factory, receiver) = queue::channel(4096);
    let clock = Clock::monotonic();
    let journal: Box<dyn Journal> = Box::new(writer);
    let live =
        Live::start(begun.world, receiver, clock.clone(), config.r#loop, 4096, Some(journal))
            .expect("runs");
    history.connect(live.commands.clone());
    let host = Host {
        pen: Some(Arc::new(Mutex::new(VirtualPen::new(&factory, clock.clone())))),
        history: Some(history),
        web: Some(page(&live, &factory, &clock)),
        ..Host::new(live.commands.clone(), live.published.clone(), sculptd::presets().clone())
    };
    let ask = |method: &str, params| call(&host, method, params).ok();
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 100 } else { 3 };
    let mut r = Random(0x5eed);
    let (mut stale, mut untold, mut waits) = (Vec::new(), Vec::new(), Vec::new());
    let mut refusals = std::collections::BTreeMap::new();
    let mut done = std::collections::BTreeMap::new();
    for round in 0..rounds + MORE_ROUNDS {
        println!("round {round} at {} s", clock.now_us() / 1_000_000);
        for method in METHODS.iter().map(|m| m.name).filter(|m| !LEFT_OUT.contains(m)) {
            let never = done.get(method).is_none_or(|n: &(u32, u32)| n.1 == 0);
            if round >= rounds && !never {
                continue;
            }
            prepare(method, &ask, dir.path());
            let asked = params(method, &mut r, &ask, dir.path());
            let before = state(&host);
            host.commands.take_effect();
            let begun_us = clock.now_us();
            let reply = call(&host, method, asked.clone());
            waits.push(clock.now_us() - begun_us);
            if clock.now_us() - begun_us > 1_000_000 {
                println!(
                    "round {round}: {method} {asked} took {} ms",
                    waits[waits.len() - 1] / 1000
                );
            }
            let effect = host.commands.take_effect();
            let at_once = state(&host);
            let of_tick = |state: &Value| {
                let keys = state.as_object().expect("an object").iter();
                keys.filter(|(key, _)| *key != GUESTS).map(|(_, v)| v.clone()).collect::<Vec<_>>()
            };
            if of_tick(&at_once) != of_tick(&before) && effect.is_none() {
                untold.push(format!("round {round}: {method} {asked}"));
            }
            let tick = live.published.load().tick + LATER;
            // A loop at rest ticks once a second: what it has not begun by then, it never does.
            let ends_us = clock.now_us() + LATER * 1_000_000 / 240 * 2;
            while live.published.load().tick < tick && clock.now_us() < ends_us {
                pause(2);
            }
            let later = state(&host);
            let count: &mut (u32, u32) = done.entry(method).or_default();
            (count.0, count.1) = (count.0 + 1, count.1 + u32::from(reply.is_ok()));
            if let Err(e) = &reply {
                refusals.insert(method, format!("{asked}: {}", e.message));
                assert_ne!(e.code, -32602, "{method} {asked}: {}", e.message);
            }
            for (key, value) in at_once.as_object().expect("an object") {
                if *value != later[key] {
                    stale.push(format!("round {round}: {method} {asked}: {key} came later"));
                }
            }
            // The scene stays small, and something of it can be changed.
            if host.published.load().scene.objects.len() > 4 {
                call(&host, "load", json!({ "path": ball })).ok();
                let objects = host.published.load().scene.objects.clone();
                for o in &objects[..objects.len() - 1] {
                    let _ = call(&host, "scene.lock", json!({ "id": o.id.0, "locked": false }));
                    let _ = call(&host, "scene.remove", json!({ "id": o.id.0 }));
                }
            }
        }
    }
    waits.sort_unstable();
    let at = |share: usize| waits[(waits.len() - 1) * share / 100] as f64 * 1e-3;
    println!(
        "{} replies: p50 {:.2} ms, p90 {:.2} ms, p99 {:.2} ms",
        waits.len(),
        at(50),
        at(90),
        at(99)
    );
    let never: Vec<_> = done.iter().filter(|(_, n)| n.1 == 0).map(|(m, _)| *m).collect();
    let why: Vec<_> = never.iter().map(|m| (m, &refusals[m])).collect();
    assert!(never.is_empty(), "never carried out: {why:#?}");
    assert!(stale.is_empty(), "{} stale: {:#?}", stale.len(), stale);
    assert!(untold.is_empty(), "without the tick of the effect: {untold:#?}");
    live.stop().expect("ends");
    assert_eq!(thread.finish(), None);
}

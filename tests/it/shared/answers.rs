//! Answers are true: random commands by a sculptor and a viewer, with their computers
//! connected, cut off, overloaded, ended and sent away.
//!
//! `SCULPTD_SHARED_CASES`: how many cases (40); `SCULPTD_SHARED_SEED`: their seed. Without root or
//! `ip` it says that it is skipped.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::json;

use super::computers::{Switch, Table, link, together};
use super::faults::{VERTICES, places, stroke};
use super::{any_command, ask, end};
use crate::daemon_process::Daemon;
use crate::seeded::Random;
use crate::waiting::{pause, until};

struct Cases<'a> {
    table: Table<'a>,
    /// The host, the sculptor and the viewer.
    people: Vec<Daemon>,
    /// Runs of the sculptor's daemon.
    runs: usize,
    small: &'a Path,
    large: &'a Path,
    r: Random,
    /// The sculptor's requests, each with its answer.
    asked: Vec<String>,
    /// Triangles may be larger than a stroke, which then moves none.
    coarse: bool,
}

impl Cases<'_> {
    fn hash(&self, k: usize) -> String {
        let reply = ask(self.people[k].home.path(), "hash", "{}").expect("an answer");
        reply["hash"].as_str().expect("a hash").to_owned()
    }

    /// The sculptor asks.
    fn bob(&self, method: &str, params: &serde_json::Value) -> Result<(), String> {
        let clock = sculptd_devices::Clock::monotonic();
        let answer = ask(self.people[1].home.path(), method, &params.to_string());
        let seconds = clock.now_us() as f64 / 1e6;
        if seconds > 8.0 {
            println!("{method} took {seconds:.1} s ({answer:?}):\n{}\n", self.states());
        }
        answer.map(drop)
    }

    /// The end of what the sculptor asked for.
    fn before(&self) -> String {
        self.asked[self.asked.len().saturating_sub(40)..].join("\n")
    }

    fn stroke(&mut self) -> serde_json::Value {
        let places = places();
        stroke(places[self.r.below(places.len() as u64) as usize])
    }

    /// Waits until all have one clay and the queues are empty.
    fn level(&self, what: &str) {
        until(&format!("{what}: one clay, and empty queues"), || {
            let (_, own) = link(self.people[1].home.path()).unwrap_or_default();
            let all: Vec<_> = self
                .people
                .iter()
                .map(|d| ask(d.home.path(), "hash", "{}").ok().map(|h| h["hash"].clone()))
                .collect();
            all[0].is_some() && all.iter().all(|h| *h == all[0]) && own["ordered"] == own["batches"]
        });
        let (link, own) = link(self.people[1].home.path()).expect("an answer");
        assert_eq!((&own["lost"], &link["undelivered"]), (&json!(0), &json!(0)), "{what}");
    }

    /// Status and last log lines of each daemon.
    fn states(&self) -> String {
        let of = |d: &Daemon| {
            let status = ask(d.home.path(), "status", "{}");
            let told = d.told.lock().expect("no panic");
            let last = told.iter().rev().take(20).rev().cloned().collect::<Vec<_>>().join("\n");
            format!("{:?}\n{status:?}\n{last}", link(d.home.path()))
        };
        self.people.iter().map(of).collect::<Vec<_>>().join("\n\n")
    }

    fn restart(&mut self, what: &str) {
        let nowhere = tempfile::tempdir().expect("a folder");
        let home = std::mem::replace(&mut self.people[1].home, nowhere);
        self.runs += 1;
        self.people[1] = self.table.start(1, self.runs, home);
        together(&self.table, &self.people, what);
    }

    fn one(&mut self, n: u64) -> String {
        let kind = self.r.below(100);
        let before = self.hash(0);
        match kind {
            0..45 => {
                // A stroke does not change masked clay.
                self.bob("mask", &json!({ "action": "clear" })).expect("unmasked");
                self.level(&format!("case {n}, unmasked"));
                let before = self.hash(0);
                let stroke = self.stroke();
                let answer = self.bob("stroke", &stroke);
                if answer.is_ok() {
                    let (asked, made) = (self.before(), self.hash(1) != before);
                    assert!(made || self.coarse, "case {n}: made, and not there after\n{asked}");
                    until("the others see the stroke", || !made || self.hash(0) != before);
                } else if answer.as_ref().is_err_and(|why| !why.contains("the stroke waits")) {
                    let there = self.hash(0) != before;
                    assert!(!there, "case {n}: {answer:?}, and it is there:\n{}", self.states());
                }
                format!("a stroke: {}", if answer.is_ok() { "made" } else { "refused" })
            }
            45..65 => {
                let home = self.people[2].home.path().to_owned();
                let (method, params) = any_command(&mut self.r, &home, self.small);
                if method == "camera" {
                    let view = ask(&home, method, &params.to_string()).expect("a viewer may turn");
                    let (yaw, asked) = (view["yaw"].as_f64(), params["yaw"].as_f64());
                    let near = yaw.zip(asked).is_some_and(|(a, b)| (a - b).abs() < 1e-4);
                    assert!(near, "case {n}: {view} for {params}");
                    return "a viewer's view: turned".into();
                }
                let why = ask(&home, method, &params.to_string()).expect_err(method);
                assert!(!why.is_empty());
                assert_eq!(self.hash(0), before, "case {n}: {method} of a viewer: {why}");
                "a viewer's command: refused".into()
            }
            65..82 => {
                let home = self.people[1].home.path().to_owned();
                let (method, params) = any_command(&mut self.r, &home, self.small);
                let answer = self.bob(method, &params);
                self.asked.push(format!("{method} {params}: {answer:?}"));
                let keeps_triangles = ["stroke", "camera", "brush", "mask", "mask-region"];
                self.coarse |= answer.is_ok() && !keeps_triangles.contains(&method);
                self.coarse &= answer.is_err() || method != "load";
                match answer {
                    Ok(()) => "a command: done".into(),
                    Err(why) => {
                        assert_eq!(self.hash(0), before, "case {n}: {method} {params}: {why}");
                        "a command: refused".into()
                    }
                }
            }
            82..85 => {
                let why = self.bob("load", &json!({ "path": self.large })).expect_err("too large");
                assert!(why.contains("MiB"), "case {n}: {why}");
                assert_eq!(self.hash(0), before, "case {n}: {why}");
                "a mesh that is too large: refused".into()
            }
            85..88 => {
                let load = json!({ "path": self.small });
                let this = &*self;
                let load = &load;
                let done = std::thread::scope(|scope| {
                    let all: Vec<_> =
                        (0..6).map(|_| scope.spawn(move || this.bob("load", load))).collect();
                    let ended = all.into_iter().map(|t| t.join().expect("no panic"));
                    ended.filter(Result::is_ok).count()
                });
                assert!(done > 0, "case {n}: nobody may load");
                "six meshes at once: loaded".into()
            }
            88..95 => {
                self.table.switch.cable(1, "down");
                pause(self.r.below(3000));
                let stroke = self.stroke();
                let answer = self.bob("stroke", &stroke);
                pause(self.r.below(1500));
                self.table.switch.cable(1, "up");
                together(&self.table, &self.people, "a cut");
                match answer {
                    Ok(()) => "a stroke while cut off: made".into(),
                    Err(why) if why.contains("wait") => "a stroke while cut off: waited".into(),
                    Err(_) => "a stroke while cut off: refused".into(),
                }
            }
            95..98 => {
                assert_eq!(end(&mut self.people[1]), Some(0), "case {n}");
                self.restart("an end");
                "an end: 0".into()
            }
            _ => {
                self.table.switch.cable(1, "down");
                let stroke = self.stroke();
                let made = self.bob("stroke", &stroke);
                let code = end(&mut self.people[1]);
                self.table.switch.cable(1, "up");
                pause(1500);
                if made.is_ok() {
                    assert_eq!(self.hash(0), before, "case {n}: nobody could deliver it");
                    assert_eq!(code, Some(1), "case {n}: its input reached nobody");
                }
                self.restart("an end while cut off");
                format!("an end while cut off: {}", code.unwrap_or(-1))
            }
        }
    }
}

#[test]
fn what_is_answered_is_so_whatever_happens_to_the_network() {
    let of = |name: &str| std::env::var(name).ok().and_then(|t| t.parse::<u64>().ok());
    let cases = of("SCULPTD_SHARED_CASES").unwrap_or(40);
    let seed = of("SCULPTD_SHARED_SEED").unwrap_or(1);
    let Some(switch) = Switch::new(format!("sa{}", std::process::id())) else {
        println!("skipped: network namespaces need root and `ip`");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, vertices: usize| {
        let path = folder.path().join(name);
        let ball = sculptd_geometry::shapes::sphere_of_about(vertices);
        sculptd_geometry::io::write_mesh(&path, &ball.to_poly()).expect("written");
        path
    };
    let (small, large) = (write("ball.ply", VERTICES), write("large.ply", 500_000));
    let mut table = Table::new(&switch, folder.path(), "answers".into());
    table.third = "viewer";
    let home = || tempfile::tempdir().expect("a folder");
    let mut people = vec![table.start(0, 1, home())];
    let load = json!({ "path": small }).to_string();
    until("the host has the ball", || ask(people[0].home.path(), "load", &load).is_ok());
    people.extend([1, 2].map(|k| table.start(k, 1, home())));
    together(&table, &people, "the start");
    let r = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let mut all = Cases {
        table,
        people,
        runs: 1,
        small: &small,
        large: &large,
        r,
        asked: Vec::new(),
        coarse: false,
    };
    let mut counts = BTreeMap::new();
    for n in 0..cases {
        let told = all.one(n);
        all.level(&format!("case {n}, {told}"));
        *counts.entry(told).or_insert(0) += 1;
    }
    for (told, count) in counts {
        println!("{count:4} {told}");
    }
    for k in [1, 2, 0] {
        let code = end(&mut all.people[k]);
        assert_eq!(code, Some(0), "{:?}", all.people[k].told.lock());
    }
}

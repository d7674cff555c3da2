//! Work on the whole object by one of three people lands while the other two sculpt.
//!
//! `SCULPTD_SHARED_ROUNDS`: how many times (3).

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use serde_json::json;

use super::faults::{VERTICES, strokes};
use super::{ask, join, key};
use crate::daemon_process::{Daemon, free_endpoint};
use crate::seeded::Random;
use crate::waiting::until;

#[test]
fn whole_object_work_lands_while_two_others_sculpt() {
    let rounds = std::env::var("SCULPTD_SHARED_ROUNDS").ok().and_then(|t| t.parse().ok());
    let folder = tempfile::tempdir().expect("a folder");
    let (keys, at) = (folder.path().join("keys"), free_endpoint());
    let keys_text = keys.display().to_string();
    let name = format!("meanwhile-{}", std::process::id());
    let small = folder.path().join("ball.ply");
    let ball = sculptd_geometry::shapes::sphere_of_about(VERTICES);
    sculptd_geometry::io::write_mesh(&small, &ball.to_poly()).expect("written");
    let host = ["--host", &*name, "--keys", &keys_text, "--listen", &at, "--as", "Ada"];
    let ada = Daemon::run(&host);
    until("the host answers", || ada.ctl("hash", None).is_some());
    let sculptor = key(&keys, "sculptor");
    let [bob, cy] = ["Bob", "Cy"].map(|who| Daemon::run(&join(&name, &sculptor, &at, who)));
    let all = [&ada, &bob, &cy];
    let hash = |d: &Daemon| Some(d.ctl("hash", None)?["hash"].clone());
    let level = || {
        until("all have one clay", || {
            let [a, b, c] = all.map(hash);
            a.is_some() && a == b && a == c
        });
    };
    level();
    let works = [
        ("remesh", json!({ "voxel": 0.03 })),
        ("boolean", json!({ "operation": "union", "path": small, "at": [0.8, 0.0, 0.0] })),
        ("decimate", json!({ "triangles": 12_000 })),
    ];
    let load = json!({ "path": small }).to_string();
    for round in 0..rounds.unwrap_or(3) {
        ask(ada.home.path(), "load", &load).expect("loaded");
        level();
        let (method, params) = &works[round % works.len()];
        let by = round / works.len() % 3;
        let (stop, next) = (AtomicBool::new(false), AtomicUsize::new(0));
        let (done, made) = std::thread::scope(|scope| {
            let others = (0..3).filter(|k| *k != by).map(|k| {
                let (home, stop, next) = (all[k].home.path(), &stop, &next);
                scope.spawn(move || strokes(home, (Random(k as u64 + 7), 600), stop, next))
            });
            let others: Vec<_> = others.collect();
            until("they sculpt", || next.load(Ordering::Relaxed) > 4);
            let done = ask(all[by].home.path(), method, &params.to_string());
            stop.store(true, Ordering::Relaxed);
            let made = others.into_iter().map(|t| t.join().expect("no panic").len());
            (done, made.sum::<usize>())
        });
        let reply = done.unwrap_or_else(|why| panic!("round {round}, {method}: {why}"));
        level();
        println!("round {round}: {method} by person {by}, {made} strokes meanwhile: {reply}");
    }
}

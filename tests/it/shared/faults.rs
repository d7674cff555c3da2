//! Random sessions of three people, each in a network namespace: daemons are killed, paused and cut
//! off while all three sculpt. In the end all have one clay, each answered stroke is in it, nothing
//! is raised where nobody sculpted, and every file gives it, replayed and opened.
//!
//! `SCULPTD_SHARED_SESSIONS`: how many sessions (1), of which four run at once;
//! `SCULPTD_SHARED_SEED`: the seed of the first one. Without root or `ip` it says that it is
//! skipped.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::DVec3;
use rustix::process::{Pid, Signal, kill_process};
use sculptd_geometry::job::Job;
use serde_json::{Value, json};

use super::computers::{PEOPLE, Switch, Table, link, together};
use super::{any_command, ask, end, replayed};
use crate::daemon_process::Daemon;
use crate::seeded::Random;
use crate::waiting::{comes, pause, until};

/// Vertices of the ball.
pub(super) const VERTICES: usize = 20_000;
/// Places on the ball. Those that face the camera get strokes. The distance between two exceeds the
/// reach of a stroke.
const PLACES: usize = 600;
const RADIUS: f64 = 0.06;
/// From the ball's middle to the eye, at the first view.
const TO_EYE: DVec3 = DVec3::new(0.44, 0.34, 0.83);

fn signal(daemon: &Daemon, signal: Signal) {
    kill_process(Pid::from_child(&daemon.child), signal).expect("it runs");
}

/// Directions that are spread evenly (a Fibonacci lattice).
fn place(i: usize) -> DVec3 {
    let z = 1.0 - (2 * i + 1) as f64 / PLACES as f64;
    let (sin, cos) = (i as f64 * std::f64::consts::PI * (3.0 - 5f64.sqrt())).sin_cos();
    DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
}

/// The places that face the camera, neighbours long after each other.
pub(super) fn places() -> Vec<usize> {
    let all = (0..PLACES).map(|i| i * 97 % PLACES);
    all.filter(|i| place(*i).dot(TO_EYE) > 0.5).collect()
}

pub(super) fn stroke(i: usize) -> Value {
    let at = place(i);
    let along = at.any_orthonormal_vector() * 0.01;
    let point = |k: i32| {
        let p = at + along * f64::from(k);
        json!([p.x, p.y, p.z, 1.0, 15 * (k + 1)])
    };
    let brush = json!({ "kind": "draw", "radius": RADIUS, "strength": 0.2 });
    json!({ "space": "world", "points": [point(-1), point(0), point(1)], "brush": brush })
}

/// Sculpts until `stop`, each stroke at a separate place, with rests of up to `rest_ms`. Returns
/// the places whose stroke was answered as made.
pub(super) fn strokes(
    home: &Path,
    (mut r, rest_ms): (Random, u64),
    stop: &AtomicBool,
    next: &AtomicUsize,
) -> Vec<usize> {
    let (places, mut made) = (places(), Vec::new());
    while !stop.load(Ordering::Relaxed) {
        let Some(&i) = places.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
        if ask(home, "stroke", &stroke(i).to_string()).is_ok() {
            made.push(i);
        }
        pause(r.below(rest_ms));
    }
    made
}

fn commands(home: &Path, mut r: Random, stop: &AtomicBool, small: &Path) {
    while !stop.load(Ordering::Relaxed) {
        let (method, params) = any_command(&mut r, home, small);
        let _refused_or_not = ask(home, method, &params.to_string());
        pause(r.below(800));
    }
}

/// Kills, pauses or cuts off one of the three, and waits until it is back.
fn fault(table: &Table, people: &mut [Daemon], runs: &mut [usize; 3], r: &mut Random) -> String {
    let k = r.below(3) as usize;
    pause(300 + r.below(2500));
    let told = match r.below(3) {
        0 => {
            signal(&people[k], Signal::KILL);
            people[k].child.wait().expect("it ends");
            pause(r.below(4000));
            let nowhere = tempfile::tempdir().expect("a folder");
            let home = std::mem::replace(&mut people[k].home, nowhere);
            runs[k] += 1;
            people[k] = table.start(k, runs[k], home);
            "killed".to_owned()
        }
        1 => {
            let ms = 1000 + r.below(4000) * (1 + 3 * (r.below(4) / 3));
            signal(&people[k], Signal::STOP);
            pause(ms);
            signal(&people[k], Signal::CONT);
            format!("paused for {ms} ms")
        }
        _ => {
            let ms = 300 + r.below(8000);
            table.switch.cable(k, "down");
            pause(ms);
            table.switch.cable(k, "up");
            format!("cut off for {ms} ms")
        }
    };
    let told = format!("{} {told}", PEOPLE[k]);
    together(table, people, &told);
    told
}

/// The newest file of a run: a daemon that had to join again went on in another one.
fn last_file(first: &Path) -> PathBuf {
    let stem = first.with_extension("").display().to_string();
    let later = (2..).map(|n| PathBuf::from(format!("{stem}-{n}.sculpt")));
    later.take_while(|f| f.exists()).last().unwrap_or_else(|| first.to_owned())
}

fn session(seed: u64) -> Option<()> {
    let switch = Switch::new(format!("sc{}x{seed}", std::process::id()))?;
    let folder = tempfile::tempdir().expect("a folder");
    let table = Table::new(&switch, folder.path(), format!("faults-{seed}"));
    let small = folder.path().join("ball.ply");
    let ball = sculptd_geometry::shapes::sphere_of_about(VERTICES);
    sculptd_geometry::io::write_mesh(&small, &ball.to_poly()).expect("written");

    let mut r = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let home = || tempfile::tempdir().expect("a folder");
    let mut runs = [1; 3];
    let mut people = vec![table.start(0, 1, home())];
    let load = json!({ "path": small }).to_string();
    until("the host has the ball", || ask(people[0].home.path(), "load", &load).is_ok());
    people.extend([1, 2].map(|k| table.start(k, 1, home())));
    together(&table, &people, "the start");

    let everything = seed % 3 == 2;
    let (stop, next) = (AtomicBool::new(false), AtomicUsize::new(0));
    let (made, mut told) = (Mutex::new(BTreeSet::new()), Vec::new());
    let homes: Vec<PathBuf> = people.iter().map(|d| d.home.path().to_owned()).collect();
    std::thread::scope(|scope| {
        let (stop, next, made, small) = (&stop, &next, &made, &small);
        for home in &homes {
            let r = Random(r.below(1 << 40) | 1);
            scope.spawn(move || match everything {
                true => commands(home, r, stop, small),
                false => {
                    let strokes = strokes(home, (r, 600), stop, next);
                    made.lock().expect("no panic").extend(strokes);
                }
            });
        }
        let faults = 1 + r.below(4);
        // A panic here would wait for the threads for ever.
        let all = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            (0..faults).for_each(|_| told.push(fault(&table, &mut people, &mut runs, &mut r)));
            pause(500);
        }));
        stop.store(true, Ordering::Relaxed);
        if let Err(panic) = all {
            std::panic::resume_unwind(panic);
        }
    });
    let told = told.join(", ");
    let made = made.into_inner().expect("no panic");
    let what = format!("session {seed} ({told}; {} strokes answered)", made.len());

    let hash =
        |d: &Daemon| ask(d.home.path(), "hash", "{}").ok()?["hash"].as_str().map(String::from);
    let level = comes(|| {
        let all: Option<Vec<_>> = people.iter().map(|d| link(d.home.path())).collect();
        let quiet = all.is_some_and(|all| {
            all.iter().all(|(link, own)| link["waiting"] == 0 && own["batches"] == own["ordered"])
        });
        let clays: BTreeSet<_> = people.iter().map(hash).collect();
        quiet && clays.len() == 1 && !clays.contains(&None)
    });
    let state = |d: &Daemon| {
        let told = d.told.lock().expect("no panic");
        let last = told.iter().rev().take(12).rev().cloned().collect::<Vec<_>>().join("\n");
        format!("{:?} {:?}\n{last}", hash(d), link(d.home.path()))
    };
    let states = || people.iter().map(state).collect::<Vec<_>>().join("\n\n");
    assert!(level, "{what}: no one clay, or something waits:\n{}", states());
    for d in &people {
        let (link, own) = link(d.home.path()).expect("an answer");
        assert_eq!((&own["lost"], &link["undelivered"]), (&json!(0), &json!(0)), "{what}");
    }
    let clay = hash(&people[0]);
    for n in [r.below(3), r.below(2), 0] {
        let mut daemon = people.remove(n as usize);
        assert_eq!(end(&mut daemon), Some(0), "{what}: {:?}", daemon.told.lock());
    }
    for k in 0..3 {
        for run in 1..runs[k] {
            let file = last_file(&table.file(k, run));
            assert!(replayed(&file).is_some(), "{what}: {} of a killed daemon", file.display());
        }
        let file = last_file(&table.file(k, runs[k]));
        assert_eq!(replayed(&file), clay, "{what}: replay of {}", file.display());
        let text = file.display().to_string();
        let again = Daemon::run(&["--session", &text]);
        until("it opens", || hash(&again).is_some());
        assert_eq!(hash(&again), clay, "{what}: {text}, opened");
    }
    if !everything {
        let asked = &places()[..next.into_inner().min(places().len())];
        let (missing, elsewhere) = raised(&last_file(&table.file(0, runs[0])), &made, asked);
        assert!(missing.is_empty(), "{what}: answered as made, and not there: {missing:?}");
        assert!(elsewhere.is_empty(), "{what}: clay that nobody raised: {elsewhere:?}");
    }
    assert!(everything || made.len() > 8, "{what}");
    println!("{what}");
    Some(())
}

/// Of the clay that a file gives: the places of `made` where it is not raised, and vertices that
/// are raised where no stroke was `asked` for.
fn raised(file: &Path, made: &BTreeSet<usize>, asked: &[usize]) -> (Vec<usize>, Vec<DVec3>) {
    let mesh = file.with_extension("ply");
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    let out = command.arg("replay").arg(file).arg("--export").arg(&mesh).output().expect("runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let mesh = sculptd_geometry::io::read_mesh(&mesh, &Job::default()).expect("a mesh");
    let mut raised = mesh.mesh.positions;
    raised.retain(|p| p.length() > 1.002);
    let near = |p: &DVec3, i: usize, reach: f64| p.normalize().distance(place(i)) < reach;
    let there = |i: &usize| raised.iter().any(|p| near(p, *i, RADIUS / 2.0));
    let missing = made.iter().filter(|i| !there(i)).copied().collect();
    // A stroke raises clay so far from its middle.
    let by_nobody = |p: &DVec3| !asked.iter().any(|i| near(p, *i, RADIUS * 2.5));
    (missing, raised.iter().filter(|p| by_nobody(p)).copied().collect())
}

#[test]
fn three_people_have_one_sculpture_after_kills_pauses_and_cuts() {
    let of = |name: &str| std::env::var(name).ok().and_then(|t| t.parse::<u64>().ok());
    let first = of("SCULPTD_SHARED_SEED").unwrap_or(1);
    let sessions = of("SCULPTD_SHARED_SESSIONS").unwrap_or(1);
    let next = AtomicUsize::new(0);
    let done = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..sessions.min(4) {
            scope.spawn(|| {
                loop {
                    let n = next.fetch_add(1, Ordering::Relaxed) as u64;
                    if n >= sessions {
                        break;
                    }
                    if session(first + n).is_none() {
                        println!("skipped: network namespaces need root and `ip`");
                        break;
                    }
                    done.fetch_add(1, Ordering::Relaxed);
                }
            });
        }
    });
    println!("{} of {sessions} sessions", done.into_inner());
}

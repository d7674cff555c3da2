//! The bound on a history, pruning, and replays from its checkpoints.

use std::path::Path;

use glam::Vec2;
use sculptd_daemon::session;
use sculptd_daemon::session::history::{Want, listing};
use sculptd_daemon::session::reopen;
use sculptd_engine::command::Command;
use sculptd_geometry::job::Job;

use super::{Studio, both_ways, pause};

/// Bytes of the history in a session's file.
fn total(path: &Path) -> u64 {
    listing::read(path).expect("reads").total_bytes
}

#[test]
fn a_history_keeps_within_its_bound_and_the_oldest_places_go_first() {
    let dir = tempfile::tempdir().expect("a folder");
    const MOST: u64 = 1536 << 10;
    let mut s = Studio::bounded(dir.path(), 3000, 1, MOST);
    let start = s.world.hash();
    let mut hashes = vec![start];
    // An early branch: two strokes, undone.
    hashes.push(s.stroke(Vec2::new(-0.1, 0.0)));
    s.settle();
    s.tick(&[], &[Command::Undo]);
    s.becomes(start);
    let mut peak = 0;
    let mut all: Vec<(u64, u64)> = Vec::new();
    for k in 0..60 {
        let hash = s.stroke(Vec2::new(-0.1 + 0.003 * k as f32, 0.02 * (k % 7) as f32 - 0.06));
        s.settle();
        all.push((s.history.tree().cursor, hash));
        peak = peak.max(total(&s.path));
        // A late branch, at which the work is not.
        if k == 57 {
            s.tick(&[], &[Command::Undo]);
            s.becomes(all[56].1);
        }
    }
    let tree = s.history.tree();
    println!(
        "{} places of 62 are left, {} KiB, {} KiB at most",
        tree.len(),
        total(&s.path) >> 10,
        peak >> 10
    );
    assert!(tree.len() < 50, "{} places: nothing went", tree.len());
    // One step may lie above the bound until the oldest went.
    assert!(peak <= MOST + (256 << 10), "{peak} bytes");
    assert!(tree.node(1).is_none(), "the early branch is the oldest");
    assert!(tree.node(all[57].0).is_some(), "the late branch stays");
    let first = tree.nodes().next().expect("a place");
    assert!(first.parent.is_none() && first.tick > 0);
    // Everything that is left can be gone to, and is what it was.
    let left: Vec<(u64, u64)> =
        all.iter().copied().filter(|(n, _)| tree.node(*n).is_some()).collect();
    assert_eq!(left.len() + 1, tree.len() + usize::from(first.id != 0));
    let mut went = 0;
    // Going to and fro makes checkpoints, for which older places go. At the very oldest none could,
    // and the pages of the first jumps would go instead: a replay from the start would miss them,
    // as opening the session does not.
    for &(node, hash) in left.iter().skip(6).step_by(3).chain([&left[6], &all[57], &all[59]]) {
        if s.history.tree().node(node).is_some() {
            s.history.want(Want::Node(node));
            s.becomes(hash);
            went += 1;
        }
    }
    assert!(went >= 8, "{went} places");
    let last = s.world.hash();
    let path = s.end();
    assert_eq!(both_ways(&path), (last, last), "a replay finds what its jumps name");
    let found = listing::read(&path).expect("reads");
    assert!(found.dropped > 10 && found.total_bytes <= MOST + (256 << 10));
    // It goes on after a restart, down to the first place that is left.
    let mut s = Studio::reopened(&path);
    let there = |n: u64| s.history.tree().node(n).is_some();
    let oldest = *left.iter().find(|l| there(l.0)).expect("a place");
    s.history.want(Want::Node(oldest.0));
    s.becomes(oldest.1);
    s.tick(&[], &[Command::Undo]);
    s.tick(&[], &[]);
    let again = s.stroke(Vec2::new(0.1, 0.05));
    let path = s.end();
    assert_eq!(both_ways(&path), (again, again));
}

#[test]
fn a_bound_below_what_must_stay_keeps_just_that() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::bounded(dir.path(), 3000, 1, 1);
    let mut hashes = vec![s.world.hash()];
    for k in 0..12 {
        hashes.push(s.stroke(Vec2::new(-0.1 + 0.015 * k as f32, 0.05)));
        s.settle();
    }
    let places = s.history.tree().len();
    assert!(places <= 4, "{places} places");
    s.tick(&[], &[Command::Undo]);
    s.tick(&[], &[Command::Undo]);
    for _ in 0..60 {
        s.tick(&[], &[]);
        pause(2);
    }
    let last = s.world.hash();
    assert!(hashes.contains(&last));
    let path = s.end();
    // The newest checkpoint serves, though hardly anything is left.
    let opened = session::open(&path).expect("opens");
    let quick = reopen(&path, &opened, None, 1, &Job::default()).expect("a checkpoint");
    assert_eq!(quick.replayed.world.hash(), last);
    let s = Studio::reopened(&path);
    assert_eq!(s.world.hash(), last);
    s.end();
}

#[test]
fn pruning_shortens_a_history_and_the_file() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1 << 26);
    let mut hashes = Vec::new();
    for k in 0..40 {
        hashes.push(s.stroke(Vec2::new(-0.1 + 0.005 * k as f32, 0.03)));
    }
    let path = s.end();
    let prune = |more: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sculptd"));
        command.args(["session", "prune", "--history", "1", "--json"]).args(more).arg(dir.path());
        let out = command.output().expect("runs");
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        serde_json::from_slice::<serde_json::Value>(&out.stdout).expect("one object")
    };
    let (size, held) = (std::fs::metadata(&path).expect("there").len(), total(&path));
    assert!(held > 2 << 20, "{held} bytes: nothing to shorten");
    let asked = prune(&[]);
    assert_eq!(asked["shortened"][0]["freed"], serde_json::Value::Null);
    assert_eq!(total(&path), held, "only with --yes");
    let done = prune(&["--yes"]);
    assert!(done["shortened"][0]["freed"]["places"].as_u64().is_some_and(|n| n > 5), "{done}");
    let now = std::fs::metadata(&path).expect("there").len();
    assert!(total(&path) <= 1 << 20 && now < size - (held - (1 << 20)) / 2, "{size} -> {now}");
    let last = hashes[39];
    assert_eq!(both_ways(&path), (last, last));
    let mut s = Studio::reopened(&path);
    s.tick(&[], &[Command::Undo]);
    s.becomes(hashes[38]);
    s.end();
}

#[test]
fn a_replay_from_a_checkpoint_is_the_replay_from_the_start() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1 << 26);
    for k in 0..12 {
        s.stroke(Vec2::new(-0.1 + 0.015 * k as f32, 0.0));
        // A checkpoint is made between strokes.
        s.settle();
    }
    let path = s.end();
    let replay = |more: &[String]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sculptd"));
        let out = command.arg("replay").arg(&path).arg("--json").args(more).output().expect("runs");
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        serde_json::from_slice::<serde_json::Value>(&out.stdout).expect("one object")
    };
    let mut begun = Vec::new();
    for until in [5, 20, 41, 60, 77] {
        let until = format!("--until={until}");
        let whole = replay(std::slice::from_ref(&until));
        let near = replay(&[until.clone(), "--from-checkpoint".into()]);
        assert_eq!((&near["hash"], &near["ticks"]), (&whole["hash"], &whole["ticks"]), "{until}");
        assert_eq!(whole["checkpoint"], serde_json::Value::Null);
        begun.push(near["checkpoint"].as_u64().unwrap_or(0));
    }
    println!("began at {begun:?}");
    assert!(begun.is_sorted() && begun[4] > 60 && begun[2] > 20, "{begun:?}");
}

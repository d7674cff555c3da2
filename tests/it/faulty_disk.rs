//! A disk that fails at the n-th call, for every n of a short day: a session is begun, sculpted
//! into, closed, and opened again. Every file access of the program and of SQLite goes through the
//! C library, where `disk/faulty_disk.c` counts it and lets one fail.

use std::path::{Path, PathBuf};
use std::process::Command;

use sculptd_daemon::session;
use serde_json::Value;

/// Builds the library; `None` where there is no C compiler.
fn shim(dir: &Path) -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/disk/faulty_disk.c");
    let library = dir.join("faulty_disk.so");
    let done = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-o"])
        .arg(&library)
        .arg(source)
        .arg("-ldl")
        .output();
    match done {
        Ok(out) if out.status.success() => Some(library),
        other => {
            println!("skipped: no C compiler ({other:?})");
            None
        }
    }
}

/// One day. `at`: the call that fails, and how.
fn day(library: &Path, dir: &Path, at: Option<(u64, &str, bool)>) -> (std::process::Output, u64) {
    let count = dir.join("calls");
    let mut run = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    run.args(["demo", "--headless", "--pace", "fast", "--for", "2", "--json", "--mesh"])
        .arg(dir.join("ball.obj"))
        .arg("--session")
        .arg(dir.join("day.sculpt"))
        .arg("--export")
        .arg(dir.join("out.stl"))
        .env("LD_PRELOAD", library)
        .env("FAULTY_PATH", "day.sculpt")
        .env("FAULTY_COUNT", &count);
    if let Some((n, kind, ever)) = at {
        run.env("FAULTY_AT", n.to_string()).env("FAULTY_KIND", kind);
        if ever {
            run.env("FAULTY_FOR", "ever");
        }
    }
    let out = run.output().expect("runs");
    let calls = std::fs::read_to_string(&count).ok().and_then(|t| t.parse().ok()).unwrap_or(0);
    (out, calls)
}

fn ball(dir: &Path) {
    let mesh = sculptd_geometry::shapes::sphere_of_about(300);
    let mut text = String::new();
    for p in &mesh.positions {
        text.push_str(&format!("v {} {} {}\n", p.x, p.y, p.z));
    }
    for t in &mesh.triangles {
        text.push_str(&format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    }
    #[allow(clippy::disallowed_methods)] // A test's input.
    std::fs::write(dir.join("ball.obj"), text).expect("written");
}

#[test]
fn a_disk_that_fails_at_any_call_loses_nothing_in_silence() {
    let home = tempfile::tempdir().expect("a folder");
    let Some(library) = shim(home.path()) else { return };
    let fresh = |dir: &Path| ball(dir);
    let dir = tempfile::tempdir().expect("a folder");
    fresh(dir.path());
    let (out, calls) = day(&library, dir.path(), None);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let good: Value = serde_json::from_slice(&out.stdout).expect("one JSON object");
    let reach = |o: &session::Opened| o.input.last().map_or(0, |t| t.tick);
    let last = reach(&session::open(&dir.path().join("day.sculpt")).expect("opens"));
    assert!(last > 200, "{last}");
    assert!(calls > 20, "{calls} calls were counted");
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let step = if long { 1 } else { (calls / 12).max(1) };
    let (mut days, mut refused, mut told, mut whole) = (0, 0, 0, 0);
    for (kind, ever) in [("eio", false), ("enospc", true), ("short", false), ("lies", true)] {
        for n in (1..=calls).step_by(step as usize) {
            let case = format!("{kind} at call {n} of {calls}");
            let dir = tempfile::tempdir().expect("a folder");
            fresh(dir.path());
            let (out, _) = day(&library, dir.path(), Some((n, kind, ever)));
            let said = String::from_utf8_lossy(&out.stderr).into_owned();
            assert!(!said.contains("panicked"), "{case}: {said}");
            assert!(out.status.code().is_some(), "{case}: ended by a signal: {said}");
            days += 1;
            let path = dir.path().join("day.sculpt");
            if !path.exists() {
                assert!(!out.status.success(), "{case}: no session, and nothing is said");
                refused += 1;
                continue;
            }
            match session::open(&path) {
                Ok(opened) if opened.loss.is_none() && reach(&opened) == last => {
                    whole += 1;
                    let replay = Command::new(env!("CARGO_BIN_EXE_sculptd"))
                        .args(["replay", "--json"])
                        .arg(&path)
                        .output()
                        .expect("runs");
                    let again: Value =
                        serde_json::from_slice(&replay.stdout).expect("one JSON object");
                    assert_eq!(again["hash"], good["hash"], "{case}");
                }
                // Cut short, or damaged: then it was said, by the day itself or by the opening.
                Ok(opened) => {
                    let at_opening = opened.loss.is_some();
                    // A day that cannot begin names the file and ends with an error.
                    let refused_by_name = !out.status.success() && said.contains("day.sculpt");
                    let by_the_day =
                        refused_by_name || said.contains("session") || said.contains("journal");
                    assert!(at_opening || by_the_day, "{case}: lost in silence: {said}");
                    told += 1;
                }
                Err(e) => {
                    let saved = session::salvage(&path);
                    assert!(saved.is_ok(), "{case}: {e}; {:?}", saved.err());
                    told += 1;
                }
            }
        }
    }
    println!(
        "{days} days of {calls} calls: {whole} whole, {told} with a loss that was told, {refused} \
         that were refused at the start"
    );
    assert!(whole > 0);
}

//! A disk that fails at the n-th call, for every n of a short day: a session is begun, sculpted
//! into, closed, and opened again; sculptures of visitors are kept, listed and sent on. Every file
//! access of the program and of SQLite goes through the
//! C library, where `disk/faulty_disk.c` counts it and lets one fail.

use std::path::{Path, PathBuf};
use std::process::Command;

use sculptd_daemon::session;
use sculptd_geometry::io::{SceneMesh, write_scene};
use sculptd_geometry::job::Job;
use serde_json::Value;

/// Builds the library; `None` where there is no C compiler.
pub(crate) fn shim(dir: &Path) -> Option<PathBuf> {
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

/// A session read from a disk with bit rot: the result is correct, or the error is reported.
#[test]
fn bit_rot_at_any_read_of_a_session_is_never_shown_as_the_sculpture() {
    let home = tempfile::tempdir().expect("a folder");
    let Some(library) = shim(home.path()) else { return };
    ball(home.path());
    let (out, _) = day(&library, home.path(), None);
    let good: Value = serde_json::from_slice(&out.stdout).expect("one JSON object");
    let session = home.path().join("day.sculpt");
    let replay = |at: Option<u64>| {
        let count = home.path().join("reads");
        let mut run = Command::new(env!("CARGO_BIN_EXE_sculptd"));
        run.args(["replay", "--json"])
            .arg(&session)
            .env("LD_PRELOAD", &library)
            .env("FAULTY_PATH", "day.sculpt")
            .env("FAULTY_READS", "1")
            .env("FAULTY_COUNT", &count);
        if let Some(n) = at {
            run.env("FAULTY_AT", n.to_string()).env("FAULTY_KIND", "rot");
        }
        let out = run.output().expect("runs");
        let reads = std::fs::read_to_string(&count).ok().and_then(|t| t.parse().ok()).unwrap_or(0);
        (out, reads)
    };
    let (out, reads) = replay(None);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    assert!(reads > 20, "{reads} reads were counted");
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let step = if long { 1 } else { (reads / 25).max(1) };
    let (mut right, mut told) = (0, 0);
    for n in (1..=reads).step_by(step as usize) {
        let (out, _) = replay(Some(n));
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(!said.contains("panicked") && out.status.code().is_some(), "read {n}: {said}");
        let shown: Value = serde_json::from_slice(&out.stdout).unwrap_or_default();
        if out.status.success() && shown["loss"].is_null() {
            assert_eq!(shown["hash"], good["hash"], "read {n} of {reads}: another sculpture");
            right += 1;
        } else {
            told += 1;
        }
    }
    println!("{} reads rotten of {reads}: {right} without effect, {told} told", right + told);
    assert!(told > 0);
}

/// The folder of [`gallery_day`]; unset where nobody runs it.
const GALLERY_DAY: &str = "SCULPTD_GALLERY_DAY";

/// The sculpture of visitor `n`.
fn visitor(n: u32) -> sculptd_geometry::PolyMesh {
    sculptd_geometry::shapes::uv_sphere(1.0, 4 + n, 8)
}

/// Keeps and sends three visitors' sculptures, and prints each on standard output. The test
/// below runs it in a separate process, whose disk fails.
#[test]
fn gallery_day() {
    use sculptd_daemon::kiosk::gallery::VisitLine;
    use sculptd_daemon::kiosk::{gallery, spool::Spool};
    let Some(folder) = std::env::var_os(GALLERY_DAY).map(PathBuf::from) else {
        println!("skipped: it is run with a disk that fails");
        return;
    };
    let (here, there) = (folder.join("works"), folder.join("store"));
    let place = there.display().to_string();
    let spool = Spool::start(&here, &place);
    for n in 1..=3 {
        match gallery::keep(&here, &visitor(n)) {
            Ok(path) => {
                let name = path.file_name().and_then(|n| n.to_str()).expect("a name").to_owned();
                println!("kept {n} {name}");
                if let Ok(spool) = &spool {
                    spool.wake();
                }
            }
            Err(e) => println!("refused {n}: {e}"),
        }
        let line = VisitLine {
            visit: 1,
            seconds: 2,
            dabs: 3,
            kept: true,
            work: None,
            interrupted: false,
            exhibit: None,
            percent: None,
        };
        if let Err(e) = gallery::audit(&folder.join("works/audit.jsonl"), &line) {
            println!("no audit: {e}");
        }
    }
    let quiet = crossbeam_channel::never::<()>();
    for _ in 0..20 {
        if sculptd_daemon::kiosk::spool::waiting(&here).is_ok_and(|all| all.is_empty()) {
            break;
        }
        let _ = quiet.recv_timeout(std::time::Duration::from_millis(10));
    }
}

#[test]
fn a_gallery_on_a_disk_that_fails_at_any_call_keeps_what_it_said_it_kept() {
    use sculptd_daemon::kiosk::{gallery, spool, spool::Spool};
    let home = tempfile::tempdir().expect("a folder");
    let Some(library) = shim(home.path()) else { return };
    let run = |folder: &Path, at: Option<(u64, &str, bool)>| {
        let count = home.path().join("calls");
        let _ = std::fs::remove_file(&count);
        let mut run = Command::new(std::env::current_exe().expect("this program"));
        run.args(["--exact", "faulty_disk::gallery_day", "--nocapture", "--test-threads", "1"])
            .env(GALLERY_DAY, folder)
            .env("LD_PRELOAD", &library)
            .env("FAULTY_PATH", "works")
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
    };
    let expected: Vec<Vec<u8>> = (1..=3)
        .map(|n| {
            let path = home.path().join(format!("{n}.glb"));
            let work = SceneMesh { mesh: visitor(n), ..SceneMesh::default() };
            write_scene(&path, &[work], &Job::default()).expect("written");
            std::fs::read(path).expect("read")
        })
        .collect();
    let dir = tempfile::tempdir().expect("a folder");
    let (out, calls): (_, u64) = run(dir.path(), None);
    assert!(out.status.success() && calls > 20, "{calls} calls");
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let step = if long { 1 } else { (calls / 12).max(1) };
    let (mut days, mut kept, mut refused) = (0, 0, 0);
    for (kind, ever) in [("eio", false), ("enospc", true), ("short", false)] {
        for n in (1..=calls).step_by(step as usize) {
            let case = format!("{kind} at call {n} of {calls}");
            let dir = tempfile::tempdir().expect("a folder");
            let (out, _) = run(dir.path(), Some((n, kind, ever)));
            let said = String::from_utf8_lossy(&out.stdout).into_owned();
            assert!(out.status.success(), "{case}: {said}");
            days += 1;
            let (here, there) = (dir.path().join("works"), dir.path().join("store"));
            // The disk works again, and the program restarts.
            let spool = Spool::start(&here, &there.display().to_string());
            let spool = spool.unwrap_or_else(|e| panic!("{case}: {e}"));
            crate::waiting::until("all is sent", || {
                spool::waiting(&here).is_ok_and(|all| all.is_empty())
            });
            drop(spool);
            for line in said.lines().filter(|l| l.contains("refused ")) {
                refused += 1;
                assert!(line.contains(": "), "{case}: {line}");
            }
            for line in said.lines().filter_map(|l| l.split("kept ").nth(1)) {
                let (n, name) = line.split_once(' ').expect("a number and a name");
                let content = &expected[n.parse::<usize>().expect("a number") - 1];
                for folder in [&here, &there] {
                    let found = std::fs::read(folder.join(name));
                    assert!(found.is_ok_and(|f| f == *content), "{case}: {name} is not whole");
                }
                kept += 1;
            }
            // Whatever has a sculpture's name is a whole one.
            for name in gallery::works(&here).expect("listed") {
                let found = std::fs::read(here.join(&name)).expect("read");
                assert!(expected.contains(&found), "{case}: {name} is torn");
            }
        }
    }
    println!("{days} days of {calls} calls: {kept} sculptures kept, {refused} refused");
    assert!(kept > 0 && refused > 0);
}

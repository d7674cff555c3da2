//! Visits that a kill interrupts, in real processes.

#[cfg(target_os = "linux")]
mod random_kills;
#[cfg(target_os = "linux")]
pub mod service;

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::daemon_process::Daemon;
use crate::hostile::{descriptors, memory_kib};
use crate::waiting::{pause, until};

const STROKE: &str = r#"{
    "points": [[0.4, 0.5, 0.8, 0], [0.5, 0.55, 0.8, 100], [0.6, 0.5, 0.8, 200]],
    "space": "view"
}"#;

/// Nobody is sent away while a test runs.
const LONG: &str = "idle_s = 3600";

/// An installation whose settings have these lines, in a home folder that stays.
fn installation(home: tempfile::TempDir, lines: &str) -> Daemon {
    let file = home.path().join("kiosk.toml");
    let works = home.path().join("works");
    let audit = home.path().join("visits.log");
    let text = format!("gallery = {works:?}\naudit = {audit:?}\n{lines}\n");
    #[allow(clippy::disallowed_methods)] // Settings of a test.
    std::fs::write(&file, text).expect("written");
    let file = file.display().to_string();
    let daemon = Daemon::run_in(home, &["--kiosk", "--kiosk-config", &file]);
    until("it answers", || daemon.ctl("status", None).is_some());
    daemon
}

/// Ends a daemon with this signal and returns its home.
fn ended(mut daemon: Daemon, signal: rustix::process::Signal) -> tempfile::TempDir {
    let child = rustix::process::Pid::from_child(&daemon.child);
    rustix::process::kill_process(child, signal).expect("it runs");
    daemon.child.wait().expect("it ends");
    std::mem::replace(&mut daemon.home, tempfile::tempdir().expect("a folder"))
}

fn hash(daemon: &Daemon) -> String {
    let answer = daemon.ctl("hash", None).expect("an answer");
    answer["hash"].as_str().expect("a hash").to_owned()
}

fn sculpt(daemon: &Daemon) {
    let before = hash(daemon);
    daemon.ctl("stroke", Some(STROKE)).expect("a stroke");
    until("the stroke sculpts", || hash(daemon) != before);
}

/// Strokes until a visit has begun and the first stroke is over.
fn visit(daemon: &Daemon) {
    let begun = || {
        let lines = daemon.told.lock().expect("no panic");
        lines.iter().filter(|l| l.contains("a visit begins")).count()
    };
    let before = begun();
    daemon.ctl("stroke", Some(STROKE)).expect("a stroke");
    until("a visit has begun", || begun() > before);
    let still = || {
        let before = hash(daemon);
        pause(300);
        hash(daemon) == before
    };
    until("the first stroke is over", still);
    sculpt(daemon);
    until("the stroke is over", still);
}

fn audit(home: &Path) -> Vec<serde_json::Value> {
    let text = std::fs::read_to_string(home.join("visits.log")).unwrap_or_default();
    // A line that is still being written has no end yet.
    let whole = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
    whole.map(|l| serde_json::from_str(l).expect("a line of JSON")).collect()
}

fn works(home: &Path) -> usize {
    sculptd_daemon::kiosk::names::works(&home.join("works")).map_or(0, |w| w.len())
}

#[test]
fn a_visit_goes_on_after_a_kill_and_its_work_comes_to_the_gallery() {
    let mut daemon = installation(tempfile::tempdir().expect("a folder"), LONG);
    visit(&daemon);
    for round in 0..3 {
        let before = hash(&daemon);
        daemon = installation(ended(daemon, rustix::process::Signal::KILL), LONG);
        until("it says so", || daemon.has_told("the last visit was interrupted"));
        assert_eq!(hash(&daemon), before, "round {round}");
        sculpt(&daemon);
        pause(500);
    }
    let home = ended(daemon, rustix::process::Signal::TERM);
    assert_eq!(works(home.path()), 1);
    let lines = audit(home.path());
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert_eq!((&lines[0]["kept"], &lines[0]["interrupted"]), (&json!(true), &json!(true)));
    assert!(!home.path().join("sculptd/kiosk/visit.sculpt").exists(), "its work was put away");
    // Nothing of the visit is left.
    let daemon = installation(home, LONG);
    until("it sculpts", || daemon.has_told("end with Ctrl-C"));
    assert!(!daemon.has_told("interrupted"));
    let home = ended(daemon, rustix::process::Signal::KILL);
    let daemon = installation(home, LONG);
    until("it sculpts", || daemon.has_told("end with Ctrl-C"));
    assert!(!daemon.has_told("interrupted"), "nobody came");
    assert_eq!(audit(daemon.home.path()).len(), 1);
}

/// A kill between the write of the work and the removal of the visit's file, as its files show it.
#[test]
fn a_kill_while_a_work_is_put_away_keeps_it_once() {
    let daemon = installation(tempfile::tempdir().expect("a folder"), LONG);
    visit(&daemon);
    let home = ended(daemon, rustix::process::Signal::KILL);
    let folder = home.path().join("sculptd/kiosk");
    // The visit's file, and SQLite's beside it.
    let all = std::fs::read_dir(&folder).expect("the visit").map(|e| e.expect("a file").path());
    let kept: Vec<(PathBuf, Vec<u8>)> =
        all.map(|file| (file.clone(), std::fs::read(&file).expect("read"))).collect();
    // It goes on, and is put away.
    let daemon = installation(home, LONG);
    until("it says so", || daemon.has_told("the last visit was interrupted"));
    let home = ended(daemon, rustix::process::Signal::TERM);
    assert_eq!((works(home.path()), audit(home.path()).len()), (1, 1));
    let name = "work-000001.glb";
    assert_eq!(audit(home.path())[0]["work"], name);
    let note = |home: &Path| {
        let put = |file: &Path, bytes: &[u8]| {
            sculptd_geometry::io::write_beside(file, |out| out.write_all(bytes)).expect("written");
        };
        kept.iter().for_each(|(file, bytes)| put(file, bytes));
        put(
            &folder.join("putting-away"),
            home.join("works").join(name).to_str().expect("text").as_bytes(),
        );
    };
    // Killed after the line in the audit, and before it.
    let mut home = home;
    for without_line in [false, true] {
        note(home.path());
        if without_line {
            std::fs::remove_file(home.path().join("visits.log")).expect("removed");
        }
        let daemon = installation(home, LONG);
        until("it says so", || daemon.has_told("its work is work-000001.glb in the gallery"));
        until("it sculpts", || daemon.has_told("end with Ctrl-C"));
        home = ended(daemon, rustix::process::Signal::TERM);
        assert_eq!(works(home.path()), 1);
        let lines = audit(home.path());
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert_eq!((&lines[0]["work"], &lines[0]["interrupted"]), (&json!(name), &json!(true)));
        assert!(!folder.join("visit.sculpt").exists() && !folder.join("putting-away").exists());
    }
    // A note of a work that was never written changes nothing: the visit goes on.
    note(home.path());
    std::fs::remove_file(home.path().join("works").join(name)).expect("removed");
    let daemon = installation(home, LONG);
    until("it says so", || daemon.has_told("the last visit was interrupted"));
}

#[test]
fn an_interrupted_visit_comes_to_the_gallery_where_the_settings_say_so() {
    let lines = "idle_s = 3600\ninterrupted = \"gallery\"";
    let daemon = installation(tempfile::tempdir().expect("a folder"), lines);
    visit(&daemon);
    let daemon = installation(ended(daemon, rustix::process::Signal::KILL), lines);
    let home = daemon.home.path();
    until("the work is in the gallery", || works(home) == 1);
    until("there is a line", || audit(home).len() == 1);
    assert_eq!(audit(home)[0]["interrupted"], json!(true));
    let home = ended(daemon, rustix::process::Signal::TERM);
    assert_eq!((works(home.path()), audit(home.path()).len()), (1, 1), "no visit was under way");
}

#[test]
fn each_visit_has_a_file_of_its_own_and_the_one_that_was_interrupted_goes_on() {
    let short = "idle_s = 2\ncountdown_s = 1";
    let daemon = installation(tempfile::tempdir().expect("a folder"), short);
    for n in 1..=3 {
        visit(&daemon);
        until("the visit is over", || audit(daemon.home.path()).len() == n);
        assert_eq!(works(daemon.home.path()), n);
    }
    let daemon = installation(ended(daemon, rustix::process::Signal::TERM), LONG);
    until("it sculpts", || daemon.has_told("end with Ctrl-C"));
    assert!(!daemon.has_told("interrupted"));
    visit(&daemon);
    let before = hash(&daemon);
    let daemon = installation(ended(daemon, rustix::process::Signal::KILL), LONG);
    until("it says so", || daemon.has_told("the last visit was interrupted"));
    assert_eq!(hash(&daemon), before);
    let home = ended(daemon, rustix::process::Signal::TERM);
    assert_eq!((works(home.path()), audit(home.path()).len()), (4, 4));
    let left = std::fs::read_dir(home.path().join("sculptd/kiosk")).expect("a folder").count();
    assert_eq!(left, 0, "files of visits");
}

/// A curator tries an exhibit: no session, work or line of the visit stays, and that is said.
#[test]
fn a_preview_keeps_nothing_of_its_visits() {
    let home = tempfile::tempdir().expect("a folder");
    let mut daemon = Daemon::of_command(home, &["kiosk", "preview", "pot"]);
    until("it answers", || daemon.ctl("status", None).is_some());
    until("it sculpts", || daemon.has_told("end with Ctrl-C"));
    visit(&daemon);
    assert!(daemon.ctl("status", None).expect("an answer")["undo_steps"].as_u64() >= Some(1));
    let child = rustix::process::Pid::from_child(&daemon.child);
    rustix::process::kill_process(child, rustix::process::Signal::TERM).expect("it runs");
    assert!(daemon.child.wait().expect("it ends").success());
    until("it says so", || daemon.has_told("the preview has ended; nothing was kept"));
    assert_eq!(bytes(daemon.home.path(), ""), 0, "it kept something");
}

#[test]
fn every_visitor_begins_with_the_brush_of_the_settings() {
    let settings = "idle_s = 2\ncountdown_s = 1\nbrush = \"inflate\"\nradius = 0.3";
    let daemon = installation(tempfile::tempdir().expect("a folder"), settings);
    let brush = || daemon.ctl("status", None).expect("an answer")["brush"].clone();
    for n in 1..=2 {
        visit(&daemon);
        let begun = brush();
        assert_eq!(begun["kind"], "inflate", "visit {n}: {begun}");
        let radius = begun["radius"].as_f64().expect("a number");
        assert!((radius - 0.3).abs() < 1e-6, "visit {n}: {begun}");
        daemon.ctl("brush", Some(r#"{"kind": "grab"}"#)).expect("another brush");
        until("it is in the hand", || brush()["kind"] == "grab");
        until("the visit is over", || audit(daemon.home.path()).len() == n);
    }
}

/// Exhibits take turns in the attract loop, so each visit begins with another clay than the one
/// that its file was prepared for.
#[test]
fn a_visit_to_any_exhibit_goes_on_after_a_kill() {
    let lines = "exhibits = [\"relief\", \"pot\"]";
    let short = format!("idle_s = 2\ncountdown_s = 1\n{lines}");
    let mut home = tempfile::tempdir().expect("a folder");
    for round in 1..=2 {
        let daemon = installation(home, &short);
        for n in 1..=2 {
            let before = audit(daemon.home.path()).len();
            visit(&daemon);
            until("the visit is over", || audit(daemon.home.path()).len() > before);
            let line = audit(daemon.home.path()).pop().expect("a line");
            let expected = ["relief", "pot"][n - 1];
            assert_eq!(line["exhibit"], expected, "round {round}: {line}");
            assert!(line["percent"].as_u64().is_some_and(|p| p < 100), "{line}");
        }
        let daemon =
            installation(ended(daemon, rustix::process::Signal::TERM), &format!("{LONG}\n{lines}"));
        // The second exhibit's film comes after the first one's.
        if round == 2 {
            until("the next film", || {
                daemon.told.lock().expect("no panic").iter().any(|l| l.contains("shows pot"))
            });
        }
        visit(&daemon);
        let before = hash(&daemon);
        let daemon =
            installation(ended(daemon, rustix::process::Signal::KILL), &format!("{LONG}\n{lines}"));
        until("it says so", || daemon.has_told("the last visit was interrupted"));
        assert_eq!(hash(&daemon), before, "round {round}");
        home = ended(daemon, rustix::process::Signal::TERM);
        let line = audit(home.path()).pop().expect("a line");
        assert_eq!(line["interrupted"], json!(true), "{line}");
        assert_eq!(line["exhibit"], ["relief", "pot"][round - 1], "{line}");
    }
}

/// Bytes of the files in a folder and the folders in it, without this one.
fn bytes(folder: &Path, without: &str) -> u64 {
    let Ok(all) = std::fs::read_dir(folder) else { return 0 };
    let all = all.filter_map(Result::ok).filter(|e| e.file_name() != without);
    all.filter_map(|e| Some((e.path(), e.metadata().ok()?)))
        .map(|(path, m)| if m.is_dir() { bytes(&path, without) } else { m.len() })
        .sum()
}

/// Limit of the time from a touch to the beginning of its visit, in microseconds.
const BEGINS_US: u64 = 1_000_000;

/// Measurements of a day of visits.
#[derive(Debug, Clone, Copy, Default)]
struct Day {
    /// Most bytes on the disk beside the gallery and the audit.
    disk: u64,
    memory_kib: u64,
    descriptors: usize,
    /// Longest time from a touch to its visit, microseconds.
    begins_us: u64,
}

/// A visitor sculpts from the attract loop on, with a stroke that is over before the visit has
/// begun. Returns the time from the touch to the beginning of the visit, in microseconds.
fn come(daemon: &Daemon, clock: &sculptd_devices::Clock) -> u64 {
    let begun = || {
        let lines = daemon.told.lock().expect("no panic");
        lines.iter().filter(|l| l.contains("a visit begins")).count()
    };
    let before = begun();
    let mut took = 0;
    std::thread::scope(|scope| {
        let touched = clock.now_us();
        let stroke = scope.spawn(|| daemon.ctl("stroke", Some(STROKE)));
        until("a visit begins", || begun() > before);
        // With the start of the program that asks for the stroke.
        took = clock.now_us() - touched;
        stroke.join().expect("no panic").expect("a stroke");
    });
    took
}

/// Settings with opening hours: today, or on another day of the week alone.
fn day_settings(open: bool, home: &Path) -> String {
    let clock = sculptd_daemon::local_time::LocalClock::new().expect("a calendar");
    let today = clock.now().expect("a time").weekday as usize;
    let days = ["mon", "tue", "wed", "thu", "fri", "sat", "sun"];
    let (from, to) = if open { (today, (today + 1) % 7) } else { (today + 3, today + 3) };
    let store = home.join("works/store");
    let span = format!("{}-{} 0:00-24:00", days[from % 7], days[to % 7]);
    format!(
        "idle_s = 1\ncountdown_s = 1\nexhibits = [\"relief\", \"pot\"]\nwall_s = 5\n\
         gallery_store = {store:?}\n\n[hours]\nopen = [\"{span}\"]"
    )
}

/// A night: it is closed, and a touch begins no visit.
fn night(home: tempfile::TempDir) -> tempfile::TempDir {
    let settings = day_settings(false, home.path());
    let daemon = installation(home, &settings);
    until("it sculpts", || daemon.has_told("end with Ctrl-C"));
    daemon.ctl("stroke", Some(STROKE)).expect("a stroke");
    pause(500);
    assert!(!daemon.has_told("a visit begins"), "it is closed");
    ended(daemon, rustix::process::Signal::TERM)
}

/// Days of twenty visits to two exhibits, with opening hours. During a visit of each day the place
/// that works are sent to is gone; the last visit is killed, goes on and is put away. A month by
/// `SCULPTD_LONG`, which takes forty minutes, or as many days as `SCULPTD_DAYS` says. Disk, memory
/// and descriptors stay flat beside the gallery and the line of each visit. Each visit begins
/// within a second of the touch, and no first stroke is wiped.
#[test]
fn days_of_visits_fill_no_disk_and_each_killed_visit_goes_on() {
    let asked = std::env::var("SCULPTD_DAYS").ok().and_then(|d| d.parse().ok());
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let (days, visits) = if long || asked.is_some() { (asked.unwrap_or(30), 20) } else { (2, 3) };
    let clock = sculptd_devices::Clock::monotonic();
    let mut home = tempfile::tempdir().expect("a folder");
    let (mut all, mut opened_us): (Vec<Day>, _) = (Vec::new(), Vec::new());
    let mut seen_first_strokes = 0;
    for day in 0..days {
        let settings = day_settings(true, home.path());
        let mut daemon = installation(home, &settings);
        until("it sculpts", || daemon.has_told("end with Ctrl-C"));
        let mut of_day = Day::default();
        for visit in 1..=visits {
            let before = audit(daemon.home.path()).len();
            let store = daemon.home.path().join("works/store");
            if visit == 2 {
                std::fs::rename(&store, store.with_extension("gone")).expect("moved");
            }
            of_day.begins_us = of_day.begins_us.max(come(&daemon, &clock));
            // The first stroke is in the visit's clay, unless the visit is over already.
            let steps = || daemon.ctl("status", None).expect("an answer")["undo_steps"].as_u64();
            let over = || audit(daemon.home.path()).len() > before;
            until("the first stroke is there", || {
                let seen = steps() >= Some(1) && !over();
                seen_first_strokes += usize::from(seen);
                seen || over()
            });
            if visit == visits {
                // On a loaded machine the visit's file is made later.
                let written = || {
                    let status = daemon.ctl("status", None).expect("an answer");
                    status["journal"]["written"].as_u64() > Some(0)
                };
                until("its input is stored", || written() || over());
                pause(400);
                let home = ended(daemon, rustix::process::Signal::KILL);
                // On a loaded machine the visit may be over before the kill.
                let was_over = audit(home.path()).len() > before;
                let begun = clock.now_us();
                daemon = installation(home, &settings);
                if !was_over {
                    until("it says so", || daemon.has_told("the last visit was interrupted"));
                    opened_us.push(clock.now_us() - begun);
                }
            }
            let home = daemon.home.path();
            until("the visit is over", || audit(home).len() == before + 1);
            let told = daemon.told.lock().expect("no panic").clone();
            let lines = audit(home);
            assert_eq!(works(home), before + 1, "day {day}, visit {visit}: {lines:#?} {told:#?}");
            of_day.disk =
                of_day.disk.max(bytes(home, "works") - bytes_of(&home.join("visits.log")));
            if visit == 2 {
                std::fs::rename(store.with_extension("gone"), &store).expect("back");
            }
            if visit + 1 == visits {
                of_day.memory_kib = memory_kib(daemon.child.id());
                of_day.descriptors = descriptors(daemon.child.id());
            }
        }
        let stored = || {
            let there =
                sculptd_daemon::kiosk::names::works(&daemon.home.path().join("works/store"));
            there.map_or(0, |names| names.len())
        };
        until("all works are sent", || stored() == (day + 1) * visits);
        home = night(ended(daemon, rustix::process::Signal::TERM));
        println!("day {day}: {of_day:?}");
        all.push(of_day);
    }
    let lines = audit(home.path());
    let interrupted = lines.iter().filter(|l| l["interrupted"] == json!(true)).count();
    let killed = opened_us.len();
    assert_eq!((lines.len(), interrupted), (days * visits, killed), "each visit has its line");
    assert!(killed > 0 && seen_first_strokes > 0, "{killed} killed, {seen_first_strokes} seen");
    opened_us.sort_unstable();
    println!(
        "{} visits, {killed} killed, {seen_first_strokes} first strokes seen; back and open after \
         {} ms in the middle, {} ms at most",
        lines.len(),
        opened_us[killed / 2] / 1000,
        opened_us[killed - 1] / 1000
    );
    let (first, last) = (all[0], all[all.len() - 1]);
    let flat = |first: u64, last: u64, more: u64| last <= first + first / 10 + more;
    assert!(flat(first.disk, last.disk, 65_536), "disk: {all:?}");
    assert!(flat(first.memory_kib, last.memory_kib, 16 << 10), "memory: {all:?}");
    assert!(flat(first.descriptors as u64, last.descriptors as u64, 4), "descriptors: {all:?}");
    assert!(all.iter().all(|day| day.begins_us < BEGINS_US), "late visits: {all:?}");
}

fn bytes_of(file: &Path) -> u64 {
    std::fs::metadata(file).map_or(0, |m| m.len())
}

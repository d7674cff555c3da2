//! `sculptd kiosk try` on an installation below a loop as of its service. The window tests
//! try the loss of an X server.

use std::cell::Cell;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use sculptd_daemon::kiosk::trial::{self, TrialOutcome, TrialReport, TrialSettings, TriedFault};
use serde_json::Value;

use crate::kiosk_kills::service::ServedInstallation;

const LONG: &str = "idle_s = 3600";

/// A small disk in memory; `None` where it cannot be mounted.
struct SmallDisk<'a>(&'a Path);

impl SmallDisk<'_> {
    fn mount(at: &Path) -> Option<SmallDisk<'_>> {
        std::fs::create_dir_all(at).expect("made");
        let mount = ["-t", "tmpfs", "-o", "size=24m", "tmpfs"];
        let done = Command::new("mount").args(mount).arg(at).output();
        done.is_ok_and(|out| out.status.success()).then_some(SmallDisk(at))
    }
}

impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(self.0).output();
    }
}

fn tried(
    home: &Path,
    fault: TriedFault,
    move_clock: &dyn Fn(i64) -> std::io::Result<()>,
) -> TrialReport {
    let settings = TrialSettings { runtime: home, patience: Duration::from_secs(60), move_clock };
    let mut all = Vec::new();
    trial::run(&settings, &[fault], &mut |report| all.push(report));
    println!("{:?}", all[0]);
    assert_eq!(all.len(), 1);
    all.remove(0)
}

fn not_moved(_: i64) -> std::io::Result<()> {
    Err(std::io::ErrorKind::PermissionDenied.into())
}

#[test]
fn a_trial_reports_what_it_saw_and_what_it_could_not_try() {
    let dir = tempfile::tempdir().expect("a folder");
    let home = dir.path();
    let _kiosk = ServedInstallation::begin(home, LONG);
    let kill = tried(home, TriedFault::Kill, &not_moved);
    assert_eq!(kill.outcome, TrialOutcome::Passed, "{kill:?}");
    assert!(kill.seen.contains("showed the same sculpture after"), "{kill:?}");
    let screen = tried(home, TriedFault::Screen, &not_moved);
    assert_eq!(screen.outcome, TrialOutcome::NotTried);
    assert_eq!(screen.seen, "it runs without an X server");
    let devices = tried(home, TriedFault::Devices, &not_moved);
    assert_eq!(devices.outcome, TrialOutcome::NotTried);
    let clock = tried(home, TriedFault::Clock, &not_moved);
    assert!(clock.outcome == TrialOutcome::NotTried && clock.seen.contains("cannot be set"));
    // The clock of this machine is left alone: the trial moves it as far back as ahead.
    let moved = Cell::new((0, 0));
    let move_clock = |seconds| {
        moved.set((moved.get().0 + seconds, moved.get().1 + 1));
        Ok(())
    };
    let clock = tried(home, TriedFault::Clock, &move_clock);
    assert_eq!((clock.outcome, moved.get()), (TrialOutcome::Passed, (0, 2)), "{clock:?}");

    // The same by the command, each trial on a line or in one object.
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.args(["kiosk", "try", "--only", "kill", "--only", "devices", "--runtime"]).arg(home);
    let out = command.output().expect("runs");
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!((out.status.code(), lines.len()), (Some(0), 2), "{text}");
    assert!(lines[0].starts_with("as promised  kill the program: another process"), "{text}");
    assert!(lines[1].starts_with("not tried    unplug the devices: no command"), "{text}");
    let out = command.arg("--json").output().expect("runs");
    let answer: Value = serde_json::from_slice(&out.stdout).expect("one JSON object");
    assert_eq!(answer["trials"][0]["outcome"], "passed");
}

#[test]
fn a_full_disk_is_seen_to_be_reported_and_to_be_over() {
    let dir = tempfile::tempdir().expect("a folder");
    let home = dir.path();
    let data = home.join("data");
    let Some(_disk) = SmallDisk::mount(&data) else {
        println!("skipped: a small disk cannot be mounted here");
        return;
    };
    let kiosk = ServedInstallation::begin(home, LONG);
    let disk = tried(home, TriedFault::Disk, &not_moved);
    assert_eq!(disk.outcome, TrialOutcome::Passed, "{disk:?}");
    assert!(disk.seen.contains("more was stored"), "{disk:?}");
    // The staff page lists it among the newest errors.
    assert!(kiosk.times("kiosk: the visit is not stored: the session file takes nothing") >= 1);
}

/// An installation that does not come back, or that is not there, is a failure.
#[test]
fn a_trial_fails_where_nothing_comes_back() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.args(["kiosk", "try", "--only", "kill", "--patience", "2", "--runtime"]);
    command.arg(dir.path());
    let out = command.output().expect("runs");
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(out.status.code(), Some(1), "{text}");
    assert!(text.starts_with("FAILED       kill the program: no installation answers"), "{text}");
    let kiosk = ServedInstallation::begin(dir.path(), LONG);
    kiosk.stop_restarting();
    let out = command.output().expect("runs");
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(out.status.code(), Some(1), "{text}");
    assert!(text.contains("it was not back after 2 s"), "{text}");
}

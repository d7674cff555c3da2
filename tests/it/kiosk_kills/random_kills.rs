//! Random kills and power cuts during visits.

use std::path::{Path, PathBuf};

use sculptd_daemon::session::{catalog, shared_memory_log};
use serde_json::{Value, json};

use super::service::ServedInstallation;
use super::{audit, works};
use crate::seeded::Random;
use crate::waiting::{pause, until};

fn wal(file: &Path) -> PathBuf {
    PathBuf::from(format!("{}-wal", file.display()))
}

/// Removes the memory and an unsynced end of the write-ahead log, as a power cut does. `synced`:
/// the log a while ago.
fn cut(file: &Path, synced: &[u8], random: &mut Random) {
    catalog::logs_of(file).iter().for_each(shared_memory_log::remove);
    let now = std::fs::read(wal(file)).unwrap_or_default();
    // A log that was begun again is synced before anything follows.
    if synced.len() < 32 || !now.starts_with(synced) {
        return;
    }
    let keep = synced.len() as u64 + random.below((now.len() - synced.len()) as u64 + 1);
    let log = std::fs::OpenOptions::new().write(true).open(wal(file));
    log.and_then(|log| log.set_len(keep)).expect("cut");
}

/// Undoes a visit's strokes, compares the clay with that of the first visitor, and redoes them.
fn has_no_residue(kiosk: &ServedInstallation, clean: &mut Option<String>) {
    let (steps, worked) = (kiosk.figure("undo_steps"), kiosk.rested());
    for _ in 0..steps {
        kiosk.ask("undo", &Value::Null);
    }
    until("all is undone", || kiosk.figure("undo_steps") == 0);
    let begun = kiosk.rested();
    let clean = clean.get_or_insert_with(|| begun.clone().expect("a hash"));
    assert_eq!(begun.as_ref(), Some(&*clean), "the visit began with a residue");
    for _ in 0..steps {
        kiosk.ask("redo", &Value::Null);
    }
    until("all is redone", || kiosk.rested() == worked);
}

/// Visits and their ends.
#[derive(Debug, Default)]
struct KillCounts {
    kills: usize,
    cuts: usize,
    /// Works that came back.
    back: usize,
    /// Of these, works that were in the gallery already.
    twice: usize,
    /// Works that were put away before the kill.
    over: usize,
    works: usize,
    lines: usize,
}

/// Kills an installation at random moments of its visits.
fn kill_visits(seed: u64, rounds: usize) -> KillCounts {
    let mut random = Random(seed);
    let dir = tempfile::tempdir().expect("a folder");
    let kiosk = ServedInstallation::begin(dir.path(), "idle_s = 6\ncountdown_s = 1");
    let home = dir.path();
    let (mut clean, mut counts) = (None, KillCounts::default());
    for round in 0..rounds {
        let at = format!("seed {seed}, round {round}");
        let (audited, kept) = (audit(home).len(), works(home));
        assert!(kept >= audited, "{at}: a work for each line");
        let begun = kiosk.times("a visit begins");
        // A program that has just started may not see the first touch.
        until("a visit begins", || {
            kiosk.stroke(0.5);
            pause(400);
            kiosk.times("a visit begins") > begun
        });
        kiosk.rested();
        // Once it is made, no earlier one is on its way, however busy the machine is.
        let row = 0.3 + 0.4 * random.part();
        until("a stroke is made", || kiosk.stroke(row));
        let mut seen = kiosk.rested();
        has_no_residue(&kiosk, &mut clean);
        let synced = std::fs::read(wal(&kiosk.visit_file())).unwrap_or_default();
        // Rest, a stroke on its way, the countdown, the farewell: the kill comes anywhere.
        if random.below(2) == 0 {
            kiosk.stroke(0.3 + 0.4 * random.part());
            seen = None;
            pause(random.below(400));
        } else {
            pause(random.below(8_000));
        }
        let interruptions = kiosk.times("the last visit was interrupted");
        let file = kiosk.visit_file();
        match random.below(3) {
            0 => {
                counts.cuts += 1;
                kiosk.kill(|| cut(&file, &synced, &mut random));
            }
            _ => {
                counts.kills += 1;
                kiosk.kill(|| ());
            }
        }
        let lines = audit(home);
        if kiosk.times("the last visit was interrupted") == interruptions {
            // The visit was over: its work is in the gallery already.
            assert_eq!((lines.len(), works(home)), (audited + 1, kept + 1), "{at}");
            counts.over += 1;
            continue;
        }
        counts.back += 1;
        // The kill fell between the gallery and the removal of the visit's file.
        counts.twice += usize::from(works(home) > kept);
        let now = kiosk.rested();
        assert!(seen.is_none() || now == seen, "{at}: another work came back");
        assert_ne!(now, clean, "{at}: the work was lost");
        until("the visit is over", || audit(home).len() > lines.len());
        let lines = audit(home);
        let line = lines.last().expect("a line");
        assert_eq!((&line["interrupted"], &line["kept"]), (&json!(true), &json!(true)), "{at}");
        assert!(works(home) >= lines.len(), "{at}: a work for each line");
    }
    KillCounts { works: works(home), lines: audit(home).len(), ..counts }
}

/// Every work comes back or is in the gallery, the audit file says which, and no visit begins with
/// a residue. 200 kills and cuts by `SCULPTD_LONG=1`, in installations beside each other.
#[test]
fn random_kills_and_cuts_lose_no_visit() {
    let (beside, rounds) =
        if std::env::var_os("SCULPTD_LONG").is_some() { (5u64, 40) } else { (2, 3) };
    let seed = std::env::var("SCULPTD_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(52);
    let start = |n: u64| std::thread::spawn(move || kill_visits(seed + n, rounds));
    let runs: Vec<_> = (0..beside).map(start).collect();
    let mut all = KillCounts::default();
    for run in runs {
        let one = run.join().expect("no work was lost");
        all.kills += one.kills;
        all.cuts += one.cuts;
        all.back += one.back;
        all.twice += one.twice;
        all.over += one.over;
        all.works += one.works;
        all.lines += one.lines;
    }
    println!("{} visits, 0 begun with a residue: {all:?}", beside as usize * rounds);
    assert!(all.back > 0);
}

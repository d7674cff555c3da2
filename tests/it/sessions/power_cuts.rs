//! Power cuts: data that was not synced exists, is torn, or is missing.

use super::*;

/// One state of the disk.
#[derive(Clone)]
pub(super) struct Disk {
    pub db: Vec<u8>,
    pub wal: Vec<u8>,
}

impl Disk {
    pub(super) fn of(path: &Path) -> Self {
        let wal = std::fs::read(wal(path)).unwrap_or_default();
        Disk { db: std::fs::read(path).expect("read"), wal }
    }
}

pub(super) const SECTOR: usize = 512;
/// Length of a write-ahead log's header.
const LOG_HEADER: usize = 32;

/// Pages of the database that differ; two are the acknowledgement's.
fn changed(a: &[u8], b: &[u8]) -> usize {
    let more = a.len().abs_diff(b.len()) / 4096;
    more + a.chunks(4096).zip(b.chunks(4096)).filter(|(a, b)| a != b).count()
}

/// The bytes of the acknowledgements in a database: of each its mark and two slots.
fn acknowledged_at(db: &[u8]) -> Vec<std::ops::Range<usize>> {
    use sculptd_daemon::session::acknowledgement::{MAGIC, SLOT};
    let marks = db.windows(MAGIC.len()).enumerate().filter(|w| *w.1 == MAGIC);
    marks.map(|(at, _)| at..at + MAGIC.len() + 2 * SLOT).collect()
}

/// Returns the database with all of its log.
fn taken_over(disk: &Disk, folder: &Path) -> Vec<u8> {
    let path = folder.join("whole.sculpt");
    put(&path, &disk.db);
    put(&wal(&path), &disk.wal);
    let db = rusqlite::Connection::open(&path).expect("opens");
    let all = "PRAGMA wal_checkpoint(TRUNCATE)";
    db.query_row(all, [], |_| Ok(())).expect("taken over");
    drop(db);
    std::fs::read(&path).expect("read")
}

/// Returns a possible content of the disk after a power cut between the states `a` (completely
/// synced) and `b` (its last writes not).
fn cut(a: &Disk, b: &Disk, folder: &Path, rng: &mut Rng) -> Disk {
    let restarted = a.wal.len() < LOG_HEADER
        || b.wal.len() < a.wal.len()
        || a.wal[..LOG_HEADER] != b.wal[..LOG_HEADER];
    // A log is begun again only after the database holds all of it: then the database is `b`'s.
    let mut out = if restarted { b.clone() } else { Disk { db: a.db.clone(), wal: b.wal.clone() } };
    // Unless its database holds more than the log of `a`: what a database took over was synced.
    if restarted && a.wal.len() >= LOG_HEADER && changed(&taken_over(a, folder), &b.db) > 2 {
        return out;
    }
    // The acknowledgement of `b` is written after `b` is synced, so it is never there.
    for at in acknowledged_at(&out.db) {
        out.db[at.clone()].copy_from_slice(&a.db[at]);
    }
    let old = a.wal.clone();
    // Bytes before this one were written and synced long ago; no write touches them again. The
    // header of a log that is begun again is synced before anything follows it.
    let same =
        old.iter().zip(&out.wal).position(|(x, y)| x != y).unwrap_or(old.len().min(out.wal.len()));
    let keep = if restarted { same.max(LOG_HEADER.min(out.wal.len())) } else { same };
    let differs: Vec<usize> = (0..out.wal.len())
        .step_by(SECTOR)
        .filter(|&s| {
            let e = (s + SECTOR).min(out.wal.len());
            old.get(s..e) != Some(&out.wal[s..e])
        })
        .collect();
    match rng.below(4) {
        // The file never grew.
        0 if !restarted => {
            let tail = out.wal.len() - a.wal.len();
            out.wal.truncate(a.wal.len() + rng.below(tail as u64 + 1) as usize);
        }
        mode => {
            for s in differs {
                if rng.below(2) == 0 {
                    continue;
                }
                let (s, e) = (s.max(keep), (s + SECTOR).min(out.wal.len()));
                match (mode, old.get(s..e)) {
                    (1 | 0, Some(was)) => out.wal[s..e].copy_from_slice(was),
                    (2, _) => out.wal[s..e].iter_mut().for_each(|x| *x = rng.below(256) as u8),
                    _ => out.wal[s..e].fill(0),
                }
            }
        }
    }
    // A database that was being brought up to date, with the log that it is brought up to date from
    // still there.
    if !restarted && changed(&a.db, &b.db) > 2 && rng.below(2) == 0 {
        out.wal = b.wal.clone();
        out.db = b.db.clone();
        for s in (0..a.db.len()).step_by(SECTOR) {
            if rng.below(2) == 0 {
                let e = (s + SECTOR).min(a.db.len()).min(out.db.len());
                out.db[s..e].copy_from_slice(&a.db[s..e]);
            }
        }
    }
    out
}

/// `cuts` power cuts of one session; answers with groups lost in full, and checkpoints that a cut
/// fell into.
fn power_cuts(seed: u64, cuts: u64) -> (u64, u64) {
    let dir = tempfile::tempdir().expect("a folder");
    let mut rng = Rng::new(seed);
    let mut script = Script::begin(dir.path());
    // Memory is gone with the power.
    session::catalog::logs_of(&script.path).iter().for_each(session::shared_memory_log::remove);
    script.group(5);
    let database = rusqlite::Connection::open(&script.path).expect("opens");
    let (mut lost, mut checkpoints) = (0, 0);
    for n in 0..cuts {
        let ticks = 1 + rng.below(90);
        // As the syncer does after a while: the next group then begins the log again.
        let mut perhaps_take_over = |one_in| {
            if rng.below(one_in) == 0 {
                let passive = "PRAGMA wal_checkpoint(PASSIVE)";
                database.query_row(passive, [], |_| Ok(())).expect("taken over");
            }
        };
        perhaps_take_over(3);
        let (synced, a) = (script.written(), Disk::of(&script.path));
        script.group(ticks);
        perhaps_take_over(5);
        let (newest, b) = (script.written(), Disk::of(&script.path));
        let checkpoint = changed(&a.db, &b.db) > 2;
        checkpoints += u64::from(checkpoint);
        let at = cut(&a, &b, dir.path(), &mut rng);
        let path = dir.path().join("after.sculpt");
        put(&path, &at.db);
        put(&wal(&path), &at.wal);
        let _ = std::fs::remove_file(format!("{}-shm", path.display()));
        let opened = session::open(&path).unwrap_or_else(|e| panic!("seed {seed}, cut {n}: {e}"));
        assert_eq!(opened.loss, None, "seed {seed}, cut {n}: a torn write must look like none");
        let last = opened.input.last().map_or(0, |t| t.tick);
        assert!(
            (synced..=newest).contains(&last),
            "seed {seed}, cut {n}: {last}, synced {synced}, newest {newest}"
        );
        // Each replay begins at the start: of a long session one in eight, and each that matters.
        if cuts < 100 || n.is_multiple_of(8) || checkpoint {
            assert_eq!(
                hash_of(&opened),
                script.hashes[last as usize],
                "seed {seed}, cut {n}, tick {last}"
            );
        }
        // And it can be gone on with.
        let (writer, thread) = session::resume(&path).expect("goes on");
        drop(writer);
        assert_eq!(thread.finish(), None);
        lost += u64::from(last < newest);
    }
    drop(database);
    script.end();
    (lost, checkpoints)
}

#[test]
fn a_hundred_power_cuts_cost_the_last_group_at_most() {
    let runs: Vec<_> =
        (0..10).map(|seed| std::thread::spawn(move || power_cuts(100 + seed, 10))).collect();
    let all: Vec<(u64, u64)> =
        runs.into_iter().map(|r| r.join().expect("no cut was fatal")).collect();
    let lost: u64 = all.iter().map(|a| a.0).sum();
    println!("100 power cuts: {lost} cost their last group, {} kept it", 100 - lost);
    assert!(lost > 20, "the cuts do tear: {all:?}");
}

/// With enough input between the cuts that SQLite moves its log into the database again and again.
#[test]
fn power_cuts_during_checkpoints_cost_no_more() {
    if std::env::var_os("SCULPTD_LONG").is_none() {
        println!("skipped: SCULPTD_LONG not set");
        return;
    }
    let (lost, checkpoints) = power_cuts(5, 900);
    println!(
        "900 power cuts of one session: {lost} cost their last group, {checkpoints} fell into a \
            checkpoint"
    );
    assert!(checkpoints > 0);
}

//! Random damage: nothing is lost silently, nothing readable is refused, the damaged file does not
//! change, and the loss is reported in ticks.

use std::path::Path;

use sculptd_daemon::session::history::Keeper;
use sculptd_daemon::session::reopen;
use sculptd_daemon::session::{OpenError, open, salvage};

use super::power_cuts::{Disk, SECTOR};
use super::*;

/// Ticks of each session.
const TICKS: u64 = 480;

/// A session with its history, half of it taken over into the main file.
fn session_with_history(dir: &Path) -> Script {
    let mut script = Script::begin(dir);
    let keeper =
        Keeper::start(script.path.as_path(), &mut script.world, 0, None, 1 << 40).expect("kept");
    script.writer.iter_mut().for_each(|w| w.keep(keeper.handle.clone()));
    let history = keeper.handle.clone();
    if let Some(thread) = &mut script.thread {
        thread.history = Some(keeper);
    }
    script.hashes = vec![script.world.hash()];
    for n in 0..TICKS / 60 {
        script.group(60);
        crate::waiting::until("the history is written", || history.is_idle());
        if n == TICKS / 120 {
            let db = rusqlite::Connection::open(&script.path).expect("opens");
            db.query_row("PRAGMA wal_checkpoint(PASSIVE)", [], |_| Ok(())).expect("taken over");
        }
    }
    script
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Damage {
    Flip,
    Zero,
    Cut,
    MissingLog,
    OthersLog,
}

fn spoil(disk: &mut Disk, other: &Disk, rng: &mut Rng) -> (Damage, bool) {
    let kinds = [Damage::Flip, Damage::Zero, Damage::Cut, Damage::MissingLog, Damage::OthersLog];
    let damage = kinds[rng.below(kinds.len() as u64) as usize];
    let log = !disk.wal.is_empty() && rng.below(2) == 0;
    match damage {
        Damage::MissingLog => disk.wal.clear(),
        Damage::OthersLog => disk.wal.clone_from(&other.wal),
        _ => {
            let bytes = if log { &mut disk.wal } else { &mut disk.db };
            let length = bytes.len() as u64;
            match damage {
                Damage::Flip => {
                    for _ in 0..=rng.below(3) {
                        bytes[rng.below(length) as usize] ^= 1 << rng.below(8);
                    }
                }
                Damage::Zero => {
                    let at = rng.below(length) as usize / SECTOR * SECTOR;
                    let end = (at + (1 + rng.below(16) as usize) * SECTOR).min(bytes.len());
                    bytes[at..end].fill(0);
                }
                _ => bytes.truncate(rng.below(length) as usize),
            }
        }
    }
    (damage, log)
}

/// The sculpture that a whole session opens with, and its tick.
fn sculpture(opened: &session::Opened) -> (u64, u64) {
    let job = Job::default();
    let made = match reopen(&opened.path, opened, None, 1, &job) {
        Some(r) => r.replayed,
        None if opened.replay_from.is_some() => panic!("no checkpoint serves"),
        None => replay::replay(opened, None, Workers::new(1), &job).expect("replays"),
    };
    (made.ticks, made.world.hash())
}

#[derive(Debug, Default)]
struct Outcome {
    whole: u32,
    saved: u32,
    /// The file was cut before the start mesh ended, and its second copy with it: no tick and no
    /// checkpoint can be read, for both are changes of the start.
    no_start: u32,
    ticks_lost: u64,
}

fn one(
    (disk, damage): (&Disk, Damage),
    hashes: &[u64],
    here: &Path,
    case: &str,
    out: &mut Outcome,
) {
    std::fs::create_dir(here).expect("a folder");
    let path = here.join("d.sculpt");
    put(&path, &disk.db);
    if !disk.wal.is_empty() {
        put(&wal(&path), &disk.wal);
    }
    match open(&path) {
        Ok(opened) if opened.loss.is_none() => {
            let last = opened.input.last().map_or(0, |t| t.tick);
            assert_eq!(last, TICKS, "{case}: lost in silence");
            assert_eq!(sculpture(&opened), (TICKS, hashes[TICKS as usize]), "{case}");
            out.whole += 1;
        }
        _ => match salvage(&path) {
            Ok(saved) => {
                let opened = open(&saved.path).unwrap_or_else(|e| panic!("{case}: {e}"));
                assert_eq!(opened.loss, None, "{case}: {saved}");
                let (tick, hash) = sculpture(&opened);
                let loss = saved.loss.clone().unwrap_or_else(|| panic!("{case}: {saved}"));
                if !saved.start_changed {
                    assert_eq!(loss.kept, tick, "{case}: {saved}");
                    assert_eq!(hash, hashes[tick as usize], "{case}: {saved}");
                }
                assert_eq!(loss.last, Some(TICKS), "{case}: {saved}");
                out.ticks_lost += TICKS.saturating_sub(loss.kept);
                out.saved += 1;
            }
            Err(SalvageError::Open(OpenError::Damaged { what, .. })) => {
                assert!(what == "start_mesh" || what == "settings", "{case}: {what}");
                assert_eq!(damage, Damage::Cut, "{case}: a second copy is in the file");
                out.no_start += 1;
            }
            Err(e) => panic!("{case}: refused: {e}"),
        },
    }
    assert!(std::fs::read(&path).expect("still there") == disk.db, "{case}: the file changed");
}

#[test]
fn random_damage_is_never_silent_and_never_refused_where_something_can_be_read() {
    let cases = if std::env::var_os("SCULPTD_LONG").is_some() { 1000 } else { 60 };
    let dirs: Vec<_> = (0..3).map(|_| tempfile::tempdir().expect("a folder")).collect();
    // Another session, whose log is put beside the others.
    let mut other = session_with_history(dirs[0].path());
    let foreign = Disk::of(&other.path);
    // One that was killed, and whose memory a power cut took.
    let mut killed = session_with_history(dirs[1].path());
    session::catalog::logs_of(&killed.path).iter().for_each(session::shared_memory_log::remove);
    let in_the_middle = Disk::of(&killed.path);
    assert!(in_the_middle.wal.len() > 100_000, "{} bytes of log", in_the_middle.wal.len());
    let mut closed = session_with_history(dirs[2].path());
    closed.end();
    let at_the_end = Disk::of(&closed.path);
    assert!(at_the_end.wal.is_empty());
    let dir = tempfile::tempdir().expect("a folder");
    let mut rng = Rng::new(2024);
    for (name, disk, hashes) in
        [("killed", &in_the_middle, &killed.hashes), ("closed", &at_the_end, &closed.hashes)]
    {
        let mut out = Outcome::default();
        for n in 0..cases / 2 {
            let mut spoilt = disk.clone();
            let (damage, log) = spoil(&mut spoilt, &foreign, &mut rng);
            let case = format!("{name} {n}: {damage:?}, log {log}");
            one(
                (&spoilt, damage),
                hashes,
                &dir.path().join(format!("{name}-{n}")),
                &case,
                &mut out,
            );
        }
        println!("{} damages of a {name} session: {out:?}", cases / 2);
        assert!(out.saved > cases / 10, "{out:?}");
    }
    killed.end();
    other.end();
}

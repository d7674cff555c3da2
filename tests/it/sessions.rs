//! Session files that went through what really happens: torn, flipped, cut off from power, on a
//! full disk.

mod damages;
mod power_cuts;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::Ordering::Relaxed;

use crate::waiting::comes;
use glam::Vec2;
use sculptd_clay::{Clay, Workers};
use sculptd_daemon::config::Config;
use sculptd_daemon::session;
use sculptd_daemon::session::format::Settings;
use sculptd_daemon::session::salvage::SalvageError;
use sculptd_daemon::session::writer::WriterThread;
use sculptd_daemon::session::{SessionWriter, replay, salvage};
use sculptd_daemon::startup;
use sculptd_daemon::tick::Journal;
use sculptd_devices::sim::faults::Rng;
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};
use serde_json::Value;

#[allow(clippy::disallowed_methods)] // A test's damaged file is meant to be what it is.
fn put(path: &Path, bytes: &[u8]) {
    std::fs::write(path, bytes).expect("written");
}

fn settings() -> Settings {
    let c = Config::default();
    Settings {
        rate_hz: 120,
        dab_budget: c.r#loop.dab_budget,
        undo_bytes: 1 << 26,
        camera: c.camera.camera(),
        brush: c.brush,
        hands: c.hand,
    }
}

fn fresh(start: &TriMesh) -> World {
    let s = settings();
    let mesh = Clay::build(start, &Job::default()).expect("a ball");
    let options =
        WorldOptions { dab_budget: s.dab_budget, undo_bytes: s.undo_bytes, hands: s.hands };
    World::new(mesh, s.camera, s.brush, Workers::new(1), options)
}

/// The script's samples of a tick: a pen that circles, and lifts every 50 ticks.
fn samples(tick: u64) -> Vec<Sample> {
    let area_mm = Vec2::new(160.0, 100.0);
    (0..4)
        .map(|k| {
            let angle = (tick * 4 + k) as f32 * 0.07;
            let pen = Pen {
                in_range: true,
                tip: tick % 50 != 0,
                pos_mm: area_mm * 0.5 + Vec2::new(angle.cos(), angle.sin()) * 18.0,
                area_mm,
                pressure: Some(0.3 + 0.2 * angle.sin()),
                ..Pen::default()
            };
            let t_us = tick * 8333 + k * 2000;
            Sample { device: DeviceId(1), t_us, device_t_us: Some(t_us), body: Body::Pen(pen) }
        })
        .collect()
}

/// A scripted session being written, with the world's hash after each tick.
struct Script {
    path: PathBuf,
    world: World,
    hashes: Vec<u64>,
    writer: Option<SessionWriter>,
    thread: Option<WriterThread>,
}

impl Script {
    fn begin(dir: &Path) -> Self {
        let start = shapes::sphere_of_about(400);
        let path = dir.join("s.sculpt");
        let (writer, thread) = session::create(&path, &start, &settings()).expect("created");
        let world = fresh(&start);
        let hashes = vec![world.hash()];
        Script { path, world, hashes, writer: Some(writer), thread: Some(thread) }
    }

    fn tick(&mut self) -> u64 {
        let tick = self.hashes.len() as u64;
        let input = samples(tick);
        self.world.step(tick, &input, &[]);
        self.hashes.push(self.world.hash());
        if let Some(writer) = &mut self.writer {
            writer.tick(tick, &input, &[], &mut self.world);
        }
        tick
    }

    fn written(&self) -> u64 {
        self.thread.as_ref().map_or(0, |t| t.health.written.load(Relaxed))
    }

    fn trouble(&self) -> Option<String> {
        self.thread.as_ref().and_then(|t| t.health.trouble())
    }

    /// Ticks of one group, and waits until it is synced.
    fn group(&mut self, ticks: u64) {
        let last = (0..ticks).map(|_| self.tick()).last().unwrap_or(0);
        let written = comes(|| self.written() >= last);
        assert!(written, "tick {last} was never written: {:?}", self.trouble());
    }

    fn end(&mut self) {
        self.writer = None;
        assert_eq!(self.thread.take().and_then(WriterThread::finish), None);
    }
}

/// A session of some groups, closed; its bytes and the hash after every tick.
fn whole(dir: &Path, groups: u64) -> (Vec<u8>, Vec<u64>) {
    let mut script = Script::begin(dir);
    for _ in 0..groups {
        script.group(60);
    }
    script.end();
    (std::fs::read(&script.path).expect("read"), script.hashes)
}

fn hash_of(opened: &session::Opened) -> u64 {
    replay::replay(opened, None, Workers::new(1), &Job::default()).expect("replays").world.hash()
}

fn wal(path: &Path) -> PathBuf {
    PathBuf::from(format!("{}-wal", path.display()))
}

#[test]
fn a_damaged_session_is_saved_beside_the_old_one_and_the_loss_told_in_ticks() {
    let dir = tempfile::tempdir().expect("a folder");
    let (bytes, hashes) = whole(dir.path(), 8);
    let mut rng = Rng::new(11);
    let (mut intact, mut saved, mut refused) = (0, 0, 0);
    for case in 0..100 {
        let here = dir.path().join(format!("case-{case}"));
        std::fs::create_dir(&here).expect("a folder");
        let path = here.join("d.sculpt");
        let mut damaged = bytes.clone();
        if case % 2 == 0 {
            damaged.truncate(rng.below(bytes.len() as u64) as usize);
        } else {
            for _ in 0..=rng.below(4) {
                let at = rng.below(bytes.len() as u64) as usize;
                damaged[at] ^= 1 << rng.below(8);
            }
        }
        put(&path, &damaged);
        match session::open(&path) {
            // Input accepted by the checksums is, to the bit, a prefix of the written input.
            Ok(opened) if opened.loss.is_none() => {
                let last = opened.input.last().map_or(0, |t| t.tick);
                assert_eq!(hash_of(&opened), hashes[last as usize], "case {case}");
                intact += 1;
            }
            _ => match salvage(&path) {
                Ok(s) => {
                    let opened = session::open(&s.path).expect("the saved file is whole");
                    assert_eq!(opened.loss, None, "case {case}");
                    let kept = opened.input.last().map_or(0, |t| t.tick);
                    if !s.start_changed {
                        assert_eq!(hash_of(&opened), hashes[kept as usize], "case {case}");
                    }
                    if let Some(loss) = &s.loss {
                        assert_eq!(loss.kept, kept, "case {case}");
                        assert!(s.to_string().contains(&format!("tick {kept}")), "{s}");
                    }
                    saved += 1;
                }
                Err(e) => {
                    assert!(e.to_string().contains("d.sculpt"), "{e}");
                    refused += 1;
                }
            },
        }
        assert!(
            std::fs::read(&path).expect("still there") == damaged,
            "case {case}: the old file changed"
        );
    }
    println!(
        "100 damaged sessions: {intact} whole in all that counts, {saved} saved, {refused} refused \
            with a reason"
    );
    assert!(saved >= 30, "{intact} {saved} {refused}");
}

#[test]
fn the_session_tools_tell_and_mend() {
    let dir = tempfile::tempdir().expect("a folder");
    whole(dir.path(), 6);
    let ask = |args: &[&str]| {
        let out = Command::new(env!("CARGO_BIN_EXE_sculptd"))
            .arg("session")
            .args(args)
            .arg("--json")
            .output()
            .expect("runs");
        let value: Value = serde_json::from_slice(&out.stdout).unwrap_or_default();
        (out.status.code(), value, String::from_utf8_lossy(&out.stderr).into_owned())
    };
    let good = dir.path().join("s.sculpt").display().to_string();
    let (code, shown, _) = ask(&["show", &good]);
    assert_eq!(
        (code, &shown["facts"]["last_tick"], &shown["damage"]),
        (Some(0), &Value::from(360), &Value::Null)
    );
    // The input of the last row is overwritten with nothing: all groups before it stay.
    let bad = dir.path().join("bad.sculpt");
    std::fs::copy(&good, &bad).expect("copied");
    let db = rusqlite::Connection::open(&bad).expect("opens");
    let spoil = "UPDATE input SET data = zeroblob(length(data))
                 WHERE number = (SELECT max(number) FROM input)";
    assert_eq!(db.execute(spoil, []).expect("spoilt"), 1);
    drop(db);
    let bad = bad.display().to_string();
    let (code, shown, said) = ask(&["show", &bad]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("session save"), "{said}");
    let (code, saved, said) = ask(&["save", &bad]);
    assert_eq!(code, Some(0), "{said}");
    let kept = 360 - saved["lost_ticks"].as_u64().expect("ticks");
    assert!(
        shown["damage"].as_str().is_some_and(|d| d.contains(&format!("tick {kept}"))),
        "{shown} {saved}"
    );
    let (_, listed, _) = ask(&["list", &dir.path().display().to_string()]);
    assert_eq!(listed["sessions"].as_array().map(Vec::len), Some(3), "{listed}");
    // Only whole ones go, and only when told to.
    let folder = dir.path().display().to_string();
    let (_, would, _) = ask(&["prune", &folder, "--keep", "0"]);
    assert_eq!(
        (would["sessions"].as_array().map(Vec::len), &would["removed"]),
        (Some(2), &Value::Bool(false))
    );
    ask(&["prune", &folder, "--keep", "0", "--yes"]);
    assert!(Path::new(&bad).exists() && !Path::new(&good).exists());
}

/// A newer version's session is neither read nor "saved".
#[test]
fn a_session_of_a_newer_layout_is_refused_and_left_alone() {
    let dir = tempfile::tempdir().expect("a folder");
    whole(dir.path(), 3);
    let path = dir.path().join("s.sculpt");
    let layout = session::VERSION + 1;
    let db = rusqlite::Connection::open(&path).expect("opens");
    db.pragma_update(None, "user_version", layout).expect("written");
    drop(db);
    let before = std::fs::read(&path).expect("read");
    for args in [&["replay"][..], &["run", "--headless", "--session"]] {
        let out = Command::new(env!("CARGO_BIN_EXE_sculptd"))
            .args(args)
            .arg(&path)
            .output()
            .expect("runs");
        let said = String::from_utf8_lossy(&out.stderr);
        assert!(!out.status.success(), "{args:?}: {said}");
        assert!(
            said.contains("a newer") && said.contains(&format!("layout {layout}")),
            "{args:?}: {said}"
        );
    }
    assert!(std::fs::read(&path).expect("read") == before, "the file was changed");
    let files = std::fs::read_dir(dir.path()).expect("a folder").flatten();
    let saved = files.filter(|f| f.file_name().to_string_lossy().ends_with(".sculpt")).count();
    assert_eq!(saved, 1, "nothing is saved beside it");
}

/// A file that layout 3 wrote (a demo of four seconds on a ball of 314 vertices): its newest
/// checkpoint is of tick 276, and replaying from there gave that version 135f19b9e55e8ef5.
#[test]
fn a_session_of_layout_3_opens_at_its_newest_checkpoint_and_goes_on() {
    let dir = tempfile::tempdir().expect("a folder");
    let fixture =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/sessions/layout-3.sculpt");
    let path = dir.path().join("old.sculpt");
    std::fs::copy(fixture, &path).expect("copied");
    let before = std::fs::read(&path).expect("read");
    let run = |args: &[&str]| {
        let out = Command::new(env!("CARGO_BIN_EXE_sculptd")).args(args).output().expect("runs");
        let value: Value = serde_json::from_slice(&out.stdout).unwrap_or_default();
        (out.status.code(), value, String::from_utf8_lossy(&out.stderr).into_owned())
    };
    let file = path.display().to_string();
    // Reading changes nothing; replay from the start is refused by name.
    let (code, _, said) = run(&["replay", &file, "--json"]);
    assert!(code == Some(6) && said.contains("layout 3") && said.contains("--from-checkpoint"));
    let at = ["replay", &file, "--from-checkpoint", "--json"];
    let (code, checkpoint, said) = run(&[&at[..], &["--until", "276"]].concat());
    assert_eq!((code, &checkpoint["checkpoint"]), (Some(0), &Value::from(276)), "{said}");
    assert_eq!(checkpoint["hash"], Value::from("ab871824e8b2af56"), "as that version had it");
    let (code, whole, said) = run(&at);
    assert_eq!((code, &whole["ticks"]), (Some(0), &Value::from(480)), "{said}");
    // As processors without AVX2 have it.
    let (code, plain, said) = run(&[&at[..], &["--portable"]].concat());
    assert_eq!((code, &plain["hash"]), (Some(0), &whole["hash"]), "{said}");
    let (code, shown, said) = run(&["session", "show", &file, "--json"]);
    assert_eq!((code, &shown["damage"]), (Some(0), &Value::Null), "{said}");
    assert_eq!(shown["history"]["places"], Value::from(2));
    assert!(std::fs::read(&path).expect("read") == before, "reading changed the file");
    // Written to, it is of this layout, with its history, and what came after the checkpoint.
    let opened = startup::begin(None, Some(&path), &Config::default(), &Job::default());
    let mut begun = opened.expect("opens");
    assert_eq!(begun.warnings, Vec::<String>::new());
    assert_eq!(format!("{:016x}", begun.world.hash()), whole["hash"].as_str().unwrap_or_default());
    let (mut writer, thread) = begun.journal.take().expect("a session");
    for _ in 0..120 {
        let tick = begun.world.tick() + 1;
        let input = samples(tick);
        begun.world.step(tick, &input, &[]);
        writer.tick(tick, &input, &[], &mut begun.world);
    }
    drop(writer);
    assert_eq!(thread.finish(), None);
    let opened = session::open(&path).expect("opens");
    assert_eq!((opened.layout, &opened.loss), (session::VERSION, &None));
    assert_eq!(opened.input.last().map(|t| t.tick), Some(601));
    let (_, last, said) = run(&at);
    assert_eq!(last["ticks"], Value::from(601), "{said}");
    assert_eq!(last["hash"], Value::from(format!("{:016x}", begun.world.hash())));
    let (_, shown, _) = run(&["session", "show", &file, "--json"]);
    assert!(shown["history"]["places"].as_u64() >= Some(2), "{shown}");
}

#[test]
fn an_empty_or_half_made_session_is_taken_over_and_another_s_file_is_not() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("n.sculpt");
    put(&path, b"");
    let begin = || {
        let begun = startup::begin(None, Some(&path), &Config::default(), &Job::default());
        let mut begun = begun.map_err(|e| e.to_string())?;
        let (writer, thread) = begun.journal.take().expect("a session");
        drop(writer);
        assert_eq!(thread.finish(), None);
        Ok::<_, String>(begun.warnings)
    };
    let warnings = begin().expect("begun anew");
    assert!(warnings.iter().any(|w| w.contains("begun anew")), "{warnings:?}");
    assert_eq!(begin(), Ok(vec![]), "it is whole now");
    put(&path, b"somebody's notes");
    let told = begin().expect_err("somebody else's file");
    assert!(told.contains("not a session file"), "{told}");
    assert_eq!(std::fs::read(&path).expect("read"), b"somebody's notes");
    let left: Vec<_> = std::fs::read_dir(dir.path())
        .expect("a folder")
        .flatten()
        .filter(|f| f.file_name().to_string_lossy().contains(".new-"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[cfg(unix)]
#[test]
fn a_session_is_its_owner_s_alone_and_a_read_only_folder_is_read() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().expect("a folder");
    whole(dir.path(), 2);
    let path = dir.path().join("s.sculpt");
    let mode = std::fs::metadata(&path).expect("there").permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    // Root may write anywhere: only what does not need it is shown then.
    let folder = |mode| std::fs::Permissions::from_mode(mode);
    std::fs::set_permissions(dir.path(), folder(0o500)).expect("set");
    let opened = session::open(&path);
    std::fs::set_permissions(dir.path(), folder(0o700)).expect("set");
    assert_eq!(opened.expect("opens").loss, None);
}

#[test]
fn a_disk_that_keeps_everybody_waiting_costs_a_kill_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut script = Script::begin(dir.path());
    script.group(30);
    // Somebody else writes, for longer than the journal is patient: no group is committed.
    let other = rusqlite::Connection::open(&script.path).expect("opens");
    other.execute_batch("BEGIN IMMEDIATE").expect("held");
    let before = script.written();
    for _ in 0..200 {
        script.tick();
    }
    let last = script.hashes.len() as u64 - 1;
    // The thread that only copies is there at once.
    comes(|| {
        let found = session::open(&script.path).expect("opens").input.last().map_or(0, |t| t.tick);
        found == last
    });
    let opened = session::open(&script.path).expect("opens");
    assert_eq!((opened.input.last().map(|t| t.tick), script.written()), (Some(last), before));
    assert_eq!(hash_of(&opened), script.hashes[last as usize]);
    // A copy does not own the original's log, which stays.
    let copy = dir.path().join("c.sculpt");
    for ending in ["", "-wal"] {
        let from = format!("{}{ending}", script.path.display());
        std::fs::copy(from, format!("{}{ending}", copy.display())).expect("copied");
    }
    let (writer, thread) = session::resume(&copy).expect("goes on");
    drop(writer);
    assert_eq!(thread.finish(), None);
    let copied = session::open(&copy).expect("opens");
    assert_eq!(copied.input.last().map(|t| t.tick), Some(before), "what was committed");
    let again = session::open(&script.path).expect("opens");
    assert_eq!(again.input.last().map(|t| t.tick), Some(last), "the log in memory is still there");
    drop(other);
    script.end();
}

#[test]
fn a_second_writer_of_the_same_session_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut script = Script::begin(dir.path());
    script.group(3);
    let refused = session::resume(&script.path).expect_err("refused").to_string();
    assert!(refused.contains("another sculptd"), "{refused}");
    script.end();
    let (writer, thread) = session::resume(&script.path).expect("free again");
    drop(writer);
    assert_eq!(thread.finish(), None);
}

/// A folder of one MiB, where root may mount one.
struct Small(PathBuf);

impl Small {
    fn mount(at: &Path) -> Option<Self> {
        let done =
            Command::new("mount").args(["-t", "tmpfs", "-o", "size=1m", "tmpfs"]).arg(at).output();
        done.is_ok_and(|o| o.status.success()).then(|| Small(at.into()))
    }
}

impl Drop for Small {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).output();
    }
}

#[test]
fn a_full_disk_is_shown_and_journalling_resumes_by_itself() {
    let dir = tempfile::tempdir().expect("a folder");
    let Some(small) = Small::mount(dir.path()) else {
        println!("skipped: no small file system could be mounted (not root)");
        return;
    };
    let mut script = Script::begin(&small.0);
    script.group(10);
    // Somebody else fills the disk.
    let filler = small.0.join("filler");
    let mut size = 1 << 20;
    while size >= 1024 {
        let mut old = std::fs::read(&filler).unwrap_or_default();
        let before = old.len();
        old.resize(before + size, 1);
        #[allow(clippy::disallowed_methods)] // It is meant to fail half-way.
        if std::fs::write(&filler, &old).is_err() {
            old.truncate(before);
            put(&filler, &old);
            size /= 2;
        }
    }
    let before = script.written();
    let mut shown = None;
    comes(|| {
        for _ in 0..10 {
            script.tick();
        }
        shown = script.trouble();
        shown.is_some()
    });
    let shown = shown.expect("the fault is shown");
    assert!(shown.contains("kept in memory") && shown.contains("full"), "{shown}");
    let stuck = script.written();
    for _ in 0..100 {
        script.tick();
    }
    std::fs::remove_file(&filler).expect("room again");
    // By itself: no further tick is needed.
    let last = script.hashes.len() as u64 - 1;
    comes(|| script.written() == last);
    assert_eq!((script.written(), script.trouble()), (last, None));
    println!("full from tick {stuck} (synced {before}), resumed, {last} ticks on the disk");
    script.end();
    let opened = session::open(&script.path).expect("opens");
    assert_eq!((opened.loss.clone(), hash_of(&opened)), (None, script.hashes[last as usize]));
}

//! A session file that is renamed, moved, deleted or replaced while it is written, and one that is
//! copied: the work is found, or it is said at once what became of it.

use std::path::{Path, PathBuf};

use glam::Vec2;

use super::{Studio, both_ways};
use crate::waiting::{comes, pause};
use sculptd_clay::Workers;
use sculptd_daemon::config::Config;
use sculptd_daemon::session::{self, CreateError, replay};
use sculptd_daemon::startup::{self, BeginError};
use sculptd_geometry::job::Job;

/// Change of the file by a person or a program.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Act {
    Rename,
    MoveToAnotherFolder,
    MoveWithItsLog,
    Delete,
    /// As editors and sync programs do: another file gets the name.
    Replace,
}

fn files(folder: &Path) -> Vec<String> {
    let all = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        all.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn fault(s: &Studio) -> Option<String> {
    s.thread.as_ref().and_then(|t| t.health.trouble())
}

/// Sculpts, does it, sculpts on and ends. Returns the file that has all, and what was said.
fn carry_out(act: Act, strokes_between: u32) -> (PathBuf, Option<String>, u64, tempfile::TempDir) {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 1200, 1 << 30);
    for k in 0..strokes_between {
        s.stroke(Vec2::new(-0.1 + 0.02 * k as f32, 0.0));
    }
    let (path, other) = (s.path.clone(), dir.path().join("other"));
    std::fs::create_dir(&other).expect("made");
    let expected = match act {
        Act::Rename => dir.path().join("renamed.sculpt"),
        Act::MoveToAnotherFolder | Act::MoveWithItsLog => other.join("s.sculpt"),
        Act::Delete | Act::Replace => dir.path().join("s-kept-1.sculpt"),
    };
    match act {
        Act::Rename | Act::MoveToAnotherFolder => {
            std::fs::rename(&path, &expected).expect("renamed");
        }
        Act::MoveWithItsLog => {
            std::fs::rename(&path, &expected).expect("renamed");
            for ending in ["-wal", "-shm"] {
                let from = dir.path().join(format!("s.sculpt{ending}"));
                std::fs::rename(from, other.join(format!("s.sculpt{ending}"))).expect("renamed");
            }
        }
        Act::Delete => std::fs::remove_file(&path).expect("deleted"),
        Act::Replace => {
            let new = dir.path().join("new");
            std::fs::copy(file!(), &new).expect("written");
            std::fs::rename(&new, &path).expect("replaced");
        }
    }
    let gone = matches!(act, Act::Delete | Act::Replace);
    if gone {
        assert!(comes(|| fault(&s).is_some()), "{act:?}: it was said");
        let said = fault(&s).expect("said");
        assert!(said.contains("was deleted or replaced"), "{said}");
        assert!(said.contains(&*expected.to_string_lossy()), "{said}: {}", expected.display());
    } else {
        let there = |s: &Studio| s.thread.as_ref().map(|t| t.path.get());
        assert!(comes(|| there(&s).as_ref() == Some(&expected)), "{act:?}: followed");
        assert_eq!(fault(&s), None);
    }
    s.stroke(Vec2::new(0.0, 0.08));
    s.stroke(Vec2::new(0.05, 0.08));
    let live = s.world.hash();
    s.settle();
    s.writer = None;
    let trouble = s.thread.take().and_then(|t| t.finish());
    (expected, trouble, live, dir)
}

#[test]
fn a_session_that_is_moved_is_followed_and_one_that_is_gone_is_written_anew() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    for round in 0..if long { 40 } else { 1 } {
        for act in
            [Act::Rename, Act::MoveToAnotherFolder, Act::MoveWithItsLog, Act::Delete, Act::Replace]
        {
            let (path, trouble, live, dir) = carry_out(act, 1 + round % 5);
            let gone = matches!(act, Act::Delete | Act::Replace);
            assert_eq!(trouble.is_some(), gone, "{act:?}: {trouble:?}");
            if let Some(said) = trouble {
                assert!(said.contains("all of the session is in"), "{said}");
            }
            // Nothing is needed beside the file, and no stray file is left.
            let mut left = files(path.parent().expect("a folder"));
            left.retain(|n| n != "other" && !(act == Act::Replace && n == "s.sculpt"));
            assert_eq!(left, [path.file_name().expect("a name").to_string_lossy()], "{act:?}");
            assert_eq!(both_ways(&path), (live, live), "{act:?}");
            if act == Act::Replace {
                let other = std::fs::read(dir.path().join("s.sculpt")).expect("read");
                assert_eq!(other, std::fs::read(file!()).expect("read"));
            }
            assert_eq!(session::open(&path).expect("opens").not_ended, None, "{act:?}");
            // It opens, and can be worked on.
            let mut s = Studio::reopened(&path);
            assert_eq!(s.world.hash(), live, "{act:?}");
            let last = s.stroke(Vec2::new(-0.05, -0.05));
            let path = s.end();
            assert_eq!(both_ways(&path), (last, last), "{act:?}");
        }
    }
}

/// A daemon that starts while the one before it still ends goes on from its last stroke.
#[test]
fn a_start_while_the_last_run_ends_has_all_of_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 3000, 1 << 30);
    let path = s.path.clone();
    let next = std::thread::spawn(move || {
        let begun = || startup::begin(None, Some(&path), &Config::default(), &Job::default());
        loop {
            match begun() {
                Err(BeginError::Create(CreateError::Busy { .. })) => {}
                begun => return begun.expect("opens").world.hash(),
            }
        }
    });
    let mut live = 0;
    for k in 0..24 {
        live = s.stroke(Vec2::new(-0.1 + 0.01 * k as f32, 0.0));
    }
    s.end();
    assert_eq!(next.join().expect("no panic"), live);
}

#[test]
fn a_copy_of_the_file_alone_lacks_at_most_seconds_and_says_which() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut s = Studio::begin(dir.path(), 1200, 1 << 30);
    for k in 0..6 {
        s.stroke(Vec2::new(-0.1 + 0.03 * k as f32, 0.0));
    }
    let (live, tick) = (s.world.hash(), s.world.tick());
    s.settle();
    let copy = dir.path().join("copy.sculpt");
    let read = || {
        std::fs::copy(dir.path().join("s.sculpt"), &copy).expect("copied");
        session::open(&copy)
    };
    // At once it may lack the newest input; then it says how much.
    let first = read().expect("a copy opens");
    let kept = first.input.last().map_or(0, |t| t.tick);
    let said = first.not_ended.as_ref().is_some_and(|t| t.contains(&format!("tick {kept} ")));
    let known = first.loss.as_ref().and_then(|l| l.last).is_some_and(|l| l > kept);
    assert!(said || known, "kept {kept}, {:?}, {:?}", first.loss, first.not_ended);
    // A few seconds later nothing is missing, although the session is still open.
    let whole = comes(|| {
        pause(100);
        let opened = read().expect("a copy opens");
        let all = opened.loss.is_none() && opened.input.last().is_some_and(|t| t.tick + 1 >= tick);
        all && replay::replay(&opened, None, Workers::new(1), &Job::default())
            .is_ok_and(|r| r.world.hash() == live)
    });
    assert!(whole, "the copy never had all");
    s.end();
}

//! The preferences on a disk that fails at the n-th call, and a file that is no longer whole.

use std::path::{Path, PathBuf};
use std::process::Command;

use sculptd_window::language::set_current;
use sculptd_window::panels::state::Preferences;
use sculptd_window::viewer::preferences_file::PreferencesFile;

/// The folder of [`preferences_day`]; unset where nobody runs it.
const PREFERENCES_DAY: &str = "SCULPTD_PREFERENCES_DAY";

fn file(folder: &Path) -> PathBuf {
    folder.join("preferences/viewer.toml")
}

/// Changes the scale three times, and prints for each change whether it was stored. The test below
/// runs it in a separate process, whose disk fails.
#[test]
fn preferences_day() {
    let Some(folder) = std::env::var_os(PREFERENCES_DAY).map(PathBuf::from) else {
        println!("skipped: it is run with a disk that fails");
        return;
    };
    set_current(super::translations().english());
    let (mut kept, mut state) = PreferencesFile::load_from(&file(&folder));
    for n in 1..=3 {
        state.prefs.scale = 1.0 + n as f32 * 0.125;
        match kept.keep(&state) {
            None => println!("quiet {n}"),
            Some(wrong) => println!("told {n}: {wrong}"),
        }
    }
}

#[test]
fn preferences_on_a_disk_that_fails_at_any_call_are_whole_and_a_loss_is_told() {
    let home = tempfile::tempdir().expect("a folder");
    let Some(library) = crate::faulty_disk::shim(home.path()) else { return };
    let run = |folder: &Path, at: Option<(u64, &str, bool)>| {
        let count = home.path().join("calls");
        let _ = std::fs::remove_file(&count);
        let mut run = Command::new(std::env::current_exe().expect("this program"));
        run.args(["--exact", "viewer::preferences::preferences_day", "--nocapture"])
            .env(PREFERENCES_DAY, folder)
            .env("LD_PRELOAD", &library)
            .env("FAULTY_PATH", "preferences")
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
    let dir = tempfile::tempdir().expect("a folder");
    let (out, calls): (_, u64) = run(dir.path(), None);
    assert!(out.status.success() && calls >= 6, "{calls} calls");
    let (mut lost, mut days) = (0, 0);
    for (kind, ever) in [("eio", false), ("enospc", true), ("short", false)] {
        for n in 1..=calls {
            let case = format!("{kind} at call {n} of {calls}");
            let dir = tempfile::tempdir().expect("a folder");
            let (out, _) = run(dir.path(), Some((n, kind, ever)));
            let said = String::from_utf8_lossy(&out.stdout).into_owned();
            assert!(out.status.success(), "{case}: {said}");
            days += 1;
            let scale = match std::fs::read_to_string(file(dir.path())) {
                Ok(text) => {
                    Preferences::read(&text).unwrap_or_else(|e| panic!("{case}: {e}")).scale
                }
                Err(_) => 1.0,
            };
            if scale != 1.375 {
                lost += 1;
                assert!(said.contains("told ") && said.contains("viewer.toml"), "{case}: {said}");
            }
        }
    }
    println!("{days} days of {calls} calls: {lost} lost the last change, each was told");
    assert!(lost > 0);
}

#[test]
fn preferences_that_cannot_be_read_are_set_aside_and_told() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("viewer.toml");
    #[allow(clippy::disallowed_methods)] // A test's input.
    std::fs::write(&path, "light = true\nscale = ???").expect("written");
    set_current(super::translations().english());
    let (mut kept, mut state) = PreferencesFile::load_from(&path);
    let told = kept.keep(&state).expect("told");
    assert!(told.contains("line 2") && told.contains("toml.unreadable"), "{told}");
    state.prefs.light = !state.prefs.light;
    assert_eq!(kept.keep(&state), None);
    let aside = std::fs::read_to_string(path.with_extension("toml.unreadable")).expect("kept");
    assert!(aside.contains("???"));
    assert!(Preferences::read(&std::fs::read_to_string(&path).expect("anew")).is_ok());
}

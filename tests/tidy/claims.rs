//! Every sentence by which the program claims that something is saved, whole, passed or proven,
//! with the test that makes it false and sees another sentence in its place.

use super::{root, sources};

/// A sentence, or a part of one; the file that has it; the test, and the file of the test.
type Claim = (&'static str, &'static str, &'static str, &'static str);

const TEXTS: &str = "config/languages/en/window.ftl";
const SALVAGE: &str = "src/daemon/session/salvage.rs";
const WRITER: &str = "src/daemon/session/writer.rs";
const MISPLACED: &str = "src/daemon/session/writer/misplaced.rs";
const REPAIR: &str = "src/mesh_commands/repair.rs";
const CHECK_PAGE: &str = "tests/it/viewer/check.rs";
const WORKBENCH: &str = "tests/it/viewer/workbench.rs";
const DAMAGES: &str = "tests/it/sessions/damages.rs";
const SESSIONS: &str = "tests/it/sessions.rs";
const DISK: &str = "tests/it/faulty_disk.rs";
const KNOWN_WALLS: &str = "src/geometry/thickness/known_walls.rs";
const CHECKED_WALLS: &str = "src/check/tests/walls.rs";
const FLEET: &str = "src/network/tests/it/fleet.rs";
const ROLLOUT: &str = "src/network/fleet/rollout.rs";
const BESIDE: &str = "src/geometry/io/beside.rs";

const UNSAVED: &str = "no_page_says_that_work_is_saved_where_it_is_not";
const FAILED_WRITE: &str = "a_failed_write_leaves_the_old_file_and_nothing_else";
const DAMAGE: &str = "random_damage_is_never_silent_and_never_refused_where_something_can_be_read";
const STOPPED_CHECK: &str = "a_check_that_was_stopped_or_failed_never_passes";
const MOVED: &str = "a_session_that_is_moved_is_followed_and_one_that_is_gone_is_written_anew";
const GALLERY: &str = "a_gallery_on_a_disk_that_fails_at_any_call_keeps_what_it_said_it_kept";
const CANARY: &str = "a_roll_out_is_stopped_by_a_canary_that_fails_and_reaches_nobody_else";
const FULL_DISK: &str = "a_full_disk_is_shown_and_journalling_resumes_by_itself";
const CALLER: &str = "a_caller_hears_what_the_world_did";
const VERDICT: &str = "no_verdict_on_a_known_wall_is_wrong";
const BRUSH: &str = "a_brush_in_hand_is_saved_under_a_name_once_and_with_its_picture";

const CLAIMS: [Claim; 20] = [
    ("Passed: every check ran", TEXTS, STOPPED_CHECK, CHECK_PAGE),
    ("This new sculpture is saved as you work.", TEXTS, UNSAVED, WORKBENCH),
    ("saved as you work: { $path }", TEXTS, UNSAVED, WORKBENCH),
    ("Work is kept", TEXTS, UNSAVED, WORKBENCH),
    ("{ $operation }: done", TEXTS, CALLER, "tests/it/meanwhile/callers.rs"),
    ("Saved { $path }", TEXTS, FAILED_WRITE, BESIDE),
    ("Saved { $frames } frames", TEXTS, FAILED_WRITE, BESIDE),
    ("Kept as { $path }", TEXTS, FAILED_WRITE, BESIDE),
    ("Works kept today", TEXTS, GALLERY, DISK),
    ("The brush { $name } is saved", TEXTS, BRUSH, "src/daemon/brush_folder.rs"),
    ("nothing is damaged: {path}", SALVAGE, DAMAGE, DAMAGES),
    ("the sculpture is whole", SALVAGE, DAMAGE, DAMAGES),
    ("all of the session is in {}", MISPLACED, MOVED, "tests/it/history/moved.rs"),
    ("what was sculpted up to tick {tick}", MISPLACED, MOVED, "tests/it/history/moved.rs"),
    ("the session file is written again", WRITER, FULL_DISK, SESSIONS),
    ("\"certified\"", "src/geometry/thickness/check.rs", VERDICT, KNOWN_WALLS),
    ("Pass with warnings", "src/check/report.rs", "slivers_are_a_warning", CHECKED_WALLS),
    ("repaired: bool", REPAIR, "the_file_is_read_and_checked_again", "tests/it/repairs.rs"),
    ("has it already", ROLLOUT, CANARY, FLEET),
    ("{name} is well", ROLLOUT, CANARY, FLEET),
];

/// Words of such sentences, in small letters.
const WORDS: [&str; 13] = [
    "saved",
    "passed",
    "pass with",
    "is kept",
    "kept as",
    "kept today",
    "certified",
    "is whole",
    "all of the session",
    "is damaged",
    "is well",
    ": done",
    "lossless",
];

/// Sentences that have one of the words and claim nothing of the kind.
const OTHERS: [&str; 18] = [
    "no work was kept today",
    "the history is damaged",
    "it does not name the owner's key",
    "check-not-passed",
    "(once more: as it was saved)",
    "not saved here",
    "No session file: the sculpture is kept only when you export it.",
    "; it is kept as { $aside }",
    "The brush is not saved:",
    "no session is kept",
    "no history is kept",
    "nothing that is sculpted is kept",
    "the group of ticks {first} to {last} is damaged",
    "of it is damaged",
    "input is kept in memory",
    "is damaged or missing",
    "sampled, not certified",
    "(this one is done)",
];

/// The texts of a line of code: what stands between quotation marks. A line of messages is one.
fn texts(line: &str, messages: bool) -> Vec<&str> {
    match messages {
        true => vec![line],
        false => line.split('"').skip(1).step_by(2).collect(),
    }
}

#[test]
fn every_claim_has_a_test_that_makes_it_false() {
    let read = |file: &str| std::fs::read_to_string(root().join(file)).unwrap_or_default();
    for (sentence, file, test, of) in CLAIMS {
        assert!(read(file).contains(sentence), "{file} does not say: {sentence}");
        assert!(read(of).contains(&format!("fn {test}(")), "{of} has no test {test}");
    }
    let messages = [(root().join(TEXTS), read(TEXTS))];
    let mut unlisted = Vec::new();
    for (path, text) in sources("src").into_iter().chain(messages) {
        let name = path.strip_prefix(root()).expect("ours").display().to_string();
        let is_test = name.contains("test") || name.contains("example");
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        for (number, line) in code.lines().enumerate().filter(|_| !is_test) {
            let start = line.trim_start();
            if start.starts_with("//") || start.starts_with('#') {
                continue;
            }
            for said in texts(line, name.ends_with(".ftl")) {
                let small = said.to_lowercase();
                let claims = said.contains(' ') && WORDS.iter().any(|w| small.contains(w));
                let is_listed = CLAIMS.iter().any(|c| said.contains(c.0))
                    || OTHERS.iter().any(|other| said.contains(other));
                if claims && !is_listed {
                    unlisted.push(format!("{name}:{}: {said}", number + 1));
                }
            }
        }
    }
    assert!(unlisted.is_empty(), "claims without a test in the list: {unlisted:#?}");
}

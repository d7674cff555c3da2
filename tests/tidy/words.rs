//! One vocabulary: no private word is left as a name, no type shares its name with another of its
//! crate or with Rust's prelude, and no line is wider than two files beside each other allow.

use std::collections::BTreeMap;

use super::{CRATES, root, sources};

/// Names that the project gave up, each with the word that took its place.
const GONE: [(&str, &str); 48] = [
    ("Deed", "HistoryEvent"),
    ("Moment", "HistoryEntry"),
    ("Thing", "HeldObject"),
    ("Works", "ReplacedClay"),
    ("Seat", "PenSlot"),
    ("Draft", "CurveStroke"),
    ("Way", "StrokeMethod"),
    ("Desk", "UiState"),
    ("Ask", "UiRequest"),
    ("WideTree", "Bvh8"),
    ("Several", "interleaved traversal"),
    ("Waiting", "StackEntry"),
    ("Remake", "ReplaceMasked"),
    ("Fates", "classification"),
    ("Ghosts", "DemoDevices"),
    ("Joiner", "BooleanJobs"),
    ("Stepped", "SimulatedLoop"),
    ("Ledger", "HistoryWriter"),
    ("Tremble", "Jitter"),
    ("Leash", "StopToken"),
    ("obey", "apply_command"),
    ("hear", "apply_sample"),
    ("lineage", "object_id"),
    ("wishes", "latest-wins worker"),
    ("newest", "latest_wins"),
    ("leash", "stop_token"),
    ("tremble", "jitter"),
    ("makers", "vendors"),
    ("remodel", "dyntopo"),
    ("mend", "repair"),
    ("crossing", "self_intersection"),
    ("meet", "intersect"),
    ("fates", "classification"),
    ("shelf", "catalog"),
    ("ledger", "history_writer"),
    ("sight", "thumbnail"),
    ("rig", "startup"),
    ("joiner", "boolean_jobs"),
    ("stepped", "simulated_loop"),
    ("ghost", "demo_devices"),
    ("figures", "metrics"),
    ("loose", "overlay_mesh"),
    ("shade", "ssao"),
    ("lapse", "timelapse"),
    ("flight", "camera_animation"),
    ("balls", "hand_menu"),
    ("draft", "curve_stroke"),
    ("prism", "trim"),
];

/// Names of Rust's prelude and of traits that every reader knows.
const PRELUDE: [&str; 20] = [
    "Option", "Some", "None", "Result", "Ok", "Err", "Box", "Vec", "String", "Drop", "Clone",
    "Copy", "Send", "Sync", "Iterator", "Default", "Eq", "Ord", "Fn", "From",
];

/// Type, function, trait, module and constant definitions of a text: keyword and name.
fn definitions(text: &str) -> Vec<(&str, &str)> {
    let keywords = ["struct", "enum", "trait", "type", "union", "fn", "mod"];
    let mut out = Vec::new();
    for line in text.lines() {
        let code = line.split("//").next().unwrap_or("");
        let mut words = code.split_whitespace().peekable();
        while let Some(word) = words.next() {
            if let (Some(keyword), Some(next)) =
                (keywords.iter().find(|k| **k == word), words.peek())
            {
                let end = next.find(|c: char| !c.is_alphanumeric() && c != '_');
                let name = &next[..end.unwrap_or(next.len())];
                if !name.is_empty() {
                    out.push((*keyword, name));
                }
            } else if !word.starts_with("pub") && !["unsafe", "const", "async"].contains(&word) {
                break;
            }
        }
    }
    out
}

#[test]
fn no_given_up_word_is_a_name() {
    let mut left = Vec::new();
    for dir in ["src", "devices/src", "devices/camera/src"] {
        for (path, text) in sources(dir) {
            for (keyword, name) in definitions(&text) {
                if let Some((_, new)) = GONE.iter().find(|(old, _)| *old == name) {
                    left.push(format!("{}: {keyword} {name}, use {new}", path.display()));
                }
            }
        }
    }
    assert!(left.is_empty(), "{left:#?}");
}

#[test]
fn a_type_has_its_name_alone_in_its_crate() {
    let mut shared = Vec::new();
    for (krate, dir) in CRATES {
        let mut seen: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for (path, text) in sources(dir) {
            let inner = path.strip_prefix(root().join(dir)).expect("under its folder");
            let part =
                inner.components().next().map(|c| c.as_os_str().to_string_lossy().into_owned());
            let skipped = ["examples", "tests", "benches", "fuzz"];
            let member =
                |p: &str| dir == "src" && root().join(dir).join(p).join("Cargo.toml").is_file();
            if part.is_some_and(|p| skipped.contains(&p.as_str()) || member(&p) || p == "bindings")
            {
                continue;
            }
            // An associated type is indented; only the types of a module count.
            for line in text.lines().filter(|l| !l.starts_with(' ')) {
                for (keyword, name) in definitions(line) {
                    if ["struct", "enum", "trait", "type", "union"].contains(&keyword) {
                        seen.entry(name.to_string()).or_default().push(inner.display().to_string());
                    }
                }
            }
        }
        for (name, places) in seen {
            if places.len() > 1 {
                shared.push(format!("{krate}: {name} in {}", places.join(", ")));
            }
            if PRELUDE.contains(&name.as_str()) {
                shared
                    .push(format!("{krate}: {name} shadows the prelude in {}", places.join(", ")));
            }
        }
    }
    assert!(shared.is_empty(), "{shared:#?}");
}

#[test]
fn two_files_fit_beside_each_other() {
    let mut wide = Vec::new();
    for dir in ["src", "devices", "tests", "benches"] {
        for (path, text) in sources(dir) {
            for (n, line) in text.lines().enumerate() {
                let columns = line.chars().count();
                if columns > 100 {
                    wide.push(format!("{}:{}: {columns}", path.display(), n + 1));
                }
            }
        }
    }
    assert!(wide.is_empty(), "longer than 100 columns: {wide:#?}");
}

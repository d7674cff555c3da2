//! The map in `src/lib.rs` says what the code has: its crates, its threads, its arrows.

use std::collections::BTreeSet;

use super::use_graph::UseGraph;
use super::{CRATES, root, sources};

fn map() -> String {
    std::fs::read_to_string(root().join("src/lib.rs")).expect("the map is there")
}

#[test]
fn the_map_names_every_crate() {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("the manifest");
    let manifest: toml::Table = manifest.parse().expect("it parses");
    let members = manifest["workspace"]["members"].as_array().expect("members").clone();
    let members: BTreeSet<String> =
        members.iter().filter_map(|m| m.as_str().map(String::from)).collect();
    let listed: BTreeSet<String> = CRATES
        .iter()
        .filter(|(name, _)| *name != "sculptd")
        .map(|(_, dir)| match dir.strip_suffix("/src") {
            Some(devices) if devices.starts_with("devices") => devices.to_string(),
            _ => (*dir).to_string(),
        })
        .collect();
    let libraries: BTreeSet<String> =
        members.iter().filter(|m| !m.starts_with("src/bindings")).cloned().collect();
    assert_eq!(libraries, listed, "this test's list of crates is not the workspace's");
    for (name, _) in CRATES {
        assert!(map().contains(&format!("`{name}`")), "the map says nothing of {name}");
    }
}

#[test]
fn the_map_names_every_thread() {
    let mut made = BTreeSet::new();
    for dir in ["src", "devices/src", "devices/camera/src"] {
        for (_, text) in sources(dir) {
            let code = text.find("#[cfg(test)]\nmod ").map_or(text.as_str(), |at| &text[..at]);
            for piece in code.split("\"sculptd-").skip(1) {
                let name = piece.split('"').next().unwrap_or("");
                let name = name.split(['{', '.']).next().unwrap_or("").trim_end_matches('-');
                made.insert(name.to_string());
            }
        }
    }
    let known = map();
    let crates: Vec<&str> =
        CRATES.iter().map(|(name, _)| name.trim_start_matches("sculptd-")).collect();
    let missing: Vec<&String> = made
        .iter()
        .filter(|n| !n.is_empty() && !crates.contains(&n.as_str()))
        // A recording has a number, and a turntable is a folder of pictures: no threads.
        .filter(|n| !n.starts_with("recording") && *n != "turntable")
        .filter(|n| !known.contains(&format!("sculptd-{n}")) && !known.contains(&format!("`-{n}`")))
        .collect();
    assert!(missing.is_empty(), "threads that the map does not name: {missing:?}");
}

/// Circles that are still to be undone, by how they begin. The list may only become shorter.
const KNOWN: [&str; 0] = [];

#[test]
fn no_circles_inside_a_crate() {
    let mut circles = Vec::new();
    for (name, dir) in CRATES {
        let without: &[&str] = match name {
            "sculptd" => &["geometry", "clay", "engine", "control", "daemon", "window", "bindings"],
            _ => &[],
        };
        let graph = UseGraph::read(&root().join(dir), without);
        assert!(graph.files.len() > 1, "{name}: no files under {dir}");
        for circle in graph.circles_between_siblings() {
            circles.push(format!("{name}: {}", circle.join(", ")));
        }
    }
    let new: Vec<&String> =
        circles.iter().filter(|c| !KNOWN.iter().any(|k| c.starts_with(k))).collect();
    assert!(new.is_empty(), "files that name each other in a circle: {new:#?}");
    let gone: Vec<&&str> =
        KNOWN.iter().filter(|k| !circles.iter().any(|c| c.starts_with(*k))).collect();
    assert!(gone.is_empty(), "no longer circles, so no longer known: {gone:?}");
}

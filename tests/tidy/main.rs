//! What the compiler does not guard: circles inside a crate, the words, the style, the map.

mod claims;
mod guide_promises;
mod languages;
mod map;
mod network_promises;
mod picture;
mod use_graph;
mod words;

use std::path::{Path, PathBuf};

/// The crates of the workspace, and where their sources lie.
const CRATES: [(&str, &str); 12] = [
    ("sculptd-geometry", "src/geometry"),
    ("sculptd-devices", "devices/src"),
    ("sculptd-camera", "devices/camera/src"),
    ("sculptd-control", "src/control"),
    ("sculptd-clay", "src/clay"),
    ("sculptd-engine", "src/engine"),
    ("sculptd-daemon", "src/daemon"),
    ("sculptd-network", "src/network"),
    ("sculptd-window", "src/window"),
    ("sculptd-check", "src/check"),
    ("sculptd-mesh-commands", "src/mesh_commands"),
    ("sculptd", "src"),
];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn sources(under: &str) -> Vec<(PathBuf, String)> {
    fn walk(dir: &Path, out: &mut Vec<(PathBuf, String)>) {
        let Ok(entries) = std::fs::read_dir(dir) else { return };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
        paths.sort();
        for path in paths {
            if path.is_dir() && !path.ends_with("target") {
                walk(&path, out);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).expect("a source file is UTF-8");
                out.push((path, text));
            }
        }
    }
    let mut out = Vec::new();
    walk(&root().join(under), &mut out);
    assert!(!out.is_empty(), "no sources under {under}");
    out
}

#[test]
fn no_file_is_longer_than_600_lines() {
    let long: Vec<String> = ["src", "devices", "tests", "benches"]
        .iter()
        .filter(|d| root().join(d).is_dir())
        .flat_map(|d| sources(d))
        .filter(|(_, text)| text.lines().count() > 600)
        .map(|(path, text)| format!("{}: {}", path.display(), text.lines().count()))
        .collect();
    assert!(long.is_empty(), "two ideas in one room? {long:#?}");
}

#[test]
fn egui_stays_in_panels_and_viewer_and_wgpu_in_viewer() {
    for (path, text) in sources("src") {
        let name = path.display().to_string();
        let code: String =
            text.lines().map(|l| l.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
        if !name.contains("/viewer/") {
            assert!(!code.contains("wgpu::"), "{name} names wgpu");
            if !name.contains("/panels/") {
                assert!(!code.contains("egui::"), "{name} names egui");
            }
        }
    }
}

#[test]
fn unsafe_lives_in_two_places() {
    // Functions compiled for a processor that only a run-time check knows; pointers that come from
    // C. The first lines of each say why.
    let places = ["src/geometry/simd", "src/bindings/c/src"].map(|p| root().join(p));
    for dir in ["src", "devices/src", "devices/camera/src"] {
        for (path, text) in sources(dir) {
            let allowed = places.iter().any(|p| path.starts_with(p));
            assert!(
                allowed || !text.contains("allow(unsafe_code)"),
                "{} allows unsafe",
                path.display()
            );
        }
    }
}

#[test]
fn nothing_is_left_undone() {
    // Spelt apart, so that this file does not find itself.
    let marks =
        [["TO", "DO"], ["FIX", "ME"], ["todo", "!("], ["unimple", "mented!("], ["X", "XX "]]
            .map(|m| m.concat());
    for dir in ["src", "devices/src", "devices/camera/src", "tests"] {
        for (path, text) in sources(dir) {
            for mark in &marks {
                assert!(!text.contains(mark.as_str()), "{} holds '{mark}'", path.display());
            }
        }
    }
}

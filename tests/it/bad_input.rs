//! Broken input is rejected with a clear message and the right exit code, and nothing is written.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::corpus;

fn sculptd(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sculptd")).args(args).output().expect("the binary starts")
}

/// Runs with a bad file and checks the exit code, the words on standard error, and that no output
/// came to be.
fn refused(args: &[&str], code: i32, words: &[&str], never: &Path) {
    let out = sculptd(args);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(code), "{args:?} said: {said}");
    for word in words {
        assert!(said.contains(word), "{args:?}: expected '{word}' in: {said}");
    }
    assert!(!said.contains("panicked"), "{said}");
    assert!(!never.exists(), "{args:?} wrote {}", never.display());
}

struct Bench {
    dir: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Bench { dir: tempfile::tempdir().expect("a temporary folder") }
    }

    fn file(&self, name: &str, content: &[u8]) -> PathBuf {
        let path = self.dir.path().join(name);
        #[allow(clippy::disallowed_methods)] // Half a file would only fail the test.
        std::fs::write(&path, content).expect("written");
        path
    }

    fn out(&self) -> PathBuf {
        self.dir.path().join("out.stl")
    }
}

#[test]
fn broken_meshes_name_the_place_and_write_nothing() {
    let bench = Bench::new();
    let mut stl = vec![0u8; 84 + 30];
    stl[80] = 2;
    let cases: [(&str, &[u8], &[&str]); 6] = [
        ("empty.obj", b"", &["empty.obj", "empty"]),
        ("short.stl", &stl, &["short.stl", "byte 114", "184"]),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", &["index.obj", "line 4", "4"]),
        ("nan.obj", b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", &["nan.obj", "line 2", "nan"]),
        ("text.ply", b"dear diary, today I sculpted a pig\n", &["text.ply"]),
        ("zero.stl", b"solid nothing\nendsolid nothing\n", &["zero.stl"]),
    ];
    let out = bench.out();
    for (name, content, words) in cases {
        let path = bench.file(name, content);
        let path = path.to_str().expect("UTF-8");
        let export = out.to_str().expect("UTF-8");
        refused(&["info", path, "--json"], 6, words, &out);
        refused(&["convert", path, export], 6, words, &out);
        refused(
            &["run", "--headless", "--for", "0.1", "--mesh", path, "--export", export],
            6,
            words,
            &out,
        );
    }
    let missing = bench.dir.path().join("missing.obj");
    refused(&["info", missing.to_str().expect("UTF-8")], 6, &["missing.obj"], &out);
}

#[test]
fn a_recording_of_an_unknown_device_is_an_absent_device() {
    let bench = Bench::new();
    // A keyboard's own descriptor: real, and no pen.
    let keyboard = b"D:0\nR: 63 05 01 09 06 a1 01 05 07 19 e0 29 e7 15 00 25 01 75 01 95 08 81 02 \
        95 01 75 08 81 03 95 05 75 01 05 08 19 01 29 05 91 02 95 01 75 03 91 03 95 06 75 08 15 00 \
        25 65 05 07 19 00 29 65 81 00 c0\nN: Somebody's Keyboard\nI: 3 dead beef\nE: 0.000000 8 00 \
        00 04 00 00 00 00 00\n";
    let path = bench.file("keyboard.hid", keyboard);
    let out = bench.out();
    let args = [
        "run",
        "--headless",
        "--play-device",
        path.to_str().expect("UTF-8"),
        "--export",
        out.to_str().expect("UTF-8"),
    ];
    refused(&args, 5, &["keyboard.hid"], &out);
    let torn = bench.file("torn.hid", b"D:0\nR: 4 05 0d zz\n");
    let args = [
        "run",
        "--headless",
        "--play-device",
        torn.to_str().expect("UTF-8"),
        "--export",
        out.to_str().expect("UTF-8"),
    ];
    refused(&args, 6, &["torn.hid"], &out);
}

#[test]
fn a_bad_configuration_names_key_line_and_range() {
    let bench = Bench::new();
    let out = bench.out();
    for (content, words) in [
        ("[loop]\nrate_hz = 120\ntypo = 1\n", &["line 3", "typo"][..]),
        ("[loop]\nrate_hz = 5\n", &["loop.rate_hz = 5", "30 to 1000"]),
        ("[loop]\nrate_hz = \"fast\"\n", &["line 2"]),
        ("[nonsense]\n", &["nonsense"]),
        ("[loop\n", &["line 1"]),
    ] {
        let path = bench.file("my.toml", content.as_bytes());
        let path = path.to_str().expect("UTF-8");
        refused(
            &["run", "--headless", "--config", path, "--export", out.to_str().expect("UTF-8")],
            3,
            words,
            &out,
        );
        refused(&["config", "check", path], 3, words, &out);
    }
}

#[test]
fn usage_errors_are_two() {
    let nowhere = Path::new("/nonexistent/never");
    refused(&["run", "--headless", "--for", "-1"], 2, &[], nowhere);
    refused(&["frobnicate"], 2, &[], nowhere);
    refused(&["run", "--headless", "--export", "out.xyz"], 2, &["out.xyz", ".obj"], nowhere);
}

#[test]
fn no_corpus_file_of_any_kind_makes_a_panic() {
    let Some(corpus) = corpus() else { return };
    // Meshes given as recordings and recordings given as meshes.
    let mesh = corpus.join("meshes/cgal_pig.off");
    let pen = corpus.join("devices/open/hid/Wacom_Intuos4_4x6_056a_00B8.hid");
    let nowhere = Path::new("/nonexistent/never");
    let (mesh, pen) = (mesh.to_str().expect("UTF-8"), pen.to_str().expect("UTF-8"));
    refused(&["info", pen], 6, &[], nowhere);
    refused(&["run", "--headless", "--play-device", mesh], 6, &[], nowhere);
}

//! Bare hands by webcam, through the program: what it says without models and without a camera,
//! and the whole demo with drawn hands.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

/// The folder of the hand models, where there is one.
fn models() -> Option<PathBuf> {
    let named = std::env::var_os("SCULPTD_CAMERA_MODELS").map(PathBuf::from);
    let own =
        std::env::var_os("HOME").map(|h| PathBuf::from(h).join(".local/share/sculptd/hand-models"));
    let found =
        named.into_iter().chain(own).find(|f| f.join("hand_landmark_full.tflite").is_file());
    if found.is_none() {
        println!("skipped: the hand models are not installed (sculptd camera setup)");
    }
    found
}

fn sculptd(arguments: &[&str], models: &std::path::Path) -> Output {
    let home = tempfile::tempdir().expect("a folder");
    Command::new(env!("CARGO_BIN_EXE_sculptd"))
        .args(arguments)
        .env("HOME", home.path())
        .env("XDG_DATA_HOME", home.path())
        .env("XDG_CONFIG_HOME", home.path())
        .env("SCULPTD_CAMERA_MODELS", models)
        .output()
        .expect("the program starts")
}

fn words(out: &Output) -> String {
    String::from_utf8_lossy(&out.stderr).into_owned()
}

#[test]
fn without_models_the_one_command_is_named() {
    let nowhere = std::path::Path::new("/nonexistent");
    for arguments in [
        &["run", "--camera", "--headless"][..],
        &["demo", "--camera", "--headless"],
        &["camera", "test"],
    ] {
        let out = sculptd(arguments, nowhere);
        let told = words(&out);
        let named = told.contains("sculptd camera setup") || told.contains("there is no camera");
        assert!(named && out.status.code() == Some(5), "{arguments:?}: {:?} {told}", out.status);
    }
    let doctor = sculptd(&["doctor"], nowhere);
    assert!(String::from_utf8_lossy(&doctor.stdout).contains("sculptd camera setup"));
}

#[test]
fn a_package_that_is_none_changes_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    let package = dir.path().join("mediapipe.whl");
    std::fs::File::create(&package).expect("a file");
    let folder = dir.path().join("models");
    let (package, target) = (package.display().to_string(), folder.display().to_string());
    let out = sculptd(&["camera", "setup", "--package", &package, "--folder", &target], dir.path());
    assert_eq!(out.status.code(), Some(6), "{}", words(&out));
    assert!(words(&out).contains("mediapipe==0.10.14") && !folder.exists(), "{}", words(&out));
}

#[test]
fn files_that_are_no_cameras_are_errors() {
    let Some(models) = models() else { return };
    let dir = tempfile::tempdir().expect("a folder");
    let text = dir.path().join("hands.txt");
    std::fs::File::create(&text).expect("a file");
    for file in [dir.path(), &text, std::path::Path::new("/nonexistent.y4m")] {
        let name = file.display().to_string();
        let out = sculptd(&["run", "--headless", "--camera", &name], &models);
        assert_eq!(out.status.code(), Some(6), "{name}: {}", words(&out));
        assert!(words(&out).contains(&name), "{}", words(&out));
    }
}

#[test]
fn drawn_hands_sculpt_the_same_bits_twice() {
    let Some(models) = models() else { return };
    let run = || {
        let dir = tempfile::tempdir().expect("a folder");
        let mesh = dir.path().join("demo.stl").display().to_string();
        let arguments =
            ["demo", "--camera", "--headless", "--pace", "fast", "--json", "--export", &mesh];
        let out = sculptd(&arguments, &models);
        assert!(out.status.success(), "{}", words(&out));
        serde_json::from_slice::<Value>(&out.stdout).expect("JSON")
    };
    let (first, second) = (run(), run());
    assert!(first["dabs"].as_u64() > Some(50), "the hands moved clay: {first}");
    assert!(first["samples"].as_u64() > Some(500), "{first}");
    assert_eq!(first["hash"], second["hash"]);
}

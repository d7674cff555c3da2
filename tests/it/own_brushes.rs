//! A person's own brushes by the command line: exported, imported, listed, and refused by line.

use std::path::Path;
use std::process::{Command, Output};

fn brush(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.args(["--json", "brush", "--brushes"]).arg(folder).args(args);
    command.output().expect("the binary starts")
}

fn listed(folder: &Path) -> (Vec<String>, String) {
    let out = brush(folder, &["list"]);
    assert!(out.status.success(), "{out:?}");
    let all: serde_json::Value = serde_json::from_slice(&out.stdout).expect("one object");
    let own = all["brushes"].as_array().expect("a list").iter().filter(|b| b["own"] == true);
    let names = own.map(|b| b["name"].as_str().unwrap_or("").to_string()).collect();
    (names, String::from_utf8_lossy(&out.stderr).into_owned())
}

#[test]
#[allow(clippy::disallowed_methods)] // Files as a person writes them.
fn brushes_are_exported_imported_and_listed_and_a_broken_one_is_told_by_its_line() {
    let dir = tempfile::tempdir().expect("a folder");
    let (own, away) = (dir.path().join("own"), dir.path().join("away"));
    let text = |path: &Path| path.to_str().expect("UTF-8").to_string();
    // One of the program's as a beginning, changed by hand, with a picture.
    let out = brush(&own, &["export", "texture", &text(&away)]);
    assert!(out.status.success(), "{out:?}");
    let file = away.join("my texture.toml");
    let preset = std::fs::read_to_string(&file).expect("written");
    let picture = away.join("oak.png");
    std::fs::copy("tests/golden/sheet/brushes.png", &picture).expect("copied");
    let bark = away.join("bark.toml");
    let changed = preset.replace("kind = ", "picture = \"oak.png\"\nkind = ");
    std::fs::write(&bark, &changed).expect("written");
    let out = brush(&own, &["import", &text(&file), &text(&bark)]);
    assert!(out.status.success(), "{out:?}");
    assert_eq!(listed(&own), (vec!["bark".into(), "my texture".into()], String::new()));
    assert!(own.join("oak.png").is_file(), "the picture comes along");
    // A second import works only with `--replace`.
    assert_eq!(brush(&own, &["import", &text(&bark)]).status.code(), Some(6));
    assert!(brush(&own, &["import", &text(&bark), "--replace"]).status.success());
    // Out again, and the same.
    let out = brush(&own, &["export", "bark", &text(&dir.path().join("out"))]);
    assert!(out.status.success(), "{out:?}");
    let read = |path: &Path| std::fs::read_to_string(path).expect("written");
    assert_eq!(read(&dir.path().join("out/bark.toml")), read(&own.join("bark.toml")));
    // A broken one.
    std::fs::write(own.join("bad.toml"), "kind = \"draw\"\n[settings]\nstrength = 7.0\n")
        .expect("written");
    let (names, said) = listed(&own);
    assert_eq!(names, ["bark", "my texture"]);
    assert!(said.contains("bad.toml:3: strength = 7: expected a number from 0 to 1"), "{said}");
    let out = brush(&away, &["import", &text(&own.join("bad.toml"))]);
    assert_eq!(out.status.code(), Some(6), "{out:?}");
    assert!(!away.join("bad.toml").exists());
}

//! `sculptd kiosk install` and `uninstall`, on a system in a folder.

use std::collections::BTreeMap;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use sculptd_daemon::kiosk::setup::{FILES, RECORD, SETTINGS};
use serde_json::Value;

/// A system as Debian and the packages of the guide leave it, as far as an install looks.
#[allow(clippy::disallowed_methods)] // Programs that nobody starts.
fn system() -> tempfile::TempDir {
    let root = tempfile::tempdir().expect("a folder");
    for file in ["usr/bin/sculptd", "usr/bin/X", "etc/passwd", "etc/group"] {
        let path = root.path().join(file);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, "").expect("written");
    }
    root
}

fn kiosk(root: &Path, args: &[&str]) -> (Option<i32>, String, Value) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.args(["--json", "kiosk"]).args(args).arg("--root").arg(root);
    let out = command.output().expect("runs");
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    (out.status.code(), told, serde_json::from_slice(&out.stdout).unwrap_or_default())
}

/// Reads paths and contents of the files, except what the commands made.
fn files(root: &Path) -> BTreeMap<String, String> {
    fn walk(root: &Path, folder: &Path, all: &mut BTreeMap<String, String>) {
        for entry in std::fs::read_dir(folder).expect("a folder").filter_map(Result::ok) {
            let path = entry.path();
            let name = format!("/{}", path.strip_prefix(root).expect("inside").display());
            if path.is_symlink() {
                let to = std::fs::read_link(&path).expect("a link");
                all.insert(name, to.display().to_string());
            } else if path.is_dir() {
                all.insert(name, "folder".into());
                walk(root, &path, all);
            } else {
                all.insert(name, std::fs::read_to_string(&path).unwrap_or_default());
            }
        }
    }
    let mut all = BTreeMap::new();
    walk(root, root, &mut all);
    let accounts = ["passwd", "group", "shadow", "gshadow", ".pwd.lock"];
    all.retain(|name, _| {
        !accounts.iter().any(|a| name.trim_start_matches("/etc/").trim_end_matches('-') == *a)
            && !name.starts_with("/home")
    });
    all
}

fn actions(answer: &Value) -> Vec<(String, String)> {
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    let files = answer["files"].as_array().expect("files");
    files.iter().map(|f| (text(&f["path"]), text(&f["action"]))).collect()
}

fn all(action: &str) -> Vec<(String, String)> {
    FILES.iter().map(|f| (f.path.to_owned(), action.to_owned())).collect()
}

fn mode(root: &Path, path: &str) -> u32 {
    let path = root.join(path.trim_start_matches('/'));
    std::fs::metadata(path).expect("a file").permissions().mode() & 0o777
}

/// Without root, and without systemd, the commands of the system cannot run.
fn commands_run() -> bool {
    let found = Command::new("systemd-sysusers").arg("--version").output();
    found.is_ok_and(|out| out.status.success()) && rustix::process::geteuid().is_root()
}

#[test]
fn an_install_writes_its_list_once_and_an_uninstall_leaves_the_system_as_it_was() {
    let system = system();
    let root = system.path();
    let before = files(root);
    let (code, told, planned) = kiosk(root, &["install", "--dry-run"]);
    assert_eq!((code, actions(&planned)), (Some(0), all("write")), "{told}");
    assert_eq!(files(root), before, "a dry run changes nothing");

    let (code, told, done) = kiosk(root, &["install"]);
    assert_eq!(actions(&done), all("write"), "{told}");
    let ran = done["commands"].as_array().expect("commands");
    let failed: Vec<_> = ran.iter().filter(|c| !c["failure"].is_null()).collect();
    assert_eq!(code, Some(i32::from(!failed.is_empty())), "{told}");
    if commands_run() {
        assert!(failed.is_empty(), "{failed:?}");
        let passwd = std::fs::read_to_string(root.join("etc/passwd")).expect("accounts");
        assert!(passwd.contains("visitor:x:") && passwd.contains(":/home/visitor:"), "{passwd}");
        let group = std::fs::read_to_string(root.join("etc/group")).expect("groups");
        for name in ["video", "render", "dialout", "input", "audio"] {
            let has = |l: &str| l.starts_with(&format!("{name}:")) && l.ends_with(":visitor");
            assert!(group.lines().any(has), "{group}");
        }
        assert_eq!(mode(root, "/home/visitor/gallery"), 0o750);
    } else {
        println!("not seen: the user, for systemd-sysusers needs systemd and root");
    }
    assert_eq!([SETTINGS, RECORD].map(|path| mode(root, path)), [0o640, 0o600]);
    assert_eq!(mode(root, "/etc/systemd/system/sculptd-kiosk.service"), 0o644);
    assert_eq!(mode(root, "/etc/X11/xorg.conf.d"), 0o755);
    let installed = files(root);
    let pin = installed[SETTINGS].lines().find_map(|l| l.strip_prefix("staff_pin = \"")?.get(..6));
    assert!(done["notes"].to_string().contains(pin.expect("a PIN")), "{done}");
    assert!(installed.values().all(|text| !text.contains("@USER@") && !text.contains("@HOME@")));

    // Again, also after an install that was cut off: nothing else happens.
    let (_, told, again) = kiosk(root, &["install"]);
    assert_eq!(actions(&again), all("unchanged"), "{told}");
    assert_eq!(files(root), installed);
    std::fs::remove_file(root.join("etc/systemd/system/sculptd-kiosk.service")).expect("removed");
    let (_, _, mended) = kiosk(root, &["install"]);
    assert_eq!(actions(&mended).iter().filter(|a| a.1 == "write").count(), 1);
    assert_eq!(files(root), installed);

    let (code, told, planned) = kiosk(root, &["uninstall", "--dry-run"]);
    assert_eq!((code, planned["files"].as_array().map(Vec::len)), (Some(0), Some(10)), "{told}");
    assert_eq!(files(root), installed, "a dry run changes nothing");
    let (code, told, _) = kiosk(root, &["uninstall"]);
    assert_eq!(code, Some(0), "{told}");
    assert_eq!(files(root), before);
    let (code, told, _) = kiosk(root, &["uninstall"]);
    assert!(code == Some(1) && told.contains("nothing was installed"), "{told}");
}

#[test]
#[allow(clippy::disallowed_methods)] // A person edits.
fn what_a_person_changed_is_neither_overwritten_nor_removed_and_works_stay() {
    let system = system();
    let root = system.path();
    let own = root.join("etc/udev/rules.d/70-sculptd.rules");
    std::fs::create_dir_all(own.parent().expect("a folder")).expect("made");
    std::fs::write(&own, "# my own\n").expect("written");
    kiosk(root, &["install", "--user", "ann"]);
    std::fs::create_dir_all(root.join("home/ann/gallery")).expect("made");
    std::fs::write(root.join("home/ann/gallery/work-000001.glb"), "a work").expect("written");
    let changed = [SETTINGS, "/etc/systemd/system/sculptd-kiosk-x.service"];
    for path in changed {
        let path = root.join(path.trim_start_matches('/'));
        let text = std::fs::read_to_string(&path).expect("a text") + "# mine\n";
        std::fs::write(path, text).expect("written");
    }
    let (_, _, again) = kiosk(root, &["install", "--user", "ann"]);
    let of = |answer: &Value, path: &str| {
        actions(answer).into_iter().find(|a| a.0 == path).map(|a| a.1).unwrap_or_default()
    };
    let rules = "/etc/udev/rules.d/70-sculptd.rules";
    for path in [changed[0], changed[1], rules] {
        assert_eq!(of(&again, path), "leave-changed", "{path}");
    }
    assert!(again["notes"].to_string().contains("kiosk-x.service: somebody changed it"), "{again}");
    // Another user: the program's own texts follow.
    let (_, _, moved) = kiosk(root, &["install", "--user", "bea"]);
    assert_eq!(of(&moved, "/etc/systemd/system/sculptd-kiosk.service"), "update");
    kiosk(root, &["install", "--user", "ann"]);

    let (code, _, gone) = kiosk(root, &["uninstall"]);
    assert_eq!(code, Some(0));
    let left = files(root);
    for path in [changed[0], changed[1], rules] {
        assert!(left.contains_key(path), "{path} stays: {left:?}");
    }
    assert!(!left.contains_key("/etc/systemd/system/sculptd-kiosk.service"));
    assert!(root.join("home/ann/gallery/work-000001.glb").exists());
    let notes = gone["notes"].to_string();
    for said in ["kiosk.toml", "kiosk-x.service", "/home/ann", "userdel -r ann"] {
        assert!(notes.contains(said), "{said}: {notes}");
    }
}

#[test]
fn an_install_that_cannot_work_says_why_and_changes_nothing() {
    let empty = tempfile::tempdir().expect("a folder");
    let (code, told, _) = kiosk(empty.path(), &["install"]);
    assert!(code == Some(1) && told.contains("sculptd, the X server"), "{told}");
    assert!(told.contains("apt install"), "{told}");
    assert_eq!(std::fs::read_dir(empty.path()).expect("a folder").count(), 0);
    let system = system();
    let before = files(system.path());
    let (code, told, _) = kiosk(system.path(), &["install", "--user", "Ann Other"]);
    assert!(code == Some(2) && told.contains("--user"), "{told}");
    // The package brings the rules for tablets.
    let packaged = system.path().join("usr/lib/udev/rules.d/70-sculptd.rules");
    std::fs::create_dir_all(packaged.parent().expect("a folder")).expect("made");
    std::fs::File::create(packaged).expect("made");
    let (_, _, planned) = kiosk(system.path(), &["install", "--dry-run"]);
    assert!(actions(&planned).iter().any(|a| a.1 == "packaged"), "{planned}");
    assert!(files(system.path()).len() > before.len());
    if !rustix::process::geteuid().is_root() {
        let (code, told, _) = kiosk(Path::new("/"), &["install"]);
        assert!(code == Some(4) && told.contains("needs root"), "{told}");
    }
}

/// systemd reads the service as it is written; what it does not know would be dropped silently.
#[test]
fn systemd_finds_no_fault_in_the_service() {
    let system = system();
    let root = system.path();
    kiosk(root, &["install"]);
    let services = ["sculptd-kiosk-x.service", "sculptd-kiosk.service"];
    let services = services.map(|name| root.join("etc/systemd/system").join(name));
    let mut verify = Command::new("systemd-analyze");
    let Ok(out) = verify.args(["verify", "--man=no"]).args(services).output() else {
        println!("skipped: systemd-analyze is not installed");
        return;
    };
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    let ours: Vec<&str> = told
        .lines()
        .filter(|l| l.contains("sculptd-kiosk") && !l.contains("is not executable"))
        .collect();
    assert!(ours.is_empty(), "{ours:?}");
}

#[test]
#[allow(clippy::disallowed_methods)] // Settings of a test.
fn settings_are_checked_with_all_that_they_name() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("kiosk.toml");
    let check = |text: &str| {
        std::fs::write(&file, text).expect("written");
        let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
        let out = command.args(["--json", "kiosk", "check"]).arg(&file).output().expect("runs");
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        let answer: Value = serde_json::from_slice(&out.stdout).unwrap_or_default();
        (out.status.code(), format!("{answer} {told}"))
    };
    let gallery = dir.path().join("works");
    let good = format!(
        "gallery = {gallery:?}\nlanguages = [\"en\", \"de\"]\nexhibits = [\"relief\"]\n\
         staff_pin = \"4711\"\n[hours]\nopen = [\"daily 0:00-24:00\"]\n"
    );
    let (code, said) = check(&good);
    assert_eq!(code, Some(0), "{said}");
    for part in ["now it is open", "English, Deutsch,", "exhibit: ", "works", "behind its PIN"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!gallery.exists(), "a check makes nothing");
    // One fault each.
    for (old, new, expected) in [
        (format!("{gallery:?}"), "\"/proc/works\"".to_owned(), "no work can be kept"),
        ("relief".to_owned(), "a vase".to_owned(), "a vase"),
        ("staff_pin".to_owned(), "attract = [\"none.hid\"]\nstaff_pin".to_owned(), "none.hid"),
        ("staff_pin".to_owned(), "curated = [\"/none\"]\nstaff_pin".to_owned(), "/none"),
    ] {
        let (code, said) = check(&good.replace(&old, &new));
        assert_eq!(code, Some(1), "{new}: {said}");
        assert!(said.contains(expected) && said.contains("faults: 1"), "{new}: {said}");
    }
    let (code, said) = check("staff_pin = 1234");
    assert!(code == Some(3) && said.contains("write it in quotes"), "{code:?} {said}");
}

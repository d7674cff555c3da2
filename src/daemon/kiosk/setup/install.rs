//! `sculptd kiosk install`.

use std::io;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;

use super::record::InstallRecord;
use super::{
    CommandReport, FILES, FileAction, FileContent, FileReport, InstalledFile, PACKAGED_RULES,
    RECORD, SERVICE, SETTINGS, SetupError, SetupReport, at, below, check_rights, content_of,
    system_command,
};
use sculptd_geometry::io::write_beside;

/// Digits of the PIN that an install draws.
const PIN_DIGITS: usize = 6;

/// Programs without which an installation does not start, each with the places where it may be.
const NEEDED: [(&str, [&str; 2]); 2] = [
    ("sculptd", ["/usr/bin/sculptd", "/usr/local/bin/sculptd"]),
    ("the X server", ["/usr/bin/X", "/usr/bin/Xorg"]),
];
const HINT: &str = "apt install ./sculptd_VERSION.deb xserver-xorg mesa-vulkan-drivers";

/// The request of an install.
#[derive(Debug, Clone, Copy)]
pub struct InstallRequest<'a> {
    /// The root of the system: `/`, or where another one is mounted.
    pub root: &'a Path,
    /// The user of the installation, who is made if absent.
    pub user: &'a str,
    /// Change nothing, and report what would be done.
    pub dry_run: bool,
    /// The text of the program's `config/kiosk.toml`.
    pub settings: &'a str,
    /// The text of the program's `config/70-sculptd.rules`.
    pub tablet_rules: &'a str,
    /// Random hexadecimal digits, from which the PIN of the staff is drawn.
    pub random: &'a str,
}

/// Sets a system up as an installation. Repeating it changes nothing.
///
/// # Errors
/// Names the missing rights or programs before anything is changed; the file that cannot be
/// written. A failed command is part of the report.
pub fn install(request: &InstallRequest) -> Result<SetupReport, SetupError> {
    let root = request.root;
    if !request.dry_run {
        check_rights(root)?;
    }
    let home = home_of(root, request.user)?;
    check_programs(root)?;
    let mut record = InstallRecord::read(root)?.unwrap_or_default();
    (record.user, record.home) = (request.user.to_owned(), home.clone());
    let pin = pin(request.random);
    let mut report = SetupReport { dry_run: request.dry_run, ..SetupReport::default() };
    let mut wanted = Vec::new();
    for file in &FILES {
        let text = match file.content {
            FileContent::Text(text, _) => fill(text, request.user, &home),
            FileContent::TabletRules => request.tablet_rules.to_owned(),
            FileContent::Settings => settings(request.settings, &home, &pin),
            FileContent::Link(to) => format!("-> {to}"),
        };
        let found = content_of(&below(root, file.path)).map_err(at(&below(root, file.path)))?;
        let packaged = file.content == FileContent::TabletRules
            && found.is_none()
            && below(root, PACKAGED_RULES).exists();
        let ours = record.files.get(file.path);
        let action = match &found {
            None if packaged => FileAction::Packaged,
            None => FileAction::Write,
            Some(found) if *found == text => FileAction::Unchanged,
            // Settings are a person's from the first start on.
            Some(found) if file.path == SETTINGS && Some(found) == ours => FileAction::Unchanged,
            Some(found) if Some(found) == ours => FileAction::Update,
            Some(_) => FileAction::LeaveChanged,
        };
        report.files.push(FileReport { path: file.path.into(), about: file.about, action });
        match action {
            FileAction::Write | FileAction::Update => wanted.push((file, text)),
            FileAction::Unchanged if ours.is_none() => {
                record.files.insert(file.path.into(), text);
            }
            _ => {}
        }
    }
    notes(&mut report, &pin);
    if request.dry_run {
        let command = |words: &&[&str]| CommandReport { command: words.join(" "), failure: None };
        report.commands = commands(root).iter().map(command).collect();
        return Ok(report);
    }
    // The record and the settings have the PIN: nobody else reads them at any moment.
    let mask = rustix::process::umask(rustix::fs::Mode::from_raw_mode(0o077));
    let written = write(root, &mut record, &wanted);
    rustix::process::umask(mask);
    written?;
    read_back(root, &wanted)?;
    report.commands = commands(root).iter().map(|words| system_command(root, words)).collect();
    Ok(report)
}

/// Writes the files, and before each what uninstall must know of it.
fn write(
    root: &Path,
    record: &mut InstallRecord,
    wanted: &[(&InstalledFile, String)],
) -> Result<(), SetupError> {
    folders(root, RECORD, record)?;
    for (file, text) in wanted {
        folders(root, file.path, record)?;
        record.files.insert(file.path.into(), text.clone());
    }
    record.write(root)?;
    for (file, text) in wanted {
        let path = below(root, file.path);
        match file.content {
            FileContent::Link(to) => {
                if path.is_symlink() {
                    std::fs::remove_file(&path).map_err(at(&path))?;
                }
                symlink(to, &path).map_err(at(&path))?;
            }
            FileContent::Settings => put(&path, text, 0o640).map_err(at(&path))?,
            FileContent::TabletRules => put(&path, text, 0o644).map_err(at(&path))?,
            FileContent::Text(_, mode) => put(&path, text, mode).map_err(at(&path))?,
        }
    }
    Ok(())
}

/// Compares the files with what was written: only then is the system set up.
fn read_back(root: &Path, wanted: &[(&InstalledFile, String)]) -> Result<(), SetupError> {
    for (file, text) in wanted {
        let path = below(root, file.path);
        if content_of(&path).map_err(at(&path))?.as_ref() != Some(text) {
            let why = "it does not hold what was written; check the disk and install again";
            return Err(at(&path)(io::Error::other(why)));
        }
    }
    Ok(())
}

fn put(path: &Path, text: &str, mode: u32) -> io::Result<()> {
    write_beside(path, |out| out.write_all(text.as_bytes()))?;
    std::fs::set_permissions(path, PermissionsExt::from_mode(mode))
}

/// Makes the folders of a file that are absent, and records them.
fn folders(root: &Path, path: &str, record: &mut InstallRecord) -> Result<(), SetupError> {
    let mut absent: Vec<&Path> = Path::new(path).ancestors().skip(1).collect();
    absent.retain(|folder| !root.join(folder.strip_prefix("/").unwrap_or(folder)).exists());
    for folder in absent.into_iter().rev() {
        let name = folder.display().to_string();
        let full = below(root, &name);
        std::fs::create_dir(&full).map_err(at(&full))?;
        std::fs::set_permissions(&full, PermissionsExt::from_mode(0o755)).map_err(at(&full))?;
        record.folders.push(name);
    }
    Ok(())
}

/// Commands that make the files count.
fn commands(root: &Path) -> Vec<&'static [&'static str]> {
    let mut all: Vec<&[&str]> = vec![
        &["systemd-sysusers", "sculptd-kiosk.conf"],
        &["systemd-tmpfiles", "--create", "sculptd-kiosk.conf"],
    ];
    if root == Path::new("/") {
        all.extend([
            &["udevadm", "control", "--reload"] as &[&str],
            &["udevadm", "trigger", "--subsystem-match=hidraw"],
            &["systemctl", "daemon-reload"],
            &["systemctl", "try-restart", "systemd-journald.service"],
        ]);
    }
    all
}

fn notes(report: &mut SetupReport, pin: &str) {
    for file in &report.files {
        match file.action {
            FileAction::LeaveChanged if file.path != SETTINGS => report.notes.push(format!(
                "{}: somebody changed it, so it was left as it is; to have the program's own, \
                 remove it and install again",
                file.path
            )),
            FileAction::Write if file.path == SETTINGS && !report.dry_run => {
                report.notes.push(format!("the PIN of the staff page is {pin}; see {SETTINGS}"));
            }
            _ => {}
        }
    }
    report.notes.push(format!(
        "start it by a restart of the computer or by `systemctl start {SERVICE}`, which takes the \
         first console; then run `sculptd kiosk try`"
    ));
}

/// Returns the user's folder: that of an existing user, else the usual place.
fn home_of(root: &Path, user: &str) -> Result<String, SetupError> {
    let usual = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    let begins = user.starts_with(|c: char| c.is_ascii_lowercase());
    if !(begins && user.len() <= 31 && user.chars().all(usual)) {
        return Err(SetupError::UserName { name: user.into() });
    }
    let passwd = std::fs::read_to_string(below(root, "/etc/passwd")).unwrap_or_default();
    let mut lines = passwd.lines().map(|line| line.split(':').collect::<Vec<_>>());
    match lines.find(|fields| fields[0] == user && fields.len() > 5) {
        Some(fields) if fields[2] == "0" => Err(SetupError::UserIsRoot { name: user.into() }),
        Some(fields) => Ok(fields[5].to_owned()),
        None => Ok(format!("/home/{user}")),
    }
}

fn check_programs(root: &Path) -> Result<(), SetupError> {
    let is_there = |path: &str| std::fs::symlink_metadata(below(root, path)).is_ok();
    let missing = NEEDED.iter().filter(|(_, places)| !places.iter().any(|p| is_there(p)));
    let what: Vec<&str> = missing.map(|(name, _)| *name).collect();
    match what.is_empty() {
        true => Ok(()),
        false => Err(SetupError::Missing { root: root.into(), what, hint: HINT }),
    }
}

fn fill(text: &str, user: &str, home: &str) -> String {
    text.replace("@USER@", user).replace("@HOME@", home)
}

/// The program's settings with the folders and the PIN of this installation.
fn settings(text: &str, home: &str, pin: &str) -> String {
    let own = [
        ("staff_pin = \"\"", format!("staff_pin = \"{pin}\"")),
        ("gallery = \"\"", format!("gallery = \"{home}/gallery\"")),
        ("audit = \"\"", format!("audit = \"{home}/visits.log\"")),
    ];
    let line = |line: &str| {
        let own = own.iter().find(|(key, _)| line.starts_with(key));
        own.map_or(line.to_owned(), |(key, value)| line.replacen(key, value, 1)) + "\n"
    };
    text.lines().map(line).collect()
}

/// Draws the PIN from random hexadecimal digits.
fn pin(random: &str) -> String {
    let number = u128::from_str_radix(random, 16).unwrap_or_default();
    format!("{:0PIN_DIGITS$}", number % 10u128.pow(PIN_DIGITS as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_settings_of_an_installation_are_read_back_as_they_were_meant() {
        let text = include_str!("../../../../config/kiosk.toml");
        let pin = pin("0123456789abcdef0123456789abcdef");
        assert!(pin.len() == 6 && pin.chars().all(|c| c.is_ascii_digit()), "{pin}");
        let read = crate::kiosk::KioskConfig::parse(&settings(text, "/home/ann", &pin));
        let read = read.expect("settings");
        assert_eq!(read.staff_pin, pin);
        assert_eq!(read.gallery, Path::new("/home/ann/gallery"));
        assert_eq!(read.audit, Path::new("/home/ann/visits.log"));
        assert_eq!(read.idle_s, crate::kiosk::KioskConfig::default().idle_s);
    }

    #[test]
    fn a_file_that_does_not_hold_what_was_written_fails_the_install() {
        let root = tempfile::tempdir().expect("a folder");
        let wanted: Vec<(&InstalledFile, String)> =
            FILES.iter().map(|file| (file, format!("text of {}", file.path))).collect();
        for (file, text) in &wanted {
            let path = below(root.path(), file.path);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            put(&path, text, 0o644).expect("written");
        }
        read_back(root.path(), &wanted).expect("all is as written");
        let (file, _) = wanted[3];
        let path = below(root.path(), file.path);
        put(&path, "text of", 0o644).expect("written");
        let said = read_back(root.path(), &wanted).expect_err("half of it").to_string();
        assert!(said.contains(file.path) && said.contains("install again"), "{said}");
        std::fs::remove_file(&path).expect("removed");
        assert!(read_back(root.path(), &wanted).is_err(), "it is missing");
    }

    #[test]
    fn names_of_users_that_a_file_could_misread_are_refused() {
        let root = tempfile::tempdir().expect("a folder");
        for name in ["", "Ann", "a b", "-a", "a:b", "ann\nm ann root", &"a".repeat(32)] {
            let refused = home_of(root.path(), name);
            assert!(matches!(refused, Err(SetupError::UserName { .. })), "{name}");
        }
        std::fs::create_dir(root.path().join("etc")).expect("made");
        let lines = "root:x:0:0::/root:/bin/sh\nann:x:1000:1000::/srv/ann:/bin/sh\n";
        write_beside(&root.path().join("etc/passwd"), |out| out.write_all(lines.as_bytes()))
            .expect("written");
        assert!(matches!(home_of(root.path(), "root"), Err(SetupError::UserIsRoot { .. })));
        assert_eq!(home_of(root.path(), "ann").expect("a user"), "/srv/ann");
        assert_eq!(home_of(root.path(), "visitor").expect("a name"), "/home/visitor");
    }
}

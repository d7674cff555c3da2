//! The setup of a computer as an installation: the files that `sculptd kiosk install` writes and
//! `sculptd kiosk uninstall` removes.
//!
//! Laws kept here:
//! * [`FILES`] lists every file. Install, uninstall, the dry run and the guide share the list.
//! * A file that a person changed is neither overwritten nor removed, and the report names it.
//! * The record names a file before it is written, so that an interrupted install can be repeated
//!   or removed.

mod install;
mod record;
mod uninstall;

pub use install::{InstallRequest, install};
pub use record::RECORD;
pub use uninstall::uninstall;

use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// The service, as systemd names it.
pub const SERVICE: &str = "sculptd-kiosk.service";
/// The folder of the control socket.
pub const RUNTIME: &str = "/run/sculptd-kiosk";
/// The settings of the installation.
pub const SETTINGS: &str = "/etc/sculptd/kiosk.toml";
/// The rule for pen tablets as the package of the program brings it.
const PACKAGED_RULES: &str = "/usr/lib/udev/rules.d/70-sculptd.rules";

/// Content of a file of the installation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FileContent {
    /// A text, in which `@USER@` and `@HOME@` are replaced, and the permissions.
    Text(&'static str, u32),
    /// The program's rules for pen tablets.
    TabletRules,
    /// The text of the program's `config/kiosk.toml`, with the installation's folders and PIN.
    Settings,
    /// A symbolic link to this path.
    Link(&'static str),
}

/// A file of the installation.
#[derive(Debug, Clone, Copy)]
pub struct InstalledFile {
    /// Absolute path, below the root of the system.
    pub path: &'static str,
    /// Purpose of the file.
    pub about: &'static str,
    content: FileContent,
}

const fn file(
    path: &'static str,
    about: &'static str,
    text: &'static str,
    mode: u32,
) -> InstalledFile {
    InstalledFile { path, about, content: FileContent::Text(text, mode) }
}

/// Every file of an installation, in the order in which it is written.
pub const FILES: [InstalledFile; 10] = [
    file(
        "/etc/sysusers.d/sculptd-kiosk.conf",
        "the user, and its groups for cameras, graphics, sound and serial pens",
        include_str!("files/sysusers.conf"),
        0o644,
    ),
    file(
        "/etc/tmpfiles.d/sculptd-kiosk.conf",
        "the user's folders, and who reads the settings",
        include_str!("files/tmpfiles.conf"),
        0o644,
    ),
    InstalledFile {
        path: "/etc/udev/rules.d/70-sculptd.rules",
        about: "pen tablets can be read without root",
        content: FileContent::TabletRules,
    },
    file(
        "/etc/X11/xorg.conf.d/90-sculptd-kiosk.conf",
        "the screen never goes dark, and no key leaves the installation",
        include_str!("files/xorg.conf"),
        0o644,
    ),
    file(
        "/etc/systemd/sleep.conf.d/sculptd-kiosk.conf",
        "the computer does not sleep",
        include_str!("files/sleep.conf"),
        0o644,
    ),
    file(
        "/etc/systemd/journald.conf.d/sculptd-kiosk.conf",
        "the log takes at most 200 MB",
        include_str!("files/journald.conf"),
        0o644,
    ),
    InstalledFile {
        path: SETTINGS,
        about: "the settings, with the staff PIN",
        content: FileContent::Settings,
    },
    file(
        "/etc/systemd/system/sculptd-kiosk-x.service",
        "the screen: an X server that starts again after each fault",
        include_str!("files/sculptd-kiosk-x.service"),
        0o644,
    ),
    file(
        "/etc/systemd/system/sculptd-kiosk.service",
        "the program: it starts again after each fault, and a watchdog observes it",
        include_str!("files/sculptd-kiosk.service"),
        0o644,
    ),
    InstalledFile {
        path: "/etc/systemd/system/multi-user.target.wants/sculptd-kiosk.service",
        about: "both start with the computer",
        content: FileContent::Link("../sculptd-kiosk.service"),
    },
];

/// Action on a file, done or planned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileAction {
    /// It was written.
    Write,
    /// An earlier text of the program was replaced.
    Update,
    /// It has this content already.
    Unchanged,
    /// Somebody changed it, so it stays as it is.
    LeaveChanged,
    /// The package of the program brings it.
    Packaged,
    /// It was removed.
    Remove,
}

/// A file and what was done to it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FileReport {
    pub path: String,
    /// Purpose of the file.
    pub about: &'static str,
    pub action: FileAction,
}

/// A command for the system, and its outcome.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CommandReport {
    pub command: String,
    /// `None`: done, or not yet run in a dry run; else why it failed or was not run.
    pub failure: Option<String>,
}

/// Actions of an install or an uninstall, done or planned.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct SetupReport {
    /// Nothing was changed.
    pub dry_run: bool,
    pub files: Vec<FileReport>,
    pub commands: Vec<CommandReport>,
    /// Remarks for the person who runs it.
    pub notes: Vec<String>,
}

impl SetupReport {
    /// Returns the number of commands that failed or were not run.
    pub fn failures(&self) -> usize {
        self.commands.iter().filter(|c| c.failure.is_some()).count()
    }
}

/// Why a setup did not happen or stopped.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    #[error("it changes the system, which needs root; run it with sudo, or name a --root FOLDER")]
    NotRoot,
    #[error("--user {name}: expected 1 to 31 of a-z, 0-9, - and _, beginning with a letter")]
    UserName { name: String },
    #[error("--user {name}: it has the rights of root; name another user")]
    UserIsRoot { name: String },
    #[error("missing below {}: {}; install them first: {hint}", root.display(), what.join(", "))]
    Missing { root: PathBuf, what: Vec<&'static str>, hint: &'static str },
    #[error("{}: nothing was installed here by `sculptd kiosk install`", .0.display())]
    NotInstalled(PathBuf),
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
}

/// Attaches the path to an error of the system.
fn at(path: &Path) -> impl FnOnce(io::Error) -> SetupError {
    let path = path.to_path_buf();
    move |source| SetupError::Io { path, source }
}

/// An absolute path of the system, below `root`.
fn below(root: &Path, path: &str) -> PathBuf {
    root.join(path.trim_start_matches('/'))
}

/// Returns the text of a file, or the target of a link behind an arrow; `None`: it does not exist.
fn content_of(path: &Path) -> io::Result<Option<String>> {
    let found = match std::fs::symlink_metadata(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
        found => found?,
    };
    Ok(Some(match found.is_symlink() {
        true => format!("-> {}", std::fs::read_link(path)?.display()),
        false => String::from_utf8_lossy(&std::fs::read(path)?).into_owned(),
    }))
}

/// Fails where the system of this computer would be changed without root.
fn check_rights(root: &Path) -> Result<(), SetupError> {
    let is_root = rustix::process::geteuid().is_root();
    if root == Path::new("/") && !is_root { Err(SetupError::NotRoot) } else { Ok(()) }
}

/// Runs a command of the system. For another root than `/` only commands that take `--root` run.
fn system_command(root: &Path, words: &[&str]) -> CommandReport {
    let mut command = std::process::Command::new(words[0]);
    if root != Path::new("/") {
        command.arg(format!("--root={}", root.display()));
    }
    let done = command.args(&words[1..]).output();
    let failure = match done {
        Ok(out) if out.status.success() => None,
        Ok(out) => Some(format!("{}: {}", out.status, String::from_utf8_lossy(&out.stderr).trim())),
        Err(e) => Some(e.to_string()),
    };
    CommandReport { command: words.join(" "), failure }
}

#[cfg(test)]
mod tests {
    use super::FILES;

    #[test]
    fn the_guide_lists_every_file() {
        let guide = include_str!("../../../../config/guide/src/kiosk.md");
        let rows: Vec<&str> = guide.lines().filter(|l| l.starts_with("| `/")).collect();
        let expected: Vec<String> =
            FILES.iter().map(|file| format!("| `{}` | {} |", file.path, file.about)).collect();
        assert_eq!(rows, expected);
    }
}

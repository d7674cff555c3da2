//! The sessions that are always on: one file a sculpture in the person's data folder, named by date
//! and object, so that closing a window or losing a machine costs nothing. Old ones go by age and
//! size.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use sculptd_daemon::session::catalog::{self, ENDING};
use sculptd_daemon::session::history::listing;
use sculptd_daemon::session::in_use;
use sculptd_daemon::window_link::NextSculpture;

use super::{Fail, Outcome};

/// The sculpture that a person chose to open next, in the window.
pub type OpenNext = Arc<Mutex<Option<NextSculpture>>>;

/// Sessions that the window offers.
const OFFERED: usize = 8;

#[allow(clippy::disallowed_methods)] // The name of a file and its age are of the calendar.
fn now_s() -> u64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(0, |d| d.as_secs())
}

/// Returns the file of a new session, and removes sessions beyond the limits in a separate thread.
/// Prints a warning and returns `None` if the folder cannot be created.
pub fn begin(mesh: Option<&Path>) -> Option<PathBuf> {
    let folder = folder()?;
    if let Err(e) = std::fs::create_dir_all(&folder) {
        eprintln!("sculptd: warning: no session is kept: {}: {e}", folder.display());
        return None;
    }
    let now = now_s();
    let old = folder.clone();
    let pruning = move || drop(prune(&old, now, &LibraryLimits::default()));
    let _ = std::thread::Builder::new().name("sculptd-prune".into()).spawn(pruning);
    let object = mesh.and_then(Path::file_stem).map(|s| s.to_string_lossy().into_owned());
    Some(new_path(&folder, now, object.as_deref().unwrap_or("ball")))
}

/// The newest sessions of the library but for the one that is open.
pub fn recent(open: Option<&Path>) -> Vec<PathBuf> {
    let all = folder().map_or_else(Vec::new, |f| entries(&f)).into_iter().map(|e| e.path);
    all.filter(|p| Some(p.as_path()) != open).take(OFFERED).collect()
}

/// Opens another sculpture in a new process, because each process can create only one window.
pub fn open(sculpture: &NextSculpture, config: Option<&Path>) -> Outcome {
    let program = std::env::current_exe().map_err(|e| Fail::io(Path::new("sculptd"), &e))?;
    let mut next = std::process::Command::new(&program);
    next.arg("run");
    if let NextSculpture::Session(path) = sculpture {
        next.arg("--session").arg(path);
    }
    if let Some(config) = config {
        next.arg("--config").arg(config);
    }
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        Err(Fail::io(&program, &next.exec()))
    }
    #[cfg(not(unix))]
    {
        next.spawn().map_err(|e| Fail::io(&program, &e))?;
        Ok(())
    }
}

/// Limits of a library.
#[derive(Debug, Clone, Copy)]
pub struct LibraryLimits {
    /// Number of newest sessions to keep regardless of age and size.
    pub keep: usize,
    /// Age in seconds since the last write, after which a session may be removed.
    pub age_s: u64,
    /// Limit of the bytes of all sessions.
    pub bytes: u64,
}

impl Default for LibraryLimits {
    fn default() -> Self {
        LibraryLimits { keep: 10, age_s: 180 * 86_400, bytes: 20 << 30 }
    }
}

/// A session of the library, without a look into the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LibraryEntry {
    pub path: PathBuf,
    /// With its write-ahead log.
    pub bytes: u64,
    /// Seconds since 1970 of the last write.
    pub written_s: u64,
}

/// Returns the folder of the sessions; `None` without a home folder.
pub fn folder() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "sculptd").map(|d| d.data_dir().join("sessions"))
}

/// Returns the folder of an installation's visit in progress; `None` without a home folder.
pub fn visits() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "sculptd").map(|d| d.data_dir().join("kiosk"))
}

/// Year, month, day, hour and minute in UTC. The civil date of a day number after Howard Hinnant,
/// "chrono-compatible low-level date algorithms" (2013).
fn civil(seconds: u64) -> (u64, u64, u64, u64, u64) {
    let z = seconds / 86_400 + 719_468;
    let (era, day) = (z / 146_097, z % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let (d, m) = (day - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    let minutes = seconds % 86_400 / 60;
    (era * 400 + year + u64::from(m <= 2), m, d, minutes / 60, minutes % 60)
}

/// A name that is not taken in `folder`, by the time in seconds since 1970 (UTC) and the object.
pub fn new_path(folder: &Path, now_s: u64, object: &str) -> PathBuf {
    let (year, month, day, hour, minute) = civil(now_s);
    let plain: String = object
        .chars()
        .map(|c| if c.is_alphanumeric() || c == '-' { c } else { '-' })
        .take(40)
        .collect();
    let stem = format!("{year:04}-{month:02}-{day:02}_{hour:02}{minute:02}_{plain}");
    let names = std::iter::once(stem.clone()).chain((2..).map(|n| format!("{stem}-{n}")));
    let mut paths = names.map(|n| folder.join(format!("{n}.{ENDING}")));
    paths.find(|p| !p.exists()).unwrap_or_default()
}

/// The sessions of a folder, the newest first; none where it cannot be read.
pub fn entries(folder: &Path) -> Vec<LibraryEntry> {
    let Ok(found) = std::fs::read_dir(folder) else { return Vec::new() };
    let entry = |e: std::fs::DirEntry| {
        let (path, about) = (e.path(), e.metadata().ok()?);
        if !about.is_file() || path.extension().is_none_or(|e| e != ENDING) {
            return None;
        }
        let mut log = path.clone().into_os_string();
        log.push("-wal");
        let log = std::fs::metadata(log).ok();
        let times = [about.modified().ok(), log.as_ref().and_then(|l| l.modified().ok())];
        let written = times.into_iter().flatten().max()?;
        let written_s = written.duration_since(std::time::UNIX_EPOCH).map_or(0, |d| d.as_secs());
        let bytes = about.len() + log.map_or(0, |l| l.len());
        Some(LibraryEntry { path, bytes, written_s })
    };
    let mut all: Vec<LibraryEntry> = found.flatten().filter_map(entry).collect();
    all.sort_by(|a, b| b.written_s.cmp(&a.written_s).then_with(|| b.path.cmp(&a.path)));
    all
}

/// Removes what is beyond the limits, the oldest first; what went. A session that a daemon writes
/// and a damaged one stay.
pub fn prune(folder: &Path, now_s: u64, limits: &LibraryLimits) -> Vec<PathBuf> {
    let (mut gone, mut total) = (Vec::new(), 0u64);
    for (i, entry) in entries(folder).into_iter().enumerate() {
        total += entry.bytes;
        let old = now_s.saturating_sub(entry.written_s) > limits.age_s;
        if i < limits.keep || (!old && total <= limits.bytes) || in_use(&entry.path) {
            continue;
        }
        let whole = catalog::look(&entry.path).is_ok_and(|e| e.damage.is_none());
        if whole && catalog::remove(&entry.path).is_ok() {
            total -= entry.bytes;
            gone.push(entry.path);
        }
    }
    gone
}

/// Removes a session in which nothing was done: its history is its start. Whether it went.
pub fn remove_untouched(path: &Path) -> bool {
    let untouched = listing::read(path).is_ok_and(|h| h.places.len() == 1);
    untouched && !in_use(path) && catalog::remove(path).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_is_named_by_its_date_and_object() {
        assert_eq!(civil(0), (1970, 1, 1, 0, 0));
        // date -u -d '2024-02-29 23:59' +%s, and the same of 2026-11-22 03:08.
        assert_eq!(civil(1_709_251_140), (2024, 2, 29, 23, 59));
        assert_eq!(civil(1_795_316_880), (2026, 11, 22, 3, 8));
        let dir = tempfile::tempdir().expect("a folder");
        let first = new_path(dir.path(), 1_795_316_880, "my head/2");
        assert!(first.ends_with("2026-11-22_0308_my-head-2.sculpt"), "{first:?}");
        std::fs::File::create(&first).expect("a file");
        let second = new_path(dir.path(), 1_795_316_880, "my head/2");
        assert!(second.ends_with("2026-11-22_0308_my-head-2-2.sculpt"), "{second:?}");
        assert_eq!(entries(dir.path()).len(), 1);
        // Not a session that can be read: it stays, whatever the limits say.
        let none = LibraryLimits { keep: 0, age_s: 0, bytes: 0 };
        assert!(prune(dir.path(), u64::MAX, &none).is_empty());
        assert!(!remove_untouched(&first) && first.exists());
    }
}

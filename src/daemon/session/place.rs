//! Where a session's file is while it is written. A person may rename it, move it, delete it, or
//! let another file take its name, and a program that syncs folders may do so too.
//!
//! * **Moved** within its disk: the writer follows. SQLite's log goes by its name and is renamed as
//!   well; all handles stay on the same files.
//! * **Gone** (deleted, moved to another disk, or replaced): nothing that is written from then on
//!   could be found again. That is said at once, and all of the session is written to a free name:
//!   then, and once more at the end.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use rusqlite::{Connection, OpenFlags};

use super::acknowledgement::{Acknowledgement, AcknowledgementPage};
use super::connection::companion;
use super::input_end::InputEnd;

/// The path of a session that may be moved while it is written. Clones name the same place.
#[derive(Debug, Clone)]
pub struct SessionPath(Arc<Mutex<PathBuf>>);

impl From<&Path> for SessionPath {
    fn from(path: &Path) -> Self {
        SessionPath(Arc::new(Mutex::new(path.to_path_buf())))
    }
}

impl SessionPath {
    /// Returns the path as it is now.
    pub fn get(&self) -> PathBuf {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set(&self, path: PathBuf) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = path;
    }
}

/// State of the file since it was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Standing {
    /// It has not moved.
    Here,
    /// It was renamed to this path.
    Moved(PathBuf),
    /// It was deleted.
    Gone,
}

/// The place of an open session file.
#[derive(Debug)]
pub(super) struct SessionPlace {
    pub path: SessionPath,
    file: Arc<File>,
    /// The path to which the session was rescued because its file was gone.
    rescued: Option<PathBuf>,
    /// True if the file was moved, so that SQLite does not remove the log, which has another name.
    moved: bool,
}

impl SessionPlace {
    pub fn new(path: SessionPath, file: Arc<File>) -> SessionPlace {
        SessionPlace { path, file, rescued: None, moved: false }
    }

    /// Looks where the file is.
    #[cfg(unix)]
    pub fn look(&self) -> Standing {
        use std::os::fd::AsRawFd;
        use std::os::unix::fs::MetadataExt;
        let Ok(own) = self.file.metadata() else { return Standing::Here };
        let is_own = |path: &Path| {
            std::fs::metadata(path).is_ok_and(|m| (m.dev(), m.ino()) == (own.dev(), own.ino()))
        };
        if is_own(&self.path.get()) {
            return Standing::Here;
        }
        let link = format!("/proc/self/fd/{}", self.file.as_raw_fd());
        match std::fs::read_link(link) {
            Ok(now) if is_own(&now) => Standing::Moved(now),
            _ => Standing::Gone,
        }
    }

    /// Looks where the file is.
    #[cfg(not(unix))]
    pub fn look(&self) -> Standing {
        // An open file can be neither renamed nor deleted there.
        Standing::Here
    }

    /// Follows the file to its new name, with its log.
    ///
    /// # Errors
    /// Returns an error if the log cannot be renamed: it is needed beside the file until the end.
    pub fn follow(&mut self, now: PathBuf) -> std::io::Result<()> {
        let before = self.path.get();
        for ending in ["-wal", "-shm"] {
            let (from, to) = (companion(&before, ending), companion(&now, ending));
            if from.exists() {
                std::fs::rename(&from, &to)?;
            }
        }
        self.path.set(now);
        self.moved = true;
        Ok(())
    }

    /// Writes the whole session to a free name and returns the path. `known`: the input that it
    /// contains.
    ///
    /// # Errors
    /// Returns an error if neither its folder nor the state folder can be written.
    pub fn rescue(
        &mut self,
        db: &Connection,
        known: Acknowledgement,
    ) -> Result<PathBuf, rusqlite::Error> {
        let (path, state) = (self.path.get(), crate::config::state_dir());
        let folders = [path.parent().map(Path::to_path_buf), Some(state)];
        let mut result = Err(rusqlite::Error::InvalidPath(path.clone()));
        for folder in folders.into_iter().flatten() {
            let target = self.rescued.clone().unwrap_or_else(|| free_name(&folder, &path));
            let begun = companion(&target, "-begun");
            let _ = std::fs::remove_file(&begun);
            // Written to a temporary name first: an earlier rescue stays until this one is
            // complete.
            result = db
                .execute("VACUUM INTO ?1", [begun.to_string_lossy()])
                .and_then(|_| ends_at(&begun, known))
                .and_then(|()| {
                    let published =
                        acknowledge(&begun, known).and_then(|()| std::fs::rename(&begun, &target));
                    published.map_err(|_| rusqlite::Error::InvalidPath(target.clone()))
                })
                .map(|()| target.clone());
            if result.is_ok() {
                self.rescued = Some(target);
                break;
            }
            let _ = std::fs::remove_file(&begun);
        }
        result
    }

    /// After the last handle of the file is closed: nothing is needed beside it.
    pub fn tidy(&self) {
        let path = self.path.get();
        match self.look() {
            Standing::Here if self.moved => {
                // Takes over what is left of the log, and removes it.
                let taken = Connection::open(&path).and_then(|db| {
                    db.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |r| r.get::<_, i64>(0))
                });
                if let Err(e) = taken {
                    tracing::warn!("{}: its log stays beside it: {e}", path.display());
                }
            }
            // All of it was rescued, and another file must never be read with this log.
            Standing::Gone if self.rescued.is_some() => {
                for ending in ["-wal", "-shm"] {
                    let _ = std::fs::remove_file(companion(&path, ending));
                }
            }
            _ => {}
        }
    }
}

/// Writes what a whole file holds into it, and brings that to the disk.
fn acknowledge(path: &Path, known: Acknowledgement) -> std::io::Result<()> {
    let file = Arc::new(File::options().read(true).write(true).open(path)?);
    if let Some((mut page, _)) = AcknowledgementPage::find(file)? {
        page.write(&known)?;
        page.sync()?;
    }
    Ok(())
}

/// Returns an unused name similar to the session's. The session's name is not reused: the log of
/// the deleted file may still exist beside it.
fn free_name(folder: &Path, path: &Path) -> PathBuf {
    let stem = path.file_stem().map_or("session".into(), |s| s.to_string_lossy().into_owned());
    let mut numbered = (1..).map(|n| folder.join(format!("{stem}-kept-{n}.sculpt")));
    numbered
        .find(|p| !p.exists() && !companion(p, "-wal").exists())
        .unwrap_or_else(|| folder.join("kept.sculpt"))
}

/// Reads back whether the input of a session's copy ends where it is `known` to end.
fn ends_at(copy: &Path, known: Acknowledgement) -> rusqlite::Result<()> {
    let db = Connection::open_with_flags(copy, OpenFlags::SQLITE_OPEN_READ_ONLY)?;
    let end = InputEnd::read(&db)?;
    match (end.identity, end.tick, end.chain) == (known.identity, known.tick, known.chain) {
        true => Ok(()),
        false => Err(rusqlite::Error::InvalidPath(copy.to_path_buf())),
    }
}

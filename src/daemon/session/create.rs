//! Making a session file: beside its name, synced, then renamed, so that a file of that name is
//! a whole session or none.

use std::fs::{File, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rusqlite::Connection;

use super::acknowledgement::acknowledge_first;
use super::carve::is_without_content;
use super::connection::{companion, in_use};
use super::format::{
    META_IDENTITY, META_SETTINGS, META_START, META_SUMS, Settings, TABLES, TABLES_OF_COPIES,
    chain_start, spare_blob,
};
use super::shared_memory_log::new_creation_number;
use super::start::SessionStart;
use super::{APPLICATION_ID, VERSION};

/// A half-made file is at most this long: what older versions left when they were killed while
/// they made a session.
const HALF_MADE_BYTES: u64 = 64 << 10;

/// Why a session cannot be made or gone on with.
/// Bytes between the two copies of the start: more than one bad place of a disk.
const GAP: u32 = 32 << 10;

#[derive(Debug, thiserror::Error)]
pub enum CreateError {
    #[error("{path}: exists already; a session is never overwritten")]
    Exists { path: String },
    #[error("{path}: another sculptd is writing it; end that one, or name another session")]
    Busy { path: String },
    #[error("{path}: {source}")]
    Store { path: String, source: rusqlite::Error },
    #[error("{path}: {source}")]
    Io { path: String, source: std::io::Error },
}

/// A session under a temporary name, removed unless it is published.
#[derive(Debug)]
pub(super) struct SessionDraft {
    db: Option<Connection>,
    /// The temporary path.
    temporary: PathBuf,
    pub identity: u64,
    published: bool,
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".{name}.new-{ending}"))
}

/// Removes what processes that ended left of sessions of this name.
fn remove_leftovers(path: &Path) {
    let start = beside(path, "").file_name().map(|n| n.to_string_lossy().into_owned());
    let (Some(folder), Some(start)) = (path.parent(), start) else { return };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(pid) = name.strip_prefix(&start).and_then(|r| r.split('-').next()) else {
            continue;
        };
        if cfg!(target_os = "linux") && !Path::new("/proc").join(pid).exists() {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// The fallback folder in the temporary directory may have been made by another user, to read what
/// is put there: it is refused then.
fn refuse_others_folder(path: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let fallback = std::env::temp_dir().join("sculptd");
        let own = rustix::process::getuid().as_raw();
        if path.parent() == Some(&fallback)
            && std::fs::symlink_metadata(&fallback)
                .is_ok_and(|m| m.uid() != own || !m.is_dir() || m.mode() & 0o002 != 0)
        {
            return Err(std::io::Error::new(
                ErrorKind::PermissionDenied,
                "the folder is not this user's alone; name a session in a folder of your own",
            ));
        }
    }
    Ok(())
}

/// Returns true if a file of that name is empty, or left over from a session killed during its
/// creation. Such a file contains no readable part of a session and may be replaced.
pub fn is_half_made(path: &Path) -> bool {
    let Ok(about) = std::fs::metadata(path) else { return false };
    if !about.is_file() || about.len() > HALF_MADE_BYTES {
        return false;
    }
    if about.len() == 0 && std::fs::metadata(companion(path, "-wal")).map_or(0, |m| m.len()) == 0 {
        return true;
    }
    // Something else's file is nobody's to take.
    let Ok(bytes) = std::fs::read(path) else { return false };
    let ours = bytes.get(68..72) == Some(&APPLICATION_ID.to_be_bytes()[..]);
    // The mark may still have been on its way; a file with any table at all is another program's.
    let no_tables = bytes.len() <= 4096 && bytes.get(103..105) == Some(&[0, 0][..]);
    let begins = bytes.is_empty() || bytes.starts_with(b"SQLite format") && (ours || no_tables);
    begins && is_without_content(path) && !in_use(path)
}

impl SessionDraft {
    /// Creates the tables with the start mesh and the settings.
    ///
    /// # Errors
    /// Returns an error if the folder or the disk cannot be written.
    pub fn begin(
        path: &Path,
        start: &SessionStart,
        settings: &Settings,
    ) -> Result<SessionDraft, CreateError> {
        static SERIAL: AtomicU32 = AtomicU32::new(0);
        let name = || path.display().to_string();
        let store = |source| CreateError::Store { path: name(), source };
        refuse_others_folder(path).map_err(|source| CreateError::Io { path: name(), source })?;
        remove_leftovers(path);
        let (pid, serial) = (std::process::id(), SERIAL.fetch_add(1, Relaxed));
        let temporary = beside(path, &format!("{pid}-{serial}"));
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        options.open(&temporary).map_err(|source| CreateError::Io { path: name(), source })?;
        let identity = new_creation_number();
        let mut draft = SessionDraft { db: None, temporary, identity, published: false };
        let db = Connection::open(&draft.temporary).map_err(store)?;
        // Nobody else sees it before it is whole, and then it is synced as a whole.
        db.pragma_update(None, "journal_mode", "off").map_err(store)?;
        db.pragma_update(None, "synchronous", "off").map_err(store)?;
        db.pragma_update(None, "application_id", APPLICATION_ID).map_err(store)?;
        db.pragma_update(None, "user_version", VERSION).map_err(store)?;
        let blob = |value: Result<Vec<u8>, postcard::Error>| {
            value.map_err(|e| store(rusqlite::Error::ToSqlConversionFailure(Box::new(e))))
        };
        let mesh = blob(start.to_bytes())?;
        let settings = blob(postcard::to_stdvec(settings))?;
        let sums = (crc32fast::hash(&mesh), crc32fast::hash(&settings));
        let sums = blob(postcard::to_stdvec(&sums))?;
        let all = || -> rusqlite::Result<()> {
            db.execute_batch("BEGIN")?;
            db.execute_batch(TABLES)?;
            db.execute_batch(super::history::store::TABLES)?;
            db.execute_batch(TABLES_OF_COPIES)?;
            acknowledge_first(&db, identity, 0, chain_start(identity))?;
            let mut put = db.prepare("INSERT INTO meta (key, value) VALUES (?1, ?2)")?;
            put.execute((META_IDENTITY, identity.to_le_bytes().as_slice()))?;
            put.execute((META_START, &mesh))?;
            put.execute((META_SETTINGS, &settings))?;
            put.execute((META_SUMS, &sums))?;
            let mut copy = db.prepare("INSERT INTO spare (data) VALUES (?1)")?;
            copy.execute([spare_blob(META_SETTINGS, &settings)])?;
            copy.execute([spare_blob(META_SUMS, &sums)])?;
            // The first start ends where the second would begin, and a bad place of a disk is
            // larger than a page.
            db.execute("INSERT INTO spare (data) VALUES (zeroblob(?1))", [GAP])?;
            copy.execute([spare_blob(META_START, &mesh)])?;
            db.execute_batch("COMMIT")
        };
        all().map_err(store)?;
        draft.db = Some(db);
        Ok(draft)
    }

    /// The tables, to put more into them.
    pub fn db(&self) -> Option<&Connection> {
        self.db.as_ref()
    }

    /// Returns the temporary path.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Syncs the session to the disk and renames it to `path`. `over`: replaces a half-made file of
    /// that name; otherwise an existing file stays and an error is returned.
    ///
    /// # Errors
    /// Returns [`CreateError::Exists`], or an error if the disk cannot be written.
    pub fn publish(mut self, path: &Path, over: bool) -> Result<(), CreateError> {
        let name = || path.display().to_string();
        let store = |source| CreateError::Store { path: name(), source };
        let io = |source| CreateError::Io { path: name(), source };
        if let Some(db) = self.db.take() {
            db.pragma_update(None, "journal_mode", "wal").map_err(store)?;
            db.close().map_err(|(_, e)| store(e))?;
        }
        File::open(&self.temporary).and_then(|f| f.sync_all()).map_err(io)?;
        if over || !path.exists() {
            // Files left by an earlier session of that name would be taken for this one's log.
            for ending in ["-wal", "-shm"] {
                let _ = std::fs::remove_file(companion(path, ending));
            }
        }
        rename(&self.temporary, path, over).map_err(|source| match source.kind() {
            ErrorKind::AlreadyExists => CreateError::Exists { path: name() },
            _ => CreateError::Io { path: name(), source },
        })?;
        self.published = true;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        // The name itself; a file system that cannot sync a folder keeps it anyhow.
        let _ = File::open(folder.unwrap_or(Path::new("."))).and_then(|f| f.sync_all());
        Ok(())
    }
}

impl Drop for SessionDraft {
    fn drop(&mut self) {
        if !self.published {
            self.db = None;
            let _ = std::fs::remove_file(&self.temporary);
        }
    }
}

/// Exclusive unless `over`: if two daemons create a session of one name at once, one gets an error.
fn rename(from: &Path, to: &Path, over: bool) -> std::io::Result<()> {
    #[cfg(target_os = "linux")]
    if !over {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        match renameat_with(CWD, from, CWD, to, RenameFlags::NOREPLACE) {
            Err(rustix::io::Errno::INVAL | rustix::io::Errno::NOSYS) => {}
            other => return other.map_err(Into::into),
        }
    }
    if !over && to.exists() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    std::fs::rename(from, to)
}

//! Opens a session's database for reading, and finds the files beside it.

use std::path::{Path, PathBuf};

use rusqlite::types::Type;
use rusqlite::{Connection, ErrorCode, OpenFlags};

use super::format::META_START;
use super::start::SessionStart;

/// An SQLite file's companion.
pub(super) fn companion(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// A connection that reads. `alone`: the main file without its log.
pub(super) fn connect(path: &Path, alone: bool) -> rusqlite::Result<Connection> {
    let plain = OpenFlags::SQLITE_OPEN_READ_ONLY;
    if !alone {
        let db = Connection::open_with_flags(path, plain)?;
        db.busy_timeout(std::time::Duration::from_secs(2))?;
        // The first statement opens the log's index, which needs a folder that can be written.
        let trial = db.query_row("PRAGMA schema_version", [], |r| r.get::<_, i64>(0));
        let closed = matches!(
            trial.as_ref().err().and_then(rusqlite::Error::sqlite_error_code),
            Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly)
        );
        let log = std::fs::metadata(companion(path, "-wal")).map_or(0, |m| m.len());
        if !closed || log > 0 {
            trial?;
            return Ok(db);
        }
    }
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.into());
    let mut uri = String::from("file:");
    for byte in whole.as_os_str().as_encoded_bytes() {
        match byte {
            b'/' | b'.' | b'-' | b'_' | b'0'..=b'9' | b'a'..=b'z' | b'A'..=b'Z' => {
                uri.push(char::from(*byte));
            }
            other => uri.push_str(&format!("%{other:02x}")),
        }
    }
    uri.push_str("?immutable=1");
    Connection::open_with_flags(uri, plain | OpenFlags::SQLITE_OPEN_URI)
}

/// Makes commits not wait for the disk, because [`super::syncer`] syncs them. Only the first commit
/// of a log that is begun again waits, until its header is on the disk: a power cut could otherwise
/// leave the old header and old pages, which would be read over the newer ones of the database.
pub(super) fn commit_without_waiting(db: &Connection) -> rusqlite::Result<()> {
    db.pragma_update(None, "synchronous", "normal")
}

/// Reads the start alone, for a caller that holds the session open for writing. No other handle of
/// the file is opened, because closing it would release SQLite's locks.
///
/// # Errors
/// Returns an error if the session cannot be read.
pub(super) fn read_start(path: &Path) -> rusqlite::Result<SessionStart> {
    let db = connect(path, false)?;
    let sql = "SELECT value FROM meta WHERE key = ?1";
    let bytes: Vec<u8> = db.query_row(sql, [META_START], |r| r.get(0))?;
    SessionStart::from_bytes(&bytes, &[])
        .map_err(|e| rusqlite::Error::FromSqlConversionFailure(0, Type::Blob, Box::new(e)))
}

/// Returns true if a daemon writes the session: the writer holds a lock while it runs.
pub fn in_use(path: &Path) -> bool {
    std::fs::File::open(path)
        .is_ok_and(|f| matches!(f.try_lock_shared(), Err(std::fs::TryLockError::WouldBlock)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 is "normal": SQLite syncs the header of a log that is begun again. With 0, "off", it does
    /// not.
    #[test]
    fn a_log_that_is_begun_again_gets_its_header_to_the_disk_first() {
        let db = Connection::open_in_memory().expect("opens");
        commit_without_waiting(&db).expect("set");
        let level: i64 = db.query_row("PRAGMA synchronous", [], |r| r.get(0)).expect("told");
        assert_eq!(level, 1);
    }
}

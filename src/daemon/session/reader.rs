//! Opening a session: the start, then every group whose checksum holds.

use std::path::Path;

use rusqlite::{Connection, OpenFlags, OptionalExtension};

use super::format::{META_SETTINGS, META_START, META_SUMS, META_TAIL, Settings, TickInput, ticks};
use super::{APPLICATION_ID, VERSION};
use crate::session::shared_memory_log;
use sculptd_geometry::TriMesh;

/// Largest start mesh that is read back, bytes; more than the 24 GiB machine's working set makes no
/// session.
const MAX_START_BYTES: i64 = 8 << 30;

#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error(
        "{path}: not a session file (expected an SQLite database with application id {APPLICATION_ID:#x})"
    )]
    NotASession { path: String },
    #[error(
        "{path}: written by {} sculptd (layout {found}, this one reads {VERSION}): the same input makes other clay in \
         each; nothing was changed, open it with that one and export the work",
        if *.found > VERSION { "a newer" } else { "an older" }
    )]
    OtherLayout { path: String, found: u32 },
    #[error("{path}: {what} cannot be read: {source}")]
    Damaged { path: String, what: &'static str, source: Box<dyn std::error::Error + Send + Sync> },
    #[error("{path}: {source}")]
    Io { path: String, source: std::io::Error },
}

/// A session, read.
#[derive(Debug)]
pub struct Opened {
    /// The file; its history is read when it is asked for.
    pub path: std::path::PathBuf,
    pub start: TriMesh,
    pub settings: Settings,
    pub input: Vec<TickInput>,
    /// What could not be read.
    pub loss: Option<Loss>,
}

/// What of a session could not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loss {
    /// The last tick that was read.
    pub kept: u64,
    /// The last tick that the file speaks of, where it could be made out.
    pub last: Option<u64>,
    pub cause: String,
}

impl Loss {
    /// Ticks of input lost, where the file still says how far it went.
    pub fn ticks(&self) -> Option<u64> {
        self.last.map(|l| l.saturating_sub(self.kept)).filter(|n| *n > 0)
    }
}

impl std::fmt::Display for Loss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "kept up to tick {}; ", self.kept)?;
        match self.ticks() {
            Some(n) => write!(f, "{n} ticks are lost, up to tick {}", self.kept + n)?,
            None => write!(f, "what came after it is lost, how many ticks cannot be told")?,
        }
        write!(f, " ({})", self.cause)
    }
}

/// Reads a session and changes nothing in it, also while a daemon writes it. A damaged tail is left
/// out and said in [`Opened::loss`]; a damaged start is an error.
pub fn open(path: &Path) -> Result<Opened, OpenError> {
    read(path, true)
}

/// `strict`: the checksums of start and settings must hold. Otherwise it is enough that they make
/// sense.
pub(super) fn read(path: &Path, strict: bool) -> Result<Opened, OpenError> {
    let name = path.display().to_string();
    if let Err(source) = std::fs::metadata(path) {
        return Err(OpenError::Io { path: name, source });
    }
    let not = |_| OpenError::NotASession { path: name.clone() };
    let db = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY).map_err(not)?;
    db.busy_timeout(std::time::Duration::from_secs(2)).map_err(not)?;
    let id: i32 = db.query_row("PRAGMA application_id", [], |r| r.get(0)).map_err(not)?;
    if id != APPLICATION_ID {
        return Err(OpenError::NotASession { path: name });
    }
    let found: u32 = db.query_row("PRAGMA user_version", [], |r| r.get(0)).map_err(not)?;
    // 0: its header never reached the disk, and what follows says what is missing.
    if found != VERSION && found != 0 {
        return Err(OpenError::OtherLayout { path: name, found });
    }
    let damaged = |what: &'static str, source: Box<dyn std::error::Error + Send + Sync>| {
        OpenError::Damaged { path: name.clone(), what, source }
    };
    let meta = |key: &'static str| -> Result<Option<Vec<u8>>, OpenError> {
        db.query_row(
            "SELECT value FROM meta WHERE key = ?1 AND length(value) < ?2",
            (key, MAX_START_BYTES),
            |r| r.get(0),
        )
        .optional()
        .map_err(|e| damaged(key, e.into()))
    };
    let start_bytes =
        meta(META_START)?.ok_or_else(|| damaged(META_START, "it is missing".into()))?;
    let settings_bytes =
        meta(META_SETTINGS)?.ok_or_else(|| damaged(META_SETTINGS, "it is missing".into()))?;
    if strict && let Some(sums) = meta(META_SUMS)? {
        let sums: (u32, u32) =
            postcard::from_bytes(&sums).map_err(|e| damaged(META_SUMS, e.into()))?;
        for (what, bytes, sum) in
            [(META_START, &start_bytes, sums.0), (META_SETTINGS, &settings_bytes, sums.1)]
        {
            if crc32fast::hash(bytes) != sum {
                return Err(damaged(what, "its checksum does not hold".into()));
            }
        }
    }
    let start: TriMesh =
        postcard::from_bytes(&start_bytes).map_err(|e| damaged(META_START, e.into()))?;
    let count = start.positions.len();
    if start.triangles.iter().flatten().any(|&v| v as usize >= count) {
        return Err(damaged(META_START, "an index is out of range".into()));
    }
    let settings =
        postcard::from_bytes(&settings_bytes).map_err(|e| damaged(META_SETTINGS, e.into()))?;
    let (mut input, cause) = read_log(&db);
    if cause.is_none()
        && let Ok(Some(tail)) = meta(META_TAIL)
        && let Ok(name) = tail.try_into().map(u64::from_le_bytes)
    {
        shared_memory_log::lengthen(&mut input, &shared_memory_log::read(name));
    }
    let loss = cause.map(|cause| Loss {
        kept: input.last().map_or(0, |t| t.tick),
        last: last_named(&db),
        cause,
    });
    Ok(Opened { path: path.into(), start, settings, input, loss })
}

/// The last tick that any readable row names.
fn last_named(db: &Connection) -> Option<u64> {
    let mut last = None;
    for order in ["ASC", "DESC"] {
        // Row by row and from both ends: a damaged page in the middle hides neither end.
        let mut scan = || -> rusqlite::Result<()> {
            let mut query =
                db.prepare(&format!("SELECT last_tick FROM log ORDER BY id {order}"))?;
            let mut rows = query.query([])?;
            while let Some(row) = rows.next()? {
                if let Ok(tick) = row.get::<_, i64>(0) {
                    last = last.max(u64::try_from(tick).ok());
                }
            }
            Ok(())
        };
        let _ = scan();
    }
    last
}

/// Every group up to the first that is missing, torn, or out of order, and what is wrong with that
/// one.
fn read_log(db: &Connection) -> (Vec<TickInput>, Option<String>) {
    let mut input: Vec<TickInput> = Vec::new();
    let mut read = || -> Result<Option<String>, rusqlite::Error> {
        let mut query =
            db.prepare("SELECT id, first_tick, last_tick, crc, data FROM log ORDER BY id")?;
        let mut rows = query.query([])?;
        let mut expected = 1i64;
        while let Some(row) = rows.next()? {
            let (id, first, last): (i64, i64, i64) = (row.get(0)?, row.get(1)?, row.get(2)?);
            let (crc, data): (u32, Vec<u8>) = (row.get(3)?, row.get(4)?);
            if id != expected {
                return Ok(Some(format!("group {expected} is missing")));
            }
            expected += 1;
            let broken = || Some(format!("the group of ticks {first} to {last} is damaged"));
            if crc32fast::hash(&data) != crc {
                return Ok(broken());
            }
            for tick in ticks(&data) {
                match tick {
                    Ok(tick) if input.last().is_none_or(|l| l.tick < tick.tick) => input.push(tick),
                    _ => return Ok(broken()),
                }
            }
        }
        Ok(None)
    };
    let cause = read().unwrap_or_else(|e| Some(format!("the log cannot be read to its end: {e}")));
    (input, cause)
}

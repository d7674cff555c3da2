//! Opening a session: the start, then every group whose checksum holds.

use std::path::Path;

use rusqlite::{Connection, OpenFlags, OptionalExtension};

use super::format::{META_SETTINGS, META_START, Settings, TickInput, ticks};
use super::{APPLICATION_ID, VERSION};
use crate::mesh::TriMesh;

/// Largest start mesh that is read back, bytes; more than the 24 GiB machine's working set makes no session.
const MAX_START_BYTES: i64 = 8 << 30;

#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error(
        "{path}: not a session file (expected an SQLite database with application id {APPLICATION_ID:#x})"
    )]
    NotASession { path: String },
    #[error("{path}: written by a newer sculptd (layout {found}, this one reads up to {VERSION})")]
    TooNew { path: String, found: u32 },
    #[error("{path}: {what} cannot be read: {source}")]
    Damaged { path: String, what: &'static str, source: Box<dyn std::error::Error + Send + Sync> },
    #[error("{path}: {source}")]
    Io { path: String, source: std::io::Error },
}

/// A session, read.
#[derive(Debug)]
pub struct Opened {
    pub start: TriMesh,
    pub settings: Settings,
    pub input: Vec<TickInput>,
    /// What could not be read, in words: groups after the first broken one, with their ticks.
    pub loss: Option<String>,
}

/// Reads a session. A damaged tail is left out and said in [`Opened::loss`]; a damaged start is an error.
pub fn open(path: &Path) -> Result<Opened, OpenError> {
    let name = path.display().to_string();
    std::fs::File::open(path).map_err(|source| OpenError::Io { path: name.clone(), source })?;
    let not = |_| OpenError::NotASession { path: name.clone() };
    let db = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_WRITE).map_err(not)?;
    let id: i32 = db.query_row("PRAGMA application_id", [], |r| r.get(0)).map_err(not)?;
    if id != APPLICATION_ID {
        return Err(OpenError::NotASession { path: name });
    }
    let found: u32 = db.query_row("PRAGMA user_version", [], |r| r.get(0)).map_err(not)?;
    if found > VERSION {
        return Err(OpenError::TooNew { path: name, found });
    }
    let meta = |key: &'static str| -> Result<Vec<u8>, OpenError> {
        let damaged = |source: Box<dyn std::error::Error + Send + Sync>| OpenError::Damaged {
            path: name.clone(),
            what: key,
            source,
        };
        let row: Option<Vec<u8>> = db
            .query_row(
                "SELECT value FROM meta WHERE key = ?1 AND length(value) < ?2",
                (key, MAX_START_BYTES),
                |r| r.get(0),
            )
            .optional()
            .map_err(|e| damaged(e.into()))?;
        row.ok_or_else(|| damaged("it is missing".into()))
    };
    let decode_error =
        |what, e: postcard::Error| OpenError::Damaged { path: name.clone(), what, source: e.into() };
    let start: TriMesh = postcard::from_bytes(&meta(META_START)?).map_err(|e| decode_error(META_START, e))?;
    let count = start.positions.len();
    if start.triangles.iter().flatten().any(|&v| v as usize >= count) {
        return Err(OpenError::Damaged {
            path: name,
            what: META_START,
            source: "an index is out of range".into(),
        });
    }
    let settings = postcard::from_bytes(&meta(META_SETTINGS)?).map_err(|e| decode_error(META_SETTINGS, e))?;
    let (input, loss) = read_log(&db);
    Ok(Opened { start, settings, input, loss })
}

fn read_log(db: &Connection) -> (Vec<TickInput>, Option<String>) {
    let mut input: Vec<TickInput> = Vec::new();
    let mut read = || -> Result<Option<String>, rusqlite::Error> {
        let mut query = db.prepare("SELECT first_tick, last_tick, crc, data FROM log ORDER BY id")?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            let (first, last): (i64, i64) = (row.get(0)?, row.get(1)?);
            let (crc, data): (u32, Vec<u8>) = (row.get(2)?, row.get(3)?);
            let broken = || {
                Some(format!(
                    "the input from tick {first} on is damaged (the group of ticks {first} to {last})"
                ))
            };
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
    let loss = read().unwrap_or_else(|e| Some(format!("the log cannot be read to its end: {e}")));
    (input, loss)
}

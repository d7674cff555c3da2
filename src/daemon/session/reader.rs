//! Opening a session: the start, then every group whose checksums hold, compared with what must be
//! there.

use std::path::{Path, PathBuf};

use rusqlite::{Connection, ErrorCode, OptionalExtension};

use super::acknowledgement::{self, Acknowledged, Acknowledgement, ENDED};
use super::carve::log_salts;
use super::connection::{connect, in_use};
use super::format::{
    InputRow, META_IDENTITY, META_REPLAY_FROM, META_SETTINGS, META_START, META_SUMS, ReplayFrom,
    Settings, TickInput, chain_start, field_counts, ticks, v3,
};
use super::history::Store;
use super::shared_memory_log::{FileIdentity, following, logs_of, read as read_log};
use super::start::SessionStart;
use super::{APPLICATION_ID, VERSION};
use sculptd_engine::old_layout::from_bytes;
use sculptd_geometry::TriMesh;

/// Largest start mesh that is read back, bytes; more than the 24 GiB machine's working set makes no
/// session.
const MAX_START_BYTES: i64 = 8 << 30;
/// Number of times that a session in use is read again until its file and its log in memory agree.
const TRIES: u32 = 5;
/// A log that SQLite began again after an acknowledgement has a first salt that is larger by one.
const RESTARTS: u32 = 16;

#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error(
        "{path}: not a session file (expected an SQLite database with application id \
            {APPLICATION_ID:#x})"
    )]
    NotASession { path: String },
    #[error(
        "{path}: written by {} sculptd (layout {found}, this one reads {VERSION}{}); nothing was \
         changed, open it with that one and export the sculpture",
        if *.found > VERSION { "a newer" } else { "an older" },
        if *.found > VERSION { "" } else { ", and older ones with a checkpoint: it has none" }
    )]
    OtherLayout { path: String, found: u32 },
    #[error("{path}: it can be opened at a checkpoint only, and none can be read: {why}")]
    NoCheckpoint { path: String, why: String },
    #[error("{path}: {what} cannot be read: {source}")]
    Damaged { path: String, what: &'static str, source: Box<dyn std::error::Error + Send + Sync> },
    #[error("{path}: {source}")]
    Io { path: String, source: std::io::Error },
    #[error(
        "{path}: its folder cannot be written, and its log ({path}-wal) must be taken over there: \
         copy both to a folder that can be written"
    )]
    ReadOnlyFolder { path: String },
}

/// A session, read.
#[derive(Debug)]
pub struct Opened {
    /// The file; its history is read when it is asked for.
    pub path: PathBuf,
    /// The layout of the file, [`VERSION`] or an older one.
    pub layout: u32,
    pub start: SessionStart,
    pub settings: Settings,
    pub input: Vec<TickInput>,
    /// Present where a replay from the start is refused.
    pub replay_from: Option<ReplayFrom>,
    /// The input that could not be read.
    pub loss: Option<Loss>,
    /// Description of input that may be missing. It is unknown if the session did not end cleanly
    /// and this is not its daemon's file, or the machine was restarted since.
    pub not_ended: Option<String>,
}

/// Input of a session that could not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loss {
    /// The last tick that was read.
    pub kept: u64,
    /// The last tick of the session, if it can be determined.
    pub last: Option<u64>,
    pub cause: String,
}

impl Loss {
    /// Ticks of input lost, where it could be made out how far the session went.
    pub fn ticks(&self) -> Option<u64> {
        self.last.map(|l| l.saturating_sub(self.kept))
    }
}

impl std::fmt::Display for Loss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "kept up to tick {}; ", self.kept)?;
        match self.ticks() {
            Some(0) => write!(f, "no ticks are lost at the end")?,
            Some(n) => write!(f, "{n} ticks are lost, up to tick {}", self.kept + n)?,
            None => write!(f, "what came after it is lost, how many ticks cannot be told")?,
        }
        write!(f, " ({})", self.cause)
    }
}

/// Reads a session without changing it, also while a daemon writes it. [`Opened::loss`] reports
/// missing or damaged input after a readable start; a damaged start is an error.
///
/// # Errors
/// [`OpenError`]
pub fn open(path: &Path) -> Result<Opened, OpenError> {
    let mut opened = read(path)?;
    for _ in 1..TRIES {
        // A daemon is writing: the data read from the file may be older than that from the log.
        if opened.loss.is_none() || !in_use(path) {
            break;
        }
        opened = read(path)?;
    }
    if opened.loss.is_none()
        && let Some(cause) = history_damage(path)
    {
        let kept = opened.input.last().map_or(0, |t| t.tick);
        opened.loss = Some(Loss { kept, last: Some(kept), cause });
    }
    Ok(opened)
}

/// Returns a description of the damage in a session's history, if any.
pub fn history_damage(path: &Path) -> Option<String> {
    let damage = Store::read(path).and_then(|s| s.check());
    match damage {
        Ok(None) => None,
        Ok(Some(text)) => Some(format!("the history is damaged: {text}")),
        Err(e) => Some(format!("the history cannot be read: {e}")),
    }
}

/// Returns true if the log beside a session belongs to another session, or to another time of this
/// one.
pub(super) fn log_is_foreign(path: &Path, known: &Acknowledgement) -> bool {
    log_salts(path).is_some_and(|now| salts_are_foreign(known, now))
}

/// Returns true if no log of this session since the acknowledgement has these salts.
pub(super) fn salts_are_foreign(known: &Acknowledgement, now: [u32; 2]) -> bool {
    let had = known.salts;
    had != [0, 0]
        && had != ENDED
        && had != now
        && now[0].wrapping_sub(had[0]).wrapping_sub(1) >= RESTARTS
}

/// One reading, without the history.
pub(super) fn read(path: &Path) -> Result<Opened, OpenError> {
    let name = path.display().to_string();
    let io = |source| OpenError::Io { path: name.clone(), source };
    std::fs::metadata(path).map_err(io)?;
    // Before the input: what is acknowledged meanwhile may be missing below.
    let known = acknowledgement::read(path).map_err(io)?;
    let foreign = matches!(&known, Acknowledged::Known(a) if log_is_foreign(path, a));
    let not = |e: rusqlite::Error| match e.sqlite_error_code() {
        Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly) => {
            OpenError::ReadOnlyFolder { path: name.clone() }
        }
        Some(ErrorCode::PermissionDenied) => OpenError::Io {
            path: name.clone(),
            source: std::io::ErrorKind::PermissionDenied.into(),
        },
        Some(ErrorCode::NotADatabase) => OpenError::NotASession { path: name.clone() },
        _ => OpenError::Damaged { path: name.clone(), what: "the database", source: e.into() },
    };
    let db = connect(path, foreign).map_err(not)?;
    let id: i32 = db.query_row("PRAGMA application_id", [], |r| r.get(0)).map_err(not)?;
    if id != APPLICATION_ID {
        return Err(OpenError::NotASession { path: name });
    }
    let layout: u32 = db.query_row("PRAGMA user_version", [], |r| r.get(0)).map_err(not)?;
    let damaged = |what: &'static str, source: Box<dyn std::error::Error + Send + Sync>| {
        OpenError::Damaged { path: name.clone(), what, source }
    };
    let Some(counts) = field_counts(layout) else {
        return Err(match layout {
            // Its header never reached the disk.
            0 => damaged("the database", "its layout is not named".into()),
            found => OpenError::OtherLayout { path: name, found },
        });
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
    let start = meta(META_START)?.ok_or_else(|| damaged(META_START, "it is missing".into()))?;
    let settings =
        meta(META_SETTINGS)?.ok_or_else(|| damaged(META_SETTINGS, "it is missing".into()))?;
    if let Some(sums) = meta(META_SUMS)? {
        let sums: (u32, u32) =
            postcard::from_bytes(&sums).map_err(|e| damaged(META_SUMS, e.into()))?;
        for (what, bytes, sum) in [(META_START, &start, sums.0), (META_SETTINGS, &settings, sums.1)]
        {
            if crc32fast::hash(bytes) != sum {
                return Err(damaged(what, "its checksum does not hold".into()));
            }
        }
    }
    let start =
        SessionStart::from_bytes(&start, counts).map_err(|e| damaged(META_START, e.into()))?;
    if !indices_hold(&start.mesh) {
        return Err(damaged(META_START, "an index is out of range".into()));
    }
    let settings = from_bytes(&settings, counts).map_err(|e| damaged(META_SETTINGS, e.into()))?;
    let path = path.to_path_buf();
    if layout == v3::LAYOUT {
        let (mut input, cause) = v3::read_log(&db);
        if cause.is_none()
            && let Some(name) = meta(v3::META_TAIL)?.and_then(|t| t.try_into().ok())
        {
            v3::lengthen(&mut input, u64::from_le_bytes(name));
        }
        let kept = input.last().map_or(0, |t| t.tick);
        let loss = cause.map(|cause| Loss { kept, last: last_named(&db, "log"), cause });
        let replay_from = Some(older(&db, &name)?);
        let not_ended = None;
        return Ok(Opened { path, layout, start, settings, input, replay_from, loss, not_ended });
    }
    let identity = meta(META_IDENTITY)?
        .and_then(|v| v.try_into().ok())
        .map(u64::from_le_bytes)
        .ok_or_else(|| damaged(META_IDENTITY, "it is missing".into()))?;
    let replay_from = meta(META_REPLAY_FROM)?
        .map(|v| postcard::from_bytes(&v).map_err(|e| damaged(META_REPLAY_FROM, e.into())))
        .transpose()?;
    let mut found = read_rows(&db, identity);
    // The log in memory of this very file.
    let mut newest = 0;
    let logs = FileIdentity::of(&path, identity).map(|f| logs_of(&f)).unwrap_or_default();
    let has_log = !logs.is_empty();
    if found.cause.is_none() {
        for log in logs {
            let entries = read_log(&log);
            newest = newest.max(entries.last().map_or(0, |e| e.last));
            for entry in following(found.end, &entries) {
                if !found.extend(&entry.data) {
                    break;
                }
                found.end = (entry.last, super::format::chain(found.end.1, &entry.data));
            }
        }
    }
    let kept = found.end.0;
    let (must, cause) = expected(&known, identity, found.end, newest, foreign);
    let cause = found.cause.take().or(cause);
    let last = must.max(last_named(&db, "input")).max(Some(newest)).max(Some(kept));
    let loss = cause.map(|cause| Loss { kept, last, cause });
    let ended = matches!(&known, Acknowledged::Known(a) if a.salts == ENDED);
    let not_ended = (!ended && !has_log && marks_its_end(&db) && !in_use(&path)).then(|| {
        format!(
            "the session was still open when this file was written: what was sculpted after tick \
             {kept} may be missing, at most about 2 s of it"
        )
    });
    let input = found.input;
    Ok(Opened { path, layout, start, settings, input, replay_from, loss, not_ended })
}

/// Returns true if the program that wrote the file marks the end of a session. Programs that do not
/// also write no proofs of checkpoints.
fn marks_its_end(db: &Connection) -> bool {
    let sql = "SELECT count(*) FROM sqlite_schema WHERE name = 'proof'";
    db.query_row(sql, [], |r| r.get::<_, i64>(0)).is_ok_and(|n| n > 0)
}

/// Returns true if every triangle has valid vertex indices.
pub(super) fn indices_hold(mesh: &TriMesh) -> bool {
    let count = mesh.positions.len();
    !mesh.triangles.iter().flatten().any(|&v| v as usize >= count)
}

/// Returns the last tick that must exist, and the fault if the input does not reach it.
fn expected(
    known: &Acknowledged,
    identity: u64,
    end: (u64, u32),
    newest: u64,
    foreign: bool,
) -> (Option<u64>, Option<String>) {
    let (kept, chain) = end;
    let log = "the write-ahead log is missing, damaged or cut";
    match known {
        Acknowledged::Known(a) if a.identity != identity => {
            (None, Some("its parts are of two sessions".into()))
        }
        Acknowledged::Known(a) => {
            let must = Some(a.tick.max(newest));
            let cause = if foreign {
                Some(
                    "the write-ahead log beside it is another session's, or of another time".into(),
                )
            } else if a.tick > kept {
                Some(format!("{log}: tick {} is acknowledged", a.tick))
            } else if newest > kept {
                Some(format!("{log}: tick {newest} was handed over"))
            } else if a.tick == kept && a.chain != chain {
                Some("the input is not the one that was acknowledged".into())
            } else {
                None
            };
            (must, cause)
        }
        Acknowledged::Damaged | Acknowledged::Missing => (
            None,
            Some(
                "the acknowledgement cannot be read: whether ticks are missing is not known".into(),
            ),
        ),
    }
}

/// An older layout's session opens at its checkpoints.
fn older(db: &Connection, name: &str) -> Result<ReplayFrom, OpenError> {
    let layout = v3::LAYOUT;
    let first: Option<i64> = db
        .query_row("SELECT min(tick) FROM checkpoint", [], |r| r.get(0))
        .optional()
        .ok()
        .flatten()
        .flatten();
    let Some(tick) = first else {
        return Err(OpenError::OtherLayout { path: name.into(), found: layout });
    };
    Ok(ReplayFrom {
        tick: tick as u64,
        why: format!(
            "it was begun by an older sculptd (layout {layout}), in which the same input makes \
             other clay"
        ),
    })
}

/// The last tick that any readable row names.
fn last_named(db: &Connection, table: &str) -> Option<u64> {
    let mut last = None;
    for order in ["ASC", "DESC"] {
        // Row by row and from both ends: a damaged page in the middle hides neither end.
        let mut scan = || -> rusqlite::Result<()> {
            let mut query =
                db.prepare(&format!("SELECT last_tick FROM {table} ORDER BY rowid {order}"))?;
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

/// Input that hangs together from the first row on.
#[derive(Debug)]
struct FoundInput {
    input: Vec<TickInput>,
    /// The last tick, and the chain there.
    end: (u64, u32),
    /// The fault of the next row.
    cause: Option<String>,
}

impl FoundInput {
    fn extend(&mut self, data: &[u8]) -> bool {
        for tick in ticks(data, &[]) {
            match tick {
                Ok(tick) if self.input.last().is_none_or(|l| l.tick < tick.tick) => {
                    self.input.push(tick);
                }
                _ => return false,
            }
        }
        true
    }
}

/// Every row up to the first that is missing, torn, or another session's.
fn read_rows(db: &Connection, identity: u64) -> FoundInput {
    let mut found = FoundInput { input: Vec::new(), end: (0, chain_start(identity)), cause: None };
    let mut number = 0;
    let mut read = || -> Result<Option<String>, rusqlite::Error> {
        let mut query = db.prepare(
            "SELECT number, first_tick, last_tick, crc, chain, data FROM input ORDER BY number",
        )?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            let row = InputRow {
                number: row.get::<_, i64>(0)? as u64,
                first: row.get::<_, i64>(1)? as u64,
                last: row.get::<_, i64>(2)? as u64,
                crc: row.get(3)?,
                chain: row.get(4)?,
                data: row.get(5)?,
            };
            let (first, last) = (row.first, row.last);
            if row.number != number + 1 {
                return Ok(Some(format!("group {} is missing", number + 1)));
            }
            if !row.is_whole(identity) {
                return Ok(Some(format!("the group of ticks {first} to {last} is damaged")));
            }
            if !row.follows((number, found.end.1)) || !found.extend(&row.data) {
                return Ok(Some(format!(
                    "the group of ticks {first} to {last} does not follow on the one before"
                )));
            }
            number += 1;
            found.end = (row.last, row.chain);
        }
        Ok(None)
    };
    let cause = read();
    found.cause =
        cause.unwrap_or_else(|e| Some(format!("the input cannot be read to its end: {e}")));
    found
}

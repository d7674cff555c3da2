//! The sessions in a folder: what they hold, how whole they are, and which may go.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::acknowledgement::{self, Acknowledged};
use super::connection::in_use;
use super::history::{Store, StoreError, listing};
use super::reader::open;
use super::shared_memory_log::{self, FileIdentity, LogName};
use crate::session::history::retention::{Freed, bound};

/// The ending of a session file's name.
pub const ENDING: &str = "sculpt";

/// One session, as `sculptd session` lists it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SessionEntry {
    pub path: PathBuf,
    /// Size, including the write-ahead log.
    pub bytes: u64,
    /// Seconds since 1970 of the last write.
    pub written_s: u64,
    /// Absent if the file cannot be read at all.
    pub facts: Option<SessionFacts>,
    /// Description of the unreadable parts, or the reason that nothing can be read.
    pub damage: Option<String>,
    /// Description of possibly missing input, if the session did not end cleanly.
    pub not_ended: Option<String>,
    /// Number of places in the history, including branches, and the bytes of their pages.
    pub history: Option<HistoryFigures>,
}

/// The history, in figures.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct HistoryFigures {
    pub places: usize,
    pub branches: usize,
    pub checkpoints: u64,
    pub bytes: u64,
    /// With pictures, checkpoints and the rest: what `undo.history_bytes` bounds.
    pub total_bytes: u64,
    /// Places that were let go.
    pub dropped: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SessionFacts {
    pub start_vertices: u64,
    pub rate_hz: u32,
    /// Ticks that had input.
    pub ticks: u64,
    pub last_tick: u64,
    pub samples: u64,
    pub commands: u64,
    /// The layout of the file.
    pub layout: u32,
    /// Why it opens at a checkpoint and cannot be replayed from its start, where that is so.
    pub replay_from: Option<String>,
}

fn wal(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push("-wal");
    name.into()
}

/// Reads one session to its end.
pub fn look(path: &Path) -> std::io::Result<SessionEntry> {
    let about = std::fs::metadata(path)?;
    let log = std::fs::metadata(wal(path)).ok();
    let modified = log.as_ref().unwrap_or(&about).modified().ok();
    let since = modified.and_then(|t| t.duration_since(std::time::UNIX_EPOCH).ok());
    let (facts, damage, not_ended) = match open(path) {
        Ok(o) => {
            let facts = SessionFacts {
                start_vertices: o.start.vertices(),
                rate_hz: o.settings.rate_hz,
                ticks: o.input.len() as u64,
                last_tick: o.input.last().map_or(0, |t| t.tick),
                samples: o.input.iter().map(|t| t.samples.len() as u64).sum(),
                commands: o.input.iter().map(|t| t.commands.len() as u64).sum(),
                layout: o.layout,
                replay_from: o.replay_from.map(|r| r.why),
            };
            (Some(facts), o.loss.map(|l| l.to_string()), o.not_ended)
        }
        Err(e) => (None, Some(e.to_string()), None),
    };
    Ok(SessionEntry {
        path: path.into(),
        bytes: about.len() + log.map_or(0, |m| m.len()),
        written_s: since.map_or(0, |d| d.as_secs()),
        facts,
        damage,
        not_ended,
        history: listing::read(path).ok().filter(|h| !h.places.is_empty()).map(|h| {
            HistoryFigures {
                places: h.places.len(),
                branches: h.places.iter().filter(|p| p.branch).count(),
                checkpoints: h.checkpoints,
                bytes: h.bytes,
                total_bytes: h.total_bytes,
                dropped: h.dropped,
            }
        }),
    })
}

/// Every session in a folder, the newest first. Links and folders are no sessions.
pub fn list(folder: &Path) -> std::io::Result<Vec<SessionEntry>> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        if entry.file_type()?.is_file() && path.extension().is_some_and(|e| e == ENDING) {
            all.push(look(&path)?);
        }
    }
    all.sort_by(|a, b| b.written_s.cmp(&a.written_s).then_with(|| a.path.cmp(&b.path)));
    Ok(all)
}

/// The sessions that may go so that `keep` of them stay: the oldest, never one that a daemon
/// writes, never a damaged one (somebody may still want to save it).
pub fn spare(mut all: Vec<SessionEntry>, keep: usize) -> Vec<SessionEntry> {
    let old = all.split_off(keep.min(all.len()));
    old.into_iter().filter(|e| e.damage.is_none() && !in_use(&e.path)).collect()
}

/// Removes the oldest places of a session until its history is at most `most` bytes, and shrinks
/// the file. Everything needed to open the session stays. Returns `None` if a daemon writes the
/// session or if it is already within the bound.
///
/// # Errors
/// Returns an error if the file cannot be read or written.
pub fn shorten(path: &Path, most: u64) -> Result<Option<Freed>, StoreError> {
    let damaged = |e: std::io::Error| StoreError::Damaged(e.to_string());
    // Held until the end, so that no daemon opens it meanwhile.
    let lock = std::fs::File::open(path).map_err(damaged)?;
    if matches!(lock.try_lock(), Err(std::fs::TryLockError::WouldBlock))
        || !Store::read(path)?.has_tables()?
    {
        return Ok(None);
    }
    let store = Store::write(path)?;
    let had = store.total()?;
    if had <= most {
        return Ok(None);
    }
    let mut tree = store.tree()?;
    if let Some(newest) = store.checkpoints(u64::MAX)?.first() {
        tree.cursor = store.checkpoint(*newest)?.node;
    }
    let (mut names, mut topologies) = (store.names()?, store.topologies()?);
    let (freed, _) = bound(&store, &mut tree, &mut names, &mut topologies, had, most)?;
    store.compact()?;
    drop(store);
    drop(lock);
    Ok(Some(freed))
}

/// Returns the logs in shared memory left by the processes that wrote this file.
pub fn logs_of(path: &Path) -> Vec<LogName> {
    match acknowledgement::read(path) {
        Ok(Acknowledged::Known(a)) => FileIdentity::of(path, a.identity)
            .map(|f| shared_memory_log::logs_of(&f))
            .unwrap_or_default(),
        _ => Vec::new(),
    }
}

/// Removes a session with what belongs to it.
pub fn remove(path: &Path) -> std::io::Result<()> {
    let logs = logs_of(path);
    std::fs::remove_file(path)?;
    logs.iter().for_each(shared_memory_log::remove);
    for ending in ["-wal", "-shm"] {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        let _ = std::fs::remove_file(PathBuf::from(name));
    }
    Ok(())
}

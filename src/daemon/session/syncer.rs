//! Bringing the log to the disk itself, on a thread of its own.
//!
//! A group that was committed is in the system's hands: a killed process loses nothing of it. That
//! the disk has it too takes as long as the disk likes, which on a loaded machine is longer than a
//! group; so nobody waits for it but this thread. It also takes the log over into the database,
//! with SQLite's own syncs before and after, so a power cut never leaves an unreadable file.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use crossbeam_channel as cc;
use rusqlite::Connection;

/// A log of this many bytes is taken over into the database.
const LOG_BYTES: u64 = 4 << 20;
/// Syncs between two times: the file of a log keeps its length when it is begun again.
const SYNCS: u32 = 200;

/// The thread, for the one who commits.
#[derive(Debug)]
pub(super) struct Syncer {
    wake: cc::Sender<()>,
    committed: Arc<AtomicU64>,
    /// Why the last sync failed, if it did.
    trouble: Arc<Mutex<Option<String>>>,
    thread: JoinHandle<()>,
}

impl Syncer {
    /// `written` gets the last tick that is on the disk.
    pub(super) fn start(database: &Path, written: Arc<AtomicU64>) -> std::io::Result<Self> {
        let mut name = database.as_os_str().to_owned();
        name.push("-wal");
        let path = PathBuf::from(name);
        let (wake, calls) = cc::bounded::<()>(1);
        let committed = Arc::new(AtomicU64::new(0));
        let trouble = Arc::new(Mutex::new(None));
        let (last, said, database) = (committed.clone(), trouble.clone(), database.to_path_buf());
        let thread = std::thread::Builder::new().name("sculptd-sync".into()).spawn(move || {
            let mut log: Option<File> = None;
            let mut own: Option<Connection> = None;
            let mut since = SYNCS;
            for () in calls {
                // Taken before the sync: what is committed meanwhile belongs to the next one.
                let tick = last.load(Relaxed);
                since += 1;
                let mut result = sync(&mut log, &path);
                if since > SYNCS && result.as_ref().is_ok_and(|bytes| *bytes > LOG_BYTES) {
                    since = 0;
                    result =
                        take_over(&mut own, &database).map(|()| 0).map_err(std::io::Error::other);
                }
                if result.is_ok() {
                    written.fetch_max(tick, Relaxed);
                }
                if let Ok(mut said) = said.lock() {
                    *said = result.err().map(|e| format!("{}: {e}", path.display()));
                }
            }
        })?;
        Ok(Syncer { wake, committed, trouble, thread })
    }

    /// Everything up to `tick` is committed.
    pub(super) fn committed(&self, tick: u64) {
        self.committed.store(tick, Relaxed);
        // A call that waits already comes after this store.
        let _ = self.wake.try_send(());
    }

    pub(super) fn trouble(&self) -> Option<String> {
        self.trouble.lock().ok().and_then(|t| t.clone())
    }

    /// Waits for the last sync.
    pub(super) fn finish(self) -> Option<String> {
        drop(self.wake);
        let _ = self.thread.join();
        self.trouble.lock().ok().and_then(|mut t| t.take())
    }
}

/// Brings the log to the disk; its bytes. The file is opened once: SQLite keeps the same one as
/// long as it is connected.
fn sync(log: &mut Option<File>, path: &Path) -> std::io::Result<u64> {
    if log.is_none() {
        *log = Some(OpenOptions::new().read(true).write(true).open(path)?);
    }
    let Some(log) = log else { return Ok(0) };
    log.sync_data()?;
    Ok(log.metadata()?.len())
}

/// Takes what it can of the log into the database, and holds up nobody who writes.
fn take_over(own: &mut Option<Connection>, database: &Path) -> rusqlite::Result<()> {
    if own.is_none() {
        let db = Connection::open(database)?;
        db.pragma_update(None, "synchronous", "full")?;
        *own = Some(db);
    }
    own.as_ref().map_or(Ok(()), |db| db.query_row("PRAGMA wal_checkpoint(PASSIVE)", [], |_| Ok(())))
}

//! Bringing the log to the disk itself, on a thread of its own.
//!
//! A group that was committed is in the system's hands: a killed process loses nothing of it. That
//! the disk has it too takes as long as the disk likes, which on a loaded machine is longer than a
//! group; so nobody waits for it but this thread. It also takes the log over into the database,
//! with SQLite's own syncs before and after, so a power cut never leaves an unreadable file. What
//! the disk has is acknowledged in the file, see [`super::acknowledgement`].

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use crossbeam_channel as cc;
use rusqlite::Connection;

use super::acknowledgement::{Acknowledgement, AcknowledgementPage};
use super::connection::companion;

/// A log of this many bytes is taken over into the database.
const LOG_BYTES: u64 = 4 << 20;
/// Syncs between two times: the file of a log keeps its length when it is begun again.
const SYNCS: u32 = 200;

/// The thread, for the one who commits.
#[derive(Debug)]
pub(super) struct Syncer {
    wake: cc::Sender<()>,
    /// The last tick that is committed, and the chain there.
    committed: Arc<Mutex<(u64, u32)>>,
    /// Why the last sync failed, if it did.
    trouble: Arc<Mutex<Option<String>>>,
    thread: JoinHandle<()>,
}

impl Syncer {
    /// `written` gets the last tick that is on the disk, `taken_over` the last one that the main
    /// file has. `page`: where it is acknowledged.
    pub(super) fn start(
        database: &Path,
        written: Arc<AtomicU64>,
        taken_over: Arc<AtomicU64>,
        mut page: AcknowledgementPage,
        first: Acknowledgement,
    ) -> std::io::Result<Self> {
        let path = companion(database, "-wal");
        let (wake, calls) = cc::bounded::<()>(1);
        let committed = Arc::new(Mutex::new((first.tick, first.chain)));
        let trouble = Arc::new(Mutex::new(None));
        let (last, said, database) = (committed.clone(), trouble.clone(), database.to_path_buf());
        let thread = std::thread::Builder::new().name("sculptd-sync".into()).spawn(move || {
            let mut log: Option<File> = None;
            let mut own: Option<Connection> = None;
            let mut since = SYNCS;
            for () in calls {
                // Taken before the sync: what is committed meanwhile belongs to the next one.
                let (tick, chain) = last.lock().map(|l| *l).unwrap_or_default();
                since += 1;
                let mut result = sync(&mut log, &path);
                if let Ok(synced) = &result {
                    let now = Acknowledgement { tick, chain, salts: synced.salts, ..first };
                    result = page.write(&now).map(|()| *synced);
                }
                if since > SYNCS && result.as_ref().is_ok_and(|s| s.bytes > LOG_BYTES) {
                    since = 0;
                    match take_over(&mut own, &database) {
                        Ok(true) => drop(taken_over.fetch_max(tick, Relaxed)),
                        Ok(false) => {}
                        Err(e) => result = Err(std::io::Error::other(e)),
                    }
                }
                if result.is_ok() {
                    written.fetch_max(tick, Relaxed);
                }
                if let Ok(mut said) = said.lock() {
                    *said = result.err().map(|e| format!("{}: {e}", path.display()));
                }
            }
            // The power may go once the session is closed.
            if let Err(e) = page.sync()
                && let Ok(mut said) = said.lock()
            {
                said.get_or_insert(e.to_string());
            }
        })?;
        Ok(Syncer { wake, committed, trouble, thread })
    }

    /// Everything up to `tick` is committed, and the chain there.
    pub(super) fn committed(&self, tick: u64, chain: u32) {
        if let Ok(mut committed) = self.committed.lock() {
            *committed = (tick, chain);
        }
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

/// A write-ahead log that was brought to the disk.
#[derive(Debug, Clone, Copy)]
struct SyncedLog {
    bytes: u64,
    salts: [u32; 2],
}

/// Brings the log to the disk. The file is opened once: SQLite keeps the same one as long as it is
/// connected.
fn sync(log: &mut Option<File>, path: &Path) -> std::io::Result<SyncedLog> {
    if log.is_none() {
        *log = Some(OpenOptions::new().read(true).write(true).open(path)?);
    }
    let Some(log) = log else { return Ok(SyncedLog { bytes: 0, salts: [0, 0] }) };
    log.sync_data()?;
    let mut head = [0; 24];
    log.seek(SeekFrom::Start(0))?;
    let salts = match log.read_exact(&mut head) {
        Ok(()) => [16, 20]
            .map(|at| u32::from_be_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]])),
        Err(_) => [0, 0],
    };
    Ok(SyncedLog { bytes: log.metadata()?.len(), salts })
}

/// Takes what it can of the log into the database, and holds up nobody who writes. Whether that was
/// all of it.
fn take_over(own: &mut Option<Connection>, database: &Path) -> rusqlite::Result<bool> {
    if own.is_none() {
        let db = Connection::open(database)?;
        db.pragma_update(None, "synchronous", "full")?;
        *own = Some(db);
    }
    own.as_ref().map_or(Ok(false), |db| {
        db.query_row("PRAGMA wal_checkpoint(PASSIVE)", [], |r| {
            Ok(r.get::<_, i64>(0)? == 0 && r.get::<_, i64>(1)? == r.get::<_, i64>(2)?)
        })
    })
}

//! Syncs the log to the disk, on a separate thread.
//!
//! The operating system holds every committed group, so a killed process loses none of it. Syncing
//! it to the disk may take longer than a group on a loaded machine, so only this thread waits for
//! it. The thread also checkpoints the log into the database. SQLite syncs before and after, so a
//! power cut never leaves an unreadable file. The synced state is acknowledged in the file, see
//! [`super::acknowledgement`].

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;
use rusqlite::{Connection, OpenFlags};

use super::acknowledgement::{Acknowledgement, AcknowledgementPage, ENDED};
use super::connection::companion;
use super::place::SessionPath;
use sculptd_devices::Clock;

/// The database takes over the log so long after its first change, microseconds: a copy of the
/// database alone, as backup programs make it, lacks at most about this much.
const AGE_US: u64 = 1_500_000;

/// The thread, for the one who commits.
#[derive(Debug)]
pub(super) struct Syncer {
    wake: cc::Sender<()>,
    /// The last tick that is committed, and the chain there.
    committed: Arc<Mutex<(u64, u32)>>,
    /// Why the last sync failed, if it did, and where the file was then.
    trouble: Arc<Mutex<Option<(PathBuf, String)>>>,
    database: SessionPath,
    thread: JoinHandle<()>,
}

impl Syncer {
    /// `written` gets the last tick that is on the disk, `taken_over` the last one that the main
    /// file has. `page`: where it is acknowledged.
    pub(super) fn start(
        database: SessionPath,
        written: Arc<AtomicU64>,
        taken_over: Arc<AtomicU64>,
        mut page: AcknowledgementPage,
        first: Acknowledgement,
    ) -> std::io::Result<Self> {
        let (wake, calls) = cc::bounded::<()>(1);
        let committed = Arc::new(Mutex::new((first.tick, first.chain)));
        let trouble = Arc::new(Mutex::new(None));
        let (last, said, clock) = (committed.clone(), trouble.clone(), Clock::monotonic());
        let path = database.clone();
        // Opened now: later the file may have another name.
        let mut own: Option<Connection> = None;
        let _ = take_over(&mut own, &database.get());
        let thread = std::thread::Builder::new().name("sculptd-sync".into()).spawn(move || {
            let mut log: Option<File> = None;
            // Time of the next checkpoint of the log into the database; `None`: it contains all of
            // it.
            let mut due_us: Option<u64> = None;
            loop {
                let now = clock.now_us();
                let call = match due_us {
                    None => calls.recv().map_err(|_| cc::RecvTimeoutError::Disconnected),
                    Some(due) => calls.recv_timeout(Duration::from_micros(due.saturating_sub(now))),
                };
                let mut result = Ok(());
                let mut on_disk = false;
                // Taken before the sync: what is committed meanwhile belongs to the next one.
                let (tick, chain) = last.lock().map(|l| *l).unwrap_or_default();
                match call {
                    Err(cc::RecvTimeoutError::Disconnected) => break,
                    Err(cc::RecvTimeoutError::Timeout) => {}
                    Ok(()) => {
                        due_us = due_us.or(Some(clock.now_us() + AGE_US));
                        let path = companion(&database.get(), "-wal");
                        result = sync(&mut log, &path).and_then(|salts| {
                            page.write(&Acknowledgement { tick, chain, salts, ..first })
                        });
                        on_disk = result.is_ok();
                    }
                }
                if result.is_ok() && due_us.is_some_and(|due| clock.now_us() >= due) {
                    match take_over(&mut own, &database.get()) {
                        // The history may still write what belongs to the newest input.
                        Ok(true) if matches!(call, Err(cc::RecvTimeoutError::Timeout)) => {
                            on_disk = true;
                            taken_over.fetch_max(tick, Relaxed);
                            due_us = None;
                        }
                        Ok(whole) => {
                            if whole {
                                taken_over.fetch_max(tick, Relaxed);
                            }
                            due_us = Some(clock.now_us() + AGE_US);
                        }
                        Err(e) => {
                            due_us = Some(clock.now_us() + AGE_US);
                            result = Err(std::io::Error::other(e));
                        }
                    }
                }
                if on_disk {
                    written.fetch_max(tick, Relaxed);
                }
                if let Ok(mut said) = said.lock() {
                    *said = result.err().map(|e| (database.get(), e.to_string()));
                }
            }
            // Everything is in the file once the session is closed. The power may go then.
            let (tick, chain) = last.lock().map(|l| *l).unwrap_or_default();
            let ended = Acknowledgement { tick, chain, salts: ENDED, ..first };
            if let Err(e) = page.write(&ended).and_then(|()| page.sync())
                && let Ok(mut said) = said.lock()
            {
                said.get_or_insert((database.get(), e.to_string()));
            }
        })?;
        Ok(Syncer { wake, committed, trouble, database: path, thread })
    }

    /// Everything up to `tick` is committed, and the chain there.
    pub(super) fn committed(&self, tick: u64, chain: u32) {
        if let Ok(mut committed) = self.committed.lock() {
            *committed = (tick, chain);
        }
        // A call that waits already comes after this store.
        let _ = self.wake.try_send(());
    }

    /// Returns why the last sync failed. A failure at a place from which the file has moved since
    /// is none.
    pub(super) fn trouble(&self) -> Option<String> {
        let found = self.trouble.lock().ok().and_then(|t| t.clone());
        let (path, why) = found.filter(|(path, _)| *path == self.database.get())?;
        Some(format!("{}: {why}", path.display()))
    }

    /// Waits for the last sync.
    pub(super) fn finish(self) -> Option<String> {
        let Syncer { wake, trouble, thread, .. } = self;
        drop(wake);
        let _ = thread.join();
        let (path, why) = trouble.lock().ok().and_then(|mut t| t.take())?;
        Some(format!("{}: {why}", path.display()))
    }
}

/// Brings the log to the disk, and returns its salts. The file is opened once: SQLite keeps the
/// same one as long as it is connected.
fn sync(log: &mut Option<File>, path: &Path) -> std::io::Result<[u32; 2]> {
    if log.is_none() {
        *log = Some(OpenOptions::new().read(true).write(true).open(path)?);
    }
    let Some(log) = log else { return Ok([0, 0]) };
    log.sync_data()?;
    let mut head = [0; 24];
    log.seek(SeekFrom::Start(0))?;
    Ok(match log.read_exact(&mut head) {
        Ok(()) => [16, 20]
            .map(|at| u32::from_be_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]])),
        Err(_) => [0, 0],
    })
}

/// Takes what it can of the log into the database, and holds up nobody who writes. Whether that was
/// all of it.
fn take_over(own: &mut Option<Connection>, database: &Path) -> rusqlite::Result<bool> {
    if own.is_none() {
        // A missing file is not created.
        let db = Connection::open_with_flags(database, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        db.pragma_update(None, "synchronous", "full")?;
        *own = Some(db);
    }
    own.as_ref().map_or(Ok(false), |db| {
        db.query_row("PRAGMA wal_checkpoint(PASSIVE)", [], |r| {
            Ok(r.get::<_, i64>(0)? == 0 && r.get::<_, i64>(1)? == r.get::<_, i64>(2)?)
        })
    })
}

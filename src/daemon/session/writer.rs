//! Writes a session: the tick thread fills recycled buffers, and a separate thread turns them into
//! rows.
//!
//! A full disk does not stop the sculpting. Groups are kept in memory up to `KEPT_BYTES`, the fault
//! is shown, and the groups are written once there is room.

mod misplaced;

use std::fs::File;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed, Ordering::SeqCst};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;
use rusqlite::Connection;

use super::GROUP_MS;
use super::acknowledgement::{Acknowledgement, AcknowledgementPage};
use super::connection::commit_without_waiting;
use super::create::{CreateError, SessionDraft, is_half_made};
use super::format::{Settings, append};
use super::health::Health;
use super::history::{Handle, keeper::Keeper};
use super::hold::{HeldSession, hold};
use super::input_end::{InputEnd, begin_log, upgrade};
use super::place::{SessionPath, SessionPlace};
use super::shared_memory_log::LogName;
use super::start::SessionStart;
use super::syncer::Syncer;
use crate::priority::raise_priority_below;
use crate::session::shared_memory_log;
use crate::session::shared_memory_log::SharedMemoryLog;
use crate::tick::Journal;
use sculptd_devices::{Clock, Sample};
use sculptd_engine::command::Command;
use sculptd_engine::world::World;

/// Buffers between the tick thread and the writer: at 1,000 ticks a second a quarter of a second of
/// arrears.
const BUFFERS: usize = 256;
/// First size of a buffer; a tick of a few pens fits.
const BUFFER_BYTES: usize = 4096;
/// Groups kept in memory while the disk takes nothing: more than an hour of a pen at 250 Hz.
pub const KEPT_BYTES: usize = 64 << 20;
/// Longest time between two signs of life of the writing thread.
const IDLE: Duration = Duration::from_millis(1000);
/// Interval at which the file's location is checked, and between retries after a full disk.
const LOOK: Duration = Duration::from_millis(1000);

/// The tick thread's end.
#[derive(Debug)]
pub struct SessionWriter {
    full: cc::Sender<InputMessage>,
    empty: cc::Receiver<Vec<u8>>,
    /// Ticks whose input will never be in the file. After the first of them nothing more is handed
    /// over: a log with a hole cannot be replayed beyond it.
    lost: Arc<AtomicU64>,
    /// The last tick that was handed over, or waits for room.
    handed: Arc<AtomicU64>,
    /// Ticks that found no free buffer, while the disk is slow; handed over with the next that
    /// finds one.
    carry: Vec<u8>,
    carry_ticks: (u64, u64),
    history: Option<Handle>,
    /// A checkpoint is to be made as soon as the world is at rest.
    owed: bool,
}

impl SessionWriter {
    /// Begins with the encoded input of these ticks, which came before the file was made.
    #[must_use]
    pub fn after(mut self, ticks: (u64, u64), encoded: Vec<u8>) -> SessionWriter {
        (self.carry, self.carry_ticks) = (encoded, ticks);
        self
    }

    /// From now on the history is kept too, a checkpoint first.
    pub fn keep(&mut self, history: Handle) {
        self.history = Some(history);
        self.owed = true;
    }
}

/// The writing thread.
#[derive(Debug)]
pub struct WriterThread {
    thread: JoinHandle<()>,
    pub health: Health,
    /// The history, if it is kept.
    pub history: Option<Keeper>,
    /// Path of the file.
    pub path: SessionPath,
    /// For the work that remains after all handles are closed.
    place: Arc<Mutex<SessionPlace>>,
}

impl WriterThread {
    /// Waits until all input is written. Call it after the loop, and with it the [`SessionWriter`],
    /// has ended.
    pub fn finish(self) -> Option<String> {
        let history = self.history.and_then(Keeper::finish);
        let _ = self.thread.join();
        if let Ok(place) = self.place.lock() {
            place.tidy();
        }
        self.health
            .trouble()
            .or_else(|| history.map(|why| format!("the history is not whole: {why}")))
    }
}

/// Encoded input of the ticks from the first number to the second.
enum InputMessage {
    Ticks(u64, u64, Vec<u8>),
}

/// Makes a new session file. It is on the disk, whole, before this returns; a file of that name
/// which is empty or half-made is taken over.
///
/// # Errors
/// [`CreateError`]
pub fn create(
    path: &Path,
    start: impl Into<SessionStart>,
    settings: &Settings,
) -> Result<(SessionWriter, WriterThread), CreateError> {
    create_with(path, start, settings, Health::default())
}

/// As [`create`]; `health` shows the state of this session from now on.
///
/// # Errors
/// [`CreateError`]
pub fn create_with(
    path: &Path,
    start: impl Into<SessionStart>,
    settings: &Settings,
    health: Health,
) -> Result<(SessionWriter, WriterThread), CreateError> {
    let over = path.exists();
    if over && !is_half_made(path) {
        return Err(CreateError::Exists { path: path.display().to_string() });
    }
    SessionDraft::begin(path, &start.into(), settings)?.publish(path, over)?;
    resume_with(path, hold(path)?, health)
}

/// Goes on writing a session that was opened. One of an older layout is brought to this one.
///
/// # Errors
/// [`CreateError`]
pub fn resume(path: &Path) -> Result<(SessionWriter, WriterThread), CreateError> {
    resume_held(path, hold(path)?)
}

/// As [`resume`], with a session that is held already.
///
/// # Errors
/// [`CreateError`]
pub fn resume_held(
    path: &Path,
    held: HeldSession,
) -> Result<(SessionWriter, WriterThread), CreateError> {
    resume_with(path, held, Health::default())
}

fn resume_with(
    path: &Path,
    HeldSession(lock): HeldSession,
    health: Health,
) -> Result<(SessionWriter, WriterThread), CreateError> {
    let store = |source| CreateError::Store { path: path.display().to_string(), source };
    let io = |source| CreateError::Io { path: path.display().to_string(), source };
    // Before SQLite begins a log: the salts of that one are not known yet.
    if let Some((mut page, known)) = AcknowledgementPage::find(lock.clone()).map_err(io)? {
        page.write(&Acknowledgement { salts: [0, 0], ..known }).map_err(io)?;
        page.sync().map_err(io)?;
    }
    let mut db = Connection::open(path).map_err(store)?;
    tune(&db).map_err(store)?;
    upgrade(&mut db).map_err(store)?;
    start_thread(db, lock, path, health)
}

/// Write-ahead log, every group synced by [`Syncer`]: a kill costs what was not committed, a power
/// cut the last group at most.
fn tune(db: &Connection) -> rusqlite::Result<()> {
    db.busy_timeout(Duration::from_secs(2))?;
    db.pragma_update(None, "journal_mode", "wal")?;
    db.pragma_update(None, "wal_autocheckpoint", 0)?;
    // Until the syncer thread takes over the syncs: see `start_thread`.
    db.pragma_update(None, "synchronous", "full")
}

fn start_thread(
    db: Connection,
    lock: Arc<File>,
    path: &Path,
    health: Health,
) -> Result<(SessionWriter, WriterThread), CreateError> {
    let (full, inbox) = cc::bounded(BUFFERS);
    let (recycle, empty) = cc::bounded(BUFFERS);
    for _ in 0..BUFFERS {
        let _ = recycle.try_send(Vec::with_capacity(BUFFER_BYTES));
    }
    health.lost.store(0, Relaxed);
    health.written.store(0, Relaxed);
    let sql = |source| CreateError::Store { path: path.display().to_string(), source };
    let io = |source| CreateError::Io { path: path.display().to_string(), source };
    let (end, tail) = begin_log(&db, path).map_err(sql)?;
    let (committed, taken_over) =
        tail.as_ref().map(|t| (t.committed.clone(), t.taken_over.clone())).unwrap_or_default();
    committed.store(end.tick, Relaxed);
    let tail_name = tail.as_ref().map(|t| t.name().clone());
    let found = AcknowledgementPage::find(lock.clone()).map_err(io)?;
    let Some((mut page, _)) = found else {
        return Err(io(std::io::Error::other("the acknowledgement cannot be read")));
    };
    let first = end.known([0, 0]);
    page.write(&first).map_err(io)?;
    let session_path = SessionPath::from(path);
    let syncer =
        Syncer::start(session_path.clone(), health.written.clone(), taken_over, page, first)
            .map_err(io)?;
    // From here on the syncer does it.
    let store = |source| CreateError::Store { path: path.display().to_string(), source };
    commit_without_waiting(&db).map_err(store)?;
    let safe = health.safe.clone();
    safe.store(end.tick, SeqCst);
    health.handed.store(end.tick, SeqCst);
    // Two threads: the first only copies, and never waits for a disk.
    let (onward, groups) = cc::unbounded();
    std::thread::Builder::new()
        .name("sculptd-tail".into())
        .spawn(move || copy_on(tail, &safe, &inbox, &onward))
        .map_err(|source| CreateError::Io { path: path.display().to_string(), source })?;
    let place = Arc::new(Mutex::new(SessionPlace::new(session_path.clone(), lock.clone())));
    let mut writing = JournalThread {
        db,
        place: place.clone(),
        misplaced: None,
        looked_us: 0,
        tail: tail_name,
        committed,
        end,
        syncer: Some(syncer),
        _lock: lock,
        recycle,
        health: health.clone(),
        groups: Vec::new(),
        closed: false,
        unsynced: false,
        clock: Clock::monotonic(),
    };
    let thread = std::thread::Builder::new()
        .name("sculptd-journal".into())
        .spawn(move || writing.run(&groups))
        .map_err(|source| CreateError::Io { path: path.display().to_string(), source })?;
    let (lost, handed) = (health.lost.clone(), health.handed.clone());
    let writer = SessionWriter {
        full,
        empty,
        lost,
        handed,
        carry: Vec::new(),
        carry_ticks: (0, 0),
        history: None,
        owed: false,
    };
    Ok((writer, WriterThread { thread, health, history: None, path: session_path, place }))
}

impl Journal for SessionWriter {
    fn tick(&mut self, tick: u64, samples: &[Sample], commands: &[Command], world: &mut World) {
        self.log(tick, samples, commands);
        if let Some(history) = &self.history {
            self.owed |= history.tick(tick, world);
            if self.owed && history.checkpoint(world) {
                self.owed = false;
            }
        }
    }

    fn has_waiting(&self) -> bool {
        !self.carry.is_empty()
    }
}

impl SessionWriter {
    fn log(&mut self, tick: u64, samples: &[Sample], commands: &[Command]) {
        if samples.is_empty() && commands.is_empty() && self.carry.is_empty() {
            return;
        }
        if self.lost.load(Relaxed) > 0 {
            self.lost.fetch_add(1, Relaxed);
            return;
        }
        self.handed.store(tick, SeqCst);
        let free = self.empty.try_recv().ok();
        if let Some(mut buffer) = free {
            buffer.clear();
            let mut first = tick;
            if !self.carry.is_empty() {
                std::mem::swap(&mut buffer, &mut self.carry);
                first = self.carry_ticks.0;
            }
            if !(samples.is_empty() && commands.is_empty()) {
                append(&mut buffer, tick, samples, commands);
            }
            // As many buffers as places: one in hand is a place free.
            let _ = self.full.try_send(InputMessage::Ticks(first, tick, buffer));
            return;
        }
        if samples.is_empty() && commands.is_empty() {
            return;
        }
        if self.carry.is_empty() {
            self.carry_ticks.0 = tick;
        }
        self.carry_ticks.1 = tick;
        if self.carry.len() > KEPT_BYTES {
            self.carry = Vec::new();
            self.lost.fetch_add(1 + tick.saturating_sub(self.carry_ticks.0), Relaxed);
            return;
        }
        append(&mut self.carry, tick, samples, commands);
    }
}

impl Drop for SessionWriter {
    /// Hands over what still waits; now there is time.
    fn drop(&mut self) {
        if !self.carry.is_empty() {
            let carry = std::mem::take(&mut self.carry);
            let _ =
                self.full.send(InputMessage::Ticks(self.carry_ticks.0, self.carry_ticks.1, carry));
        }
    }
}

struct InputGroup {
    first: u64,
    last: u64,
    data: Vec<u8>,
}

/// Copies what comes into the tail and hands it on to whoever writes it.
fn copy_on(
    mut tail: Option<SharedMemoryLog>,
    safe: &AtomicU64,
    inbox: &cc::Receiver<InputMessage>,
    onward: &cc::Sender<InputMessage>,
) {
    raise_priority_below();
    for message in inbox {
        let InputMessage::Ticks(first, last, data) = &message;
        if tail.as_mut().is_some_and(|tail| tail.put(*first, *last, data)) {
            safe.fetch_max(*last, SeqCst);
        }
        if onward.send(message).is_err() {
            return;
        }
    }
}

struct JournalThread {
    db: Connection,
    place: Arc<Mutex<SessionPlace>>,
    /// Message about a file that no name leads to any more.
    misplaced: Option<String>,
    looked_us: u64,
    /// The shared-memory log's name, to remove it once the file has everything.
    tail: Option<LogName>,
    /// The last tick in the file: the tail may discard earlier input.
    committed: Arc<AtomicU64>,
    /// End of the file's input.
    end: InputEnd,
    /// Taken at the end.
    syncer: Option<Syncer>,
    /// Dropped after `db`: closing another handle of the file first would release SQLite's locks.
    _lock: Arc<File>,
    recycle: cc::Sender<Vec<u8>>,
    health: Health,
    /// Closed groups that are not on the disk yet, oldest first.
    groups: Vec<InputGroup>,
    /// Input was given up: what comes after it would make a log with a hole.
    closed: bool,
    /// The reported fault is that of the syncer.
    unsynced: bool,
    clock: Clock,
}

impl JournalThread {
    fn run(&mut self, inbox: &cc::Receiver<InputMessage>) {
        raise_priority_below();
        let mut open: Option<InputGroup> = None;
        let mut due_us = u64::MAX;
        loop {
            let now = self.clock.now_us();
            let patience = if open.is_some() {
                Duration::from_micros(due_us.saturating_sub(now))
            } else if self.groups.is_empty() {
                IDLE
            } else {
                LOOK
            };
            let message = inbox.recv_timeout(patience);
            self.health.turns.fetch_add(1, Relaxed);
            self.watch_place();
            let ended = matches!(message, Err(cc::RecvTimeoutError::Disconnected));
            if let Ok(InputMessage::Ticks(first, last, bytes)) = message {
                if self.closed {
                    self.health.lost.fetch_add(1 + last - first, Relaxed);
                } else {
                    let group = open.get_or_insert_with(|| {
                        due_us = self.clock.now_us() + GROUP_MS * 1000;
                        InputGroup { first, last, data: Vec::new() }
                    });
                    group.data.extend_from_slice(&bytes);
                    group.last = last;
                }
                let _ = self.recycle.try_send(bytes);
            }
            // A sync that failed, or works again, is reported without further input too.
            let mut synced = self.is_synced();
            if !synced && !self.unsynced {
                // A file that was moved is followed first.
                self.looked_us = 0;
                self.watch_place();
                synced = self.is_synced();
            }
            let waits = !self.groups.is_empty() || synced == self.unsynced;
            if ended || self.clock.now_us() >= due_us || (open.is_none() && waits) {
                self.groups.extend(open.take());
                due_us = u64::MAX;
                self.flush();
            }
            if ended {
                self.end();
                return;
            }
        }
    }

    fn is_synced(&self) -> bool {
        self.syncer.as_ref().is_none_or(|syncer| syncer.trouble().is_none())
    }

    /// The last group is synced too before the thread is gone.
    fn end(&mut self) {
        // Closing takes the rest of the log over, and syncs as it should.
        let _ = self.db.pragma_update(None, "synchronous", "full");
        let why = self.syncer.take().and_then(Syncer::finish);
        let all_written = self.groups.is_empty() && !self.closed;
        if let (Some(name), true) = (&self.tail, all_written) {
            shared_memory_log::remove(name);
        }
        if let Ok(mut fault) = self.health.fault.lock() {
            match why {
                Some(why) => {
                    fault.get_or_insert(format!("the session file was not synced: {why}"));
                }
                // The cause of the failed sync is over: the last sync succeeded.
                None if all_written => *fault = None,
                None => {}
            }
        }
        self.rescue_again();
    }

    fn flush(&mut self) {
        let kept: usize = self.groups.iter().map(|g| g.data.len()).sum();
        let result = self.write();
        let text = match result {
            Ok(last) => {
                self.groups.clear();
                if let Some(last) = last {
                    self.committed.fetch_max(last, Relaxed);
                    self.health.safe.fetch_max(last, SeqCst);
                    if let Some(syncer) = &self.syncer {
                        syncer.committed(last, self.end.chain);
                    }
                }
                let unsynced = self.syncer.as_ref().and_then(Syncer::trouble);
                self.unsynced = unsynced.is_some();
                let unsynced = unsynced.map(|e| format!("the session file cannot be synced: {e}"));
                self.misplaced.clone().or(unsynced)
            }
            Err(e) if kept > KEPT_BYTES => {
                // Waiting input is written once there is room. Later input is discarded, because a
                // log with a gap cannot be replayed.
                self.closed = true;
                Some(format!(
                    "the session file takes nothing and {kept} bytes wait: input is being lost \
                        ({e})"
                ))
            }
            Err(e) => Some(format!("the session file takes nothing, input is kept in memory: {e}")),
        };
        let written = self.health.written.load(Relaxed);
        let text = text.or_else(|| {
            self.closed.then(|| {
                format!(
                    "the session file ends at tick {written}: the disk was full too long; begin \
                    another session"
                )
            })
        });
        let text = text.or_else(|| self.misplaced.clone());
        let Ok(mut fault) = self.health.fault.lock() else { return };
        // Once when it begins and once when it is over, however often it is tried between.
        match (fault.is_some(), &text) {
            (false, Some(text)) => tracing::error!("journal: {text}"),
            (true, None) => {
                tracing::info!("journal: the session file is written again, up to tick {written}")
            }
            _ => {}
        }
        *fault = text;
    }

    fn write(&mut self) -> rusqlite::Result<Option<u64>> {
        let all = self.db.transaction()?;
        let mut end = self.end;
        for g in &self.groups {
            end.put(&all, g.first, g.last, &g.data)?;
        }
        all.commit()?;
        self.end = end;
        Ok(self.groups.last().map(|g| g.last))
    }
}

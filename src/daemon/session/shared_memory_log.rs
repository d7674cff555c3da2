//! The newest input in memory that outlives the process: input not yet on the disk when it is
//! killed.
//!
//! A write to a file may wait for the disk: a file system that syncs its journal delays every
//! process for tenths of a second on a loaded machine. So every tick's input is first written to a
//! file in memory (`/dev/shm`), which copies it and never waits. That input is discarded once the
//! session's main file contains it, so that a damaged write-ahead log costs nothing after a kill.
//! Opening the session reads both. A power cut loses the memory; then only the session file
//! remains.
//!
//! **Name**: `sculptd-CREATION-DEVICE-INODE-PID.START.SERIAL-PART`, in hexadecimal: the session's
//! creation number, the identity of its file, and the life of the process that writes it. A copy
//! of a session has another inode, so opening it never takes the original's log.
//!
//! **Bytes**, little-endian: `MAGIC`, the length of the session's path (4) and the path; then
//! entries: first tick, last tick, the last tick before (8 each), the chain before (4, see
//! [`super::format`]), bytes (4), CRC-32 of the creation number, all these and the bytes (4), the
//! bytes. The chain decides whether an entry continues the file's input.
//!
//! Without such a folder, input waits for the session file alone.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

use super::format::chain;

/// Folder of files in memory.
const PLACE: &str = "/dev/shm";
const MAGIC: [u8; 8] = *b"sculptd4";
/// A full part of this size is kept while the other one is written, once that is free.
const PART_BYTES: u64 = 256 << 10;
/// Above this size a part is discarded once the write-ahead log contains it, even if the main file
/// does not.
const PLENTY: u64 = 8 << 20;
/// The disk takes nothing: so much is kept at most.
const MOST: u64 = 64 << 20;
const HEAD: usize = 3 * 8 + 3 * 4;
/// A log whose session is not where it was is kept this long.
const KEPT: Duration = Duration::from_secs(24 * 3600);

/// Identity of a session file, independent of its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileIdentity {
    /// Given once, when the session is created; copies share it.
    pub creation: u64,
    pub device: u64,
    pub inode: u64,
}

impl FileIdentity {
    /// Returns the identity of the file of a session with this creation number.
    ///
    /// # Errors
    /// Returns an error if the file's metadata cannot be read.
    pub fn of(path: &Path, creation: u64) -> std::io::Result<FileIdentity> {
        let about = std::fs::metadata(path)?;
        #[cfg(unix)]
        let (device, inode) = {
            use std::os::unix::fs::MetadataExt;
            (about.dev(), about.ino())
        };
        #[cfg(not(unix))]
        let (device, inode) = {
            drop(about);
            (0, u64::from(crc32fast::hash(path.as_os_str().as_encoded_bytes())))
        };
        Ok(FileIdentity { creation, device, inode })
    }
}

/// A number that no other session has.
pub fn new_creation_number() -> u64 {
    use std::hash::{BuildHasher, Hasher};
    let mut seed = std::hash::RandomState::new().build_hasher();
    seed.write_u32(std::process::id());
    seed.finish()
}

/// The name of a session's log in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogName {
    pub file: FileIdentity,
    pid: u32,
    /// Start time of the process, as counted by the system; 0 if unknown.
    start: u64,
    serial: u64,
}

/// Returns the start time of a process; `None` if no process has this number.
fn start_of(pid: u32) -> Option<u64> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The program's name is in brackets and may contain any character.
    let rest = text.rsplit_once(')')?.1;
    rest.split_ascii_whitespace().nth(19)?.parse().ok()
}

impl LogName {
    fn new(file: FileIdentity) -> LogName {
        static SERIAL: AtomicU64 = AtomicU64::new(0);
        let pid = std::process::id();
        let start = start_of(pid).unwrap_or(0);
        LogName { file, pid, start, serial: SERIAL.fetch_add(1, Relaxed) }
    }

    fn path(&self, part: usize) -> PathBuf {
        let (f, pid, start, serial) = (&self.file, self.pid, self.start, self.serial);
        let (creation, device, inode) = (f.creation, f.device, f.inode);
        Path::new(PLACE).join(format!(
            "sculptd-{creation:016x}-{device:x}-{inode:x}-{pid:x}.{start:x}.{serial:x}-{part}"
        ))
    }

    fn parse(name: &str) -> Option<LogName> {
        let mut parts = name.strip_prefix("sculptd-")?.split('-');
        let mut hex = || u64::from_str_radix(parts.next()?, 16).ok();
        let file = FileIdentity { creation: hex()?, device: hex()?, inode: hex()? };
        let mut life = parts.next()?.split('.').map(|n| u64::from_str_radix(n, 16).ok());
        let mut next = || life.next().flatten();
        let (pid, start, serial) = (u32::try_from(next()?).ok()?, next()?, next()?);
        parts.next().map(|_| LogName { file, pid, start, serial })
    }

    /// Returns true if the process that writes it still runs.
    pub fn owner_lives(&self) -> bool {
        start_of(self.pid).is_some_and(|start| start == self.start)
    }

    /// Returns true if this process wrote it.
    pub fn is_own(&self) -> bool {
        self.pid == std::process::id() && self.owner_lives()
    }
}

/// All logs in memory for which `wanted` holds.
fn find(wanted: impl Fn(&LogName) -> bool) -> Vec<LogName> {
    let Ok(folder) = std::fs::read_dir(PLACE) else { return Vec::new() };
    let mut all: Vec<LogName> = Vec::new();
    for name in folder.flatten().filter_map(|e| LogName::parse(&e.file_name().to_string_lossy())) {
        if wanted(&name) && !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

/// The logs of one file.
pub fn logs_of(file: &FileIdentity) -> Vec<LogName> {
    find(|n| n.file == *file)
}

/// The logs of a session and of all copies of it.
pub fn logs_of_session(creation: u64) -> Vec<LogName> {
    find(|n| n.file.creation == creation)
}

/// Removes logs whose process ended and whose session file is gone or was replaced: nobody will
/// ask for them. Of what was only moved they are kept for a day.
pub fn prune() {
    for name in find(|n| !n.owner_lives()) {
        let part = name.path(0);
        let session = File::open(&part).ok().and_then(|f| session_path(&mut f.take(1 << 16)));
        let there = session
            .and_then(|s| FileIdentity::of(&s, name.file.creation).ok())
            .is_some_and(|now| now == name.file);
        let age = std::fs::metadata(&part).and_then(|m| m.modified()).ok();
        let old = age.and_then(|t| t.elapsed().ok()).is_some_and(|age| age > KEPT);
        if !there && old {
            remove(&name);
        }
    }
}

fn session_path(from: &mut dyn Read) -> Option<PathBuf> {
    let mut head = [0; MAGIC.len() + 4];
    from.read_exact(&mut head).ok()?;
    let length = u32_at(&head, MAGIC.len()) as usize;
    if head[..MAGIC.len()] != MAGIC || length > 1 << 15 {
        return None;
    }
    let mut bytes = vec![0; length];
    from.read_exact(&mut bytes).ok()?;
    String::from_utf8(bytes).ok().map(PathBuf::from)
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    bytes[at..at + 8].iter().rev().fold(0, |n, x| n << 8 | u64::from(*x))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    bytes[at..at + 4].iter().rev().fold(0, |n, x| n << 8 | u32::from(*x))
}

/// One entry as it is read back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogEntry {
    pub first: u64,
    pub last: u64,
    /// The last tick that was handed over before it.
    pub after: u64,
    /// The chain before its bytes.
    pub chain: u32,
    pub data: Vec<u8>,
}

#[derive(Debug)]
struct LogPart {
    file: File,
    bytes: u64,
    last: u64,
}

/// The writing end: two files, taken in turns.
#[derive(Debug)]
pub struct SharedMemoryLog {
    name: LogName,
    head: Vec<u8>,
    parts: [LogPart; 2],
    now: usize,
    after: u64,
    chain: u32,
    /// The last tick that the write-ahead log has.
    pub committed: Arc<AtomicU64>,
    /// The last tick that the main file has.
    pub taken_over: Arc<AtomicU64>,
}

fn sum(creation: u64, head: &[u8], data: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(&creation.to_le_bytes());
    crc.update(head);
    crc.update(data);
    crc.finalize()
}

impl SharedMemoryLog {
    /// `after`: the last tick of the session so far, and the chain there. `None` if there is no
    /// folder in memory.
    pub fn create(file: FileIdentity, session: &Path, after: (u64, u32)) -> Option<Self> {
        let name = LogName::new(file);
        let whole = std::path::absolute(session).unwrap_or_else(|_| session.into());
        let text = whole.to_string_lossy();
        let mut head = MAGIC.to_vec();
        head.extend_from_slice(&u32::try_from(text.len()).ok()?.to_le_bytes());
        head.extend_from_slice(text.as_bytes());
        let part = |n: usize| {
            let mut options = OpenOptions::new();
            options.write(true).create_new(true);
            #[cfg(unix)]
            std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
            let mut file = options.open(name.path(n)).ok()?;
            file.write_all(&head).ok()?;
            Some(LogPart { file, bytes: 0, last: 0 })
        };
        let made = part(0).zip(part(1));
        if made.is_none() {
            remove(&name);
        }
        let (a, b) = made?;
        let (after, chain) = after;
        let (committed, taken_over) = (Arc::default(), Arc::default());
        Some(SharedMemoryLog {
            name,
            head,
            parts: [a, b],
            now: 0,
            after,
            chain,
            committed,
            taken_over,
        })
    }

    /// Returns true if a part may be overwritten.
    fn may_go(&self, part: usize) -> bool {
        let part = &self.parts[part];
        part.last <= self.taken_over.load(Relaxed)
            || part.bytes > PLENTY && part.last <= self.committed.load(Relaxed)
    }

    /// Appends the input of some ticks. Returns false for input that does not fit: it goes to the
    /// session file alone.
    pub fn put(&mut self, first: u64, last: u64, data: &[u8]) -> bool {
        let other = 1 - self.now;
        if self.parts[self.now].bytes > PART_BYTES && self.may_go(other) {
            self.now = other;
            let part = &mut self.parts[other];
            part.bytes = 0;
            if part.file.set_len(0).is_err()
                || part.file.seek(SeekFrom::Start(0)).is_err()
                || part.file.write_all(&self.head).is_err()
            {
                return false;
            }
        }
        let after = std::mem::replace(&mut self.after, last);
        let before = self.chain;
        self.chain = chain(before, data);
        let part = &mut self.parts[self.now];
        let Ok(length) = u32::try_from(data.len()) else { return false };
        if part.bytes + u64::from(length) > MOST {
            return false;
        }
        let mut entry = Vec::with_capacity(HEAD + data.len());
        entry.extend_from_slice(&first.to_le_bytes());
        entry.extend_from_slice(&last.to_le_bytes());
        entry.extend_from_slice(&after.to_le_bytes());
        entry.extend_from_slice(&before.to_le_bytes());
        entry.extend_from_slice(&length.to_le_bytes());
        let crc = sum(self.name.file.creation, &entry, data);
        entry.extend_from_slice(&crc.to_le_bytes());
        entry.extend_from_slice(data);
        // In one call: a kill finds all of it or nothing.
        let is_written = part.file.write_all(&entry).is_ok();
        if is_written {
            part.bytes += entry.len() as u64;
            part.last = last;
        }
        is_written
    }

    pub fn name(&self) -> &LogName {
        &self.name
    }
}

/// Every whole entry, by tick.
pub fn read(name: &LogName) -> Vec<LogEntry> {
    let mut all = Vec::new();
    for part in 0..2 {
        let Ok(file) = File::open(name.path(part)) else { continue };
        let (mut file, mut bytes) = (file.take(2 * MOST), Vec::new());
        if session_path(&mut file).is_some() && file.read_to_end(&mut bytes).is_ok() {
            entries(name.file.creation, &bytes, &mut all);
        }
    }
    all.sort_by_key(|e| e.last);
    all
}

fn entries(creation: u64, mut bytes: &[u8], all: &mut Vec<LogEntry>) {
    while bytes.len() >= HEAD {
        let (head, rest) = bytes.split_at(HEAD);
        let length = u32_at(head, 28) as usize;
        let Some(data) = rest.get(..length) else { return };
        if sum(creation, &head[..32], data) != u32_at(head, 32) {
            return;
        }
        let (first, last, after) = (u64_at(head, 0), u64_at(head, 8), u64_at(head, 16));
        let chain = u32_at(head, 24);
        all.push(LogEntry { first, last, after, chain, data: data.to_vec() });
        bytes = &rest[length..];
    }
}

/// The entries that follow, one after the other, on input that ends with this tick and chain.
pub fn following(end: (u64, u32), log: &[LogEntry]) -> Vec<&LogEntry> {
    let (mut tick, mut now) = end;
    let mut found = Vec::new();
    for entry in log.iter().filter(|e| e.last > end.0) {
        if entry.after != tick || entry.chain != now {
            break;
        }
        (tick, now) = (entry.last, chain(now, &entry.data));
        found.push(entry);
    }
    found
}

/// Lets it go.
pub fn remove(name: &LogName) {
    for part in 0..2 {
        let _ = std::fs::remove_file(name.path(part));
    }
}

#[cfg(test)]
mod tests {
    use super::super::format::{append, chain_start};
    use super::*;

    #[test]
    fn what_was_put_is_read_back_in_order_and_a_hole_ends_it() {
        let creation = new_creation_number();
        let file = FileIdentity { creation, device: 1, inode: 2 };
        let start = chain_start(creation);
        let Some(mut log) = SharedMemoryLog::create(file, Path::new("/nowhere"), (5, start)) else {
            return;
        };
        assert_eq!(
            LogName::parse(&log.name.path(0).file_name().expect("a name").to_string_lossy()),
            Some(log.name.clone())
        );
        assert!(log.name.is_own());
        let mut chains = vec![start; 6];
        for tick in 6..20_000 {
            let mut data = Vec::new();
            append(&mut data, tick, &[], &[sculptd_engine::command::Command::Undo]);
            log.put(tick, tick, &data);
            chains.push(chain(chains[tick as usize - 1], &data));
            // The session file is always a hundred ticks behind.
            log.taken_over.store(tick.saturating_sub(100), Relaxed);
        }
        let all = read(&log.name);
        assert!(all.len() >= 100 && all.windows(2).all(|w| w[0].last < w[1].last));
        let last = |found: Vec<&LogEntry>| found.last().map(|e| e.last);
        assert_eq!(following((19_950, chains[19_950]), &all).len(), 49);
        assert_eq!(last(following((19_950, chains[19_950]), &all)), Some(19_999));
        // Other input up to the same tick: nothing follows on it.
        assert_eq!(last(following((19_950, chains[19_950] ^ 1), &all)), None);
        // Older than what was let go: nothing follows on it either.
        assert_eq!(last(following((5, start), &all)), None);
        let bytes = std::fs::metadata(log.name.path(0)).expect("there").len();
        assert!(bytes < 4 * PART_BYTES, "{bytes} bytes are kept");
        assert_eq!(logs_of(&file), vec![log.name.clone()]);
        assert_eq!(logs_of(&FileIdentity { inode: 3, ..file }), vec![], "a copy has none");
        // Its owner lives: it stays.
        prune();
        assert!(!read(&log.name).is_empty());
        remove(&log.name);
        assert!(read(&log.name).is_empty());
    }
}

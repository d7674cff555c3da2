//! The newest input in memory that outlives the process: what a kill finds on its way to the disk.
//!
//! A write to a file may wait for the disk, however little it waits for: a file system that brings
//! its own journal to the disk holds up everybody for tenths of a second on a loaded machine. So
//! every tick's input is first put into a file that lies in memory (`/dev/shm`), which is a copy
//! and never a wait, and is let go once the session file has it. Whoever opens the session reads
//! both. A power cut loses the tail; the session file alone is then what there is.
//!
//! Where there is no such place, input waits for the session file alone.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rusqlite::{Connection, OpenFlags};

use super::format::{META_TAIL, TickInput, ticks};

/// Where files lie in memory.
const PLACE: &str = "/dev/shm";
/// A part of this size is left for the other one, once that is let go.
const PART: u64 = 256 << 10;
/// The disk takes nothing: so much is kept at most.
const MOST: u64 = 64 << 20;
/// First tick, last tick, the last tick of the entry before, bytes, checksum of all these and the
/// bytes.
const HEAD: usize = 3 * 8 + 4 + 4;

/// One entry as it is read back.
#[derive(Debug, Clone)]
pub struct Entry {
    pub last: u64,
    /// The last tick that was handed over before it.
    pub after: u64,
    pub data: Vec<u8>,
}

#[derive(Debug)]
struct Part {
    file: File,
    bytes: u64,
    last: u64,
}

/// The writing end: two files, taken in turns.
#[derive(Debug)]
pub struct SharedMemoryLog {
    name: u64,
    parts: [Part; 2],
    now: usize,
    after: u64,
    /// The last tick that the session file has.
    pub committed: Arc<AtomicU64>,
}

fn path(name: u64, part: usize) -> PathBuf {
    Path::new(PLACE).join(format!("sculptd-{name:016x}-{part}"))
}

/// A name that no other session has.
pub fn new_name() -> u64 {
    use std::hash::{BuildHasher, Hasher};
    let mut seed = std::hash::RandomState::new().build_hasher();
    seed.write_u32(std::process::id());
    seed.finish()
}

fn sum(head: &[u8], data: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(head);
    crc.update(data);
    crc.finalize()
}

impl SharedMemoryLog {
    /// `after`: the last tick of the session so far. `None` where nothing can lie in memory.
    pub fn create(name: u64, after: u64) -> Option<SharedMemoryLog> {
        let part = |n: usize| {
            let mut options = OpenOptions::new();
            options.write(true).create_new(true);
            #[cfg(unix)]
            std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
            Some(Part { file: options.open(path(name, n)).ok()?, bytes: 0, last: 0 })
        };
        let made = part(0).zip(part(1));
        if made.is_none() {
            remove(name);
        }
        let (a, b) = made?;
        Some(SharedMemoryLog { name, parts: [a, b], now: 0, after, committed: Arc::default() })
    }

    /// Puts the input of some ticks. What does not fit is for the session file alone.
    pub fn put(&mut self, first: u64, last: u64, data: &[u8]) {
        let committed = self.committed.load(Relaxed);
        let other = 1 - self.now;
        if self.parts[self.now].bytes > PART && self.parts[other].last <= committed {
            self.now = other;
            self.parts[other].bytes = 0;
            if self.parts[other].file.set_len(0).is_err()
                || self.parts[other].file.seek(SeekFrom::Start(0)).is_err()
            {
                return;
            }
        }
        let after = std::mem::replace(&mut self.after, last);
        let part = &mut self.parts[self.now];
        let Ok(length) = u32::try_from(data.len()) else { return };
        if part.bytes + u64::from(length) > MOST {
            return;
        }
        let mut entry = Vec::with_capacity(HEAD + data.len());
        entry.extend_from_slice(&first.to_le_bytes());
        entry.extend_from_slice(&last.to_le_bytes());
        entry.extend_from_slice(&after.to_le_bytes());
        entry.extend_from_slice(&length.to_le_bytes());
        let crc = sum(&entry, data);
        entry.extend_from_slice(&crc.to_le_bytes());
        entry.extend_from_slice(data);
        // In one call: a kill finds all of it or nothing.
        if part.file.write_all(&entry).is_ok() {
            part.bytes += entry.len() as u64;
            part.last = last;
        }
    }

    pub fn name(&self) -> u64 {
        self.name
    }
}

/// Every whole entry, by tick.
pub fn read(name: u64) -> Vec<Entry> {
    let mut all = Vec::new();
    for part in 0..2 {
        let mut bytes = Vec::new();
        let file = File::open(path(name, part));
        if file.is_ok_and(|f| f.take(2 * MOST).read_to_end(&mut bytes).is_ok()) {
            entries(&bytes, &mut all);
        }
    }
    all.sort_by_key(|e| e.last);
    all
}

fn entries(mut bytes: &[u8], all: &mut Vec<Entry>) {
    let u64_at =
        |b: &[u8], at: usize| b[at..at + 8].iter().rev().fold(0u64, |n, x| n << 8 | u64::from(*x));
    let u32_at =
        |b: &[u8], at: usize| b[at..at + 4].iter().rev().fold(0u32, |n, x| n << 8 | u32::from(*x));
    while bytes.len() >= HEAD {
        let (head, rest) = bytes.split_at(HEAD);
        let length = u32_at(head, 24) as usize;
        let Some(data) = rest.get(..length) else { return };
        if sum(&head[..28], data) != u32_at(head, 28) {
            return;
        }
        all.push(Entry { last: u64_at(head, 8), after: u64_at(head, 16), data: data.to_vec() });
        bytes = &rest[length..];
    }
}

/// Adds what follows on the last tick of `input`; an entry that would leave a hole ends it.
pub fn lengthen(input: &mut Vec<TickInput>, tail: &[Entry]) -> u64 {
    let mut added = 0;
    for entry in tail {
        let now = input.last().map_or(0, |t| t.tick);
        if entry.last <= now {
            continue;
        }
        // Ticks without input are in no row: what matters is what had been handed over before.
        if entry.after > now {
            break;
        }
        for tick in ticks(&entry.data) {
            let Ok(tick) = tick else { return added };
            if tick.tick > input.last().map_or(0, |t| t.tick) {
                input.push(tick);
                added += 1;
            }
        }
    }
    added
}

/// The name of a session's tail, if it was left one.
pub fn of(session: &Path) -> Option<u64> {
    let db = Connection::open_with_flags(session, OpenFlags::SQLITE_OPEN_READ_ONLY).ok()?;
    let value: Vec<u8> =
        db.query_row("SELECT value FROM meta WHERE key = ?1", [META_TAIL], |r| r.get(0)).ok()?;
    value.try_into().ok().map(u64::from_le_bytes)
}

/// Lets it go.
pub fn remove(name: u64) {
    for part in 0..2 {
        let _ = std::fs::remove_file(path(name, part));
    }
}

#[cfg(test)]
mod tests {
    use super::super::format::append;
    use super::*;

    #[test]
    fn what_was_put_is_read_back_in_order_and_a_hole_ends_it() {
        let name = new_name();
        let Some(mut tail) = SharedMemoryLog::create(name, 5) else { return };
        let put = |tail: &mut SharedMemoryLog, tick: u64| {
            let mut data = Vec::new();
            append(&mut data, tick, &[], &[sculptd_engine::command::Command::Undo]);
            tail.put(tick, tick, &data);
        };
        for tick in 6..20_000 {
            put(&mut tail, tick);
            // The session file is always a hundred ticks behind.
            tail.committed.store(tick.saturating_sub(100), Relaxed);
        }
        let all = read(name);
        assert!(all.len() >= 100 && all.windows(2).all(|w| w[0].last < w[1].last));
        let had = |tick| vec![TickInput { tick, samples: vec![], commands: vec![] }];
        let mut input = had(19_950);
        assert_eq!(lengthen(&mut input, &all), 49);
        assert_eq!(input.last().expect("some").tick, 19_999);
        // Older than what was let go: nothing follows on it.
        let mut input = had(3);
        assert_eq!(lengthen(&mut input, &all), 0);
        let bytes = std::fs::metadata(path(name, 0)).expect("there").len();
        assert!(bytes < 4 * PART, "{bytes} bytes are kept");
        remove(tail.name());
        assert!(read(name).is_empty());
    }
}

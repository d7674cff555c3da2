//! The last tick that is known to be on the disk, written into the session file beside SQLite.
//!
//! The write-ahead log is a second file: where it is lost, damaged, or another session's, SQLite
//! shows the database as it was at the last checkpoint and says nothing. So the acknowledgement is
//! written directly into the main file, into a page that belongs to the one row of the table
//! `acknowledged`. SQLite writes this page once, when the session is created, and never again, so
//! it is never in the write-ahead log. Opening compares the input that it finds with this tick.
//!
//! A second such page, of the table `acknowledged_again`, says the same. A file without it is from
//! before it was written. The newest readable slot of both counts.
//!
//! The row's blob: 16 bytes [`MAGIC`], then two slots of [`SLOT`] bytes that are written in turns,
//! so that a torn write leaves the other one. A slot, little-endian: `sequence` (8), creation
//! number (8), tick (8), the two salts of the write-ahead log (4, 4; both 0: any), chain (4), and
//! the CRC-32 of all these (4).

use std::fs::File;
use std::io::{Read, Result, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Arc;

use rusqlite::Connection;

/// Marks the blob.
pub const MAGIC: [u8; 16] = *b"sculptd:acknowl.";
/// Bytes of a slot.
pub const SLOT: usize = 40;
/// The salts of an acknowledgement that was written when the session ended in order.
pub const ENDED: [u32; 2] = [u32::MAX; 2];
/// Bytes that are read at once while the blob is looked for.
const WINDOW: usize = 256 << 10;

/// State known to be on the disk.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Acknowledgement {
    /// The session's creation number.
    pub identity: u64,
    pub tick: u64,
    /// The chain of the row that ends with this tick, see [`super::format`].
    pub chain: u32,
    /// Salts of the write-ahead log that contains the input; zeros: unknown. [`ENDED`]: the file
    /// itself contains all of the input.
    pub salts: [u32; 2],
}

/// The acknowledgement's positions in an open file.
#[derive(Debug)]
pub struct AcknowledgementPage {
    file: Arc<File>,
    /// Offsets of the blobs: one or two.
    at: Vec<u64>,
    sequence: u64,
}

/// Result of reading a file's acknowledgement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acknowledged {
    /// No acknowledgement: an older layout, or its page is lost.
    Missing,
    /// An acknowledgement exists but cannot be read.
    Damaged,
    Known(Acknowledgement),
}

fn number(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |n, b| n << 8 | u64::from(*b))
}

fn encode(sequence: u64, a: &Acknowledgement) -> [u8; SLOT] {
    let mut slot = [0; SLOT];
    slot[..8].copy_from_slice(&sequence.to_le_bytes());
    slot[8..16].copy_from_slice(&a.identity.to_le_bytes());
    slot[16..24].copy_from_slice(&a.tick.to_le_bytes());
    slot[24..28].copy_from_slice(&a.salts[0].to_le_bytes());
    slot[28..32].copy_from_slice(&a.salts[1].to_le_bytes());
    slot[32..36].copy_from_slice(&a.chain.to_le_bytes());
    let crc = crc32fast::hash(&slot[..36]);
    slot[36..].copy_from_slice(&crc.to_le_bytes());
    slot
}

fn decode(slot: &[u8]) -> Option<(u64, Acknowledgement)> {
    if number(&slot[36..SLOT]) != u64::from(crc32fast::hash(&slot[..36])) {
        return None;
    }
    let salts = [number(&slot[24..28]) as u32, number(&slot[28..32]) as u32];
    let (identity, tick) = (number(&slot[8..16]), number(&slot[16..24]));
    let chain = number(&slot[32..36]) as u32;
    Some((number(&slot[..8]), Acknowledgement { identity, tick, chain, salts }))
}

/// The blob of a new session.
pub fn blob(first: &Acknowledgement) -> Vec<u8> {
    [&MAGIC[..], &encode(1, first), &encode(0, first)].concat()
}

/// The newest readable slot of a blob.
fn newest_slot(blob: &[u8]) -> Option<(u64, Acknowledgement)> {
    let slots = blob.get(MAGIC.len()..MAGIC.len() + 2 * SLOT)?;
    slots.chunks_exact(SLOT).filter_map(decode).max_by_key(|s| s.0)
}

/// A slot's sequence number and what it says.
type Slot = (u64, Acknowledgement);

/// The blobs of one file.
#[derive(Debug, Default)]
struct Blobs {
    /// Offsets of the blobs with a readable slot.
    at: Vec<u64>,
    /// The newest of their slots.
    newest: Option<Slot>,
    /// True if any blob was found, readable or not.
    any: bool,
}

/// Both blobs lie near the beginning, but in a file that came from an older layout; there they lie
/// near each other.
fn find(file: &File) -> Result<Blobs> {
    let mut file = file;
    let (mut found, mut at) = (Blobs::default(), 0u64);
    let size = MAGIC.len() + 2 * SLOT;
    let mut window = vec![0; WINDOW + size];
    loop {
        file.seek(SeekFrom::Start(at))?;
        let mut have = 0;
        while have < window.len() {
            match file.read(&mut window[have..])? {
                0 => break,
                n => have += n,
            }
        }
        let ended = found.newest.is_some();
        let starts = window[..have].windows(MAGIC.len()).enumerate().filter(|w| *w.1 == MAGIC);
        for (offset, _) in starts.filter(|w| w.0 < WINDOW) {
            found.any = true;
            if let Some(slot) = newest_slot(&window[offset..have]) {
                found.at.push(at + offset as u64);
                found.newest = found.newest.max(Some(slot));
            }
        }
        // One window more: the second may begin there.
        if have < window.len() || ended || found.at.len() > 1 {
            return Ok(found);
        }
        at += WINDOW as u64;
    }
}

/// Reads the acknowledgement of a file.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn read(path: &Path) -> Result<Acknowledged> {
    let found = find(&File::open(path)?)?;
    Ok(match found.newest {
        Some((_, a)) => Acknowledged::Known(a),
        None if found.any => Acknowledged::Damaged,
        None => Acknowledged::Missing,
    })
}

impl AcknowledgementPage {
    /// Finds the pages in a file open for reading and writing, and their newest acknowledgement.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn find(file: Arc<File>) -> Result<Option<(AcknowledgementPage, Acknowledgement)>> {
        let found = find(&file)?;
        Ok(found
            .newest
            .map(|(sequence, a)| (AcknowledgementPage { file, at: found.at, sequence }, a)))
    }

    /// Writes the state now on the disk, without a sync: an older acknowledgement is true too.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn write(&mut self, a: &Acknowledgement) -> Result<()> {
        self.sequence += 1;
        let slot = u64::from(self.sequence % 2 == 0) * SLOT as u64;
        let mut file: &File = &self.file;
        for at in &self.at {
            file.seek(SeekFrom::Start(at + MAGIC.len() as u64 + slot))?;
            file.write_all(&encode(self.sequence, a))?;
        }
        Ok(())
    }

    /// Syncs it to the disk.
    ///
    /// # Errors
    /// Returns an error if the sync fails.
    pub fn sync(&self) -> Result<()> {
        self.file.sync_data()
    }
}

/// Inserts the rows that acknowledgements are written into, each in a separate page.
pub(super) fn acknowledge_first(
    db: &Connection,
    identity: u64,
    tick: u64,
    chain: u32,
) -> rusqlite::Result<()> {
    let blob = blob(&Acknowledgement { identity, tick, chain, salts: [0, 0] });
    for table in ["acknowledged", "acknowledged_again"] {
        let put = format!("INSERT OR REPLACE INTO {table} (id, data) VALUES (1, ?1)");
        db.execute(&put, [&blob])?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_whole_slot_counts() {
        let first = Acknowledgement { identity: 7, ..Default::default() };
        let mut file = tempfile::tempfile().expect("a file");
        file.write_all(&[9; 5000]).expect("written");
        file.write_all(&blob(&first)).expect("written");
        file.write_all(&[9; 9000]).expect("written");
        file.write_all(&blob(&first)).expect("written");
        let file = Arc::new(file);
        let (mut page, a) = AcknowledgementPage::find(file.clone()).expect("read").expect("there");
        assert_eq!(a, first);
        let newest = |file: &File| find(file).expect("read").newest.expect("a slot").1;
        for tick in 1..6 {
            let a = Acknowledgement { tick, chain: 3, salts: [1, 2], ..first };
            page.write(&a).expect("written");
            assert_eq!(newest(&file), a);
        }
        let mut f: &File = &file;
        let mut spoil = |at: u64, bytes: &[u8]| {
            f.seek(SeekFrom::Start(at)).expect("sought");
            f.write_all(bytes).expect("written");
        };
        // The newest slot of one page is torn, and then the page is lost: the other says the same.
        spoil(5000 + 16 + 20, &[0xAA; 4]);
        assert_eq!(newest(&file).tick, 5);
        spoil(4096, &[0; 4096]);
        assert_eq!(newest(&file).tick, 5);
        // The newest slot of that is torn too: the one before it counts.
        let second = 5000 + 16 + 2 * SLOT as u64 + 9000 + 16;
        spoil(second + 20, &[0xAA; 4]);
        let left = newest(&file).tick;
        assert!(left == 4 || left == 5, "{left}");
        spoil(second, &[0; 2 * SLOT]);
        let left = find(&file).expect("read");
        assert!(left.newest.is_none() && left.any);
    }
}

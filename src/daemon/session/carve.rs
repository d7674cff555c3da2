//! Reading the rows of a damaged session page by page, without SQLite.
//!
//! Every page of the main file and every frame of the write-ahead log is examined separately. If it
//! is a leaf of a b-tree, its cells are records. The column types of a record identify its table.
//! Every relevant row carries a checksum, so a recovered row is correct even if the tree above it
//! is damaged. Nothing is written.
//!
//! The format is that of SQLite's "Database File Format" (sqlite.org/fileformat.html), sections
//! 1.6 (b-tree pages), 1.7 (overflow), 2.1 (records) and 4.1 (the log's frames); the way of looking
//! is that of its recover extension.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use super::acknowledgement::MAGIC;
use super::connection::companion;
use super::format::{InputRow, META_START, from_spare_blob};

/// Largest write-ahead log that is read.
const MAX_LOG: u64 = 4 << 30;
/// Largest record, bytes; a start mesh of some hundred million vertices.
const MAX_RECORD: usize = 8 << 30;
const LOG_HEAD: usize = 32;
const FRAME_HEAD: usize = 24;

/// One column of a record.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    Null,
    Int(i64),
    Text(String),
    Blob(Vec<u8>),
}

/// A row that was found.
#[derive(Debug, Clone, PartialEq)]
pub enum CarvedRow {
    Meta(String, Vec<u8>),
    Input(InputRow),
    /// Of layout 3: number, first tick, last tick, bytes.
    OldGroup(u64, u64, u64, Vec<u8>),
    /// A node or a thing beside the object: which one, its bytes tell. Number, bytes, layout.
    NodeOrSide(i64, Vec<u8>, i64),
    /// Number, tick, bytes, layout.
    Checkpoint(i64, i64, Vec<u8>, i64),
    /// Object, number, revision, topology, bytes.
    Page([i64; 4], Vec<u8>),
    /// Object, number, revision, bytes.
    Topology([i64; 3], Vec<u8>),
    Thumbnail(i64, Vec<u8>),
    /// A second copy of an entry of `meta`; its checksum holds.
    Spare(String, Vec<u8>),
    /// Number, tick, bytes, layout. It has no checksum.
    Pin(i64, i64, Vec<u8>, i64),
}

/// The pages of a session.
#[derive(Debug)]
pub struct PageImage {
    main: File,
    pages: u32,
    page_size: usize,
    log: Vec<u8>,
    /// Offsets of the frames' pages, in order, with their page numbers.
    frames: Vec<(u32, usize)>,
    /// The newest frame of each page.
    newest: BTreeMap<u32, usize>,
    /// The log's salts, where there is a log.
    pub salts: Option<[u32; 2]>,
}

fn u16_at(b: &[u8], at: usize) -> Option<usize> {
    Some(usize::from(u16::from_be_bytes(b.get(at..at + 2)?.try_into().ok()?)))
}

fn u32_at(b: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(b.get(at..at + 4)?.try_into().ok()?))
}

/// A variable-length integer, and the bytes that it takes.
fn varint(b: &[u8]) -> Option<(u64, usize)> {
    let mut value = 0u64;
    for (i, byte) in b.iter().take(9).enumerate() {
        if i == 8 {
            return Some((value << 8 | u64::from(*byte), 9));
        }
        value = value << 7 | u64::from(byte & 0x7f);
        if byte & 0x80 == 0 {
            return Some((value, i + 1));
        }
    }
    None
}

/// The salts in a write-ahead log's head; `None` where there is no log to speak of, and where the
/// head's checksum does not hold: a torn or damaged head says nothing, and SQLite passes such a log
/// over.
pub fn log_salts(path: &Path) -> Option<[u32; 2]> {
    let mut head = [0; LOG_HEAD];
    let mut log = File::open(companion(path, "-wal")).ok()?;
    log.read_exact(&mut head).ok()?;
    (log.metadata().ok()?.len() > LOG_HEAD as u64 && head_holds(&head))
        .then(|| Some([u32_at(&head, 16)?, u32_at(&head, 20)?]))?
}

/// Returns true if the checksum of a log's header is correct (SQLite, "The WAL File Format",
/// sections 2 and 4.3: the magic number gives the byte order of the summed words).
fn head_holds(head: &[u8; LOG_HEAD]) -> bool {
    let word: fn([u8; 4]) -> u32 = match u32_at(head, 0) {
        Some(0x377f_0682) => u32::from_le_bytes,
        Some(0x377f_0683) => u32::from_be_bytes,
        _ => return false,
    };
    let words = head[..24].chunks_exact(4).map(|b| word([b[0], b[1], b[2], b[3]]));
    let (mut sums, mut second) = ([0u32; 2], false);
    for word in words {
        let (this, other) = (usize::from(second), usize::from(!second));
        sums[this] = sums[this].wrapping_add(word).wrapping_add(sums[other]);
        second = !second;
    }
    u32_at(head, 24) == Some(sums[0]) && u32_at(head, 28) == Some(sums[1])
}

impl PageImage {
    /// Opens a session's file, and its log if `with_log` is true.
    ///
    /// # Errors
    /// Returns an error if the main file cannot be read.
    pub fn open(path: &Path, with_log: bool) -> std::io::Result<PageImage> {
        let mut main = File::open(path)?;
        let length = main.metadata()?.len();
        let mut head = [0; 100];
        let _ = main.read(&mut head)?;
        let named = u16_at(&head, 16).unwrap_or(0);
        let sound = head.starts_with(b"SQLite format 3\0") && named.is_power_of_two();
        let page_size = if sound && named >= 512 { named } else { 4096 };
        let pages = u32::try_from(length.div_ceil(page_size as u64)).unwrap_or(u32::MAX);
        let mut log = Vec::new();
        if with_log && let Ok(file) = File::open(companion(path, "-wal")) {
            let _ = file.take(MAX_LOG).read_to_end(&mut log);
        }
        let (frames, salts) = frames(&log, page_size);
        let newest = frames.iter().copied().collect();
        Ok(PageImage { main, pages, page_size, log, frames, newest, salts })
    }

    fn main_page(&mut self, n: u32) -> Option<Vec<u8>> {
        let at = u64::from(n.checked_sub(1)?) * self.page_size as u64;
        self.main.seek(SeekFrom::Start(at)).ok()?;
        let mut page = Vec::with_capacity(self.page_size);
        (&mut self.main).take(self.page_size as u64).read_to_end(&mut page).ok()?;
        // The last page may be cut: what is left of it may hold whole cells.
        page.resize(self.page_size, 0);
        Some(page)
    }

    fn page(&mut self, n: u32, log: bool) -> Option<Vec<u8>> {
        match self.newest.get(&n).filter(|_| log) {
            Some(&at) => self.log.get(at..at + self.page_size).map(<[u8]>::to_vec),
            None if n <= self.pages => self.main_page(n),
            None => None,
        }
    }

    /// Shows every row that can be made out: first those of the main file, then those of the log,
    /// the newest last. A row may come more than once. `take` says whether the row's checksum
    /// holds.
    pub fn rows(&mut self, take: &mut dyn FnMut(&CarvedRow) -> bool) {
        for n in 1..=self.pages {
            if let Some(page) = self.main_page(n) {
                self.leaf(&page, n, take);
            }
        }
        for (n, at) in self.frames.clone() {
            if let Some(page) = self.log.get(at..at + self.page_size).map(<[u8]>::to_vec) {
                self.leaf(&page, n, take);
            }
        }
    }

    fn leaf(&mut self, page: &[u8], n: u32, take: &mut dyn FnMut(&CarvedRow) -> bool) {
        let head = if n == 1 { 100 } else { 0 };
        let Some(kind) = page.get(head).copied() else { return };
        // The leaves of tables; of an index without row numbers (`meta`) also the pages above.
        let pointers = match kind {
            0x0d | 0x0a => head + 8,
            0x02 => head + 12,
            _ => return,
        };
        let count = u16_at(page, head + 3).unwrap_or(0).min(self.page_size / 4);
        for i in 0..count {
            let Some(at) = u16_at(page, pointers + 2 * i) else { return };
            // Overflowing pages are first looked up as they are now, then as the main file has
            // them: one of the two is right where the other is damaged.
            for log in [true, false] {
                match self.cell(page, at, kind, log).and_then(|(id, all)| row(id, all)) {
                    Some(found) if take(&found) => break,
                    _ if self.newest.is_empty() => break,
                    _ => {}
                }
            }
        }
    }

    fn cell(&mut self, page: &[u8], at: usize, kind: u8, log: bool) -> Option<(i64, Vec<Column>)> {
        let table = kind == 0x0d;
        let mut at = if kind == 0x02 { at + 4 } else { at };
        let (total, n) = varint(page.get(at..)?)?;
        at += n;
        let mut id = 0;
        if table {
            let (value, n) = varint(page.get(at..)?)?;
            (id, at) = (value as i64, at + n);
        }
        let total = usize::try_from(total).ok().filter(|t| *t <= MAX_RECORD)?;
        if total as u64 > u64::from(self.pages) * self.page_size as u64 + self.log.len() as u64 {
            return None;
        }
        let usable = self.page_size;
        let most = if table { usable - 35 } else { (usable - 12) * 64 / 255 - 23 };
        if total <= most {
            return record(page.get(at..at + total)?).map(|r| (id, r));
        }
        let least = (usable - 12) * 32 / 255 - 23;
        let local = least + (total - least) % (usable - 4);
        let local = if local <= most { local } else { least };
        let mut bytes = page.get(at..at + local)?.to_vec();
        let mut next = u32_at(page, at + local)?;
        while bytes.len() < total {
            let more = self.page(next, log)?;
            let part = (total - bytes.len()).min(usable - 4);
            bytes.extend_from_slice(more.get(4..4 + part)?);
            let after = u32_at(&more, 0)?;
            // A start mesh is written at once, into pages one after the other: where one of them
            // is damaged, the next is still known.
            let sound = after != 0 && after <= self.pages.max(1) + self.frames.len() as u32;
            next = if sound { after } else { next + 1 };
        }
        record(&bytes).map(|r| (id, r))
    }
}

/// A log's frames that belong to its present run, whether or not their checksums hold: the rows in
/// them have their own.
fn frames(log: &[u8], page_size: usize) -> (Vec<(u32, usize)>, Option<[u32; 2]>) {
    let salts_at = |at: usize| Some([u32_at(log, at)?, u32_at(log, at + 4)?]);
    // The head or a frame may be damaged: the salts count that most frames have.
    let places = (LOG_HEAD..log.len()).step_by(FRAME_HEAD + page_size);
    let matching = |s: &[u32; 2]| places.clone().filter(|at| salts_at(at + 8) == Some(*s)).count();
    let named = [salts_at(16), salts_at(LOG_HEAD + 8)].into_iter().flatten();
    let Some(salts) = named.max_by_key(matching) else {
        return (Vec::new(), None);
    };
    let mut all = Vec::new();
    let mut at = LOG_HEAD;
    while at + FRAME_HEAD < log.len() {
        let whole = at + FRAME_HEAD + page_size <= log.len();
        if let Some(n) = u32_at(log, at)
            && n != 0
            && whole
            && salts_at(at + 8) == Some(salts)
        {
            all.push((n, at + FRAME_HEAD));
        }
        at += FRAME_HEAD + page_size;
    }
    (all, Some(salts))
}

fn record(bytes: &[u8]) -> Option<Vec<Column>> {
    let (head, mut at) = varint(bytes)?;
    let head = usize::try_from(head).ok().filter(|h| *h <= bytes.len() && *h <= 256)?;
    let mut body = head;
    let mut all = Vec::new();
    while at < head {
        let (kind, n) = varint(bytes.get(at..head)?)?;
        at += n;
        let int = |n: usize| -> Option<i64> {
            let b = bytes.get(body..body + n)?;
            let first = i64::from(*b.first()? as i8);
            Some(b[1..].iter().fold(first, |v, x| v << 8 | i64::from(*x)))
        };
        let (column, n) = match kind {
            0 => (Column::Null, 0),
            1..=4 => (Column::Int(int(kind as usize)?), kind as usize),
            5 => (Column::Int(int(6)?), 6),
            6 => (Column::Int(int(8)?), 8),
            8 | 9 => (Column::Int(kind as i64 - 8), 0),
            12.. => {
                let n = usize::try_from((kind - 12) / 2).ok()?;
                let value = bytes.get(body..body.checked_add(n)?)?.to_vec();
                let text = kind % 2 == 1;
                (
                    if text {
                        Column::Text(String::from_utf8(value).ok()?)
                    } else {
                        Column::Blob(value)
                    },
                    n,
                )
            }
            _ => return None,
        };
        body += n;
        all.push(column);
    }
    Some(all)
}

/// Identifies the table of a record by the types of its columns. A checksum that covers one row
/// alone must be correct.
fn row(id: i64, mut all: Vec<Column>) -> Option<CarvedRow> {
    use Column::{Blob, Int, Null, Text};
    let whole = |crc: i64, data: &[u8]| i64::from(crc32fast::hash(data)) == crc;
    // Rows of layout 3 have no column `layout`.
    let layout = match all.as_slice() {
        [Null, Int(_), Blob(_), Int(l)] | [Null, Int(_), Int(_), Blob(_), Int(l)] => *l,
        _ => 3,
    };
    if matches!(all.as_slice(), [Null, Int(_), Blob(_), Int(_)])
        || matches!(all.as_slice(), [Null, Int(_), Int(_), Blob(_), Int(_)])
    {
        all.pop();
    }
    let found = match all.as_mut_slice() {
        [Text(key), Blob(value)] => CarvedRow::Meta(std::mem::take(key), std::mem::take(value)),
        [Null, Int(first), Int(last), Int(crc), Int(chain), Blob(data)] => {
            CarvedRow::Input(InputRow {
                number: id as u64,
                first: *first as u64,
                last: *last as u64,
                crc: u32::try_from(*crc).ok()?,
                chain: u32::try_from(*chain).ok()?,
                data: std::mem::take(data),
            })
        }
        [Null, Int(first), Int(last), Int(crc), Blob(data)] if whole(*crc, data) => {
            CarvedRow::OldGroup(id as u64, *first as u64, *last as u64, std::mem::take(data))
        }
        [Null, Int(crc), Blob(data)] if whole(*crc, data) => {
            CarvedRow::NodeOrSide(id, std::mem::take(data), layout)
        }
        [Null, Int(tick), Blob(data)] => CarvedRow::Pin(id, *tick, std::mem::take(data), layout),
        [Null, Int(tick), Int(crc), Blob(data)] if whole(*crc, data) => {
            CarvedRow::Checkpoint(id, *tick, std::mem::take(data), layout)
        }
        [Int(a), Int(b), Int(c), Int(d), Int(crc), Blob(data)] if whole(*crc, data) => {
            CarvedRow::Page([*a, *b, *c, *d], std::mem::take(data))
        }
        [Int(a), Int(b), Int(c), Int(crc), Blob(data)] if whole(*crc, data) => {
            CarvedRow::Topology([*a, *b, *c], std::mem::take(data))
        }
        [Null, Blob(data)] if data.starts_with(b"\x89PNG") => {
            CarvedRow::Thumbnail(id, std::mem::take(data))
        }
        [Null, Blob(data)] => {
            let (key, value) = from_spare_blob(data)?;
            CarvedRow::Spare(key, value)
        }
        _ => return None,
    };
    Some(found)
}

/// Returns true if a file and its log contain no readable part of a session.
pub(super) fn is_without_content(path: &Path) -> bool {
    let Ok(mut image) = PageImage::open(path, true) else { return false };
    let mut any = false;
    image.rows(&mut |row| {
        any |= match row {
            CarvedRow::Meta(key, _) | CarvedRow::Spare(key, _) => key == META_START,
            _ => true,
        };
        true
    });
    !any && !std::fs::read(path).is_ok_and(|b| b.windows(MAGIC.len()).any(|w| w == MAGIC))
}

/// Everything small of a session, and its input.
#[derive(Debug, Default)]
pub struct CarvedInput {
    /// Every version of each entry of `meta` that was found, the newest last.
    pub meta: BTreeMap<String, Vec<Vec<u8>>>,
    /// Rows of input whose checksums hold, by number.
    pub rows: BTreeMap<u64, InputRow>,
    /// Groups of layout 3, by number.
    pub old_groups: BTreeMap<u64, (u64, u64, Vec<u8>)>,
}

impl CarvedInput {
    /// Reads what there is. `identity`: the session's creation number, if it is known already;
    /// otherwise the one that is found is taken and returned.
    pub fn read(image: &mut PageImage, identity: Option<u64>) -> (CarvedInput, Option<u64>) {
        let mut all = CarvedInput::default();
        let mut loose = Vec::new();
        image.rows(&mut |row| match row {
            CarvedRow::Meta(key, value) => {
                let versions = all.meta.entry(key.clone()).or_default();
                if !versions.contains(value) {
                    versions.push(value.clone());
                }
                // More than one version may be right; see the other ones too.
                versions.len() > 1
            }
            CarvedRow::Spare(key, value) => {
                let versions = all.meta.entry(key.clone()).or_default();
                if !versions.contains(value) {
                    versions.push(value.clone());
                }
                true
            }
            CarvedRow::Input(r) => {
                loose.push(r.clone());
                identity.is_some_and(|i| r.is_whole(i))
            }
            CarvedRow::OldGroup(n, first, last, data) => {
                all.old_groups.insert(*n, (*first, *last, data.clone()));
                true
            }
            _ => true,
        });
        let named = all.meta.get(super::format::META_IDENTITY).into_iter().flatten();
        let named = named.filter_map(|v| Some(u64::from_le_bytes(v.as_slice().try_into().ok()?)));
        let identity = identity.or_else(|| {
            let whole = |i: &u64| loose.iter().filter(|r| r.is_whole(*i)).count();
            named.max_by_key(whole)
        });
        for row in loose {
            if identity.is_some_and(|i| row.is_whole(i)) {
                all.rows.insert(row.number, row);
            }
        }
        (all, identity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
    fn a_torn_head_of_a_log_has_no_salts() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.db");
        let db = rusqlite::Connection::open(&path).expect("opens");
        db.pragma_update(None, "journal_mode", "wal").expect("a log");
        db.execute_batch("CREATE TABLE t (n); INSERT INTO t VALUES (1);").expect("written");
        let log = companion(&path, "-wal");
        let whole = std::fs::read(&log).expect("there");
        let salts = log_salts(&path).expect("SQLite's own head holds");
        assert_eq!(Some(salts[0]), u32_at(&whole, 16));
        for bit in 0..LOG_HEAD * 8 {
            let mut torn = whole.clone();
            torn[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(&log, torn).expect("written");
            assert_eq!(log_salts(&path), None, "bit {bit}");
        }
    }
}

//! What layout 3 looked like: the frozen facts by which its files are read.

use std::path::{Path, PathBuf};

use rusqlite::Connection;
use sculptd_engine::old_layout::FieldCounts;

use super::{TickInput, ticks};

/// The number of this layout.
pub const LAYOUT: u32 = 3;

/// The key of `meta` that names the log in shared memory; eight bytes.
pub const META_TAIL: &str = "tail";

/// The number of fields of every struct that lay in a file of layout 3, by the names of today.
/// The numbers never change.
pub const FIELD_COUNTS: &FieldCounts = &[
    ("AutoMask", 5),
    ("Beginning", 3),
    ("BrushSettings", 22),
    ("Camera", 7),
    ("Carving", 2),
    ("Checkpoint", 6),
    ("Core", 10),
    ("Curve", 6),
    ("CurveStroke", 2),
    ("Cut", 6),
    ("Drag", 4),
    ("Fatigue", 2),
    ("Finger", 5),
    ("Hand", 15),
    ("HandSettings", 20),
    ("HandTools", 15),
    ("Hands", 3),
    ("HeldObject", 2),
    ("HeldStroke", 4),
    ("Jump", 5),
    ("Level", 2),
    ("Levels", 3),
    ("Lower", 2),
    ("Menu", 3),
    ("Mirror", 4),
    ("NewClay", 3),
    ("NewVertex", 3),
    ("Node", 11),
    ("ObjectState", 5),
    ("OtherWork", 4),
    ("Pad", 3),
    ("PalmPress", 5),
    ("PathSettings", 8),
    ("Pen", 11),
    ("PenPoint", 4),
    ("PenSlot", 3),
    ("PenTrack", 15),
    ("Picture", 3),
    ("Pin", 3),
    ("PressureCurve", 2),
    ("Push", 4),
    ("ReachBox", 2),
    ("ReachCalibration", 2),
    ("Sample", 4),
    ("Settings", 6),
    ("Similarity", 3),
    ("Spacer", 3),
    ("Stabilizer", 5),
    ("Stamp", 5),
    ("Stroke", 6),
    ("TickInput", 3),
    ("TopologySettings", 4),
    ("Track", 16),
    ("TrackedHand", 7),
    ("TriMesh", 3),
    ("Upper", 6),
    ("Volume", 3),
];

/// Reads the table `log`: every group up to the first that is missing, torn or out of order, and
/// the fault of that group.
pub fn read_log(db: &Connection) -> (Vec<TickInput>, Option<String>) {
    let mut input: Vec<TickInput> = Vec::new();
    let mut read = || -> Result<Option<String>, rusqlite::Error> {
        let mut query =
            db.prepare("SELECT id, first_tick, last_tick, crc, data FROM log ORDER BY id")?;
        let mut rows = query.query([])?;
        let mut expected = 1i64;
        while let Some(row) = rows.next()? {
            let (id, first, last): (i64, i64, i64) = (row.get(0)?, row.get(1)?, row.get(2)?);
            let (crc, data): (u32, Vec<u8>) = (row.get(3)?, row.get(4)?);
            if id != expected {
                return Ok(Some(format!("group {expected} is missing")));
            }
            expected += 1;
            if crc32fast::hash(&data) != crc || !extend(&mut input, &data) {
                return Ok(Some(format!("the group of ticks {first} to {last} is damaged")));
            }
        }
        Ok(None)
    };
    let cause = read().unwrap_or_else(|e| Some(format!("the log cannot be read to its end: {e}")));
    (input, cause)
}

/// Adds the ticks of a group; false where they make no sense.
pub fn extend(input: &mut Vec<TickInput>, data: &[u8]) -> bool {
    for tick in ticks(data, FIELD_COUNTS) {
        match tick {
            Ok(tick) if input.last().is_none_or(|l| l.tick < tick.tick) => input.push(tick),
            _ => return false,
        }
    }
    true
}

fn shared_memory(name: u64, part: usize) -> PathBuf {
    Path::new("/dev/shm").join(format!("sculptd-{name:016x}-{part}"))
}

/// Adds what a killed program of layout 3 left in shared memory.
pub fn lengthen(input: &mut Vec<TickInput>, name: u64) {
    let mut all = Vec::new();
    for part in 0..2 {
        let bytes = std::fs::read(shared_memory(name, part)).unwrap_or_default();
        entries(&bytes, &mut all);
    }
    all.sort_by_key(|e: &(u64, u64, Vec<u8>)| e.0);
    for (last, after, data) in all {
        let now = input.last().map_or(0, |t| t.tick);
        if last <= now {
            continue;
        }
        // Ticks without input are in no row: what matters is what had been handed over before.
        if after > now || !extend(input, &data) {
            return;
        }
    }
}

/// Entries as (last tick, last tick before, bytes).
fn entries(mut bytes: &[u8], all: &mut Vec<(u64, u64, Vec<u8>)>) {
    const HEAD: usize = 32;
    let u64_at = |b: &[u8], at: usize, n: usize| {
        b[at..at + n].iter().rev().fold(0u64, |n, x| n << 8 | u64::from(*x))
    };
    while bytes.len() >= HEAD {
        let (head, rest) = bytes.split_at(HEAD);
        let Some(data) = rest.get(..u64_at(head, 24, 4) as usize) else { return };
        let mut crc = crc32fast::Hasher::new();
        crc.update(&head[..28]);
        crc.update(data);
        if u64::from(crc.finalize()) != u64_at(head, 28, 4) {
            return;
        }
        all.push((u64_at(head, 8, 8), u64_at(head, 16, 8), data.to_vec()));
        bytes = &rest[data.len()..];
    }
}

/// Lets go what such a program left in shared memory.
pub fn remove_shared_memory(name: u64) {
    for part in 0..2 {
        let _ = std::fs::remove_file(shared_memory(name, part));
    }
}

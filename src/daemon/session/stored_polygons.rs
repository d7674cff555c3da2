//! The polygons of the objects' files in a session: entries of `meta`, each under the hash of the
//! triangles that it is of, written once when an object with these triangles is first seen.
//!
//! The state of the world does not depend on them, and a session without them opens as before.

use std::collections::BTreeSet;
use std::path::Path;

use rusqlite::Connection;

use super::connection::connect;
use crate::polygons;
use sculptd_clay::Snapshot;

/// Prefix of the keys; the hash follows it.
pub(super) const PREFIX: &str = "polygons:";
/// Largest entry that is written: SQLite holds no blob of more than 1,000,000,000 bytes.
const MAX_BYTES: usize = 900_000_000;

/// The polygons that a session already contains.
#[derive(Debug, Default)]
pub struct StoredPolygons {
    keys: BTreeSet<String>,
    /// Numbers of the clays already examined.
    seen: BTreeSet<u32>,
}

/// The value of an entry: the checksum of the bytes before them.
fn entry(bytes: &[u8]) -> Vec<u8> {
    [&crc32fast::hash(bytes).to_le_bytes()[..], bytes].concat()
}

/// Returns the bytes of an entry; `None` if they have changed.
pub(super) fn from_entry(value: &[u8]) -> Option<&[u8]> {
    let (sum, bytes) = value.split_first_chunk::<4>()?;
    (crc32fast::hash(bytes).to_le_bytes() == *sum).then_some(bytes)
}

fn each(db: &Connection, visit: &mut dyn FnMut(String, &[u8])) -> rusqlite::Result<()> {
    let mut query = db.prepare("SELECT key, value FROM meta WHERE key >= ?1 AND key < ?2")?;
    // The sign after the colon ends the keys with this beginning.
    let mut rows = query.query([PREFIX, "polygons;"])?;
    while let Some(row) = rows.next()? {
        let key = row.get(0)?;
        visit(key, row.get_ref(1)?.as_blob().unwrap_or_default());
    }
    Ok(())
}

impl StoredPolygons {
    /// Reads the keys in the file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn read(db: &Connection) -> rusqlite::Result<StoredPolygons> {
        let mut all = StoredPolygons::default();
        each(db, &mut |key, _| {
            all.keys.insert(key);
        })?;
        Ok(all)
    }

    /// Writes the polygons of the file that this clay was loaded from, unless the session contains
    /// them.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn keep(&mut self, db: &Connection, clay: &Snapshot) -> rusqlite::Result<()> {
        if self.seen.contains(&clay.object_id()) {
            return Ok(());
        }
        if let Some(faces) = polygons::of(clay) {
            let key = format!("{PREFIX}{:016x}", faces.key);
            if !self.keys.contains(&key) {
                let bytes = faces.to_bytes().unwrap_or_default();
                if bytes.len() <= MAX_BYTES {
                    let put = "INSERT OR REPLACE INTO meta (key, value) VALUES (?1, ?2)";
                    db.execute(put, (&key, entry(&bytes)))?;
                } else {
                    tracing::warn!("the polygons of a file are too many for the session");
                }
                self.keys.insert(key);
            }
        }
        self.seen.insert(clay.object_id());
        Ok(())
    }
}

/// Loads the polygons of a session into this process. Returns the number of damaged entries.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn restore(path: &Path) -> rusqlite::Result<usize> {
    let mut damaged = 0;
    each(&connect(path, false)?, &mut |_, value| {
        damaged += usize::from(!from_entry(value).is_some_and(polygons::restore));
    })?;
    Ok(damaged)
}

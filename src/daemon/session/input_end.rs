//! Where a session's input ends: the next row, what a dead process left in shared memory, and the
//! way from an older layout.

use std::path::Path;

use rusqlite::{Connection, OptionalExtension};

use super::VERSION;
use super::acknowledgement::{Acknowledgement, acknowledge_first};
use super::format::{
    InputRow, META_IDENTITY, META_REPLAY_FROM, META_SETTINGS, META_START, META_SUMS, ReplayFrom,
    Settings, TABLES, TABLES_OF_COPIES, append, chain_start, v3,
};
use super::shared_memory_log::{self, FileIdentity, SharedMemoryLog};
use sculptd_engine::old_layout::from_bytes;
use sculptd_geometry::TriMesh;

/// Ticks in one row of a session that came from an older layout.
const UPGRADED_GROUP: usize = 64;

/// End of a session's input.
#[derive(Debug, Clone, Copy)]
pub(super) struct InputEnd {
    pub identity: u64,
    pub number: u64,
    pub tick: u64,
    pub chain: u32,
}

impl InputEnd {
    /// Returns the acknowledgement of all input up to here.
    pub fn known(&self, salts: [u32; 2]) -> Acknowledgement {
        Acknowledgement { identity: self.identity, tick: self.tick, chain: self.chain, salts }
    }

    /// Reads the end of the input from a session's file.
    pub fn read(db: &Connection) -> rusqlite::Result<InputEnd> {
        let sql = "SELECT value FROM meta WHERE key = ?1";
        let bytes: Vec<u8> = db.query_row(sql, [META_IDENTITY], |r| r.get(0))?;
        let identity = bytes.try_into().map(u64::from_le_bytes).unwrap_or_default();
        let last = "SELECT number, last_tick, chain FROM input ORDER BY number DESC LIMIT 1";
        let last = db.query_row(last, [], |r| {
            let (number, tick): (i64, i64) = (r.get(0)?, r.get(1)?);
            Ok(InputEnd { identity, number: number as u64, tick: tick as u64, chain: r.get(2)? })
        });
        let none = InputEnd { identity, number: 0, tick: 0, chain: chain_start(identity) };
        Ok(last.optional()?.unwrap_or(none))
    }

    /// Puts the next row.
    pub fn put(
        &mut self,
        db: &Connection,
        first: u64,
        last: u64,
        data: &[u8],
    ) -> rusqlite::Result<()> {
        let before = (self.number, self.chain);
        let row = InputRow::after(before, self.identity, first..=last, data.to_vec());
        let mut put = db.prepare_cached(
            "INSERT INTO input (number, first_tick, last_tick, crc, chain, data)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
        )?;
        let number = row.number as i64;
        put.execute((number, first as i64, last as i64, row.crc, row.chain, &row.data))?;
        *self = InputEnd { number: row.number, tick: last, chain: row.chain, ..*self };
        Ok(())
    }
}

/// Takes over what a dead process left of this very file in shared memory, and begins a log of its
/// own there.
pub(super) fn begin_log(
    db: &Connection,
    path: &Path,
) -> rusqlite::Result<(InputEnd, Option<SharedMemoryLog>)> {
    let mut end = InputEnd::read(db)?;
    let Ok(file) = FileIdentity::of(path, end.identity) else { return Ok((end, None)) };
    let logs = shared_memory_log::logs_of(&file);
    let dead: Vec<_> = logs.into_iter().filter(|l| !l.owner_lives() || l.is_own()).collect();
    for log in &dead {
        let entries = shared_memory_log::read(log);
        for entry in shared_memory_log::following((end.tick, end.chain), &entries) {
            end.put(db, entry.first, entry.last, &entry.data)?;
        }
    }
    // The file has everything now, synced.
    dead.iter().for_each(shared_memory_log::remove);
    shared_memory_log::prune();
    Ok((end, SharedMemoryLog::create(file, path, (end.tick, end.chain))))
}

/// Upgrades a file of an older layout to this one in one transaction. The input after its oldest
/// checkpoint is rewritten; the earlier input stays in the older program's tables.
pub(super) fn upgrade(db: &mut Connection) -> rusqlite::Result<()> {
    let found: u32 = db.query_row("PRAGMA user_version", [], |r| r.get(0))?;
    if found != v3::LAYOUT {
        return Ok(());
    }
    let oldest: Option<i64> = db.query_row("SELECT min(tick) FROM checkpoint", [], |r| r.get(0))?;
    let oldest = oldest.unwrap_or_default() as u64;
    let (mut input, _) = v3::read_log(db);
    let sql = "SELECT value FROM meta WHERE key = ?1";
    let old_log: Option<Vec<u8>> = db.query_row(sql, [v3::META_TAIL], |r| r.get(0)).optional()?;
    let old_log = old_log.and_then(|l| l.try_into().ok()).map(u64::from_le_bytes);
    if let Some(name) = old_log {
        v3::lengthen(&mut input, name);
    }
    let all = db.transaction()?;
    all.execute_batch(&TABLES.replace("CREATE TABLE meta (", "CREATE TABLE IF NOT EXISTS meta ("))?;
    all.execute_batch(TABLES_OF_COPIES)?;
    for table in ["node", "side", "checkpoint", "pin"] {
        let known = "SELECT count(*) FROM sqlite_schema WHERE name = ?1";
        if all.query_row(known, [table], |r| r.get::<_, i64>(0))? == 0 {
            continue;
        }
        all.execute_batch(&format!(
            "ALTER TABLE {table} ADD COLUMN layout INTEGER NOT NULL DEFAULT {}",
            v3::LAYOUT
        ))?;
    }
    let identity = shared_memory_log::new_creation_number();
    let mut end = InputEnd { identity, number: 0, tick: 0, chain: chain_start(identity) };
    let after = input.partition_point(|t| t.tick <= oldest);
    for group in input[after..].chunks(UPGRADED_GROUP) {
        let mut data = Vec::new();
        for t in group {
            append(&mut data, t.tick, &t.samples, &t.commands);
        }
        end.put(&all, group[0].tick, group[group.len() - 1].tick, &data)?;
    }
    // Settings and start are read as this layout has them from now on.
    for (key, sum) in [(META_SETTINGS, 1), (META_START, 0)] {
        let bytes: Vec<u8> = all.query_row(sql, [key], |r| r.get(0))?;
        let plain = |e: postcard::Error| rusqlite::Error::ToSqlConversionFailure(Box::new(e));
        let bytes = if sum == 1 {
            let now: Settings = from_bytes(&bytes, v3::FIELD_COUNTS).map_err(plain)?;
            postcard::to_stdvec(&now).map_err(plain)?
        } else {
            let now: TriMesh = from_bytes(&bytes, v3::FIELD_COUNTS).map_err(plain)?;
            postcard::to_stdvec(&now).map_err(plain)?
        };
        all.execute("UPDATE meta SET value = ?2 WHERE key = ?1", (key, &bytes))?;
    }
    all.execute("DELETE FROM meta WHERE key IN (?1, ?2)", (META_SUMS, v3::META_TAIL))?;
    let why = format!(
        "it was begun by an older sculptd (layout {found}), in which the same input makes other \
         clay"
    );
    let from = postcard::to_stdvec(&ReplayFrom { tick: oldest, why }).unwrap_or_default();
    let put = "INSERT OR REPLACE INTO meta (key, value) VALUES (?1, ?2)";
    all.execute(put, (META_REPLAY_FROM, &from))?;
    all.execute(put, (META_IDENTITY, identity.to_le_bytes().as_slice()))?;
    acknowledge_first(&all, identity, end.tick, end.chain)?;
    all.pragma_update(None, "user_version", VERSION)?;
    all.commit()?;
    // The acknowledgement's page must be in the main file before it is written there directly.
    db.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()))?;
    old_log.into_iter().for_each(v3::remove_shared_memory);
    Ok(())
}

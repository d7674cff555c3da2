//! Saves the readable part of a damaged session into a new file beside it. The damaged file is not
//! changed.
//!
//! Every source is read: the main file page by page, its write-ahead log frame by frame
//! ([`super::carve`]), and the logs in shared memory. These include the logs of the session that
//! the file is a copy of. Only rows with a correct checksum count. The result is the part that
//! reaches furthest: the input from the start to the first gap, or a checkpoint after it and its
//! later input.

use std::path::{Path, PathBuf};

use rusqlite::Connection;
use serde::de::DeserializeOwned;

use super::VERSION;
use super::acknowledgement::{self, Acknowledged, acknowledge_first};
use super::carve::{CarvedInput, CarvedRow, PageImage};
use super::create::{CreateError, SessionDraft};
use super::format::{
    InputRow, META_REPLAY_FROM, META_SETTINGS, META_START, ReplayFrom, Settings, TickInput, append,
    chain, chain_start, field_counts, v3,
};
use super::history::{Node, Store, StoreError};
use super::reader::{Loss, OpenError, Opened, indices_hold, open, salts_are_foreign};
use super::reopen::from_checkpoint;
use super::shared_memory_log::{self, LogEntry};
use super::start::SessionStart;
use super::stored_polygons;
use sculptd_engine::old_layout::from_bytes;
use sculptd_geometry::job::Job;

/// Names that are tried for the new file.
const NAMES: u32 = 1000;
/// Rows of the history in one transaction.
const ROWS: usize = 1000;

#[derive(Debug, thiserror::Error)]
pub enum SalvageError {
    /// Nothing that a session needs could be read.
    #[error(transparent)]
    Open(#[from] OpenError),
    #[error("nothing is damaged: {path}")]
    Whole { path: String },
    #[error(transparent)]
    Create(#[from] CreateError),
    #[error("{path}: {source}")]
    Store { path: String, source: rusqlite::Error },
    #[error("{path}: no free name beside it")]
    NoName { path: String },
}

/// A new session file that holds what could be read.
#[derive(Debug, Clone)]
pub struct Saved {
    pub old: PathBuf,
    pub path: PathBuf,
    /// The lost input, in ticks.
    pub loss: Option<Loss>,
    /// True if the start mesh or the settings differ from the original.
    pub start_changed: bool,
}

impl std::fmt::Display for Saved {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{}: damaged; what can be read is in {}",
            self.old.display(),
            self.path.display()
        )?;
        if let Some(loss) = &self.loss {
            write!(f, ": {loss}")?;
        }
        if self.start_changed {
            write!(f, "; its start has changed bytes, the sculpture may differ from what it was")?;
        }
        Ok(())
    }
}

/// Input without a gap: rows of ticks, from the first to the last.
#[derive(Debug, Default)]
struct InputRun {
    /// True if it begins with the session.
    from_start: bool,
    first: u64,
    last: u64,
    /// First tick, last tick, bytes as this layout writes them.
    groups: Vec<(u64, u64, Vec<u8>)>,
}

/// The readable parts of a damaged file.
struct Readable {
    start: SessionStart,
    settings: Settings,
    start_changed: bool,
    runs: Vec<InputRun>,
    /// The last tick that any source names.
    last: Option<u64>,
    /// A session that was no longer replayed from its start.
    replay_from: Option<ReplayFrom>,
    /// Entries of [`stored_polygons`] whose checksums hold.
    polygons: Vec<(String, Vec<u8>)>,
    layout: u32,
}

/// Saves what can be read of `path` as `NAME.saved.sculpt` (or `NAME.saved-2.sculpt`, ...) in the
/// same folder.
///
/// # Errors
/// [`SalvageError::Whole`] where nothing is damaged, the others where nothing can be read or
/// written.
pub fn salvage(path: &Path) -> Result<Saved, SalvageError> {
    let why = match open(path) {
        Ok(Opened { loss: None, .. }) => {
            return Err(SalvageError::Whole { path: path.display().to_string() });
        }
        Ok(opened) => opened.loss.map(|l| l.cause).unwrap_or_default(),
        Err(
            e @ (OpenError::OtherLayout { .. }
            | OpenError::Io { .. }
            | OpenError::ReadOnlyFolder { .. }),
        ) => return Err(e.into()),
        Err(e) => match e {
            OpenError::Damaged { what, source, .. } => format!("{what} cannot be read: {source}"),
            e => e.to_string(),
        },
    };
    let io = |source| OpenError::Io { path: path.display().to_string(), source };
    let known = match acknowledgement::read(path).map_err(io)? {
        Acknowledged::Known(a) => Some(a),
        _ => None,
    };
    let mut image = PageImage::open(path, true).map_err(io)?;
    if let (Some(known), Some(salts)) = (&known, image.salts)
        && salts_are_foreign(known, salts)
    {
        image = PageImage::open(path, false).map_err(io)?;
    }
    let (carved, identity) = CarvedInput::read(&mut image, known.map(|a| a.identity));
    let readable = read(path, carved, identity, known.map(|a| a.tick))?;
    let create = |source| SalvageError::Store { path: path.display().to_string(), source };
    let draft = SessionDraft::begin(path, &readable.start, &readable.settings)?;
    let db = draft.db().ok_or_else(|| SalvageError::NoName { path: path.display().to_string() })?;
    copy_history(&mut image, db).map_err(create)?;
    for entry in &readable.polygons {
        let put = "INSERT OR REPLACE INTO meta (key, value) VALUES (?1, ?2)";
        db.execute(put, (&entry.0, &entry.1)).map_err(create)?;
    }
    let kept = choose(&draft, db, &readable).map_err(create)?;
    let Some(kept) = kept else {
        let path = path.display().to_string();
        let old = readable.replay_from.map(|r| r.why);
        let why = old.unwrap_or_else(|| "it was begun by an older sculptd".into());
        return Err(OpenError::NoCheckpoint { path, why }.into());
    };
    let new = publish_beside(path, draft)?;
    let gap = match kept.after_gap {
        true => format!("{why}; ticks before a checkpoint are missing, the sculpture is whole"),
        false => why,
    };
    let loss = Loss { kept: kept.tick, last: readable.last.max(Some(kept.tick)), cause: gap };
    let last = if known.is_none() && readable.layout == VERSION && loss.last == Some(kept.tick) {
        // Nothing says how far it went.
        None
    } else {
        loss.last
    };
    let loss = Some(Loss { last, ..loss });
    Ok(Saved { old: path.into(), path: new, loss, start_changed: readable.start_changed })
}

fn read(
    path: &Path,
    mut carved: CarvedInput,
    identity: Option<u64>,
    acknowledged: Option<u64>,
) -> Result<Readable, OpenError> {
    let damaged = |what, source: Box<dyn std::error::Error + Send + Sync>| OpenError::Damaged {
        path: path.display().to_string(),
        what,
        source,
    };
    let layout =
        if identity.is_none() && !carved.old_groups.is_empty() { v3::LAYOUT } else { VERSION };
    let counts = field_counts(layout).unwrap_or(&[]);
    let sums: Vec<(u32, u32)> = carved
        .meta
        .get(super::format::META_SUMS)
        .into_iter()
        .flatten()
        .filter_map(|v| postcard::from_bytes(v).ok())
        .collect();
    let mut start_changed = false;
    let mut best = |key: &str, sum: &dyn Fn(&(u32, u32)) -> u32| {
        let all = carved.meta.remove(key)?;
        let whole = |v: &&Vec<u8>| sums.iter().any(|s| sum(s) == crc32fast::hash(v));
        let exact = all.iter().find(whole).cloned();
        start_changed |= exact.is_none() && !sums.is_empty();
        exact.or_else(|| all.last().cloned())
    };
    let start =
        best(META_START, &|s| s.0).ok_or_else(|| damaged(META_START, "it is missing".into()))?;
    let settings = best(META_SETTINGS, &|s| s.1)
        .ok_or_else(|| damaged(META_SETTINGS, "it is missing".into()))?;
    let start =
        SessionStart::from_bytes(&start, counts).map_err(|e| damaged(META_START, e.into()))?;
    if !indices_hold(&start.mesh) {
        return Err(damaged(META_START, "an index is out of range".into()));
    }
    // A start that nothing can begin with is no start.
    start.clay(&Job::default()).map_err(|e| damaged(META_START, e.into()))?;
    let settings = from_bytes(&settings, counts).map_err(|e| damaged(META_SETTINGS, e.into()))?;
    let replay_from: Option<ReplayFrom> = carved
        .meta
        .get(META_REPLAY_FROM)
        .into_iter()
        .flatten()
        .find_map(|v| postcard::from_bytes(v).ok());
    let polygons = carved.meta.range(stored_polygons::PREFIX.to_string()..);
    let polygons = polygons.take_while(|(key, _)| key.starts_with(stored_polygons::PREFIX));
    let whole = |v: &&Vec<u8>| stored_polygons::from_entry(v).is_some();
    let polygons: Vec<(String, Vec<u8>)> = polygons
        .filter_map(|(key, all)| Some((key.clone(), all.iter().find(whole)?.clone())))
        .collect();
    let mut last = acknowledged;
    let runs = if layout == v3::LAYOUT {
        last = last.max(carved.old_groups.values().map(|g| g.1).max());
        old_runs(&carved)
    } else {
        let identity = identity.unwrap_or_default();
        last = last.max(carved.rows.values().map(|r| r.last).max());
        let logs: Vec<Vec<LogEntry>> = shared_memory_log::logs_of_session(identity)
            .iter()
            .filter(|l| !l.owner_lives() || l.is_own())
            .map(shared_memory_log::read)
            .collect();
        let of_file = shared_memory_log::FileIdentity::of(path, identity)
            .map(|f| shared_memory_log::logs_of(&f))
            .unwrap_or_default();
        for log in of_file {
            let newest = shared_memory_log::read(&log).last().map(|e| e.last);
            last = last.max(newest);
        }
        runs(&carved.rows.into_values().collect::<Vec<_>>(), identity, &logs)
    };
    Ok(Readable { start, settings, start_changed, runs, last, replay_from, polygons, layout })
}

/// Rows that hang together, by number and chain; each run lengthened by what follows on it in
/// memory.
fn runs(rows: &[InputRow], identity: u64, logs: &[Vec<LogEntry>]) -> Vec<InputRun> {
    let mut all: Vec<InputRun> =
        vec![InputRun { from_start: true, first: 1, ..InputRun::default() }];
    let mut end = (0, chain_start(identity));
    let mut ends = vec![end.1];
    for row in rows {
        if !row.follows(end) {
            all.push(InputRun { first: row.first, ..InputRun::default() });
            ends.push(row.chain);
        }
        end = (row.number, row.chain);
        if let (Some(run), Some(chain)) = (all.last_mut(), ends.last_mut()) {
            run.groups.push((row.first, row.last, row.data.clone()));
            run.last = row.last;
            *chain = row.chain;
        }
    }
    for (run, end) in all.iter_mut().zip(ends) {
        let mut end = (run.last, end);
        for log in logs {
            for entry in shared_memory_log::following(end, log) {
                end = (entry.last, chain(end.1, &entry.data));
                run.last = entry.last;
                run.groups.push((entry.first, entry.last, entry.data.clone()));
            }
        }
    }
    // Input that exists only in memory, after a gap.
    for log in logs {
        let mut run: Option<(InputRun, u32)> = None;
        for e in log {
            match &mut run {
                Some((run, end)) if *end == e.chain && run.last == e.after => {
                    run.groups.push((e.first, e.last, e.data.clone()));
                    run.last = e.last;
                    *end = chain(*end, &e.data);
                }
                _ => {
                    all.extend(run.take().map(|r| r.0));
                    let groups = vec![(e.first, e.last, e.data.clone())];
                    let (first, last) = (e.after + 1, e.last);
                    run = Some((
                        InputRun { from_start: false, first, last, groups },
                        chain(e.chain, &e.data),
                    ));
                }
            }
        }
        all.extend(run.map(|r| r.0));
    }
    all
}

/// Groups of layout 3, written as this layout has them.
fn old_runs(carved: &CarvedInput) -> Vec<InputRun> {
    let mut all = vec![InputRun { from_start: true, first: 1, ..InputRun::default() }];
    let mut expected = 1;
    for (number, (first, last, data)) in &carved.old_groups {
        if *number != expected {
            all.push(InputRun { first: *first, ..InputRun::default() });
        }
        expected = number + 1;
        let mut input: Vec<TickInput> = Vec::new();
        v3::extend(&mut input, data);
        let mut bytes = Vec::new();
        for t in &input {
            append(&mut bytes, t.tick, &t.samples, &t.commands);
        }
        if let Some(run) = all.last_mut() {
            run.groups.push((*first, *last, bytes));
            run.last = *last;
        }
    }
    all
}

/// Copies the rows of the history whose checksums hold, and, as they have none, pictures and pins.
fn copy_history(image: &mut PageImage, db: &Connection) -> rusqlite::Result<()> {
    db.execute_batch("BEGIN")?;
    let (mut failed, mut open) = (None, 0);
    image.rows(&mut |row| {
        let done = put_row(db, row);
        open += 1;
        if open >= ROWS {
            open = 0;
            failed = failed.take().or(db.execute_batch("COMMIT; BEGIN").err());
        }
        match done {
            Ok(known) => known,
            Err(e) => {
                failed.get_or_insert(e);
                true
            }
        }
    });
    db.execute_batch("COMMIT")?;
    failed.map_or(Ok(()), Err)
}

fn decodes<T: DeserializeOwned>(data: &[u8], layout: i64) -> Option<T> {
    from_bytes(data, field_counts(u32::try_from(layout).ok()?)?).ok()
}

fn put_row(db: &Connection, row: &CarvedRow) -> rusqlite::Result<bool> {
    let crc = |data: &[u8]| crc32fast::hash(data);
    match row {
        CarvedRow::NodeOrSide(id, data, layout) => {
            let node = decodes::<Node>(data, *layout).is_some_and(|n| n.id as i64 == *id);
            let table = if node { "node" } else { "side" };
            let sql = format!(
                "INSERT OR REPLACE INTO {table} (id, crc, data, layout) VALUES (?1, ?2, ?3, ?4)"
            );
            db.prepare_cached(&sql)?.execute((id, crc(data), data, layout))?;
        }
        CarvedRow::Checkpoint(id, tick, data, layout) => {
            let sql = "INSERT OR REPLACE INTO checkpoint (id, tick, crc, data, layout)
                       VALUES (?1, ?2, ?3, ?4, ?5)";
            db.prepare_cached(sql)?.execute((id, tick, crc(data), data, layout))?;
        }
        CarvedRow::Page(name, data) => {
            let sql = "INSERT OR REPLACE INTO page
                       (lineage, number, revision, topology, crc, data)
                       VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
            let [a, b, c, d] = name;
            db.prepare_cached(sql)?.execute((a, b, c, d, crc(data), data))?;
        }
        CarvedRow::Topology(name, data) => {
            let sql = "INSERT OR REPLACE INTO topology (lineage, number, revision, crc, data)
                       VALUES (?1, ?2, ?3, ?4, ?5)";
            let [a, b, c] = name;
            db.prepare_cached(sql)?.execute((a, b, c, crc(data), data))?;
        }
        CarvedRow::Thumbnail(id, png) => {
            let sql = "INSERT OR REPLACE INTO sight (node, png) VALUES (?1, ?2)";
            db.prepare_cached(sql)?.execute((id, png))?;
        }
        CarvedRow::Pin(id, tick, data, layout) => {
            let pin = decodes::<super::history::retention::Pin>(data, *layout);
            if pin.is_none() {
                return Ok(false);
            }
            let sql = "INSERT OR REPLACE INTO pin (id, tick, data, layout) VALUES (?1, ?2, ?3, ?4)";
            db.prepare_cached(sql)?.execute((id, tick, data, layout))?;
        }
        CarvedRow::Meta(..)
        | CarvedRow::Spare(..)
        | CarvedRow::Input(_)
        | CarvedRow::OldGroup(..) => {}
    }
    Ok(true)
}

/// Result of the salvage.
struct Salvaged {
    tick: u64,
    /// True if input before a checkpoint is missing.
    after_gap: bool,
}

/// Takes what reaches furthest: the input from the start, or a checkpoint with what follows it.
/// `None`: there is neither.
fn choose(
    draft: &SessionDraft,
    db: &Connection,
    readable: &Readable,
) -> rusqlite::Result<Option<Salvaged>> {
    let prefix = readable.runs.first();
    let refused = readable.replay_from.is_some() || readable.layout == v3::LAYOUT;
    let from_start = prefix.filter(|p| p.from_start && !refused).map_or(0, |p| p.last);
    let mut best: Option<(u64, u64, Option<&InputRun>)> = None;
    if let Ok(store) = Store::read(draft.temporary()) {
        for id in store.checkpoints(u64::MAX).unwrap_or_default() {
            let Ok(c) = store.checkpoint(id) else { continue };
            // The run that holds all input after it.
            let run = readable
                .runs
                .iter()
                .filter(|r| r.first <= c.tick + 1 && r.last > c.tick)
                .max_by_key(|r| r.last);
            let reach = run.map_or(c.tick, |r| r.last);
            if reach > from_start.max(best.as_ref().map_or(0, |b| b.0))
                && serves(&store, readable, id).unwrap_or(false)
            {
                best = Some((reach, c.tick, run));
            }
        }
    }
    let identity = draft.identity;
    let (kept, run, from) = match best {
        Some((reach, tick, run)) => (reach, run, Some(tick)),
        None if refused => return Ok(None),
        None => (from_start, prefix, None),
    };
    db.execute_batch("BEGIN")?;
    let mut end = (0, chain_start(identity));
    for (first, last, data) in run.into_iter().flat_map(|r| &r.groups) {
        let row = InputRow::after(end, identity, *first..=*last, data.clone());
        let values = (row.number as i64, *first as i64, *last as i64, row.crc, row.chain, data);
        let sql = "INSERT INTO input (number, first_tick, last_tick, crc, chain, data)
                   VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
        db.prepare_cached(sql)?.execute(values)?;
        end = (row.number, row.chain);
    }
    if let Some(tick) = from {
        let why = match &readable.replay_from {
            Some(old) => old.why.clone(),
            None if readable.layout == v3::LAYOUT => {
                "it was begun by an older sculptd, in which the same input makes other clay".into()
            }
            None => format!("it was damaged, and input before tick {tick} is lost"),
        };
        let value = postcard::to_stdvec(&ReplayFrom { tick, why }).unwrap_or_default();
        let put = "INSERT OR REPLACE INTO meta (key, value) VALUES (?1, ?2)";
        db.execute(put, (META_REPLAY_FROM, value))?;
    }
    // Checkpoints of what is not there.
    db.execute("DELETE FROM checkpoint WHERE tick > ?1", [kept as i64])?;
    let last = run.filter(|r| !r.groups.is_empty()).map_or(0, |r| r.last);
    acknowledge_first(db, identity, last, end.1)?;
    db.execute_batch("COMMIT")?;
    Ok(Some(Salvaged { tick: kept, after_gap: from.is_some() && !refused }))
}

/// Returns true if a checkpoint's sculpture can be restored.
fn serves(store: &Store, readable: &Readable, id: u64) -> Result<bool, StoreError> {
    let damaged = |_| StoreError::Damaged("the start".into());
    let base = readable.start.clay(&Job::default()).map_err(damaged)?;
    let opened = Opened {
        path: PathBuf::new(),
        layout: VERSION,
        start: readable.start.clone(),
        settings: readable.settings.clone(),
        input: Vec::new(),
        replay_from: Some(ReplayFrom { tick: 0, why: String::new() }),
        loss: None,
        not_ended: None,
    };
    let tree = store.tree()?;
    let parts = (store, &tree, &base);
    Ok(from_checkpoint(parts, &opened, id, None, 1, &Job::default())?.is_some())
}

fn publish_beside(path: &Path, draft: SessionDraft) -> Result<PathBuf, SalvageError> {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    for n in 1..=NAMES {
        let name = if n == 1 {
            format!("{stem}.saved.sculpt")
        } else {
            format!("{stem}.saved-{n}.sculpt")
        };
        let new = path.with_file_name(name);
        if new.exists() {
            continue;
        }
        draft.publish(&new, false)?;
        return Ok(new);
    }
    Err(SalvageError::NoName { path: path.display().to_string() })
}

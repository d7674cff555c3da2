//! What can be read of a damaged session, saved into a new file beside it. The damaged one is not
//! touched.

use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::format::append;
use super::reader::{Loss, OpenError, Opened, open, read};
use super::writer::{self, CreateError};

/// Ticks in one group of a saved file.
const GROUP: usize = 64;
/// Names that are tried for the new file.
const NAMES: u32 = 1000;

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
    /// `None`: all input was read, only the start or the settings have changed bytes.
    pub loss: Option<Loss>,
    /// The start mesh or the settings are not, to the bit, what they were.
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
            write!(f, "; its start has changed bytes, the work may differ from what it was")?;
        }
        Ok(())
    }
}

/// Saves what can be read of `path` as `NAME.saved.sculpt` (or `NAME.saved-2.sculpt`, ...) in the
/// same folder.
pub fn salvage(path: &Path) -> Result<Saved, SalvageError> {
    let (opened, start_changed) = match open(path) {
        Ok(Opened { loss: None, .. }) => {
            return Err(SalvageError::Whole { path: path.display().to_string() });
        }
        Ok(opened) => (opened, false),
        Err(OpenError::Damaged { .. }) => (read(path, false)?, true),
        Err(e) => return Err(e.into()),
    };
    // A start that cannot be built is no start.
    if let Err(e) = sculptd_clay::Clay::build(&opened.start, &sculptd_geometry::job::Job::default())
    {
        return Err(OpenError::Damaged {
            path: path.display().to_string(),
            what: "start_mesh",
            source: e.into(),
        }
        .into());
    }
    let new = create_beside(path, &opened)?;
    if let Err(source) = copy(&new, &opened) {
        // Half a file helps nobody, and the old one is still there.
        let _ = std::fs::remove_file(&new);
        return Err(SalvageError::Store { path: new.display().to_string(), source });
    }
    Ok(Saved { old: path.into(), path: new, loss: opened.loss, start_changed })
}

fn create_beside(path: &Path, opened: &Opened) -> Result<PathBuf, SalvageError> {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    for n in 1..=NAMES {
        let name = if n == 1 {
            format!("{stem}.saved.sculpt")
        } else {
            format!("{stem}.saved-{n}.sculpt")
        };
        let new = path.with_file_name(name);
        match writer::create(&new, &opened.start, &opened.settings) {
            Ok((writer, thread)) => {
                drop(writer);
                thread.finish();
                return Ok(new);
            }
            Err(CreateError::Exists { .. }) => {}
            Err(e) => return Err(e.into()),
        }
    }
    Err(SalvageError::NoName { path: path.display().to_string() })
}

fn copy(new: &Path, opened: &Opened) -> rusqlite::Result<()> {
    let mut db = Connection::open(new)?;
    db.pragma_update(None, "synchronous", "full")?;
    let all = db.transaction()?;
    {
        let mut put = all.prepare(
            "INSERT INTO log (first_tick, last_tick, crc, data) VALUES (?1, ?2, ?3, ?4)",
        )?;
        let mut data = Vec::new();
        for group in opened.input.chunks(GROUP) {
            data.clear();
            for t in group {
                append(&mut data, t.tick, &t.samples, &t.commands);
            }
            let (first, last) = (group[0].tick, group[group.len() - 1].tick);
            put.execute((first as i64, last as i64, crc32fast::hash(&data), &data))?;
        }
    }
    all.commit()
}

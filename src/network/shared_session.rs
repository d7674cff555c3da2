//! The files of a joining replica: a session for each world received as a checkpoint, recorded from
//! there on. Earlier work is in the files of others.

use std::path::{Path, PathBuf};

use sculptd_daemon::session::format::Settings;
use sculptd_daemon::session::{self, SessionStart};
use sculptd_daemon::shared_input::SharedJournal;
use sculptd_engine::world::World;

/// Names that are tried.
const NAMES: u32 = 10_000;

/// Destination of the sessions.
#[derive(Debug)]
pub struct SharedSession {
    path: PathBuf,
    settings: Settings,
}

impl SharedSession {
    /// The first session has this name unless a file has it already: the one that a host wrote from
    /// the beginning, or an earlier one. Those after it are `NAME-2.sculpt` and so on.
    pub fn new(path: &Path, settings: Settings) -> SharedSession {
        SharedSession { path: path.into(), settings }
    }

    /// Begins a file with a world that is at rest. The history of single steps is not kept: undo
    /// in a shared sculpture goes as far back as memory does.
    ///
    /// # Errors
    /// The file cannot be created; the text says why.
    pub fn begin(&self, world: &mut World, rate_hz: u32) -> Result<SharedJournal, String> {
        let start = SessionStart::of_world(world).ok_or("the world is not at rest")?;
        let names = (2..=NAMES).map(|n| numbered(&self.path, n));
        let path = std::iter::once(self.path.clone())
            .chain(names)
            .find(|p| !p.exists())
            .ok_or_else(|| format!("{}: too many of that name", self.path.display()))?;
        let settings = Settings { rate_hz, ..self.settings.clone() };
        let journal = session::create(&path, start, &settings).map_err(|e| e.to_string())?;
        tracing::info!("recorded from here on in {}", path.display());
        Ok(Box::new(journal))
    }
}

fn numbered(path: &Path, n: u32) -> PathBuf {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let ending = path.extension().map_or("sculpt".into(), |e| e.to_string_lossy().into_owned());
    path.with_file_name(format!("{stem}-{n}.{ending}"))
}

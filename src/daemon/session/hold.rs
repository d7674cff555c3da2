//! The right to write a session, which one daemon has at a time.

use std::fs::{File, TryLockError};
use std::path::Path;
use std::sync::Arc;

use super::create::CreateError;

/// Keeps other daemons from writing a session, until it is dropped or the process ends.
#[derive(Debug)]
pub struct HeldSession(pub(super) Arc<File>);

/// Holds a session. Whoever goes on with one holds it before reading it: what is read later is
/// what its last daemon left.
///
/// # Errors
/// Returns [`CreateError::Busy`] while another daemon writes it, or the system's error.
pub fn hold(path: &Path) -> Result<HeldSession, CreateError> {
    let name = || path.display().to_string();
    let file = File::options()
        .read(true)
        .write(true)
        .open(path)
        .map_err(|source| CreateError::Io { path: name(), source })?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(CreateError::Busy { path: name() }),
        // A file system without locks: as before there were any.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(HeldSession(Arc::new(file))),
    }
}

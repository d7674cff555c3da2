//! The record of what an install wrote, by which an uninstall knows what it may remove.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{SetupError, at, below};
use sculptd_geometry::io::write_beside;

/// The record, below the root of the system.
pub const RECORD: &str = "/var/lib/sculptd/kiosk-install.json";

/// Everything that an install wrote.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct InstallRecord {
    /// The user of the installation.
    pub user: String,
    /// The user's folder.
    pub home: String,
    /// Paths and what was written there.
    pub files: BTreeMap<String, String>,
    /// Folders that were made, the outer ones first.
    pub folders: Vec<String>,
}

impl InstallRecord {
    /// Reads the record of the system below `root`; `None`: there is none.
    pub fn read(root: &Path) -> Result<Option<InstallRecord>, SetupError> {
        let path = below(root, RECORD);
        let text = match std::fs::read_to_string(&path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            text => text.map_err(at(&path))?,
        };
        let record = serde_json::from_str(&text);
        record.map(Some).map_err(|e| at(&path)(io::Error::other(e)))
    }

    /// Writes it. Only root reads it, because it has the PIN of the staff.
    pub fn write(&self, root: &Path) -> Result<(), SetupError> {
        let path = below(root, RECORD);
        let text = serde_json::to_string_pretty(self).map_err(io::Error::other);
        let text = text.map_err(at(&path))?;
        write_beside(&path, |out| out.write_all(text.as_bytes())).map_err(at(&path))
    }
}

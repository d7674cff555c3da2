//! Earlier sculptures, as the wall of them shows them.

use std::path::PathBuf;

/// An earlier sculpture that can be opened.
#[derive(Clone)]
pub struct EarlierWork {
    /// Its session file.
    pub path: PathBuf,
    /// Its newest small picture; `None`: it has none, or it is still being read.
    pub picture: Option<egui::TextureHandle>,
    /// What people must know before they open it: what is missing of it, or that its program did
    /// not end cleanly.
    pub told: Option<String>,
}

impl std::fmt::Debug for EarlierWork {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // A texture has nothing to tell.
        f.debug_struct("EarlierWork").field("path", &self.path).finish_non_exhaustive()
    }
}

/// The wall of earlier sculptures.
#[derive(Debug, Default)]
pub struct EarlierWorks {
    /// The newest first.
    pub all: Vec<EarlierWork>,
    /// The offer at the start was answered.
    pub answered: bool,
    /// A person has asked for the wall.
    pub open: bool,
}

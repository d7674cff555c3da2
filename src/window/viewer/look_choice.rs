//! The viewer's state of the chosen look of the clay.

use super::look_files::LookFilesWanted;
use crate::look::Light;

/// Choices at the last request for pictures.
#[derive(Debug, Default)]
pub(super) struct LookChoice {
    pub(super) asked: LookFilesWanted,
    /// Light of the clay, and the opacity of the reference behind it.
    pub(super) shown: (Light, u32),
}

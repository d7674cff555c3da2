//! What was chosen for the look of the clay, as the viewer has it.

use super::look_files::LookFilesWanted;
use crate::look::Light;

/// What was chosen when the pictures were asked for last.
#[derive(Debug, Default)]
pub(super) struct LookChoice {
    pub(super) asked: LookFilesWanted,
    /// What lights the clay, and how dense the reference is behind it.
    pub(super) shown: (Light, u32),
}

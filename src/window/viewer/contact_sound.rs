//! What the window has of the sound of the contact.

use crate::sound::Player;
use crate::sound::heard::Heard;

/// What is heard, and what plays it.
#[derive(Debug, Default)]
pub(super) struct ContactSound {
    pub(super) heard: Heard,
    pub(super) player: Option<Player>,
    /// It was told why nothing plays; asked for anew, it is tried anew.
    pub(super) failed: bool,
}

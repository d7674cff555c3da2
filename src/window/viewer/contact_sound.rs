//! What the window has of the sound of the contact.

use crate::sound::Player;
use crate::sound::heard::Heard;

/// State of the contact sound, and its player.
#[derive(Debug, Default)]
pub(super) struct ContactSound {
    pub(super) heard: Heard,
    pub(super) player: Option<Player>,
    /// True after its failure was reported; switching the sound on again retries.
    pub(super) failed: bool,
}

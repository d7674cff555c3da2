//! A program that was built without the feature `sound`: nothing plays.

use super::contact::Touch;
use super::no_sound::NoSound;

/// There is none.
#[derive(Debug)]
pub enum NoPlayer {}

impl NoPlayer {
    /// # Errors
    /// Always: [`NoSound::NotBuilt`].
    pub fn open() -> Result<NoPlayer, NoSound> {
        Err(NoSound::NotBuilt)
    }

    pub fn play(&mut self, _: &Touch, _: bool) -> Option<NoSound> {
        match *self {}
    }
}

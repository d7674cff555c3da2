//! What the hand does to the clay, as a quiet sound: for hands that feel nothing, and for eyes that
//! look elsewhere. Sonification by parameter mapping (Grond and Berger, The Sonification Handbook,
//! 2011, chapter 15): pressure is loudness, speed is brightness, the brush is the pitch.
//!
//! [`heard`] says what is done from what was published, [`contact`] computes samples of it, and
//! the [`Player`] of the feature `sound` plays them on a thread of the sound system. The tick
//! knows none of them: it neither waits for them nor writes for them.

pub mod contact;
pub mod heard;
#[cfg(not(feature = "sound"))]
mod no_player;
pub mod no_sound;
#[cfg(feature = "sound")]
mod player;

#[cfg(not(feature = "sound"))]
pub use no_player::NoPlayer as Player;
#[cfg(feature = "sound")]
pub use player::Player;

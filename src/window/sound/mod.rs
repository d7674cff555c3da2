//! What the hand does to the clay, as a quiet sound: for hands that feel nothing, and for eyes that
//! look elsewhere. Sonification by parameter mapping (Grond and Berger, The Sonification Handbook,
//! 2011, chapter 15): pressure is loudness, speed is brightness, the brush is the pitch.
//!
//! [`heard`] says what is done from what was published, [`contact`] computes samples of it, and
//! [`player`], with the feature `sound`, plays them on a thread of the sound system. None of them is
//! known to the tick, which neither waits for them nor writes for them.

pub mod contact;
pub mod heard;
pub mod no_sound;
#[cfg_attr(not(feature = "sound"), path = "no_player.rs")]
pub mod player;

//! Why nothing is heard.

/// Why nothing plays.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoSound {
    /// The program was built without sound.
    NotBuilt,
    /// The error of the sound system.
    Failed(String),
}

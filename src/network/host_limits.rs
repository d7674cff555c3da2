//! The bounds that a host holds, and its times.

/// People in one sculpture at once.
pub const MAX_MEMBERS: usize = 64;
/// Bytes that a member may send at once, and a second: a command with a mesh, then strokes.
pub const BYTES: (f64, f64) = (24e6, 512e3);
/// Of these a member uses this share for what is large: the rest is for strokes.
pub const LARGE_SHARE: f64 = 0.8;
/// Samples, commands and batches of a member that are taken at once, and a second: what was given
/// while the network was gone for a while, then a person with several devices.
pub const ENTRIES: (f64, f64) = (20e3, 2e3);
/// Refusals of greetings that are sent at once, and a second, to all strangers together.
pub const REFUSALS: (f64, f64) = (64.0, 20.0);
/// Signatures of greetings that are checked at once, and a second: a tenth of a processor's time.
pub const CHECKS: (f64, f64) = (500.0, 500.0);
/// Microseconds between two looks for other hosts of the same name.
pub const LOOK_US: u64 = 1_000_000;
/// Microseconds between two looks whether an invitation has ended, and between two words about a
/// new list of members to one who does not know it.
pub const MEMBERS_US: u64 = 500_000;
/// Batches of one person that wait for their ticks.
pub const MAX_WAITING: usize = 4096;
/// Violations after which a member is sent away.
pub const PATIENCE: u32 = 200;
/// A member that was not heard for so long is gone.
pub const GONE_US: u64 = 5_000_000;
/// A host that had replicas and has none waits so long before it acknowledges alone.
pub const ALONE_US: u64 = 15_000_000;
/// Strokes are waited for so long before a checkpoint ends them.
pub const REST_US: u64 = 2_000_000;
/// After the last input so long every tick has its frame.
pub const BUSY_US: u64 = 1_000_000;
/// Chunks that one request may ask for.
pub const MAX_WANTED: u32 = 256;
/// Frames after which a checkpoint is not given to who joins: another is made. Half a minute of
/// frames takes less time to come than another checkpoint.
pub const RECENT: u64 = 3600;
/// The end of the reason why nobody else of the same name is let in.
pub const HERE_ALREADY: &str = "is here already";

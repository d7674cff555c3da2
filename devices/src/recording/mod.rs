//! Recordings: raw stamped bytes of real devices, and how they are fed again through the live path.

mod device_info;
mod hands;
pub mod hid_recorder;
mod pens;
mod player;
pub mod raw;

use std::path::PathBuf;

pub use device_info::{DeviceInfo, DeviceKind};
pub use player::Player;

/// A HID device as it was recorded: one [`crate::catalogue::Identity`] an interface, and every
/// report in order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HidRecording {
    pub interfaces: Vec<crate::catalogue::Identity>,
    /// Every report, in order of time.
    pub reports: Vec<Stamped>,
    /// Number of the last line, from 1, where it was cut off and therefore left out.
    pub cut_at: Option<usize>,
}

/// One report.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stamped {
    /// Microseconds since the first report; never less than the one before.
    pub t_us: u64,
    /// Index into [`HidRecording::interfaces`].
    pub interface: usize,
    pub bytes: Vec<u8>,
}

#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    #[error("{}: {error}", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error("{}:{line}: {what}", path.display())]
    Broken { path: PathBuf, line: usize, what: String },
    /// No interface of the device is known: one reason each.
    #[error("{}: no known device in this recording ({why})", path.display())]
    Unknown { path: PathBuf, why: String },
}

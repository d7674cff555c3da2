//! Recordings: the raw bytes of real devices with their times, and how they are played through the
//! live decoders.

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
    /// Identity of each interface.
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
    /// The report, its id first where the device has ids.
    pub bytes: Vec<u8>,
}

/// Why a recording cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be read.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// A line is not what it should be.
    #[error("{}:{line}: {what}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// The fault, and the expected content.
        what: String,
    },
    /// No interface of the device is known.
    #[error("{}: no known device in this recording ({why})", path.display())]
    Unknown {
        /// The file.
        path: PathBuf,
        /// One reason for each interface.
        why: String,
    },
}

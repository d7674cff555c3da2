//! A tracker's recorded frames, decoded by the same parser as a live connection's.

use std::path::Path;

use super::RecordingError;
use crate::leap::{FrameFile, Message, parse_message};
use crate::sample::{Body, DeviceId, Hands, Sample};

/// Every frame of a file, with its time from the first on.
#[derive(Debug, Clone, Default)]
pub(super) struct HandRecording {
    pub frames: Vec<(u64, Option<u64>, Hands)>,
}

/// A file that starts like one: gzipped, or with a JSON object.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
        || bytes.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{')
}

pub(super) fn open(path: &Path) -> Result<HandRecording, RecordingError> {
    let broken =
        |line: usize, what: String| RecordingError::Broken { path: path.to_owned(), line, what };
    let file = FrameFile::open(path)
        .map_err(|error| RecordingError::Io { path: path.to_owned(), error })?;
    let mut out = HandRecording::default();
    for (i, line) in file.enumerate() {
        let (t_us, text) = line.map_err(|e| broken(i + 1, e.to_string()))?;
        match parse_message(&text).map_err(|e| broken(i + 1, e.to_string()))? {
            Message::Frame(f) => out.frames.push((t_us, f.device_t_us, f.hands)),
            Message::Version(_) | Message::Device { .. } | Message::Other => {}
        }
    }
    if out.frames.is_empty() {
        return Err(broken(1, "no frame: not a tracker's recording".to_owned()));
    }
    Ok(out)
}

impl HandRecording {
    pub(super) fn sample(&self, i: usize, device: DeviceId, offset_us: u64) -> Sample {
        let (t_us, device_t_us, hands) = self.frames[i];
        Sample {
            device,
            t_us: t_us.saturating_add(offset_us),
            device_t_us,
            body: Body::Hands(hands),
        }
    }

    /// The last word: every hand has gone.
    pub(super) fn farewell(&self, device: DeviceId, offset_us: u64) -> Option<Sample> {
        let (t_us, device_t_us, last) = self.frames.last()?;
        let gone = Hands { frame: last.frame.saturating_add(1), ..Hands::default() };
        let t_us = t_us.saturating_add(offset_us);
        (last.count > 0).then_some(Sample {
            device,
            t_us,
            device_t_us: *device_t_us,
            body: Body::Hands(gone),
        })
    }
}

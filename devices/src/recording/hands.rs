//! A tracker's recorded frames, decoded by the same parser as a live connection's.

use std::io::ErrorKind;
use std::path::Path;

use super::RecordingError;
use crate::leap::{FrameFile, Message, parse_message};
use crate::sample::{Body, DeviceId, Hands, Sample};

/// Every frame of a file, with its time from the first on.
#[derive(Debug, Clone, Default)]
pub(super) struct HandRecording {
    pub frames: Vec<(u64, Option<u64>, Hands)>,
    /// Number of the last line, from 1, where it was cut off and therefore left out.
    pub cut_at: Option<usize>,
    /// Lines before it that cannot be read and are left out, as a live connection leaves them out;
    /// and the number of the first, from 1.
    pub skipped: Option<(usize, usize)>,
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
    let (mut bad, mut first_why, mut last) = (Vec::new(), None, 0);
    for (i, line) in file.enumerate() {
        let message = match line {
            Ok((t_us, text)) => parse_message(&text).map(|m| (t_us, m)).map_err(|e| e.to_string()),
            // A gzipped file that was cut off ends in this error, again and again.
            Err(e) if e.kind() == ErrorKind::UnexpectedEof && !out.frames.is_empty() => {
                out.cut_at = Some(i + 1);
                break;
            }
            Err(e) => return Err(broken(i + 1, e.to_string())),
        };
        match message {
            Ok((t_us, Message::Frame(f))) => out.frames.push((t_us, f.device_t_us, f.hands)),
            Ok(_) => {}
            Err(why) => {
                bad.push(i + 1);
                first_why.get_or_insert((i + 1, why));
            }
        }
        last = i + 1;
    }
    // A file that is no recording has more lines that cannot be read than frames.
    if let Some((line, why)) = first_why.filter(|_| bad.len() > out.frames.len()) {
        return Err(broken(line, why));
    }
    if bad.last() == Some(&last) && !out.frames.is_empty() {
        bad.pop();
        out.cut_at = out.cut_at.or(Some(last));
    }
    out.skipped = bad.first().map(|first| (bad.len(), *first));
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

    /// The last sample: every hand has left.
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

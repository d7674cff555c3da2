//! Recorded frames: one JSON message a line, the first the version's, plain or gzipped.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use flate2::bufread::GzDecoder;
use serde::Deserialize;

use super::frame::MAX_MESSAGE;

/// The step between frames of a recording without usable times: 100 frames a second.
const USUAL_STEP_US: u64 = 10_000;

/// A longer gap than this between two frames is a cut in the recording, not time that passed.
const MAX_STEP_US: u64 = 5_000_000;

/// The lines of a recording, each with its time from the first frame on.
pub struct FrameFile {
    lines: Box<dyn BufRead + Send>,
    t_us: u64,
    last_stamp: Option<u64>,
    any: bool,
}

impl std::fmt::Debug for FrameFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FrameFile").field("t_us", &self.t_us).finish_non_exhaustive()
    }
}

#[derive(Deserialize)]
struct Stamp {
    timestamp: Option<f64>,
}

impl FrameFile {
    /// Opens a frame file. Whether it is gzipped is seen by its first two bytes, not by its name.
    pub fn open(path: &Path) -> io::Result<Self> {
        Self::from_reader(File::open(path)?)
    }

    /// The same, from any source of bytes.
    pub fn from_reader(source: impl Read + Send + 'static) -> io::Result<Self> {
        let mut source = BufReader::new(source);
        let zipped = source.fill_buf()?.starts_with(&[0x1f, 0x8b]);
        let lines: Box<dyn BufRead + Send> = if zipped {
            Box::new(BufReader::new(GzDecoder::new(source)))
        } else {
            Box::new(source)
        };
        Ok(FrameFile { lines, t_us: 0, last_stamp: None, any: false })
    }

    fn next_line(&mut self) -> io::Result<Option<String>> {
        loop {
            let mut line = Vec::new();
            let cap = MAX_MESSAGE as u64 + 2;
            if self.lines.by_ref().take(cap).read_until(b'\n', &mut line)? == 0 {
                return Ok(None);
            }
            if line.len() as u64 == cap {
                return Err(io::Error::new(
                    io::ErrorKind::InvalidData,
                    format!("a line of more than {MAX_MESSAGE} bytes"),
                ));
            }
            let line = String::from_utf8(line)
                .map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e))?;
            if !line.trim().is_empty() {
                return Ok(Some(line.trim_end().to_owned()));
            }
        }
    }

    /// Time passes with the tracker's stamps; where they run backwards, jump or are missing, at the
    /// usual rate.
    fn advance(&mut self, line: &str) {
        let stamp = serde_json::from_str::<Stamp>(line).ok().and_then(|s| s.timestamp);
        let stamp = stamp.filter(|t| *t >= 0.0 && *t < 9e15).map(|t| t as u64);
        if self.any {
            let step = stamp.zip(self.last_stamp).and_then(|(new, old)| new.checked_sub(old));
            self.t_us += step.filter(|s| *s <= MAX_STEP_US).unwrap_or(USUAL_STEP_US);
        }
        self.any |= stamp.is_some() || line.contains("\"hands\"");
        self.last_stamp = stamp.or(self.last_stamp);
    }
}

impl Iterator for FrameFile {
    /// Microseconds since the first frame, and the message's text.
    type Item = io::Result<(u64, String)>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.next_line() {
            Ok(None) => None,
            Ok(Some(line)) => {
                self.advance(&line);
                Some(Ok((self.t_us, line)))
            }
            Err(e) => Some(Err(e)),
        }
    }
}

//! Motion JPEG: one picture after the other, nothing between them (`ffmpeg -f mjpeg`).

use std::fs::File;
use std::io::{BufRead, BufReader};

use super::{CameraError, PictureSource, USUAL_RATE, jpeg};
use crate::picture::Picture;

/// Longest picture, bytes.
const MAX_BYTES: usize = 64 << 20;

/// A Motion JPEG file.
#[derive(Debug)]
pub(super) struct MotionJpegFile {
    name: String,
    input: BufReader<File>,
    number: u64,
}

impl MotionJpegFile {
    pub(super) fn new(name: String, file: File) -> Self {
        MotionJpegFile { name, input: BufReader::new(file), number: 0 }
    }

    /// Returns the bytes from one start marker to before the next; empty at the end.
    fn piece(&mut self) -> std::io::Result<Vec<u8>> {
        let mut piece: Vec<u8> = Vec::new();
        loop {
            let read = self.input.read_until(0xff, &mut piece)?;
            if read == 0 {
                return Ok(piece);
            }
            let next = self.input.fill_buf()?.first().copied();
            // A start marker inside a picture would be a thumbnail, in a segment of its own; the
            // pictures of a camera have none.
            if next == Some(0xd8) && piece.len() > 2 {
                // The marker's first byte is taken already: the next piece begins after it.
                piece.pop();
                self.input.consume(1);
                return Ok(piece);
            }
            if piece.len() > MAX_BYTES {
                return Ok(piece);
            }
        }
    }
}

impl PictureSource for MotionJpegFile {
    fn next_picture(&mut self) -> Result<Option<(u64, Picture)>, CameraError> {
        let mut piece =
            self.piece().map_err(|source| CameraError::Io { name: self.name.clone(), source })?;
        if piece.is_empty() {
            return Ok(None);
        }
        self.number += 1;
        if self.number > 1 {
            // The start marker went with the piece before.
            piece.splice(0..0, [0xff, 0xd8]);
        }
        let t_us = ((self.number - 1) as f64 * 1e6 / USUAL_RATE) as u64;
        match jpeg::decode(&piece) {
            Ok(picture) => Ok(Some((t_us, picture))),
            Err(why) => {
                Err(CameraError::Damaged { name: self.name.clone(), number: self.number, why })
            }
        }
    }

    fn describe(&self) -> String {
        format!("{}: Motion JPEG, {USUAL_RATE} pictures a second", self.name)
    }
}

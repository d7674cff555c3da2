//! Y4M: uncompressed pictures with a header of text, as ffmpeg writes them (`-pix_fmt yuv420p`).

use std::fs::File;
use std::io::{BufRead, BufReader, Read};

use super::{CameraError, PictureSource, USUAL_RATE, yuv};
use crate::picture::{MAX_PIXELS, Picture};

/// Longest line of a header.
const MAX_LINE: u64 = 4096;

/// A Y4M file.
#[derive(Debug)]
pub(super) struct Y4mFile {
    name: String,
    input: BufReader<File>,
    size: (usize, usize),
    /// Pixels that one colour difference covers; `None`: there are none.
    step: Option<(usize, usize)>,
    full: bool,
    rate: f64,
    number: u64,
    /// Damaged in such a way that nothing after it can be read.
    ended: bool,
}

impl Y4mFile {
    pub(super) fn open(name: String, file: File) -> Result<Self, CameraError> {
        let mut y4m = Y4mFile {
            name,
            input: BufReader::new(file),
            size: (0, 0),
            step: Some((2, 2)),
            full: false,
            rate: USUAL_RATE,
            number: 0,
            ended: false,
        };
        let header = y4m.line()?;
        for word in header.split_whitespace().skip(1) {
            y4m.parameter(word).map_err(|why| y4m.damaged(why))?;
        }
        let (width, height) = y4m.size;
        let pixels = width.saturating_mul(height);
        if width < 2 || height < 2 || pixels > MAX_PIXELS {
            return Err(y4m.damaged(format!("its size is {width} by {height} pixels")));
        }
        Ok(y4m)
    }

    fn damaged(&self, why: String) -> CameraError {
        CameraError::Damaged { name: self.name.clone(), number: self.number.max(1), why }
    }

    fn line(&mut self) -> Result<String, CameraError> {
        let mut line = Vec::new();
        let read = self.input.by_ref().take(MAX_LINE).read_until(b'\n', &mut line);
        read.map_err(|source| CameraError::Io { name: self.name.clone(), source })?;
        if line.len() as u64 == MAX_LINE {
            return Err(self.damaged("a header without end".into()));
        }
        Ok(String::from_utf8_lossy(&line).trim_end().to_owned())
    }

    fn parameter(&mut self, word: &str) -> Result<(), String> {
        let bad = || format!("the header says {word}");
        let (kind, value) = word.split_at_checked(1).ok_or_else(bad)?;
        match kind {
            "W" => self.size.0 = value.parse().map_err(|_| bad())?,
            "H" => self.size.1 = value.parse().map_err(|_| bad())?,
            "F" => {
                let (a, b) = value.split_once(':').ok_or_else(bad)?;
                let (a, b): (f64, f64) =
                    (a.parse().map_err(|_| bad())?, b.parse().map_err(|_| bad())?);
                if !(a > 0.0 && b > 0.0 && (0.1..=1000.0).contains(&(a / b))) {
                    return Err(bad());
                }
                self.rate = a / b;
            }
            "C" if value.starts_with("420") && !value.starts_with("420p1") => {
                (self.step, self.full) = (Some((2, 2)), value == "420jpeg");
            }
            "C" if value == "422" => self.step = Some((2, 1)),
            "C" if value == "444" => self.step = Some((1, 1)),
            "C" if value == "mono" => self.step = None,
            "C" => return Err(format!("pixels of kind {value}; use 420, 422, 444 or mono")),
            "X" if value == "COLORRANGE=FULL" => self.full = true,
            _ => {}
        }
        Ok(())
    }
}

impl PictureSource for Y4mFile {
    fn next_picture(&mut self) -> Result<Option<(u64, Picture)>, CameraError> {
        if self.ended {
            return Ok(None);
        }
        let header = self.line()?;
        if header.is_empty() {
            return Ok(None);
        }
        self.number += 1;
        if !header.starts_with("FRAME") {
            // Everything after it would be read at the wrong place.
            self.ended = true;
            return Err(self.damaged("its header is not FRAME".into()));
        }
        let (width, height) = self.size;
        let light = width * height;
        let colour = self.step.map_or(0, |(x, y)| width.div_ceil(x) * height.div_ceil(y));
        let mut bytes = vec![0; light + 2 * colour];
        if let Err(e) = self.input.read_exact(&mut bytes) {
            return match e.kind() {
                std::io::ErrorKind::UnexpectedEof => Err(self.damaged("it is cut off".into())),
                _ => Err(CameraError::Io { name: self.name.clone(), source: e }),
            };
        }
        let (y, rest) = bytes.split_at(light);
        let (u, v) = rest.split_at(colour);
        let step = self.step.unwrap_or((1, 1));
        let picture = yuv::of_planes([y, u, v], self.size, step, self.full);
        let t_us = ((self.number - 1) as f64 * 1e6 / self.rate) as u64;
        Ok(Some((t_us, picture)))
    }

    fn describe(&self) -> String {
        let (w, h) = self.size;
        format!("{}: Y4M, {w} by {h} pixels, {:.3} a second", self.name, self.rate)
    }
}

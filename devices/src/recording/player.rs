//! Feeds a recording through the same parser and state that a live device is read with.

use std::path::Path;

use super::device_info::{DeviceInfo, DeviceKind};
use super::hands::HandRecording;
use super::pens::PenPlayer;
use super::{HidRecording, RecordingError, hands, hid_recorder, raw};
use crate::catalogue::Catalogue;
use crate::pressure_use::PressureUse;
use crate::sample::{DeviceId, Sample};

#[derive(Debug)]
enum Source {
    Pen(PenPlayer),
    Hands(HandRecording),
}

/// A recording being played.
#[derive(Debug)]
pub struct Player {
    info: DeviceInfo,
    source: Source,
    next: usize,
    offset_us: u64,
    ended: bool,
}

impl Player {
    /// Opens a recording of any kind that is known, and finds its device.
    pub fn open(
        path: &Path,
        device: DeviceId,
        catalogue: &Catalogue,
    ) -> Result<Player, RecordingError> {
        let bytes = std::fs::read(path)
            .map_err(|error| RecordingError::Io { path: path.to_owned(), error })?;
        if hands::looks_like(&bytes) {
            let recording = hands::open(path)?;
            let info = DeviceInfo {
                name: "hand tracker".to_owned(),
                kind: DeviceKind::Hand,
                area_mm: glam::Vec2::ZERO,
                device,
                notes: recording
                    .skipped
                    .map(|(n, first)| skip_warning(path, n, first))
                    .into_iter()
                    .chain(recording.cut_at.map(|line| cut_warning(path, line)))
                    .collect(),
            };
            return Ok(Player::with(info, Source::Hands(recording)));
        }
        let broken = |line, what| RecordingError::Broken { path: path.to_owned(), line, what };
        if bytes.contains(&0) {
            return Err(broken(1, "binary data: not a recording".to_owned()));
        }
        let text = String::from_utf8_lossy(&bytes);
        let parsed =
            if raw::looks_like(&bytes) { raw::parse(&text) } else { hid_recorder::parse(&text) };
        let recording = parsed.map_err(|b| broken(b.line, b.what))?;
        Player::of(path, recording, device, catalogue)
    }

    /// Plays a recording that is already in memory; `path` names it in errors.
    pub fn of(
        path: &Path,
        recording: HidRecording,
        device: DeviceId,
        catalogue: &Catalogue,
    ) -> Result<Player, RecordingError> {
        let cut_at = recording.cut_at;
        let (pen, mut info) = PenPlayer::of(path, recording, device, catalogue)?;
        info.notes.extend(cut_at.map(|line| cut_warning(path, line)));
        Ok(Player::with(info, Source::Pen(pen)))
    }

    fn with(info: DeviceInfo, source: Source) -> Player {
        Player { info, source, next: 0, offset_us: 0, ended: false }
    }

    /// Returns the recorded device.
    pub fn device(&self) -> &DeviceInfo {
        &self.info
    }

    /// Returns how its pen has used the pressure range so far; the default for hands.
    pub fn pressure_use(&self) -> PressureUse {
        match &self.source {
            Source::Pen(p) => p.pressure_use(),
            Source::Hands(_) => PressureUse::default(),
        }
    }

    /// Adds `us` to every time from here on, so that the first report falls at `us`.
    pub fn start_at(&mut self, us: u64) {
        self.offset_us = us;
    }

    /// Returns the time of the next report, relative to the first; `None` after the last one.
    pub fn next_due_us(&self) -> Option<u64> {
        match &self.source {
            Source::Pen(p) => p.recording.reports.get(self.next).map(|r| r.t_us),
            Source::Hands(h) => h.frames.get(self.next).map(|f| f.0),
        }
    }

    /// Every report was played, and whatever was in range has left.
    pub fn finished(&self) -> bool {
        self.ended
    }

    /// Plays every report due up to `until_us`, relative to the first report, that one included.
    /// After the last, whatever is in range leaves.
    pub fn advance(&mut self, until_us: u64, emit: &mut dyn FnMut(Sample)) {
        let mut last = 0;
        while let Some(due) = self.next_due_us().filter(|&due| due <= until_us) {
            last = due.saturating_add(self.offset_us);
            match &mut self.source {
                Source::Pen(p) => p.feed(self.next, last, emit),
                Source::Hands(h) => emit(h.sample(self.next, self.info.device, self.offset_us)),
            }
            self.next += 1;
        }
        let done = self.next_due_us().is_none();
        match &mut self.source {
            Source::Pen(p) if !done => p.tick(until_us.saturating_add(self.offset_us), emit),
            Source::Pen(p) if !self.ended => p.leave(last, emit),
            Source::Hands(h) if done && !self.ended => {
                h.farewell(self.info.device, self.offset_us).into_iter().for_each(&mut *emit);
            }
            _ => {}
        }
        self.ended = done;
    }
}

/// Warns of a recording whose last line was cut off, and gives the warning for people.
fn cut_warning(path: &Path, line: usize) -> String {
    let what = format!("line {line} was cut off and is left out");
    tracing::warn!("{}: {what}", path.display());
    what
}

/// Warns of lines that cannot be read, and gives the warning for people.
fn skip_warning(path: &Path, count: usize, first: usize) -> String {
    let lines = if count == 1 { "line" } else { "lines" };
    let what =
        format!("{count} {lines} cannot be read and are left out, the first is line {first}");
    tracing::warn!("{}: {what}", path.display());
    what
}
